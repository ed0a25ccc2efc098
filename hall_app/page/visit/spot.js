// Where the visitor stands, kept for this tab: loading the page again leads back to the same spot and heading.

const KEY = "hall.spot";
const EVERY = 1000; // [ms] between two notes while walking
const FIELDS = ["x", "z", "yaw", "pitch", "eye"];

/** A visit by a link or a typed address begins at the entrance; one that is loaded again, or gone back to, goes on. */
function comesAgain() {
  const [navigation] = performance.getEntriesByType("navigation");
  return ["reload", "back_forward"].includes(navigation?.type);
}

/** The spot {x, z, eye [m], yaw, pitch [rad]} to come back to, null on a fresh visit. */
export function recallSpot() {
  if (!comesAgain()) return null;
  try {
    const spot = JSON.parse(sessionStorage.getItem(KEY));
    return FIELDS.every((name) => Number.isFinite(spot?.[name])) ? spot : null;
  } catch {
    return null; // storage forbidden, or not what we wrote
  }
}

/** createSpot(pose) -> {note(now)}: keeps pose() at most once a second, and on leaving the page. */
export function createSpot(pose) {
  let last = -Infinity;

  function keep() {
    const found = pose();
    if (!found) return;
    try {
      sessionStorage.setItem(KEY, JSON.stringify(Object.fromEntries(FIELDS.map((name) => [name, found[name]]))));
    } catch {
      // forgetting is fine
    }
  }

  addEventListener("pagehide", keep);
  return {
    note(now) {
      if (now - last < EVERY) return;
      last = now;
      keep();
    },
  };
}
