// Cloth is drawn from both sides, and its shading turned towards whoever looks.
//
// three.js turns it by the triangle's own side. Along a fold's edge a triangle that just faces away fights for pixels
// with its neighbour that does not: the two share their corners' directions, but the turned one is lit from behind,
// and the edge is dotted. So the direction itself decides, and only once it clearly points away.

import { requestRender } from "../viser/viser_adapter.js";

const BOTH = 2; // three.js: DoubleSide
const CLEARLY = 0.2; // cosine
const CHUNK = "#include <normal_fragment_begin>";
const TURNED = CHUNK + `
#if defined(DOUBLE_SIDED) && !defined(FLAT_SHADED)
  if (!gl_FrontFacing && dot(normalize(vNormal), normalize(vViewPosition)) > -${CLEARLY.toFixed(1)}) {
    normal = -normal;
    #ifdef USE_NORMALMAP_TANGENTSPACE
      tbn[2] = -tbn[2];
    #endif
  }
#endif
`;

/** Mend the materials of meshes that are drawn from both sides and lit; idempotent. */
export function shadeBySight(meshes) {
  let changed = false;
  for (const { material } of meshes) {
    if (!material?.isMeshStandardMaterial || material.side !== BOTH || material.userData.bySight) continue;
    material.userData.bySight = true;
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(CHUNK, TURNED);
    };
    material.customProgramCacheKey = () => "by-sight";
    material.needsUpdate = true;
    changed = true;
  }
  if (changed) requestRender();
}
