// What is worn beneath a thinned garment: between its few triangles an inner layer, or a knee, may come a few millimetres
// through, though no simulated cloth is crossed. What lies beneath is drawn a little further away than it is, in depth
// alone: its outline stays.

import { requestRender } from "../viser/viser_adapter.js";

const CHUNK = "#include <project_vertex>";
const FURTHER = `${CHUNK}
  vec4 behindPosition = projectionMatrix * vec4(mvPosition.xyz * (1. + behindMetres / length(mvPosition.xyz)), 1.);
  gl_Position.z = behindPosition.z / behindPosition.w * gl_Position.w;
`;
const LAYER = 0.004; // [m] that a layer is drawn behind the one over it
const BORNE = ["linen", "petticoat"]; // materials of what bears the dress: beneath all of it
const CLOTH = "silk_hall"; // of dress as it is seen in the hall
const PART = /( \d+)?( afar)?$/; // a garment's node is named after its layer, its further weaves and its coarse level also

/** Draw what has this material so many metres further from whoever looks, once and for all; keeps what changed it before. */
export function drawBehind(material, metres) {
  if (!material?.isMaterial || material.userData.behind) return;
  material.userData.behind = metres;
  const before = material.onBeforeCompile, key = material.customProgramCacheKey;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    shader.uniforms.behindMetres = { value: metres };
    shader.vertexShader = `uniform float behindMetres;\n${shader.vertexShader.replace(CHUNK, FURTHER)}`;
  };
  material.customProgramCacheKey = () => `${key.call(material)} behind`;
  material.needsUpdate = true;
}

/** Each layer of a dressed figure behind those over it, and the figure behind all; its garments come from the skin outwards. */
export function layerBeneath(meshes) {
  if (!meshes.length || meshes[0].userData.layered) return;
  for (const mesh of meshes) mesh.userData.layered = true;
  const layers = [...new Set(meshes.filter(isCloth).map(layerOf))];
  for (const mesh of meshes) {
    const under = isCloth(mesh) ? layers.length - 1 - layers.indexOf(layerOf(mesh)) : isBorne(mesh) ? layers.length : 0;
    if (under > 0) drawBehind(mesh.material, under * LAYER);
  }
  requestRender();
}

const isCloth = ({ material }) => material?.name === CLOTH;
const isBorne = ({ material }) => BORNE.includes(material?.name);
const layerOf = (mesh) => (mesh.userData.name ?? mesh.name).replace(PART, "");
