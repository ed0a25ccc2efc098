// The time of all that moves by clips: one for the whole hall, so that garment and figure stay together, also after a tab
// slept. It can be stopped. For who has asked the system for less motion it stands until they start it.

/** createClock() -> {seconds(), stopped, toggle(), watch(act)}; act(stopped) hears of every change, and at once. */
export function createClock(now = () => performance.now()) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const heard = [];
  let lost = 0, stoppedAt = calm.matches ? 0 : null; // [ms]

  function stop(on) {
    if (on === (stoppedAt !== null)) return;
    if (on) stoppedAt = now() - lost;
    else {
      lost = now() - stoppedAt;
      stoppedAt = null;
    }
    for (const act of heard) act(on);
  }
  calm.addEventListener("change", () => stop(calm.matches));

  return {
    seconds: () => (stoppedAt ?? now() - lost) / 1000,
    get stopped() { return stoppedAt !== null; },
    toggle: () => stop(stoppedAt === null),
    watch(act) {
      heard.push(act);
      act(stoppedAt !== null);
    },
  };
}
