// Which of viser's clients this page is. viser mounts the mark a moment after its socket opens, and another one
// whenever that had to connect again.

import { clientMark } from "../viser/viser_adapter.js";
import { until } from "./loading.js";

const PATIENCE = 10000; // [ms]
const LOOK_EVERY = 1000; // [ms]

/** createMark(display, onNew) -> {find()}; onNew(mark) when the page has become another client, until it gives true. */
export function createMark(display, onNew) {
  const read = () => (display === "page" ? clientMark() : document.querySelector("[data-hall-client]")?.dataset.hallClient);
  let mark = null, told = false;
  setInterval(() => {
    const now = read();
    if (!told || !now || now === mark) return;
    if (onNew(now)) mark = now;
  }, LOOK_EVERY);
  return {
    /** The mark, null where the scene takes too long: onNew tells it later. */
    async find() {
      mark = await until(read, PATIENCE);
      told = true;
      return mark;
    },
  };
}
