// Exhibits turn on their stand: moving ones by the hall's clock, on which a page turns them on between two ticks, live ones
// to their visitor. Only in sight of a visitor who is there, and who has not asked the system for less motion. An idle hall
// stands still.

import { requestRender, turnNode } from "../viser/viser_adapter.js";
import { createPresence, inSight } from "./sight.js";

const CATCH_UP = 2; // [1/s] share of what it lags behind that is made up, so that no tick shows
const SETTLED = 0.004; // [rad] of what stands: nearer to where it should be nobody sees it turn

const TURN = 2 * Math.PI;
/** The same angle [rad] within half a turn of nought. */
const shortest = (angle) => angle - TURN * Math.round(angle / TURN);

/** createTurning(wake) -> {heard({id, angle, rate}), frame(dt, scene, {x, z, yaw})}; [rad, rad/s], dt [s]. */
export function createTurning(wake) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const told = new Map(); // id -> {angle, rate, at} of the last tick
  const shown = new Map(); // id -> angle
  const present = createPresence();

  function turn({ id, facing }, { angle, rate, at }, dt) {
    const wanted = angle + (rate * (performance.now() - at)) / 1000;
    const before = shown.get(id);
    if (rate === 0 && Math.abs(shortest(wanted - before)) < SETTLED) return;
    const next = before === undefined
      ? wanted
      : before + rate * dt + shortest(wanted - before - rate * dt) * Math.min(1, CATCH_UP * dt);
    const half = ((facing * Math.PI) / 180 + next) / 2;
    if (!turnNode(`/exhibits/${id}`, [Math.cos(half), 0, Math.sin(half), 0])) return;
    shown.set(id, shortest(next));
    requestRender();
    wake();
  }

  return {
    heard: ({ id, angle, rate }) => void told.set(id, { angle, rate, at: performance.now() }),
    frame(dt, scene, from) {
      if (calm.matches || !present()) return;
      for (const exhibit of scene.exhibits) {
        const tick = told.get(exhibit.id);
        if (tick && exhibit.kind !== "still" && inSight(exhibit, from)) turn(exhibit, tick, dt);
      }
    },
  };
}
