// The page: loads the scene's description, waits for viser to draw it, then lets the visitor in.

import * as camera from "./camera.js";
import { createCloseup } from "./closeup.js";
import { createGaze } from "./gaze.js";
import { createKeys } from "./keys.js";
import { loadGrid } from "./walkmath.js";
import { createUi } from "./ui/ui.js";
import { createWalk } from "./walk.js";

const HOOK_PATIENCE = 8000; // [ms] before the page hands the camera to the server
const LONGEST_FRAME = 0.5; // [s] a hidden tab does not leap when it comes back

const fetchJson = async (url) => {
  const answer = await fetch(url, { cache: "no-cache" });
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer.json();
};
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

async function until(test, patience, every = 50) {
  for (const end = performance.now() + patience; performance.now() < end; await pause(every)) {
    const value = test();
    if (value) return value;
  }
  return null;
}

function chosenLanguage(scene) {
  const asked = new URLSearchParams(location.search).get("lang") ?? localStorage.getItem("hall.lang");
  if (asked === "zh" || asked === "en") return asked;
  const own = navigator.language.slice(0, 2);
  return own === "zh" || own === "en" ? own : (scene.language ?? "en");
}

async function loadClearance(walk) {
  if (walk.mode !== "predict" || !walk.grid) return null;
  try {
    const answer = await fetch(walk.grid.url);
    if (!answer.ok) throw new Error(String(answer.status));
    return loadGrid(await answer.arrayBuffer(), walk.grid);
  } catch (error) {
    console.warn("no clearance grid, the server walks:", error);
    return null;
  }
}

function webglWorks() {
  return Boolean(document.createElement("canvas").getContext("webgl2"));
}

let ui = null;

async function start() {
  let [scene, texts] = await Promise.all([fetchJson("/api/scene"), fetchJson("/api/texts")]);
  let lang = chosenLanguage(scene);
  let entered = false, opened = null, stick = { forward: 0, right: 0 };
  let near = null, headingThere = null;

  const actions = {
    enter: () => { entered = true; openLinked(); },
    open: (id) => walk.send({ t: "open", id }),
    close() {
      walk.send({ t: "close" });
      leave(); // at once, and also while the server is away
    },
    goTo: (x, z, yaw) => {
      headingThere = yaw ?? null;
      walk.send({ t: "goto", x, z });
    },
    move: (forward, right) => { stick = { forward, right }; },
    setLang: (next) => { lang = next; localStorage.setItem("hall.lang", next); document.documentElement.lang = next; },
  };
  document.documentElement.lang = lang;
  ui = createUi({ root: document.body, scene, texts, lang, actions });
  if (!webglWorks()) {
    ui.fail("webgl");
    return;
  }
  ui.progress(0.05, "loading_hall");
  ui.problems(scene.problems);

  const [hooks, grid] = await Promise.all([
    window.HALL?.withoutHooks ? null : until(camera.hooksPresent, HOOK_PATIENCE),
    loadClearance(scene.walk),
  ]);
  const display = hooks ? "page" : "viser";
  const walking = () => entered && !opened;
  const { gaze } = createGaze(document.documentElement, scene.eye, walking);
  const closeup = createCloseup(ui); // before the walking keys: in a close-up the arrows turn the exhibit
  const keys = createKeys(walking, camera.requestRender); // a key wakes the renderer in time for the next frame
  gaze.yaw = scene.start.yaw;

  const walk = createWalk({ scene, grid, display, mark: findMark, on: {
    moved(pose) {
      if (pose.first) {
        gaze.yaw = pose.yaw;
        if (entered) openLinked();
      }
      else if (pose.t === "hi" && opened) actions.open(opened); // back after a lost connection
      else if (headingThere !== null) Object.assign(gaze, { yaw: headingThere, pitch: 0 });
      headingThere = null;
    },
    async open(message) {
      opened = message.id;
      const detail = await fetchJson(`/api/exhibits/${encodeURIComponent(message.id)}`);
      if (opened !== message.id) return; // closed again meanwhile
      keys.release();
      ui.showExhibit(detail, { play: message.play === true });
      closeup.enter(message);
    },
    closed: leave,
    near({ id, on, glow, caption, node }) {
      if (glow) camera.glow(node, on);
      if (!caption) return;
      near = on ? id : (near === id ? null : near);
      ui.near(near);
    },
    connection: (state) => ui.connection(state),
    async content(message) {
      scene = await fetchJson("/api/scene");
      ui.updateScene(scene);
      ui.problems(message.problems);
      if (opened && scene.exhibits.some((exhibit) => exhibit.id === opened)) {
        ui.updateExhibit(await fetchJson(`/api/exhibits/${encodeURIComponent(opened)}`));
      }
    },
  } });

  function leave() {
    if (!opened) return;
    opened = null;
    ui.hideExhibit();
    closeup.leave();
    walked();
  }

  // viser mounts the mark a moment after its socket opens, and another one whenever it had to connect again.
  const readMark = () => (hooks ? camera.clientMark() : document.querySelector("[data-hall-client]")?.dataset.hallClient);
  let mark = null;
  async function findMark() {
    mark = await until(readMark, 10000);
    return mark;
  }
  setInterval(() => {
    const now = readMark();
    if (!mark || !now || now === mark) return;
    mark = now;
    walk.send({ t: "client", client: mark });
  }, 1000);

  function walked() {
    if (display !== "page") return;
    const ahead = camera.direction(gaze.yaw, gaze.pitch);
    camera.look([walk.pose.x, gaze.eye, walk.pose.z], ahead);
  }

  let last = performance.now(), drawn = "", moving = false;
  function frame(now) {
    const dt = Math.min((now - last) / 1000, LONGEST_FRAME);
    last = now;
    if (walking()) {
      const forward = Math.max(-1, Math.min(1, keys.forward() + stick.forward));
      const right = Math.max(-1, Math.min(1, keys.right() + stick.right));
      // The frame in which a key goes down was mostly stood still.
      const started = moving || !(forward || right) ? dt : Math.min(dt, Math.max(now - keys.since(), 4) / 1000);
      moving = Boolean(forward || right);
      walk.frame(started, forward, right, gaze.yaw, gaze.eye);
      ui.pose({ x: walk.pose.x, z: walk.pose.z, yaw: gaze.yaw });
    }
    if (display === "page" && !opened) {
      camera.holdGestures();
      camera.plainTones();
      const view = [walk.pose.x, walk.pose.z, gaze.eye, gaze.yaw, gaze.pitch].map((v) => v.toFixed(5)).join();
      if (view !== drawn || now < settleUntil) { drawn = view; walked(); }
    }
  }
  // viser places its own first camera once the scene arrives: hold ours until the picture stands.
  let settleUntil = performance.now() + 60000;
  window.HALL.beforeFrame = frame; // runs ahead of viser's renderer: what it sets is drawn in the same frame
  const beat = () => requestAnimationFrame(beat);
  beat();

  await load(scene, ui, hooks);
  settleUntil = performance.now() + 1500;
  ui.pose({ x: walk.pose.x, z: walk.pose.z, yaw: gaze.yaw });
  ui.ready();

  function openLinked() {
    if (opened) return;
    const wanted = new URLSearchParams(location.search).get("exhibit");
    if (wanted && scene.exhibits.some((exhibit) => exhibit.id === wanted)) actions.open(wanted);
  }

  // What tests and curious visitors may use: to read, and to go where the minimap goes.
  window.hall = Object.freeze({
    goTo: actions.goTo,
    displayed: camera.displayed,
    pose: () => ({ ...walk.pose, ...gaze }),
    mode: () => walk.mode,
    disagreement: () => walk.disagreement,
    display: () => display,
    opened: () => opened,
    near: () => near,
    closeupAt: closeup.drawnAt,
    loadedAt: performance.now(),
  });
}

async function load(scene, ui, hooks) {
  if (!hooks) { ui.progress(1, "loading_hall"); return; }
  const missing = () => scene.nodes.filter((name) => camera.meshesOf(name).length === 0);
  await until(() => {
    const left = missing().length;
    ui.progress(0.1 + 0.85 * (1 - left / scene.nodes.length), "loading_models");
    return left === 0 && camera.drawnOnce();
  }, 120000);
  ui.progress(1, "loading_models");
}

start().catch((error) => {
  console.error(error);
  if (ui) ui.fail("load");
  else document.body.insertAdjacentHTML("beforeend",
    '<p class="hall-failed" role="alert">展厅无法打开，请刷新页面。<br>The hall could not be opened. Please reload the page.</p>');
});
