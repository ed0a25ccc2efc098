// What the page needs before a visitor can enter: descriptions, the clearance grid, viser's hooks, the drawn hall.

import { drawnOf, drawnOnce, framesDrawn } from "../viser/viser_adapter.js";
import { loadGrid } from "../walk/walkmath.js";

export const LOAD_PATIENCE = 120000; // [ms]

/** signal: ends the waiting, of an AbortController. */
export const fetchJson = async (url, signal) => {
  const answer = await fetch(url, { cache: "no-cache", signal });
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer.json();
};

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** The first truthy value of `test()`, null after `patience` [ms], which does not run while `held()`. */
export async function until(test, patience, { every = 50, held = () => false } = {}) {
  for (let end = performance.now() + patience; performance.now() < end; await pause(every)) {
    const value = test();
    if (value) return value;
    if (held()) end = performance.now() + patience;
  }
  return null;
}

/** The grid the page predicts its way on, null where the server has to walk. */
export async function loadClearance(walk) {
  if (walk.mode !== "predict" || !walk.grid) return null;
  try {
    const answer = await fetch(walk.grid.url);
    if (!answer.ok) throw new Error(String(answer.status));
    return loadGrid(await answer.arrayBuffer(), walk.grid);
  } catch (error) {
    console.warn("no clearance grid, the server walks:", error);
    return null;
  }
}

export function webglWorks() {
  return Boolean(document.createElement("canvas").getContext("webgl2"));
}

/**
 * Wait until the visitor is inside, every node of `awaited()` is there and a picture of them all has been drawn; tells
 * `progress(fraction)`. False where that took too long; waiting in the queue does not count.
 */
export async function loadHall(awaited, progress, { inside, held }) {
  let complete = null; // pictures drawn when the last node had come; the one under way may lack it
  const stands = await until(() => {
    const nodes = awaited(), left = nodes.length - drawnOf(nodes).length;
    progress(1 - left / nodes.length);
    if (left === 0) complete ??= framesDrawn();
    return left === 0 && drawnOnce() && framesDrawn() > complete + 1 && inside();
  }, LOAD_PATIENCE, { held });
  return stands !== null;
}
