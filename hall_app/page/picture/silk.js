// Silk gleams in a band that is narrow along its yarns and wide across them, tinted by the fibre it went through.
//
// glTF says so by KHR_materials_anisotropy, and three.js then reckons two microfacet lobes, sheen and their environment
// for every pixel. One stretched lobe for each lamp in their place looks the same on cloth and costs less than plain
// GGX: what sheen and anisotropy a model brings is read once and taken off its material.

import { requestRender } from "../viser/viser_adapter.js";

const FACETS = "#include <lights_physical_pars_fragment>";
const TURNED = "#include <normal_fragment_maps>";
const SHINE = 0.048; // of a lobe's height; as sim_core's lit_cloth has it beside its sun

const LOBE = `${FACETS}
uniform vec4 silkLobe; // alpha along the yarns; how much wider across, 0 to 1; cosine and sine of the way across
#ifdef SILK_MAP
uniform sampler2D silkMap;
#endif
vec3 silkAlong, silkAcross, silkTint;
vec2 silkWidth;
void RE_Direct_Silk(const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal,
    const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material,
    inout ReflectedLight reflectedLight) {
  vec3 irradiance = saturate(dot(geometryNormal, directLight.direction)) * directLight.color;
  vec3 between = normalize(directLight.direction + geometryViewDir);
  float up = max(dot(geometryNormal, between), .05);
  vec2 lean = vec2(dot(silkAlong, between), dot(silkAcross, between)) / (silkWidth * up);
  reflectedLight.directSpecular += irradiance * silkTint * exp(-dot(lean, lean));
  reflectedLight.directDiffuse += irradiance * BRDF_Lambert(material.diffuseColor);
}
#undef RE_Direct
#define RE_Direct RE_Direct_Silk
`;

const FRAME = `${TURNED}
  vec4 silk = silkLobe;
  #ifdef SILK_MAP
    vec3 silkTexel = texture2D(silkMap, vMapUv).rgb;
    silk.yzw = vec3(silkTexel.b * silkTexel.b, normalize(silkTexel.rg * 2. - 1.));
  #endif
  silkAcross = normalize(normalize(tbn[0]) * silk.z + normalize(tbn[1]) * silk.w);
  silkAlong = cross(normal, silkAcross);
  silkWidth = vec2(silk.x, mix(silk.x, 1., silk.y));
  silkTint = mix(vec3(.35), vec3(1.), diffuseColor.rgb / max(max(diffuseColor.r, diffuseColor.g), max(diffuseColor.b, .05)));
  silkTint *= ${SHINE} / (silkWidth.x * silkWidth.y);
`;

/** Give meshes whose material has a direction of gleam the cheaper lobe; idempotent, keeps what changed them before. */
export function gleam(meshes) {
  let changed = false;
  for (const { material } of meshes) {
    if (!material?.isMeshPhysicalMaterial || material.userData.silk || !material.normalMap) continue;
    const { anisotropy, anisotropyRotation: angle, anisotropyMap: map, roughness } = material;
    if (!(anisotropy > 0)) continue;
    material.userData.silk = true;
    const lobe = [roughness ** 2, anisotropy ** 2, Math.cos(angle), Math.sin(angle)];
    material.anisotropy = 0;
    material.sheen = 0;
    material.anisotropyMap = null;
    const drawn = Boolean(map && material.map);
    if (drawn) material.defines = { ...material.defines, SILK_MAP: "" };
    const before = material.onBeforeCompile, key = material.customProgramCacheKey;
    material.onBeforeCompile = (shader, renderer) => {
      before.call(material, shader, renderer);
      shader.uniforms.silkLobe = { value: lobe };
      if (drawn) shader.uniforms.silkMap = { value: map };
      shader.fragmentShader = shader.fragmentShader.replace(FACETS, LOBE).replace(TURNED, FRAME);
    };
    material.customProgramCacheKey = () => `${key.call(material)} silk ${drawn}`;
    material.needsUpdate = true;
    changed = true;
  }
  if (changed) requestRender();
}
