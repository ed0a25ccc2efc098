// What is worn beneath a thinned garment: between its few triangles an inner layer, or a knee, may come a few millimetres
// through, though no simulated cloth is crossed. What lies beneath is drawn a little further away than it is, in depth
// alone: its outline stays.

import { requestRender } from "../viser/viser_adapter.js";

const CHUNK = "#include <project_vertex>";
// Of what is so many times further away along its line of sight the depth alone: z' = (P (k x)).z / (P (k x)).w.
const FURTHER = `${CHUNK}
  float behindTimes = 1. + behindMetres / length(mvPosition.xyz);
  gl_Position.z = (projectionMatrix * vec4(mvPosition.xyz * behindTimes, 1.)).z / behindTimes;
`;
const LAYER = 0.004; // [m] that a layer is drawn behind the one over it
const CLOTH = "silk_hall"; // material of dress as it is seen in the hall
const FIGURE = "linen"; // of who wears it
const PART = /( \d+)?( afar)?$/; // a garment's node is named after its layer, its further weaves and its coarse level also

/** Draw what has this material so many metres further from whoever looks, at least; keeps what changed it before. */
export function drawBehind(material, metres) {
  if (!material?.isMaterial) return;
  const { behind } = material.userData;
  if (behind) {
    behind.value = Math.max(behind.value, metres);
    return;
  }
  const uniform = (material.userData.behind = { value: metres });
  const before = material.onBeforeCompile, key = material.customProgramCacheKey;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    shader.uniforms.behindMetres = uniform;
    shader.vertexShader = `uniform float behindMetres;\n${shader.vertexShader.replace(CHUNK, FURTHER)}`;
  };
  material.customProgramCacheKey = () => `${key.call(material)} behind`;
  material.needsUpdate = true;
}

/**
 * Of a dressed figure each layer behind those over it, and whatever bears it behind all; its garments come from the skin
 * outwards. Cloths that hang on a stand lie beside each other.
 */
export function layerBeneath(meshes) {
  if (!meshes.length || meshes[0].userData.layered) return;
  for (const mesh of meshes) mesh.userData.layered = true;
  const lit = meshes.filter(({ material }) => material?.isMeshStandardMaterial); // the rest is viser's own
  if (!lit.some(({ material }) => material.name === FIGURE)) return;
  const layers = [...new Set(lit.filter(isCloth).map(layerOf))];
  for (const mesh of lit) {
    const under = isCloth(mesh) ? layers.length - 1 - layers.indexOf(layerOf(mesh)) : layers.length;
    if (under > 0) drawBehind(mesh.material, under * LAYER);
  }
  requestRender();
}

const isCloth = ({ material }) => material.name === CLOTH;
const layerOf = (mesh) => (mesh.userData.name ?? mesh.name).replace(PART, "");
