// A visit: walking, coming near, looking closely, leaving again. Keeps pose, picture and overlay in step.

import { createAddress, linkedExhibit } from "./address.js";
import * as camera from "../look/camera.js";
import { createClips } from "../look/clip/clips.js";
import { createCloseup } from "../look/closeup.js";
import { createGaze } from "../look/gaze.js";
import { createGlow } from "../look/glow.js";
import { drawnOf, requestRender } from "../viser/viser_adapter.js";
import { createKeys } from "../walk/keys.js";
import { fetchJson, loadClearance } from "./loading.js";
import { createLater } from "./later.js";
import { createMark } from "./mark.js";
import { createSpot, recallSpot } from "./spot.js";
import { createTurning } from "../look/turning.js";
import { lookedAt, standBefore } from "../ui/map/geometry.js";
import { createWalk } from "../walk/walk.js";

const LONGEST_FRAME = 0.5; // [s] a longer one is no picture of a slow machine: the page itself stood still, or was hidden
const SETTLE = 1500; // [ms] viser may place its own first camera that long after the scene has arrived

const EXHIBITS = "/exhibits/"; // scene nodes
const exhibitUrl = (id) => `/api/exhibits/${encodeURIComponent(id)}`;
const TEXT_PATIENCE = 15000; // [ms] an exhibit's text may take on a slow line
const ASK_AFTER = 150, ASK_AGAIN = 3000; // [ms] that a tab rests before what it compares is asked for, and once more
const clamp = (value) => Math.max(-1, Math.min(1, value));

/**
 * createVisit({scene, grid, display, ui, wake, connection, clock, points}) -> visit
 *
 * clock: of what moves by clips; points: what was tracked of who moves; display: "page" where this page places the camera, "viser" where the server does; wake(): draw on for a while;
 * connection(state, place): hears of the walk's.
 */
export function createVisit({ scene, grid, display, ui, wake, connection, clock, points }) {
  let entered = false, opened = null, near = null, headingThere = null;
  const beside = new Set(); // exhibits that have noticed the visitor
  let compares = false, compared = null, comparison = null; // wanted; {clip} while it is shown; of the open exhibit
  let asking = 0, early = null; // the next time it is asked for; the last answer since the exhibit was opened
  let stick = { forward: 0, right: 0, since: 0 };
  const walking = () => entered && !opened;
  const { gaze, head } = createGaze(document.documentElement, scene.eye, walking, wake);
  const closeup = createCloseup(ui); // before the walking keys: in a close-up the arrows turn the exhibit
  const keys = createKeys({
    active: walking,
    head,
    onPress() {
      ui.walks();
      requestRender(); // a key wakes the renderer in time for the next frame
      wake();
    },
    onRelease: () => walk.stand(gaze.yaw, gaze.eye),
  });
  gaze.yaw = scene.start.yaw;
  const turning = createTurning(wake);
  const clips = createClips({ clock, wake });
  const glow = createGlow({ wake, onHover: (node) => ui.hover(node && !opened ? node.slice(EXHIBITS.length) : null) });

  const exhibitOf = (id) => scene.exhibits.find((exhibit) => exhibit.id === id);
  const address = createAddress({ lang: () => ui.lang, onWanted: showWanted });
  const arrival = recallSpot() ?? besideLinked();
  let arrived = false;
  const spot = createSpot(() => (arrived ? { ...walk.pose, ...gaze } : null));

  const mark = createMark(display, (client) => walk.send({ t: "client", client }));
  const walk = createWalk({
    scene, grid, display, mark: mark.find, at: arrival,
    on: { moved, open: openExhibit, compared: showCompared, closed: leave, near: comeNear, turn: turning.heard, content: refresh, connection, heard: wake },
  });

  function open(id) { walk.send({ t: "open", id }); }

  /** Whoever comes by an exhibit's link stands before it, so that leaving it leads beside it and not to the entrance. */
  function besideLinked() {
    const exhibit = exhibitOf(linkedExhibit());
    return exhibit ? { ...standBefore(exhibit, scene), eye: scene.eye.default, exhibit } : null;
  }

  function openLinked() {
    const wanted = linkedExhibit();
    if (wanted === null || wanted === opened) return;
    if (exhibitOf(wanted)) open(wanted);
    else {
      address.follow(null);
      ui.unknownExhibit();
    }
  }

  /** What Back or Forward has led to. */
  function showWanted(id) {
    if (!entered || id === opened) return;
    if (id !== null) openLinked();
    else close();
  }

  /** As on arriving: at the entrance, before a linked exhibit, or where the page was left. */
  function face({ x, z, yaw }) {
    gaze.yaw = yaw;
    if (!arrival) return;
    const { exhibit, pitch, eye } = arrival;
    gaze.yaw = exhibit ? Math.atan2(x - exhibit.x, z - exhibit.z) : arrival.yaw; // the server may have moved us aside
    gaze.pitch = camera.clampPitch(pitch);
    gaze.eye = Math.max(scene.eye.min, Math.min(scene.eye.max, eye));
  }

  function moved(pose) {
    if (pose.t === "hi") { // whoever greets us notices us anew
      beside.clear();
      look();
    }
    if (pose.t === "hi" && pose.revision !== scene.revision) refresh(); // changed while we were not there to hear it
    if (pose.first) {
      arrived = true;
      face(pose);
      if (entered) openLinked();
    } else if (pose.t === "hi" && (opened || entered)) { // back after a lost connection
      if (opened) open(opened);
      else openLinked(); // by Enter or Forward meanwhile
    } else if (headingThere !== null) {
      head.forget();
      Object.assign(gaze, headingThere);
    }
    headingThere = null;
  }

  async function openExhibit(message) {
    opened = message.id;
    compared = early = null; // the hall shows the exhibit itself first
    address.follow(opened);
    const detail = await fetchJson(exhibitUrl(message.id), AbortSignal.timeout(TEXT_PATIENCE)).catch(() => null);
    if (opened !== message.id) return; // closed again meanwhile
    if (!detail) { // taken away meanwhile, or the server is
      close();
      ui.unreadExhibit();
      return;
    }
    keys.release();
    ui.hover(null);
    ui.showExhibit(detail, { play: message.play === true });
    comparison = detail.comparison;
    closeup.enter(message);
    if (early) showCompared(early); // its tab was chosen while the text came
    else ask(0); // or the line was lost meanwhile
  }

  /** The close-up shows the exhibit's meshes side by side, or the exhibit again, as the tab that is chosen wants it. */
  function compare(on) {
    compares = on;
    ask(ASK_AFTER); // of tabs that are run through, the one that is stayed on
  }

  /** Ask until it is shown: a line may lose it, or the hall have been asked too often. */
  function ask(delay) {
    clearTimeout(asking);
    asking = setTimeout(() => {
      if (!opened || compares === (compared !== null)) return;
      walk.send({ t: "compare", on: compares });
      ask(ASK_AGAIN);
    }, delay);
  }

  function showCompared(message) {
    if (opened !== message.id) return; // another one meanwhile
    early = message;
    compared = message.on ? { clip: comparison?.clip ?? null } : null;
    closeup.enter(message);
    ask(ASK_AFTER);
  }

  function close() {
    walk.send({ t: "close" });
    leave(); // at once, and also while the server is away
  }

  function leave() {
    if (!opened) return;
    opened = compared = early = null;
    compares = false; // the server forgets it with the exhibit
    clearTimeout(asking);
    address.follow(null);
    ui.hideExhibit();
    closeup.leave();
    showPose();
  }

  function comeNear({ id, on, glow: lit, caption, node }) {
    if (lit) glow.near(node, on);
    if (!caption) return;
    if (on) beside.add(id);
    else beside.delete(id);
    look();
  }

  /** Of all it stands beside, the caption names the exhibit that the visitor looks at, which Enter opens. */
  function look() {
    const next = lookedAt(beside, scene.exhibits, { ...walk.pose, yaw: gaze.yaw }, near);
    if (next === near) return;
    near = next;
    ui.near(near);
  }

  let asked = 0;
  async function refresh() {
    const mine = ++asked;
    const next = await fetchJson("/api/scene").catch(() => null);
    // The server has gone again, and its welcome tells the revision once more; or a later change is on its way.
    if (!next || mine !== asked) return;
    const floor = next.walk.grid?.url !== scene.walk.grid?.url;
    scene = next;
    ui.updateScene(scene);
    ui.problems(scene.problems);
    wake();
    if (floor) {
      const grid = await loadClearance(next.walk);
      if (scene.walk.grid?.url === next.walk.grid?.url) walk.change(grid); // and not another one since
    }
    if (opened && scene.exhibits.some((exhibit) => exhibit.id === opened)) {
      const id = opened, detail = await fetchJson(exhibitUrl(id)).catch(() => null);
      if (!detail || mine !== asked || id !== opened) return;
      comparison = detail.comparison;
      ui.updateExhibit(detail);
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
    if (moving || head.busy) wake();
    head.frame(dt, now / 1000);
    walk.frame(walked, forward, right, gaze.yaw, gaze.eye);
    ui.pose({ x: walk.pose.x, z: walk.pose.z, yaw: gaze.yaw });
    if (beside.size > 1) look();
  }

  const nodes = () => scene.exhibits.map(({ id }) => `${EXHIBITS}${id}`);

  let last = performance.now(), ordinary = 0, drawn = "", settleUntil = Infinity;
  function frame(now) {
    const passed = (now - last) / 1000;
    const dt = passed > LONGEST_FRAME ? ordinary : passed; // after a stall walking goes on, it does not leap
    ordinary = Math.min(passed, LONGEST_FRAME);
    last = now;
    spot.note(now);
    if (walking()) step(dt, now);
    if (display !== "page") return;
    if (settleUntil < Infinity) clips.frame(scene, { ...walk.pose, yaw: gaze.yaw }, opened, compared); // after the first view
    points.frame(clips.shown(exhibitOf(opened) ?? {}));
    if (opened) return;
    camera.holdGestures();
    camera.fitLens();
    turning.frame(dt, scene, { ...walk.pose, yaw: gaze.yaw });
    glow.frame(now, nodes());
    const view = [walk.pose.x, walk.pose.z, gaze.eye, gaze.yaw, gaze.pitch].map((v) => v.toFixed(5)).join();
    // viser's controls begin anew after a lost connection, wherever they like.
    if (view === drawn && now >= settleUntil && camera.standsAt(walk.pose.x, walk.pose.z)) return;
    if (view !== drawn) wake();
    drawn = view;
    showPose();
  }

  return {
    frame,
    /** The hall stands: hold our camera a little longer, then only where it moves. */
    settle() {
      createLater({ display, nodes, busy: () => opened !== null, ask: walk.stands });
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
    close,
    compare,
    /** To (x, z) [m], looking along `yaw` and `pitch` [rad] if given. */
    goTo(x, z, yaw, pitch = 0) {
      const sent = walk.send({ t: "goto", x, z });
      headingThere = sent && yaw !== undefined ? { yaw, pitch } : null;
    },
    move(forward, right) {
      const since = stick.forward || stick.right ? stick.since : performance.now();
      stick = { forward, right, since };
      wake();
    },
    pose: () => ({ ...walk.pose, ...gaze }),
    mode: () => walk.mode,
    ahead: () => walk.ahead,
    disagreement: () => walk.disagreement,
    opened: () => opened,
    near: () => near,
    compares: () => compared !== null,
    closeupAt: closeup.drawnAt,
    /** Whether what is not in the first view is there, too. */
    whole: () => drawnOf(nodes()).length === scene.exhibits.length,
    /** Nodes of the first view. */
    awaited: () => scene.nodes,
    /** As it is described now. */
    scene: () => scene,
    playing: clips.playing,
  };
}
