// All that the page's modules know of viser's inside: no public API, pinned to viser 1.1.1 (web/pages/client.py) and
// asserted in tests/browser. What must run ahead of viser's script is beside this: first.js, line.js.

const viser = () => window.__viserMutable;

/** True when every hook this page needs is there. */
export function hooksPresent() {
  const m = viser();
  return Boolean(m && m.cameraControl && m.camera && m.canvas && m.nodePoseData && window.__viserSceneTree);
}

/** three.js' renderer, null before the first frame. */
export function renderer() {
  return viser()?.scene?.__r3f?.root?.getState?.().gl ?? null;
}

/** three.js' scene, camera and canvas, and viser's camera-controls; undefined until viser has made them. */
export const scene = () => viser()?.scene;
export const camera = () => viser()?.camera;
export const canvas = () => viser()?.canvas;
export const cameraControl = () => viser()?.cameraControl;

/** How far an orbit may lead from its middle [m]; viser puts it on new controls. */
export function allowDistance(metres) { viser().configuredMaxOrbitDistance = metres; }

/** [w, x, y, z] by which viser turns the whole scene for three.js, null before it has. */
export const sceneTurn = () => viser()?.nodePoseData?.[""]?.wxyz ?? null;

/** A vector rotated by the unit quaternion [w, x, y, z]. */
function rotated([w, x, y, z], [a, b, c]) {
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

/** A point of the hall [m] in three.js' world. */
export function inThree(point) {
  const turn = sceneTurn();
  return turn ? rotated(turn, point) : point;
}

/** A point of three.js' world in the hall's own metres. */
export function inHall(point) {
  const turn = sceneTurn();
  if (!turn) return point;
  const [w, x, y, z] = turn;
  return rotated([w, -x, -y, -z], point);
}

/** Where the picture is seen from, in the hall's own metres; null before there is one. */
export function seenFrom() {
  const eye = camera()?.position;
  return eye ? inHall([eye.x, eye.y, eye.z]) : null;
}

/** Turn a node's drawn pose to [w, x, y, z]; false while there is no such node. */
export function turnNode(name, wxyz) {
  const pose = viser()?.nodePoseData?.[name];
  if (!pose) return false;
  pose.wxyz = wxyz;
  if (pose.poseUpdateState === "updated") pose.poseUpdateState = "needsUpdate";
  return true;
}

/** Pixels drawn per CSS pixel, from now on. */
export function drawAt(ratio) {
  const settings = window.__viserTestpoints?.devSettings;
  if (settings?.set && settings.get().fixedDpr !== ratio) settings.set({ fixedDpr: ratio });
}

/** Names of the scene nodes the page has received. */
export function nodeNames() {
  const tree = window.__viserSceneTree;
  return tree ? Object.keys(tree.getState()) : [];
}

/** The drawn meshes below a node; empty while its model is still being read. */
export function meshesOf(name) {
  const found = [];
  const object = viser()?.nodeRefFromName?.[name];
  if (object) object.traverse((child) => { if (child.isMesh) found.push(child); });
  return found;
}

/** Of these nodes, those whose model is drawn. */
export const drawnOf = (names) => names.filter((name) => meshesOf(name).length > 0);

/** From a node's own metres to three.js' world, 16 numbers; null while there is no such node. */
export const placeOf = (name) => viser()?.nodeRefFromName?.[name]?.matrixWorld?.elements ?? null;

const nobody = () => {};

/** act(renderer, scene, camera) hears of every picture as soon as it is drawn, in the same frame; null: nobody does. */
export function whenDrawn(act) {
  const stage = scene();
  if (stage && stage.onAfterRender !== (act ?? nobody)) stage.onAfterRender = act ?? nobody;
}

// What the renderer has drawn. three.js counts anew, in a new object, when a lost context comes back, and viser's test
// points keep the old one: they are asked only until there is a renderer.
const drawn = () => (renderer()?.info ?? window.__viserTestpoints?.rendererInfo)?.render;

export function drawnOnce() { return Boolean(drawn()?.calls > 0 && drawn().triangles > 0); }

/** Pictures drawn so far, since the context last came back. */
export function framesDrawn() { return drawn()?.frame ?? 0; }

export function requestRender() { viser()?.requestRender?.(); }

/** Text the server left in the page to say which of its clients this page is: "<id>.<token>". */
export function clientMark() {
  const prefix = "/_visitor/";
  const name = nodeNames().find((candidate) => candidate.startsWith(prefix));
  return name ? name.slice(prefix.length) : null;
}
