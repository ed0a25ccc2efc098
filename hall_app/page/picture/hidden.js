// What walls hide is not drawn, nor what stands in another place: the hall while one is in the studio, and the other way.
//
// A renderer leaves out by itself what lies beside or behind the view, but draws whatever stands behind a wall, and pays
// for its corners. The plan says where walls are, so that it is known from every place what they hide: a thing is
// hidden when the walls between it and the eye cover all the directions in which its box lies. Nothing that can be
// seen is ever left out; what a wall and a piece of furniture hide together is drawn.

import { inHall, requestRender } from "../viser/viser_adapter.js";

const HAIR = 1e-6; // [rad] between two walls that meet
const ELSEWHERE = 250; // [m]
const SEEN = 0, UNSEEN = 31; // layers of three.js: cameras look at the first alone

const turned = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

/** The directions [from, to], about `middle`, that a wall hides from an eye that does not stand in its line. */
function covered([ax, az, bx, bz], [x, z], middle) {
  const ends = [Math.atan2(az - z, ax - x), Math.atan2(bz - z, bx - x)].map((angle) => turned(angle - middle));
  const [from, to] = ends.sort((one, other) => one - other);
  return to - from <= Math.PI ? [[from, to]] : [[-Math.PI, from], [to, Math.PI]];
}

/**
 * Whether walls hide all of a box from an eye [x, y, z]; metres in the hall. Pure.
 * walls: [x, z, x, z, top] of each, top null where it reaches the ceiling; box: [low x, low z, high x, high z, top].
 */
export function hides(walls, [x, y, z], [lowX, lowZ, highX, highZ, boxTop]) {
  const corners = [[lowX, lowZ], [lowX, highZ], [highX, lowZ], [highX, highZ]];
  const between = walls.filter(([ax, az, bx, bz, top]) => {
    if (top !== null && top < Math.max(y, boxTop)) return false;
    const side = (px, pz) => Math.sign((bx - ax) * (pz - az) - (bz - az) * (px - ax));
    const here = side(x, z);
    return here !== 0 && corners.every(([px, pz]) => side(px, pz) === -here);
  });
  if (!between.length) return false;
  const middle = Math.atan2((lowZ + highZ) / 2 - z, (lowX + highX) / 2 - x);
  const ways = corners.map(([px, pz]) => turned(Math.atan2(pz - z, px - x) - middle));
  const last = Math.max(...ways);
  let reached = Math.min(...ways);
  const parts = between.flatMap((wall) => covered(wall, [x, z], middle)).sort((one, other) => one[0] - other[0]);
  for (const [from, to] of parts) {
    if (from > reached + HAIR) return false;
    reached = Math.max(reached, to);
  }
  return reached >= last;
}

/** Whether a box, as for `hides`, is so far from an eye that it belongs to another place. Pure. */
export function elsewhere([x, , z], [lowX, lowZ, highX, highZ]) {
  return Math.hypot(x - Math.min(Math.max(x, lowX), highX), z - Math.min(Math.max(z, lowZ), highZ)) > ELSEWHERE;
}

/** Draw of these meshes what is seen; boxOf(mesh): as for `hides`, null of what may be anywhere. Idempotent. */
export function drawSeen(meshes, walls, eye, boxOf) {
  let changed = false;
  for (const mesh of meshes) {
    const box = boxOf(mesh);
    const layer = box && (elsewhere(eye, box) || hides(walls, eye, box)) ? UNSEEN : SEEN;
    if (mesh.userData.layer === layer) continue;
    mesh.userData.layer = layer;
    mesh.layers.set(layer);
    changed = true;
  }
  if (changed) requestRender();
}

/** The box of a mesh that is made where it stands, as the room's are. */
export function ownBox({ geometry }) {
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox;
  return [min.x, min.z, max.x, max.z, max.y];
}

/** The box about the ball in which a mesh stays, however it moves; null of one whose corners its geometry does not tell. */
export function boxAbout({ isInstancedMesh, isSkinnedMesh, geometry, matrixWorld: { elements: m } }) {
  if (isInstancedMesh || isSkinnedMesh) return null;
  if (!geometry.boundingSphere) geometry.computeBoundingSphere();
  const { center: { x: a, y: b, z: c }, radius } = geometry.boundingSphere;
  const [x, y, z] = inHall([0, 1, 2].map((k) => m[k] * a + m[4 + k] * b + m[8 + k] * c + m[12 + k]));
  const reach = radius * Math.max(...[0, 4, 8].map((k) => Math.hypot(m[k], m[k + 1], m[k + 2])));
  return [x - reach, z - reach, x + reach, z + reach, y + reach];
}
