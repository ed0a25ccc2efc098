// Who sees an exhibit move: a visitor who stands near, looks that way, and is there.

const SIGHT = 9; // [m]
const ASIDE = Math.cos((50 * Math.PI) / 180); // farther from the middle of the picture nobody sees it move
const PRESENT = 60e3; // [ms] after the last sign of life
const LIFE = ["pointermove", "pointerdown", "keydown", "wheel", "touchstart"];

/** Whether what stands at {x, z} is seen by a visitor at {x, z, yaw}. */
export function inSight({ x, z }, from) {
  const [dx, dz] = [x - from.x, z - from.z];
  const away = Math.hypot(dx, dz);
  const ahead = -Math.sin(from.yaw) * dx - Math.cos(from.yaw) * dz;
  return away < SIGHT && ahead > ASIDE * away;
}

/** createPresence() -> present(): whether the visitor has given a sign of life within the last minute, or just come back. */
export function createPresence() {
  let seenAt = 0;
  for (const sign of LIFE) addEventListener(sign, () => (seenAt = performance.now()), { capture: true, passive: true });
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) seenAt = performance.now();
  });
  return () => performance.now() - seenAt <= PRESENT;
}
