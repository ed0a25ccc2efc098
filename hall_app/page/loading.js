// What the page needs before a visitor can enter: descriptions, the clearance grid, viser's hooks, the drawn hall.

import { drawnOnce, meshesOf } from "./hooks.js";
import { recall } from "./ui/words.js";
import { loadGrid } from "./walkmath.js";

const LOAD_PATIENCE = 120000; // [ms]

export const fetchJson = async (url) => {
  const answer = await fetch(url, { cache: "no-cache" });
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer.json();
};

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** The first truthy value of `test()`, null after `patience` [ms]. */
export async function until(test, patience, every = 50) {
  for (const end = performance.now() + patience; performance.now() < end; await pause(every)) {
    const value = test();
    if (value) return value;
  }
  return null;
}

/** The address' language, the remembered one, the browser's or the hall's. */
export function chosenLanguage(scene) {
  const asked = new URLSearchParams(location.search).get("lang") ?? recall("hall.lang");
  if (asked === "zh" || asked === "en") return asked;
  const own = navigator.language.slice(0, 2);
  return own === "zh" || own === "en" ? own : (scene.language ?? "en");
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

/** Wait until every node of the hall has been drawn; tells `progress(fraction, text)`. */
export async function loadHall(scene, progress) {
  await until(() => {
    const left = scene.nodes.filter((name) => meshesOf(name).length === 0).length;
    progress(0.1 + 0.85 * (1 - left / scene.nodes.length), "loading_models");
    return left === 0 && drawnOnce();
  }, LOAD_PATIENCE);
}
