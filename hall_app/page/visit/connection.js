// The connection as the visitor is told of it: the walk's, and that of viser's picture, which comes by a socket of its
// own (line.js). Whoever is back on the walk and still without a picture is not back.

const VIEW_PATIENCE = 15000; // [ms] from the welcome to the picture's first message
const HELD = new Set(["queue", "full", "refused", "away"]); // not lost, only not yet our turn

/**
 * createConnection({view, tell, late}) -> {walk, inside, held}. view: HALL.view; tell(state, place) as notices.js takes
 * it; late() when the first picture does not come.
 */
export function createConnection({ view, tell, late }) {
  let state = "open", place = 0, welcomed = false, seen = false, timer = null;

  function render() {
    seen ||= view.here;
    clearTimeout(timer);
    if (welcomed && !seen) timer = setTimeout(late, VIEW_PATIENCE);
    tell(welcomed && seen && !view.here ? "lost" : state, place);
  }

  view.change = render;
  return {
    /** The walk's state, as walk.js tells it. */
    walk(next, at = 0) {
      state = next;
      place = at;
      welcomed = next === "open" || next === "waiting";
      render();
    },
    /** Welcomed, and the picture comes. */
    inside: () => welcomed && view.here,
    held: () => HELD.has(state),
  };
}
