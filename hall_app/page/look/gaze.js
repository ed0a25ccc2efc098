// Looking: left drag or one finger turns the head, as keys do (head.js); the middle button raises or lowers the eye.

import { clampPitch } from "./camera.js";
import { Head } from "./head.js";

const RADIANS_PER_PIXEL = 0.0042;
const METRES_PER_PIXEL = 0.004;

/** -> {gaze, head}: yaw, pitch [rad] and eye [m], and what turns them by keys; `active()` says whether dragging looks
 *  around, `onTurn()` hears of it. */
export function createGaze(surface, eye, active, onTurn) {
  const gaze = { yaw: 0, pitch: 0, eye: eye.default };
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const head = new Head(gaze, () => calm.matches);
  let drag = null;

  function turn(dx, dy) {
    head.levelling = false;
    gaze.yaw -= dx * RADIANS_PER_PIXEL;
    gaze.pitch = clampPitch(gaze.pitch - dy * RADIANS_PER_PIXEL);
  }
  function raise(dy) {
    gaze.eye = Math.max(eye.min, Math.min(eye.max, gaze.eye - dy * METRES_PER_PIXEL));
  }

  // Captured but not stopped: viser still sees the press, so that a click on an exhibit reaches it.
  surface.addEventListener("pointerdown", (event) => {
    if (!active() || drag || !(event.target instanceof HTMLCanvasElement)) return;
    if (event.button > 1) return;
    drag = { id: event.pointerId, middle: event.button === 1, x: event.clientX, y: event.clientY };
  }, true);
  addEventListener("pointermove", (event) => {
    if (!drag || event.pointerId !== drag.id) return;
    const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
    drag.x = event.clientX;
    drag.y = event.clientY;
    if (!active()) return;
    if (drag.middle) raise(dy);
    else turn(dx, dy);
    onTurn();
  }, true);
  const end = (event) => { if (drag && (!event.pointerId || event.pointerId === drag.id)) drag = null; };
  addEventListener("pointerup", end, true);
  addEventListener("pointercancel", end, true);
  addEventListener("blur", end);
  // The middle button would start the browser's own scrolling.
  surface.addEventListener("mousedown", (event) => { if (event.button === 1) event.preventDefault(); }, true);

  return { gaze, head };
}
