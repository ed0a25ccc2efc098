// What was tracked of the wearer of the open exhibit: fetched when it is first asked for, and drawn over the close-up, of
// the frame that its model shows. Each picture is drawn over right after it was made, by the camera that made it. While
// nobody asks, nothing is fetched, drawn or waited for.

import { CLOSEUP } from "../clip/clips.js";
import { canvas, placeOf, requestRender, whenDrawn } from "../../viser/viser_adapter.js";
import { createDrawing, product } from "./drawing.js";
import { readPoints } from "./points_file.js";

const SHARPEST = 2; // pixels a CSS pixel

async function fetched(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  const data = await readPoints(await answer.arrayBuffer());
  return { data, drawing: createDrawing(data) };
}

/**
 * createPoints() -> {element, show(url), hide(), draw(on), frame(shown), follow(act), told()}
 *
 * element: the canvas, to lie on the picture; draw(on): whether they are drawn; frame(shown): ahead of every picture, the
 * frame of the clip that the model in the close-up shows, null: it stands. act({data, row, failed}) hears of every
 * change; told(): what a test may ask.
 */
export function createPoints() {
  const element = Object.assign(document.createElement("canvas"), { className: "points", hidden: true });
  element.setAttribute("aria-hidden", "true");
  const pen = element.getContext("2d");
  const known = new Map(); // address -> what is there, or a promise of it
  let open = null, shown = null, row = 0, on = true, failed = false, heard = () => {}, took = 0;

  const tell = () => heard({ data: shown?.data ?? null, row, failed });

  function fit({ clientWidth: width, clientHeight: height }) {
    const ratio = Math.min(SHARPEST, devicePixelRatio || 1);
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (element.width !== wide || element.height !== high) Object.assign(element, { width: wide, height: high });
    else pen.clearRect(0, 0, wide, high);
    pen.setTransform(wide / width, 0, 0, high / height, 0, 0);
    return { width, height };
  }

  /** three.js calls it when a picture has been drawn. */
  function paint(_renderer, _scene, lens) {
    const began = performance.now(), picture = canvas(), place = placeOf(CLOSEUP);
    if (!picture?.clientHeight) return;
    const size = fit(picture);
    if (!place || !shown) return;
    const { elements: lensed } = lens.projectionMatrix;
    const matrix = product(product(lensed, lens.matrixWorldInverse.elements), place);
    shown.drawing.draw(pen, size, matrix, row, (lensed[5] * size.height) / 2);
    took = performance.now() - began;
  }

  function set() {
    const drawn = Boolean(open && shown && on);
    if (element.hidden !== drawn) return;
    element.hidden = !drawn;
    whenDrawn(drawn ? paint : null);
    requestRender();
  }

  function hide() {
    [open, shown, row, failed] = [null, null, 0, false];
    set();
  }

  return {
    element,
    async show(url) {
      if (url === open && !failed) return;
      hide();
      tell();
      open = url;
      if (!known.has(url)) known.set(url, fetched(url));
      try {
        const found = await known.get(url);
        if (url === open) shown = found;
      } catch (error) {
        console.warn("no tracked points:", error);
        known.delete(url); // the next one who asks may have it
        if (url === open) failed = true;
      }
      if (url !== open) return;
      set();
      tell();
    },
    hide,
    draw(next) {
      on = next;
      set();
    },
    frame(now) {
      if (!shown) return;
      if (on) whenDrawn(paint); // viser may have made another scene
      const { begin, rows } = shown.data;
      const next = now === null ? 0 : Math.min(begin + now, rows - 1);
      if (next === row) return;
      row = next;
      if (on) requestRender();
      tell();
    },
    follow(act) {
      heard = act;
      tell();
    },
    told: () => (element.hidden ? null : { frame: row - shown.data.begin, took, ...shown.drawing.drawn() }),
  };
}
