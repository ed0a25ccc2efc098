// Silk gleams in a band that is narrow along its yarns and wide across them, tinted by the fibre it went through.
//
// glTF says so by KHR_materials_anisotropy, and three.js then reckons two microfacet lobes, sheen and their environment
// for every pixel. One stretched lobe for each lamp in their place looks the same on cloth and costs less than plain
// GGX: what sheen and anisotropy a model brings is read once and taken off its material.
//
// A figured silk brings more: which small weave lies at each crossing, and the yarns of each. glTF has no place for
// them, so they lie where lacquer and thin films have their textures, whose factors are 0. From a hand's breadth on
// they take over from the picture of the whole repeat, bit by bit as a pixel gets smaller than a yarn.

import { requestRender } from "../viser/viser_adapter.js";

const FACETS = "#include <lights_physical_pars_fragment>";
const TURNED = "#include <normal_fragment_maps>";
const SHINE = 0.048; // of a lobe's height; as sim_core's lit_cloth has it beside its sun
const NEAR = [12e-6, 60e-6]; // [m] of cloth a pixel: yarns alone, the repeat's picture alone
const YARN = [0.2, 0.42]; // alpha along and across a yarn whose filaments are drawn
const NEAREST = 1003, NEAREST_SIZE = 1007, BETWEEN_SIZES = 1008; // three.js: Nearest, LinearMipmapNearest, …Linear

const LOBE = `${FACETS}
uniform vec4 silkLobe; // alpha along the yarns; how much wider across, 0 to 1; cosine and sine of the way across
#ifdef SILK_MAP
uniform sampler2D silkMap;
#endif
#ifdef SILK_CELLS
uniform sampler2D silkNumber;
uniform sampler2D silkCell[SILK_CELLS];
uniform vec2 silkRepeat, silkSize[SILK_CELLS]; // [m]
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

/** The cell's own texel, chosen without a branch in the sampler's number; `at` and `dx`, `dy` in metres of cloth. */
const chosen = (count) => {
  const one = (k) => `textureGrad(silkCell[${k}], at / silkSize[${k}], dx / silkSize[${k}], dy / silkSize[${k}])`;
  const rest = Array.from({ length: count - 1 }, (_, k) => `cell < ${k}.5 ? ${one(k)} : `).join("");
  return `${rest}${one(count - 1)}`;
};

const frame = (cells) => `${TURNED}
  vec4 silk = silkLobe;
  #ifdef SILK_MAP
    vec3 silkTexel = texture2D(silkMap, vMapUv).rgb;
    silk.yzw = vec3(silkTexel.b * silkTexel.b, normalize(silkTexel.rg * 2. - 1.));
  #endif
  silkWidth = vec2(silk.x, mix(silk.x, 1., silk.y));
  #ifdef SILK_CELLS
  {
    vec2 at = vMapUv * silkRepeat, dx = dFdx(at), dy = dFdy(at);
    float near = 1. - smoothstep(${NEAR[0]}, ${NEAR[1]}, max(length(dx), length(dy)));
    if (near > 0.) {
      float cell = textureLod(silkNumber, vMapUv, 0.).r * 255.;
      vec3 yarn = (${cells ? chosen(cells) : "vec4(0.)"}).rgb;
      vec3 facet = vec3((yarn.rg * 2. - 1.) * sign(normalScale), 0.);
      facet.z = sqrt(max(1. - dot(facet.xy, facet.xy), .04));
      normal = normalize(mix(normal, normalize(tbn * facet), near));
      diffuseColor.rgb *= mix(1., yarn.b * 2., near);
      silkWidth = mix(silkWidth, vec2(${YARN[0].toFixed(2)}, ${YARN[1].toFixed(2)}), near);
    }
  }
  #endif
  silkAcross = normalize(tbn[0] * silk.z + tbn[1] * silk.w);
  silkAlong = cross(normal, silkAcross);
  silkTint = mix(vec3(.35), vec3(1.), diffuseColor.rgb / max(max(diffuseColor.r, diffuseColor.g), max(diffuseColor.b, .05)));
  silkTint *= ${SHINE} / (silkWidth.x * silkWidth.y);
`;

/** Number and cells of a figured silk, taken off the slots that carry them; null where there are none. */
function cellsOf(material) {
  const told = material.userData.silk;
  const { clearcoatMap: number, clearcoatNormalMap, clearcoatRoughnessMap, iridescenceMap, iridescenceThicknessMap } = material;
  material.clearcoatMap = material.clearcoatNormalMap = material.clearcoatRoughnessMap = null;
  material.iridescenceMap = material.iridescenceThicknessMap = null;
  const cells = [clearcoatNormalMap, clearcoatRoughnessMap, iridescenceMap, iridescenceThicknessMap].filter(Boolean);
  if (!told?.cells || !number || !material.map || cells.length !== told.cells.length) return null;
  number.magFilter = number.minFilter = NEAREST;
  number.generateMipmaps = false;
  number.needsUpdate = true;
  return { number, cells, sizes: told.cells.flat(), repeat: told.repeat };
}

/** Mix two sizes of each cell's picture, or take the nearer one, which a software renderer draws faster. */
function filter(cells, blend) {
  for (const cell of cells) {
    const wanted = blend ? BETWEEN_SIZES : NEAREST_SIZE;
    if (cell.minFilter === wanted) continue;
    cell.minFilter = wanted;
    cell.needsUpdate = true;
  }
}

/**
 * Give meshes whose material has a direction of gleam the cheaper lobe; idempotent, keeps what changed them before.
 * blend: as of `sharpen`.
 */
export function gleam(meshes, blend = true) {
  let changed = false;
  for (const { material } of meshes) {
    if (material?.userData.cells) filter(material.userData.cells, blend);
    if (!material?.isMeshPhysicalMaterial || material.userData.gleams || !material.normalMap) continue;
    const { anisotropy, anisotropyRotation: angle, anisotropyMap: map, roughness } = material;
    if (!(anisotropy > 0)) continue;
    material.userData.gleams = true;
    const lobe = [roughness ** 2, anisotropy ** 2, Math.cos(angle), Math.sin(angle)];
    const near = cellsOf(material), drawn = Boolean(map && material.map);
    material.userData.cells = near?.cells;
    material.anisotropy = 0;
    material.sheen = 0;
    material.anisotropyMap = null;
    const defines = { ...material.defines };
    if (drawn) defines.SILK_MAP = "";
    if (near) defines.SILK_CELLS = near.cells.length;
    material.defines = defines;
    const before = material.onBeforeCompile, key = material.customProgramCacheKey;
    material.onBeforeCompile = (shader, renderer) => {
      before.call(material, shader, renderer);
      shader.uniforms.silkLobe = { value: lobe };
      if (drawn) shader.uniforms.silkMap = { value: map };
      if (near) {
        shader.uniforms.silkNumber = { value: near.number };
        shader.uniforms.silkCell = { value: near.cells };
        shader.uniforms.silkSize = { value: near.sizes };
        shader.uniforms.silkRepeat = { value: near.repeat };
      }
      shader.fragmentShader = shader.fragmentShader
        .replace(FACETS, LOBE).replace(TURNED, frame(near?.cells.length ?? 0));
    };
    material.customProgramCacheKey = () => `${key.call(material)} silk ${drawn} ${near?.cells.length ?? 0}`;
    material.needsUpdate = true;
    changed = true;
  }
  if (changed) requestRender();
}
