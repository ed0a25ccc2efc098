// The hall's light. The room is drawn unlit and carries its own baked light map; the few real lights touch garments only.
//
// The room's GLB brings the map as the base colour of a hidden triangle whose material is named "lightmap", and the
// coordinates of its meshes "hall_*" as a second set. glTF has no word for light maps, so the page lays it on. Where
// that cannot be done the room stays evenly lit, but whole.

import { renderer, requestRender, scene } from "../viser/viser_adapter.js";

const MAP = "lightmap";
const ROOM = "hall_";
const SKY_ALONE = 2.4; // times: garments are as bright without reflections as with them
const LINEAR = 1006, NEAREST_SIZE = 1007, BETWEEN_SIZES = 1008; // three.js: Linear, LinearMipmapNearest, …Linear
const STRENGTH = 2 * Math.PI; // the map holds light / 2, and three.js divides a light map by pi

const listOf = (material) => [material ?? []].flat();

/** Colours as the palette has them: viser's client maps tones by default, which greys warm whites. */
export function plainTones() {
  const gl = renderer();
  if (!gl || gl.toneMapping === 0) return;
  gl.toneMapping = 0;
  scene().traverse((object) => {
    for (const material of listOf(object.material)) material.needsUpdate = true;
  });
  requestRender();
}

/**
 * Lay the light map on the meshes of a room. Idempotent and cheap, so it runs ahead of every drawn picture: viser
 * makes new meshes whenever the room changes or its socket had to connect again.
 * Returns how many meshes carry the map now.
 */
export function layLight(meshes) {
  const bearer = meshes.find((mesh) => mesh.material?.name === MAP && mesh.material.map);
  if (!bearer) return 0;
  const map = bearer.material.map;
  bearer.visible = false;
  map.channel = 1;
  plainly(map);
  let lit = 0, changed = false;
  for (const mesh of meshes) {
    const { material, geometry } = mesh;
    if (!mesh.name.startsWith(ROOM) || !material.isMeshBasicMaterial || !geometry.attributes.uv1) continue;
    lit += 1;
    if (material.lightMap === map) continue;
    material.lightMap = map;
    material.lightMapIntensity = STRENGTH;
    material.needsUpdate = true;
    changed = true;
  }
  if (changed) requestRender();
  return lit;
}

/** Light is smooth: one bilinear look-up a pixel is enough, and a software renderer pays for every further one. */
function plainly(map) {
  if (map.minFilter === LINEAR) return;
  map.minFilter = LINEAR;
  map.generateMipmaps = false;
  map.anisotropy = 1;
  map.needsUpdate = true;
}

/**
 * Filter textures: `wanted` samples where seen at a slant, as far as the machine can; `blend` mixes two sizes of a
 * texture in each, which hides where one size follows another. A software renderer pays dearly for both. Light maps
 * stay as they are.
 */
export function sharpen(meshes, wanted, blend = true) {
  const anisotropy = Math.min(wanted, renderer()?.capabilities.getMaxAnisotropy() ?? 1);
  const sizes = blend ? BETWEEN_SIZES : NEAREST_SIZE;
  let changed = false;
  for (const mesh of meshes) {
    for (const material of listOf(mesh.material)) {
      if (material.name === MAP) continue;
      for (const texture of Object.values(material)) {
        if (!texture?.isTexture || texture === material.lightMap) continue;
        const wantedFilter = texture.minFilter === LINEAR ? LINEAR : sizes;
        if (texture.anisotropy === anisotropy && texture.minFilter === wantedFilter) continue;
        texture.anisotropy = anisotropy;
        texture.minFilter = wantedFilter;
        texture.needsUpdate = true;
        changed = true;
      }
    }
  }
  if (changed) requestRender();
}

const HALF_FLOAT = 1016; // three.js

/**
 * viser's client decodes its environment map into a render target: it lives on the graphics card alone, and a lost
 * context would take it away for good. With its pixels in memory three.js can send it there again, as every texture.
 */
function keepPixels(texture) {
  const target = texture.renderTarget, gl = renderer();
  if (!texture.isRenderTargetTexture || !target || texture.type !== HALF_FLOAT || gl.getContext().isContextLost()) return;
  const { width, height } = target;
  const data = new Uint16Array(4 * width * height);
  gl.readRenderTargetPixels(target, 0, 0, width, height, data);
  texture.source.data = { data, width, height };
  texture.isRenderTargetTexture = false;
  texture.isDataTexture = true;
}

let kept = null; // the environment map while it is taken off
let skies = [];

/**
 * Reflections of the room on the exhibits, on or off; without them the sky's light makes up for their brightness.
 * viser's client puts its environment map on again at times.
 */
export function reflect(on) {
  const hall = scene();
  if (!hall) return;
  if (hall.environment) keepPixels(hall.environment);
  let changed = true;
  if (!on && hall.environment) {
    kept = hall.environment;
    kept.addEventListener("dispose", (event) => { if (kept === event.target) kept = null; });
    hall.environment = null;
  } else if (on && !hall.environment && kept) {
    hall.environment = kept;
    kept = null;
  } else changed = false;
  if (!skies.length || skies.some((light) => !light.parent)) {
    skies = [];
    hall.traverse((object) => { if (object.isHemisphereLight) skies.push(object); });
  }
  for (const light of skies) {
    light.userData.shipped ??= light.intensity;
    const wanted = light.userData.shipped * (hall.environment ? 1 : SKY_ALONE);
    changed ||= light.intensity !== wanted;
    light.intensity = wanted;
  }
  if (changed) requestRender();
}
