// Exhibits that turn on their stand (behaviour "turn_slowly"): only in sight of a visitor who is there, and who has not
// asked the system for less motion. Every page turns them for itself, so an empty or idle hall stands still.

import { requestRender, turnNode } from "../viser/viser_adapter.js";

const RATE = 0.25; // [rad/s]
const SIGHT = 9; // [m]
const ASIDE = Math.cos((50 * Math.PI) / 180); // farther from the middle of the picture nobody sees it turn
const PRESENT = 60e3; // [ms] after the last sign of life
const LIFE = ["pointermove", "pointerdown", "keydown", "wheel", "touchstart"];

/** createTurning(wake) -> {frame(dt, scene, {x, z, yaw})}; dt [s]. */
export function createTurning(wake) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const angles = new Map();
  let seenAt = 0;
  for (const sign of LIFE) addEventListener(sign, () => (seenAt = performance.now()), { capture: true, passive: true });

  function inSight({ x, z }, from) {
    const [dx, dz] = [x - from.x, z - from.z];
    const away = Math.hypot(dx, dz);
    const ahead = -Math.sin(from.yaw) * dx - Math.cos(from.yaw) * dz;
    return away < SIGHT && ahead > ASIDE * away;
  }

  function turn({ id, facing }, dt) {
    const angle = ((angles.get(id) ?? 0) + RATE * dt) % (2 * Math.PI);
    const half = ((facing * Math.PI) / 180 + angle) / 2;
    if (!turnNode(`/exhibits/${id}`, [Math.cos(half), 0, Math.sin(half), 0])) return;
    angles.set(id, angle);
    requestRender();
    wake();
  }

  return {
    frame(dt, scene, from) {
      if (calm.matches || performance.now() - seenAt > PRESENT) return;
      for (const exhibit of scene.exhibits)
        if (exhibit.behaviours.includes("turn_slowly") && inSight(exhibit, from)) turn(exhibit, dt);
    },
  };
}
