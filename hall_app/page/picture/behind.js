// A figure that moves under a thinned coat: between the coat's few triangles a knee may come a few millimetres through,
// though no simulated cloth is crossed. It is drawn a little further away than it is, in depth alone: its outline stays.

const CHUNK = "#include <project_vertex>";

const further = (metres) => `${CHUNK}
  vec4 behindPosition = projectionMatrix * vec4(mvPosition.xyz * (1. + ${metres.toFixed(4)} / length(mvPosition.xyz)), 1.);
  gl_Position.z = behindPosition.z / behindPosition.w * gl_Position.w;
`;

/** Draw what has this material so many metres further from whoever looks, once and for all; keeps what changed it before. */
export function drawBehind(material, metres) {
  if (!material?.isMaterial || material.userData.behind) return;
  material.userData.behind = metres;
  const before = material.onBeforeCompile, key = material.customProgramCacheKey;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    shader.vertexShader = shader.vertexShader.replace(CHUNK, further(metres));
  };
  material.customProgramCacheKey = () => `${key.call(material)} behind ${metres}`;
  material.needsUpdate = true;
}
