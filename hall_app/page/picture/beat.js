// The page's own beat: every frame while something moves, twice a second at rest. A hall is open all day.

const AWAKE = 1500; // [ms] after the last sign of movement
const REST = 500; // [ms] between two looks at rest
const NET = 20000; // [ms] between two pictures that nobody asked for

/**
 * Calls `frame(now)` ahead of viser's renderer (web/pages/door.py): what it sets is drawn in the same frame.
 * Returns {wake(ms), rest()}: go on every frame for so long; from now on only while something moves.
 */
export function createBeat(frame) {
  let awakeUntil = performance.now() + AWAKE, resting = 0;
  window.HALL.beforeFrame = frame;

  function beat() {
    resting = 0;
    if (performance.now() < awakeUntil) requestAnimationFrame(beat);
    else resting = setTimeout(() => requestAnimationFrame(beat), REST);
  }

  function wake(ms = AWAKE) {
    awakeUntil = Math.max(awakeUntil, performance.now() + ms);
    if (!resting) return;
    clearTimeout(resting);
    resting = 0;
    requestAnimationFrame(beat);
  }

  // viser draws once a second in case a change asked for no picture. Here every change asks for one.
  let netAt = performance.now();
  window.HALL.mayRest = () => {
    const now = performance.now();
    if (now < awakeUntil || now - netAt > NET) netAt = now;
    return netAt !== now;
  };

  beat();
  return { wake, rest: () => (awakeUntil = performance.now() + AWAKE) };
}
