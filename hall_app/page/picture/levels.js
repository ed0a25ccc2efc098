// Of a model that brings two levels the one that is seen from where the visitor stands.
//
// A renderer pays for every corner, however small it is on the screen. `hall build` writes a coarser level that deviates
// by no more pixels from its distance on than the fine one from the nearest view; its nodes have no size, so that
// whoever does not read `from` shows the fine one alone.

import { camera, placeOf, requestRender } from "../viser/viser_adapter.js";

const SLACK = 0.04; // of the distance: nobody who stands there makes it change to and fro

/** Metres from the eye to a node, null while there is none. */
export function awayFrom(name) {
  const place = placeOf(name), eye = camera()?.position;
  return place && eye ? Math.hypot(place[12] - eye.x, place[13] - eye.y, place[14] - eye.z) : null;
}

/** Show the level of these meshes that belongs to a distance [m]; idempotent. */
export function showLevel(meshes, away) {
  if (away === null) return;
  let changed = false;
  for (const mesh of meshes) {
    const { from, until } = mesh.userData, edge = from ?? until;
    if (edge === undefined) continue;
    const before = mesh.userData.afar;
    const afar = away > edge * (before === undefined ? 1 : before ? 1 - SLACK : 1 + SLACK);
    if (afar === before) continue;
    mesh.userData.afar = afar;
    mesh.visible = afar === (from !== undefined);
    if (from !== undefined) mesh.scale.setScalar(1);
    changed = true;
  }
  if (changed) requestRender();
}
