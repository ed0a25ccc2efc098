// The camera behind a few small verbs.
// World: y up, metres. three.js sees it through the orientation of viser's root node.

import { allowDistance, camera, cameraControl, canvas, inThree, requestRender, seenFrom } from "../viser/viser_adapter.js";

const ROTATE = 1, DOLLY = 16, TOUCH_ROTATE = 64, TOUCH_DOLLY = 1024;
const LENS = 58; // [deg] vertical field of view: show/scene.py
const NARROWEST = 40; // [deg] of width on an upright screen
const WIDEST = 78; // [deg] of height there
const PITCH_LIMIT = (75 * Math.PI) / 180;

/** Direction of view for a heading and pitch; yaw 0 looks to -z, positive turns left. */
export function direction(yaw, pitch) {
  const flat = Math.cos(pitch);
  return [-Math.sin(yaw) * flat, Math.sin(pitch), -Math.cos(yaw) * flat];
}

export function clampPitch(pitch) { return Math.max(-PITCH_LIMIT, Math.min(PITCH_LIMIT, pitch)); }

/** Walking: viser's own gestures are switched off, every frame; React may have mounted new controls meanwhile. */
export function holdGestures() {
  const control = cameraControl();
  if (!control) return;
  for (const button of ["left", "middle", "right", "wheel"]) control.mouseButtons[button] = 0;
  for (const fingers of ["one", "two", "three"]) control.touches[fingers] = 0;
}

/** Close-up: one button or finger turns the exhibit, the wheel or two fingers come nearer. */
export function orbitGestures(near, far) {
  const control = cameraControl();
  if (!control) return;
  Object.assign(control.mouseButtons, { left: ROTATE, middle: DOLLY, right: 0, wheel: DOLLY });
  Object.assign(control.touches, { one: TOUCH_ROTATE, two: TOUCH_DOLLY, three: 0 });
  control.minDistance = near;
  control.maxDistance = far;
  allowDistance(far);
}

export function freeDistances() {
  const control = cameraControl();
  if (!control) return;
  control.minDistance = 0.01;
  control.maxDistance = 1e4;
  allowDistance(1e4);
}

/** Place the camera at `eye` [m], looking along `ahead`. */
export function look(eye, ahead) {
  const control = cameraControl();
  if (!control) return;
  const from = inThree(eye), to = inThree([eye[0] + ahead[0], eye[1] + ahead[1], eye[2] + ahead[2]]);
  control.setLookAt(...from, ...to, false);
}

/** Look at `target` from `eye`, both [m]. */
export function lookAt(eye, target) {
  const control = cameraControl();
  if (control) control.setLookAt(...inThree(eye), ...inThree(target), false);
}

/** Look at a point of three.js' own world from the side the eye is on now, so many metres away; turning goes round it. */
export function comeNear(point, metres) {
  const control = cameraControl(), eye = camera()?.position;
  if (!control || !eye) return;
  const [x, y, z] = [eye.x - point[0], eye.y - point[1], eye.z - point[2]];
  const share = metres / Math.max(Math.hypot(x, y, z), 1e-6);
  control.setLookAt(point[0] + share * x, point[1] + share * y, point[2] + share * z, ...point, false);
}

export function orbit(azimuth, polar) { cameraControl()?.rotate(azimuth, polar, false); }

export function dolly(metres) { cameraControl()?.dolly(metres, false); }

const halfTan = (degrees) => Math.tan((degrees * Math.PI) / 360);

/** Come nearer or go farther by a factor of the distance. */
export function zoom(factor) {
  const control = cameraControl();
  if (control) control.dollyTo(control.distance * factor, false);
}

/** An upright phone would see a slot of the hall: give it more height. `near`: a close-up, which has its own distance. */
export function fitLens(near = false) {
  const lens = camera(), picture = canvas();
  if (!lens || !picture?.clientHeight) return;
  const aspect = picture.clientWidth / picture.clientHeight;
  const upright = (360 / Math.PI) * Math.atan(halfTan(NARROWEST) / aspect);
  const wanted = near ? LENS : Math.min(WIDEST, Math.max(LENS, upright));
  if (Math.abs(lens.fov - wanted) < 0.01) return;
  lens.fov = wanted;
  lens.updateProjectionMatrix();
  requestRender();
}

/** Vertical field of view [rad]. */
export function fieldOfView() { return ((camera()?.fov ?? LENS) * Math.PI) / 180; }

/** Where the picture is seen from now, in world metres: what a visitor really sees, used by tests. */
export function displayed() { return seenFrom(); }

/** Whether the picture is seen from above (x, z) [m], to a millimetre. */
export function standsAt(x, z) {
  const place = displayed();
  return place === null || Math.hypot(place[0] - x, place[2] - z) < 1e-3;
}

/** Move the picture's middle into what panel at the right, bar on top, sheet or hints at the bottom [px] leave free. */
export function leaveRoom({ panel, bottom, top }) {
  const lens = camera(), picture = canvas();
  if (!lens || !picture) return;
  const width = picture.clientWidth, height = picture.clientHeight;
  if (panel || bottom || top) lens.setViewOffset(width, height, panel / 2, (bottom - top) / 2, width, height);
  else lens.clearViewOffset();
  requestRender();
}
