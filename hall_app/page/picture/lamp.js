// Each exhibit is lit by a lamp of its own, from above and beside whoever stands before it.
//
// The scene has one distant lamp for all of them, which a renderer pays for once. Where an exhibit turns its back to
// it, the lamp's direction is turned for its materials: the same lamp, hung in front of each.

import { requestRender, sceneTurn } from "../viser/viser_adapter.js";

// As the exhibit has its axes: +z is its front, and whoever looks at it has +x on his right.
const LAMP = [-0.45, 0.7, 0.9];
const LIGHTS = "#include <lights_pars_begin>";
const FACETS = "#include <lights_physical_pars_fragment>";
// Without surroundings to reflect three.js looks up how much of them a surface would, and multiplies that by nothing.
const REFLECTING = `${FACETS}
#ifndef USE_ENVMAP
  #undef RE_IndirectSpecular
#endif
`;
const AIMED = `${LIGHTS}
uniform vec3 hallLamp;
uniform float hallLampPower;
#if NUM_DIR_LIGHTS > 0
  void getHallLamp(const in DirectionalLight all, out IncidentLight light) {
    getDirectionalLightInfo(all, light);
    light.direction = normalize((viewMatrix * vec4(hallLamp, 0.)).xyz);
    light.color *= hallLampPower;
  }
  #define getDirectionalLightInfo getHallLamp
#endif
`;

/** Where the lamp of an exhibit hangs, as a unit vector in three.js' world. facing: degrees about +y; turn: the scene's. */
export function lampOf(facing, [w, ...axis]) {
  const angle = (facing * Math.PI) / 180, [right, up, front] = LAMP;
  const way = [
    right * Math.cos(angle) + front * Math.sin(angle), up, front * Math.cos(angle) - right * Math.sin(angle),
  ];
  const cross = (a, b) => [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
  const once = cross(axis, way), twice = cross(axis, once), length = Math.hypot(...LAMP);
  return way.map((part, k) => (part + 2 * (w * once[k] + twice[k])) / length);
}

/**
 * Light the meshes of one exhibit by its own lamp; idempotent, keeps what changed their materials before.
 * lamp: how bright it is, of the lamp of all.
 */
export function aimLamp(meshes, { facing, lamp: power }) {
  const turn = sceneTurn();
  if (!turn) return;
  let changed = false;
  for (const { material } of meshes) {
    if (!material?.isMeshStandardMaterial || material.userData.lamp) continue;
    const lamp = (material.userData.lamp = lampOf(facing, turn));
    const before = material.onBeforeCompile, key = material.customProgramCacheKey();
    material.onBeforeCompile = (shader, renderer) => {
      before.call(material, shader, renderer);
      shader.uniforms.hallLamp = { value: lamp };
      shader.uniforms.hallLampPower = { value: power };
      shader.fragmentShader = shader.fragmentShader.replace(LIGHTS, AIMED).replace(FACETS, REFLECTING);
    };
    material.customProgramCacheKey = () => `${key} lamp`;
    material.needsUpdate = true;
    changed = true;
  }
  if (changed) requestRender();
}
