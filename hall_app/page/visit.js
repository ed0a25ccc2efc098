// A visit: walking, coming near, looking closely, leaving again. Keeps pose, picture and overlay in step.

import * as camera from "./camera.js";
import { createCloseup } from "./closeup.js";
import { createGaze } from "./gaze.js";
import { createGlow } from "./glow.js";
import { requestRender } from "./hooks.js";
import { createKeys } from "./keys.js";
import { fetchJson } from "./loading.js";
import { createMark } from "./mark.js";
import { createTurning } from "./turning.js";
import { createWalk } from "./walk.js";

const LONGEST_FRAME = 0.5; // [s] a hidden tab does not leap when it comes back
const SETTLE = 1500; // [ms] viser may place its own first camera that long after the scene has arrived

const EXHIBITS = "/exhibits/"; // scene nodes
const exhibitUrl = (id) => `/api/exhibits/${encodeURIComponent(id)}`;
const clamp = (value) => Math.max(-1, Math.min(1, value));

/**
 * createVisit({scene, grid, display, ui, wake}) -> visit
 *
 * display: "page" where this page places the camera, "viser" where the server does; wake(): draw on for a while.
 */
export function createVisit({ scene, grid, display, ui, wake }) {
  let entered = false, opened = null, near = null, headingThere = null;
  let stick = { forward: 0, right: 0, since: 0 };
  const walking = () => entered && !opened;
  const { gaze } = createGaze(document.documentElement, scene.eye, walking, wake);
  const closeup = createCloseup(ui); // before the walking keys: in a close-up the arrows turn the exhibit
  const keys = createKeys(walking, () => {
    ui.walks();
    requestRender(); // a key wakes the renderer in time for the next frame
    wake();
  });
  gaze.yaw = scene.start.yaw;
  const turning = createTurning(wake);
  const glow = createGlow({ wake, onHover: (node) => ui.hover(node && !opened ? node.slice(EXHIBITS.length) : null) });

  const mark = createMark(display, (client) => walk.send({ t: "client", client }));
  const walk = createWalk({
    scene, grid, display, mark: mark.find,
    on: { moved, open: openExhibit, closed: leave, near: comeNear, content: refresh, connection: ui.connection, heard: wake },
  });

  function open(id) { walk.send({ t: "open", id }); }

  function openLinked() {
    if (opened) return;
    const wanted = new URLSearchParams(location.search).get("exhibit");
    if (wanted && scene.exhibits.some((exhibit) => exhibit.id === wanted)) open(wanted);
  }

  function moved(pose) {
    if (pose.first) {
      gaze.yaw = pose.yaw;
      if (entered) openLinked();
    } else if (pose.t === "hi" && opened) open(opened); // back after a lost connection
    else if (headingThere !== null) Object.assign(gaze, headingThere);
    headingThere = null;
  }

  async function openExhibit(message) {
    opened = message.id;
    const detail = await fetchJson(exhibitUrl(message.id));
    if (opened !== message.id) return; // closed again meanwhile
    keys.release();
    ui.hover(null);
    ui.showExhibit(detail, { play: message.play === true });
    closeup.enter(message);
  }

  function leave() {
    if (!opened) return;
    opened = null;
    ui.hideExhibit();
    closeup.leave();
    showPose();
  }

  function comeNear({ id, on, glow: lit, caption, node }) {
    if (lit) glow.near(node, on);
    if (!caption) return;
    near = on ? id : (near === id ? null : near);
    ui.near(near);
  }

  async function refresh(message) {
    scene = await fetchJson("/api/scene");
    ui.updateScene(scene);
    ui.problems(message.problems);
    wake();
    if (opened && scene.exhibits.some((exhibit) => exhibit.id === opened)) {
      ui.updateExhibit(await fetchJson(exhibitUrl(opened)));
    }
  }

  function showPose() {
    if (display !== "page") return;
    camera.look([walk.pose.x, gaze.eye, walk.pose.z], camera.direction(gaze.yaw, gaze.pitch));
  }

  let moving = false;
  function step(dt, now) {
    const forward = clamp(keys.forward() + stick.forward), right = clamp(keys.right() + stick.right);
    const wanted = Boolean(forward || right);
    // The frame in which a key goes down was mostly stood still.
    const since = Math.max(keys.since(), stick.since);
    const walked = moving || !wanted ? dt : Math.min(dt, Math.max(now - since, 4) / 1000);
    moving = wanted;
    if (moving) wake();
    walk.frame(walked, forward, right, gaze.yaw, gaze.eye);
    ui.pose({ x: walk.pose.x, z: walk.pose.z, yaw: gaze.yaw });
  }

  let last = performance.now(), drawn = "", settleUntil = Infinity;
  function frame(now) {
    const dt = Math.min((now - last) / 1000, LONGEST_FRAME);
    last = now;
    if (walking()) step(dt, now);
    if (display !== "page" || opened) return;
    camera.holdGestures();
    camera.fitLens();
    turning.frame(dt, scene, { ...walk.pose, yaw: gaze.yaw });
    glow.frame(now, scene.nodes.filter((name) => name.startsWith(EXHIBITS)));
    const view = [walk.pose.x, walk.pose.z, gaze.eye, gaze.yaw, gaze.pitch].map((v) => v.toFixed(5)).join();
    if (view === drawn && now >= settleUntil) return;
    if (view !== drawn) wake();
    drawn = view;
    showPose();
  }

  return {
    frame,
    /** The hall stands: hold our camera a little longer, then only where it moves. */
    settle() {
      settleUntil = performance.now() + SETTLE;
      wake(SETTLE);
      ui.pose({ x: walk.pose.x, z: walk.pose.z, yaw: gaze.yaw });
    },
    enter() {
      entered = true;
      wake();
      openLinked();
    },
    open,
    close() {
      walk.send({ t: "close" });
      leave(); // at once, and also while the server is away
    },
    /** To (x, z) [m], looking along `yaw` and `pitch` [rad] if given. */
    goTo(x, z, yaw, pitch = 0) {
      headingThere = yaw === undefined ? null : { yaw, pitch };
      walk.send({ t: "goto", x, z });
    },
    move(forward, right) {
      const since = stick.forward || stick.right ? stick.since : performance.now();
      stick = { forward, right, since };
      wake();
    },
    pose: () => ({ ...walk.pose, ...gaze }),
    mode: () => walk.mode,
    disagreement: () => walk.disagreement,
    opened: () => opened,
    near: () => near,
    closeupAt: closeup.drawnAt,
  };
}
