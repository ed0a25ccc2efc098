// The page: loads the scene's description, waits for viser to draw it, then lets the visitor in.

import { createBeat } from "./beat.js";
import * as camera from "./camera.js";
import { framesDrawn, hooksPresent, requestRender } from "./hooks.js";
import { chosenLanguage, fetchJson, loadClearance, loadHall, until, webglWorks } from "./loading.js";
import { createQuality } from "./quality.js";
import { remember } from "./ui/words.js";
import { createUi } from "./ui/ui.js";
import { createVisit } from "./visit.js";

const HOOK_PATIENCE = 8000; // [ms] before the page hands the camera to the server
const FIRST_LOOK = 2500; // [ms] the finished hall is drawn on end, to see what the machine bears

let ui = null;

/** What the overlay may ask for; `parts` fills up while the page loads. */
function createActions(parts) {
  return {
    enter: () => parts.visit.enter(),
    open: (id) => parts.visit.open(id),
    close: () => parts.visit.close(),
    goTo: (...there) => parts.visit.goTo(...there),
    move: (forward, right) => parts.visit.move(forward, right),
    setLang(next) {
      remember("hall.lang", next);
      document.documentElement.lang = next;
    },
    setQuality: (choice) => parts.quality?.choose(choice),
  };
}

async function start() {
  const [scene, texts] = await Promise.all([fetchJson("/api/scene"), fetchJson("/api/texts")]);
  const lang = chosenLanguage(scene), parts = { visit: null, quality: null };
  document.documentElement.lang = lang;
  ui = createUi({ root: document.body, scene, texts, lang, actions: createActions(parts) });
  if (!webglWorks()) {
    ui.fail("webgl");
    return;
  }
  ui.progress(0.05, "loading_hall");
  ui.problems(scene.problems);
  const [hooks, grid] = await Promise.all([
    window.HALL?.withoutHooks ? null : until(hooksPresent, HOOK_PATIENCE),
    loadClearance(scene.walk),
  ]);
  const display = hooks ? "page" : "viser";
  const beat = createBeat((now) => frame(parts, now));
  parts.visit = createVisit({ scene, grid, display, ui, wake: beat.wake });
  if (hooks) parts.quality = createQuality(() => {
    ui.quality(parts.quality);
    requestRender();
    beat.wake();
  });
  ui.quality(parts.quality);
  beat.wake(120000);
  if (hooks) await loadHall(scene, ui.progress);
  beat.rest();
  parts.visit.settle();
  if (parts.quality?.choice === "auto") firstLook(beat);
  ui.ready();
  publish(parts, display);
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
function publish({ visit, quality }, display) {
  const { goTo, pose, mode, disagreement, opened, near, closeupAt } = visit;
  window.hall = Object.freeze({
    goTo, pose, mode, disagreement, opened, near, closeupAt,
    displayed: camera.displayed,
    display: () => display,
    quality: () => (quality ? { choice: quality.choice, level: quality.level } : null),
    setQuality: (choice) => quality?.choose(choice),
    framesDrawn,
    loadedAt: performance.now(),
  });
}

start().catch((error) => {
  console.error(error);
  if (ui) ui.fail("load");
  else document.body.insertAdjacentHTML("beforeend",
    '<p class="hall-failed" role="alert">展厅无法打开，请刷新页面。<br>The hall could not be opened. Please reload the page.</p>');
});
