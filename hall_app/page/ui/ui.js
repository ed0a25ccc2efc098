// The overlay over the hall: builds its parts, keeps language, exhibit and connection in step between them.

import { watchContext } from "../picture/context.js";
import { LEVELS } from "../picture/judge.js";
import { createCaption } from "./hints/caption.js";
import { createCurtain } from "./enter/curtain.js";
import { el, ownsEnter } from "./elements.js";
import { createEnter } from "./enter/enter.js";
import { createExhibitsList } from "./dialogs/exhibits.js";
import { createHelp } from "./dialogs/help.js";
import { createHints } from "./hints/hints.js";
import { createMinimap } from "./map/minimap.js";
import { createMusic } from "./bar/music.js";
import { createConnection, createProblems, createToasts, createVoice } from "./hints/notices.js";
import { createPanel } from "./panel/panel.js";
import { createViewer } from "./panel/pictures.js";
import { createSettings } from "./dialogs/settings.js";
import { createSurveyDialog } from "./dialogs/survey.js";
import { createBrand, createLanguageSwitch, createTools } from "./bar/top_bar.js";
import { createStick, noticeTouch } from "./hints/touch.js";
import { createWords } from "./words.js";

// As judge.js has them, and the one that leaves it to the judge.
const CHOICES = ["auto", ...LEVELS];
const WRITTEN_IN = "input:not([type=checkbox], [type=radio]), textarea";
const NARROW = "(max-width: 720px)"; // the open plan covers the way one wants to walk

/**
 * createUi({root, scene, texts, lang, actions, clock, points}) -> ui
 *
 * scene: answer of /api/scene; texts: {zh, en} of texts.toml; lang: "zh" or "en".
 * clock: of what moves; points: what was tracked of who moves. actions: enter(), open(id), close(), compare(on), opened(), goTo(x, z, yaw?, pitch?), setLang(lang), setQuality(choice), move(forward, right).
 */
export function createUi({ root, scene, texts, lang, actions, clock, points }) {
  const words = createWords(texts, lang);
  const parts = createParts({ words, scene, actions, clock, points });
  const overlay = arrange(parts);
  root.append(overlay);
  followLanguage(words, parts, overlay);
  listenToKeys(parts, actions);
  noticeTouch(() => {
    overlay.classList.add("is-touch");
    parts.hints.touch();
    parts.caption.touch();
  });
  return face(parts, overlay, words);
}

function createParts({ words, scene, actions, clock, points }) {
  const parts = { words, scene, clock, points, covers: new Set() };
  const music = createMusic(scene);
  const titleOf = (id) => words.pick(parts.scene.exhibits.find((exhibit) => exhibit.id === id)?.title);
  const choose = (next) => {
    if (words.setLang(next)) actions.setLang(next);
  };
  const hallSurvey = () => parts.survey.open(parts.scene.questionnaire, null);
  const goTo = (...there) => {
    if (parts.panel.detail()) actions.close();
    if (matchMedia(NARROW).matches) parts.minimap.fold(true);
    actions.goTo(...there);
    focusStage(parts.stage); // Enter means the caption there, not the dot or the list once more
  };
  return Object.assign(parts, {
    music,
    titleOf,
    stage: el("div", { class: "stage", testid: "stage", role: "application", tabindex: 0 }),
    languages: createLanguageSwitch({ words, onChoose: choose }),
    enter: createEnter({ words, scene, onEnter: () => enterHall(parts, actions) }),
    brand: createBrand({ words, scene }),
    tools: createTools({
      words,
      music,
      clock,
      scene,
      onList: () => parts.list.open(),
      onHelp: () => parts.help.open(),
      onSurvey: hallSurvey,
      onSettings: () => parts.settings.open(),
    }),
    settings: createSettings({ words, music, choices: CHOICES, onQuality: actions.setQuality }),
    minimap: createMinimap({ words, scene, goTo, onBay: (bay) => announceBay(parts, bay) }),
    list: createExhibitsList({ words, scene, onOpen: actions.open, onGo: goTo }),
    help: createHelp({ words, scene, onSurvey: hallSurvey }),
    panel: createPanel({
      words,
      motion: { clock, points },
      onClose: actions.close,
      onSurvey: (detail) => parts.survey.open(detail.questionnaire, detail.id),
      onEnlarge: (pictures, index) => parts.viewer.open(pictures, index),
      onSounding: (sounding) => music.duck(sounding),
      onCompare: actions.compare,
      onFold: (folded) => foldPanel(parts, folded),
    }),
    curtain: createCurtain({ words }),
    viewer: createViewer({ words }),
    survey: createSurveyDialog({
      words,
      onSubmitted(exhibit) {
        if (exhibit) parts.panel.answered(exhibit);
        parts.toasts.toast(words.t("survey.thanks"));
      },
    }),
    caption: createCaption({ words, scene, onOpen: actions.open }),
    hints: createHints(words),
    stick: createStick({ words, move: actions.move }),
    toasts: createToasts(),
    connection: createConnection({
      words,
      onRestored: () => parts.toasts.toast(words.t("connection.restored")),
    }),
    problems: createProblems(words),
    voice: createVoice(),
  });
}

function arrange(parts) {
  const {
    enter,
    languages,
    stage,
    brand,
    tools,
    minimap,
    caption,
    hints,
    panel,
    toasts,
    connection,
    problems,
    voice,
    curtain,
  } = parts;
  enter.actions.append(languages);
  const dialogs = [parts.list, parts.settings, parts.help, parts.viewer, parts.survey].map(({ element }) => element);
  for (const dialog of dialogs) {
    // The browser gives the focus back; to the hall it comes without a frame, as on entering.
    dialog.addEventListener("close", () => document.activeElement === stage && focusStage(stage));
  }
  const top = el("header", { class: "top" }, brand.element, tools.element);
  const low = el(
    "div",
    { class: "low" },
    minimap.element,
    parts.stick,
    el("div", { class: "middle" }, problems.element, caption.element, hints.element),
  );
  const chrome = el("div", { class: "chrome", inert: true }, top, low, panel.element);
  const notices = el("div", { class: "announcements" }, connection.element, curtain.note, toasts.element, voice.element);
  const around = [parts.points.element, curtain.ground, stage, chrome, enter.element, notices];
  // Who hears the page read meets viser's picture as the stage, which answers to keys; what is drawn has no words.
  document.getElementById("root")?.setAttribute("aria-hidden", "true");
  return el("main", { id: "hall-ui", class: "is-outside" }, ...around, ...dialogs);
}

function followLanguage(words, parts, overlay) {
  words.follow(() => {
    document.documentElement.lang = words.lang === "zh" ? "zh-Hans" : "en";
    showTitle(parts);
    overlay.lang = document.documentElement.lang;
    overlay.setAttribute("aria-label", words.pick(parts.scene.title));
    parts.stage.setAttribute("aria-label", words.t("stage.label"));
  });
}

/** The tab, the history and whoever hands the link on read which exhibit is open. */
function showTitle({ words, scene, panel }) {
  document.title = [panel.detail()?.title, scene.title].filter(Boolean).map((title) => words.pick(title)).join(" · ");
}

function foldPanel({ stage, covers }, folded) {
  stage.parentElement.classList.toggle("has-folded-panel", folded);
  for (const listener of covers) listener();
}

function enterHall(parts, actions) {
  const overlay = parts.stage.parentElement;
  overlay.classList.remove("is-outside");
  overlay.querySelector(".chrome").inert = false;
  parts.tools.element.prepend(parts.languages);
  parts.enter.leave();
  focusStage(parts.stage);
  parts.music.start();
  actions.enter();
}

/** Gives the hall the focus without a frame around it; coming back by Tab shows the frame. */
function focusStage(stage) {
  stage.classList.add("is-quiet");
  stage.addEventListener("blur", () => stage.classList.remove("is-quiet"), { once: true });
  stage.focus({ preventScroll: true });
}

function announceBay({ words, voice }, bay) {
  if (bay) voice?.say(words.t("stage.entered", { place: words.pick(bay.name) }));
}

/** Esc leaves the close-up (an open dialog has its own Esc), Enter opens what is near, P stops motion, ? shows the help. */
function listenToKeys(parts, actions) {
  addEventListener("keydown", (event) => {
    const inside = parts.stage.parentElement.classList.contains("is-outside");
    if (inside || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector("dialog[open]")) return;
    if (event.key === "Escape" && actions.opened()) actions.close();
    else if (
      event.key === "Enter" &&
      parts.caption.id() &&
      !actions.opened() &&
      !ownsEnter(event.target)
    ) {
      event.preventDefault();
      actions.open(parts.caption.id());
    } else if (event.code === "KeyP" && !event.repeat && !event.target.closest?.(WRITTEN_IN)) parts.clock.toggle();
    else if (event.key === "?" && !event.target.closest?.("input, textarea")) parts.help.open();
  });
}

/** What the page's script may call. */
function face(parts, overlay, words) {
  const { enter, minimap, hints, caption, panel, voice, titleOf } = parts;
  const closeup = (open) => {
    overlay.classList.toggle("has-panel", open);
    hints.closeup(open);
    showTitle(parts);
  };
  watchContext(parts.curtain.set);
  return Object.freeze({
    ready: enter.ready,
    fail: enter.fail,
    pose(pose) {
      minimap.pose(pose);
      hints.pose(pose);
    },
    showExhibit(detail, options) {
      panel.show(detail, options);
      closeup(true);
      voice.say(words.t("stage.opened", { title: words.pick(detail.title) }));
    },
    hideExhibit() {
      if (!panel.detail()) return;
      // Going back in the browser's history also leaves what was opened from the panel.
      for (const window of [parts.viewer, parts.survey]) window.close();
      panel.hide();
      closeup(false);
      if (document.activeElement === document.body) focusStage(parts.stage);
      voice.say(words.t("stage.closed"));
    },
    updateExhibit(detail) {
      panel.update(detail);
      showTitle(parts);
    },
    near(id) {
      caption.near(id);
      minimap.mark(id);
      if (id) voice.say(words.t("stage.near", { title: titleOf(id) }));
    },
    hover(id) {
      caption.hover(id);
      document.documentElement.classList.toggle("hall-hover", Boolean(id));
    },
    /** Whoever walks is in the hall: a button that was left behind with the focus shall not take Enter. */
    walks() {
      const { activeElement } = document;
      if (activeElement !== parts.stage && overlay.contains(activeElement)) focusStage(parts.stage);
    },
    unknownExhibit: () => parts.toasts.toast(words.t("link.unknown")),
    unreadExhibit: () => parts.toasts.toast(words.t("link.unread")),
    connection(state, place) {
      enter.wait(state, place);
      parts.connection.set(state, place);
    },
    quality: parts.settings.quality,
    problems: parts.problems.set,
    updateScene(scene) {
      parts.scene = scene;
      for (const part of [
        enter,
        parts.brand,
        parts.tools,
        minimap,
        parts.list,
        parts.help,
        caption,
        parts.music,
      ])
        part.updateScene(scene);
      showTitle(parts);
    },
    get lang() {
      return words.lang;
    },
    /** Calls `listener` when the panel is folded or unfolded. */
    whenCovered: (listener) => parts.covers.add(listener),
    /** What covers the picture [px]: the panel's width at the right, bar on top, sheet or hints at the bottom. */
    get visible() {
      const { offsetLeft, offsetWidth, offsetHeight } = panel.element; // layout, not the sliding picture of it
      if (!panel.detail()) return { panel: 0, bottom: 0, top: 0 };
      const bar = overlay.querySelector(".top");
      const top = bar.offsetTop + bar.offsetHeight;
      if (offsetWidth > 0.9 * overlay.clientWidth) return { panel: 0, bottom: offsetHeight, top };
      const low = overlay.querySelector(".low");
      const hinted = low.offsetHeight && overlay.clientHeight - low.offsetTop - low.offsetHeight + hints.element.offsetHeight;
      return { panel: overlay.clientWidth - offsetLeft, bottom: hinted, top };
    },
  });
}
