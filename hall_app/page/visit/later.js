// What is not in the first view comes after it, one exhibit at a time, the nearest first: the page asks for the next when
// the last is drawn, and for none while a close-up is open, which would wait for it.

import { drawnOf } from "../viser/viser_adapter.js";

const LOOK_EVERY = 300; // [ms]
const AGAIN = { page: 10000, viser: 3000 }; // [ms] after which the next is asked for though the last has not come, or nobody sees it

/** createLater({display, nodes(), busy(), ask()}); nodes: names of all exhibits' nodes. */
export function createLater({ display, nodes, busy, ask }) {
  let before = -1, askedAt = 0, asked = 0;
  const look = () => {
    const all = nodes(), there = drawnOf(all).length;
    const unseen = display === "viser"; // nothing is known of what viser has drawn
    if (busy() || (unseen ? asked > all.length : there === all.length)) return;
    const now = performance.now();
    if (there === before && now - askedAt < AGAIN[display]) return;
    [before, askedAt, asked] = [there, now, asked + 1];
    ask();
  };
  look();
  setInterval(look, LOOK_EVERY);
}
