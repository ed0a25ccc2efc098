// The page: builds the overlay from the scene's description, waits for viser to draw it, then lets the visitor in.

import { createBeat } from "./picture/beat.js";
import * as camera from "./look/camera.js";
import { createClock } from "./look/clip/clock.js";
import { createPoints } from "./look/points/points.js";
import { createConnection } from "./visit/connection.js";
import { framesDrawn, hooksPresent, requestRender } from "./viser/viser_adapter.js";
import { LOAD_PATIENCE, loadClearance, loadHall, until, webglWorks } from "./visit/loading.js";
import { createQuality } from "./picture/quality.js";
import { remember } from "./ui/words.js";
import { createUi } from "./ui/ui.js";
import { createVisit } from "./visit/visit.js";

const HOOK_PATIENCE = 60000; // [ms] before the page hands the camera to the server; a slow machine takes its time
const DRAW_ON = 5000; // [ms] at a time, while the hall's nodes come
const FIRST_LOOK = 2500; // [ms] the finished hall is drawn on end, to see what the machine bears

let ui = null;

/** What the overlay may ask for; `parts` fills up while the page loads. */
function createActions(parts) {
  return {
    enter: () => parts.visit.enter(),
    open: (id) => parts.visit.open(id),
    close: () => parts.visit.close(),
    compare: (on) => parts.visit.compare(on),
    opened: () => parts.visit?.opened() ?? null,
    goTo: (...there) => parts.visit.goTo(...there),
    move: (forward, right) => parts.visit.move(forward, right),
    setLang: (next) => remember("hall.lang", next),
    setQuality: (choice) => parts.quality?.choose(choice),
  };
}

async function start() {
  const { door } = window.HALL; // it has been fetching since the first paint
  const [scene, texts] = await Promise.all([door.scene, door.texts]);
  const { lang } = door, parts = { visit: null, quality: null };
  const clock = createClock(), points = createPoints();
  ui = createUi({ root: document.body, scene, texts, lang, actions: createActions(parts), clock, points });
  if (!webglWorks()) {
    ui.fail("webgl");
    return;
  }
  ui.problems(scene.problems);
  const [hooks, grid] = await Promise.all([
    window.HALL.withoutHooks ? null : door.viewer.then(() => until(hooksPresent, HOOK_PATIENCE)),
    loadClearance(scene.walk),
  ]);
  const display = hooks ? "page" : "viser";
  const beat = createBeat((now) => frame(parts, now));
  const connection = createConnection({ view: window.HALL.view, tell: ui.connection, late: () => ui.fail("load") });
  parts.visit = createVisit({ scene, grid, display, ui, wake: beat.wake, connection: connection.walk, clock, points });
  if (hooks) parts.quality = createQuality(parts.visit.scene, () => {
    ui.quality(parts.quality);
    requestRender();
    beat.wake();
  });
  ui.quality(parts.quality);
  await door.models;
  await stand(parts.visit.awaited, hooks, connection, beat);
  beat.rest();
  parts.visit.settle();
  if (parts.quality?.choice === "auto") firstLook(beat);
  ui.ready();
  publish(parts, points, display);
}

/** Until the hall stands and the visitor is inside. What takes too long is said, and may still come. */
async function stand(awaited, hooks, connection, beat) {
  function progress(fraction) {
    window.HALL.door.progress("drawing", fraction);
    if (!connection.held()) beat.wake(DRAW_ON); // in the queue there is nothing to draw
  }
  const arrives = hooks
    ? () => loadHall(awaited, progress, connection)
    : () => until(connection.inside, LOAD_PATIENCE, connection);
  while (!(await arrives())) ui.fail("load");
}

/** Everything that must stand before viser draws; a fault of the picture's quality leaves the hall flat, but whole. */
function frame(parts, now) {
  parts.visit?.frame(now);
  if (!parts.quality) return;
  try {
    parts.quality.frame(now);
  } catch (error) {
    console.warn("the hall stays without its light:", error);
    parts.quality = null;
  }
}

/** Draw on for a moment, so that the picture's quality is settled before the visitor walks. */
function firstLook(beat) {
  const end = performance.now() + FIRST_LOOK;
  beat.wake(FIRST_LOOK);
  const timer = setInterval(() => {
    requestRender();
    if (performance.now() > end) clearInterval(timer);
  }, 200);
}

/** What tests and curious visitors may use: to read, and to go where the minimap goes. */
function publish({ visit, quality }, points, display) {
  const { goTo, pose, mode, ahead, disagreement, opened, near, compares, closeupAt, playing, whole } = visit;
  window.hall = Object.freeze({
    goTo, pose, mode, ahead, disagreement, opened, near, compares, closeupAt, playing, whole,
    displayed: camera.displayed,
    display: () => display,
    quality: () => (quality ? { choice: quality.choice, level: quality.level } : null),
    setQuality: (choice) => quality?.choose(choice),
    framesDrawn,
    points: points.told,
    loadedAt: performance.now(),
  });
}

start().catch((error) => {
  console.error(error);
  (ui ?? window.HALL.door).fail("load");
});
