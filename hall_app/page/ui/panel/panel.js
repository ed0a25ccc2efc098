// The exhibit's panel: title, tabs, content, two buttons. It follows language and content without losing the open tab.

import { el, setAttribute } from "../elements.js";
import { icon } from "../icons.js";
import { createComparePage } from "./compare.js";
import { createDataPage } from "./data.js";
import { createClip, createMediaPage } from "./media.js";
import { createPicturesPage } from "./pictures.js";
import { createTabs } from "./tabs.js";
import { createWhyPage } from "./why.js";

/** The one door for HTML: the server has sanitised the curator's text. Above it runs the film of "play_clip". */
function createTextPage(words, onSounding) {
  const element = el("div", { class: "prose", testid: "exhibit-text" });
  const clip = createClip(words, onSounding);
  let shown = null;
  return {
    element: el("div", {}, clip.element, element),
    filled: () => true,
    play: clip.play,
    render(detail) {
      clip.render(detail);
      const html = words.pick(detail.text);
      if (html === shown) return;
      shown = html;
      element.lang = detail.text?.[words.lang] ? words.lang : words.other;
      if (html) element.innerHTML = html;
      else element.replaceChildren(el("p", { class: "quiet", text: words.t("panel.no_text") }));
    },
    silence: clip.silence,
  };
}

function createPages(words, { onEnlarge, onSounding, onCompare, motion }) {
  return {
    intro: createTextPage(words, onSounding),
    pictures: createPicturesPage(words, onEnlarge),
    film: createMediaPage(words, "video", onSounding),
    sound: createMediaPage(words, "audio", onSounding),
    data: createDataPage(words),
    why: createWhyPage(words, motion),
    compare: createComparePage(words, { onCompare, clock: motion.clock }),
  };
}

const SWIPE = 28; // [px] a thumb has to move the sheet's head

/** On small windows the panel is a sheet whose head alone can stay; `turn(folded)` by button, tap or swipe. */
function createFold(words, turn) {
  let folded = false;
  const button = words.label(
    el(
      "button",
      { type: "button", class: "icon-button panel-fold", testid: "panel-fold", "aria-controls": "panel-content" },
      icon("fold"),
    ),
    "panel.details",
  );
  const show = () => button.setAttribute("aria-expanded", String(!folded));
  function set(next) {
    folded = next;
    show();
    turn(folded);
  }
  button.addEventListener("click", () => set(!folded));

  /** The head can be pushed up and down by a thumb; whoever only taps it turns it over. */
  function grip(head) {
    const taken = (event) => button.offsetParent && !event.target.closest("button, a");
    let from = null;
    let pushed = false;
    head.addEventListener("pointerdown", (event) => {
      pushed = false;
      from = taken(event) ? event.clientY : null;
      if (from !== null) head.setPointerCapture(event.pointerId);
    });
    head.addEventListener("pointerup", (event) => {
      const moved = from === null ? 0 : event.clientY - from;
      from = null;
      pushed = Math.abs(moved) > SWIPE;
      if (pushed) set(moved > 0);
    });
    // Not as soon as the finger leaves: the click that follows would fall on whatever has come to lie under it.
    head.addEventListener("click", (event) => taken(event) && !pushed && set(!folded));
    head.addEventListener("pointercancel", () => (from = null));
  }

  show();
  return { button, grip, set };
}

/** createPanel({words, motion: {clock, points}, onClose, onSurvey, onEnlarge, onSounding, onCompare, onFold}) -> {element, show, update, hide, answered, detail} */
export function createPanel({ words, motion, onClose, onSurvey, onEnlarge, onSounding, onCompare, onFold }) {
  let detail = null;
  let returnTo = null;
  let watcher = null;
  const answered = new Set();
  const title = el("h2", { id: "panel-title", class: "panel-title", tabindex: -1 });
  const second = el("p", { class: "panel-second" });
  const line = el("p", { class: "panel-line" });
  const shut = el(
    "button",
    { type: "button", class: "icon-button", testid: "panel-close", on: { click: () => onClose() } },
    icon("close"),
  );
  words.label(shut, "panel.close");
  // A link, so that it works as one: among one's own it is known who asks, and the way back leads to this exhibit.
  const keep = words.label(el("a", { class: "icon-button panel-keep", testid: "keep" }, icon("keep")), "panel.keep");
  const pages = createPages(words, { onEnlarge, onSounding, onCompare, motion });
  const tabs = createTabs(words, pages);
  const surveyText = el("span");
  const survey = el(
    "button",
    { type: "button", class: "button primary", testid: "survey", on: { click: () => onSurvey(detail) } },
    surveyText,
  );
  const back = el(
    "button",
    { type: "button", class: "button quiet-button", testid: "panel-back", on: { click: () => onClose() } },
    words.text(el("span"), "panel.back"),
    el("kbd", { text: "Esc", "aria-hidden": "true" }),
  );
  const head = el("div", { class: "panel-head" });
  const content = el(
    "div",
    { id: "panel-content", class: "panel-content" },
    tabs.list,
    tabs.body,
    el("div", { class: "panel-foot" }, survey, back),
  );
  const element = el(
    "div",
    { class: "panel paper", testid: "panel", role: "dialog", "aria-labelledby": "panel-title", hidden: true },
    head,
    content,
  );
  const fold = createFold(words, (folded) => {
    element.classList.toggle("is-folded", folded);
    if (folded) silence();
    onFold(folded);
  });
  head.append(el("div", { class: "panel-names" }, title, second, line), keep, fold.button, shut);
  fold.grip(head);

  function silence() {
    for (const page of Object.values(pages)) page.silence();
  }

  function render() {
    if (!detail) return;
    title.textContent = words.pick(detail.title);
    second.textContent = words.pick(detail.title, words.other);
    second.lang = words.other;
    line.textContent = words.pick(detail.caption) || words.pick(detail.title, words.other);
    tabs.render(detail);
    keep.href = `/me/keep?${new URLSearchParams({ exhibit: detail.id, lang: words.lang })}`;
    setAttribute(survey, "hidden", !detail.questionnaire);
    const done = answered.has(detail.id);
    surveyText.textContent = words.t(done ? "panel.answered" : "panel.survey");
    survey.classList.toggle("is-done", done);
  }

  /** options.play: the exhibit's film starts, muted, above the text (behaviour "play_clip"). */
  function show(next, { play = false } = {}) {
    const other = detail?.id !== next.id;
    if (!detail) returnTo = document.activeElement;
    if (other) {
      tabs.reset();
      fold.set(false);
    }
    detail = next;
    render();
    element.hidden = false;
    watch();
    if (!other) return;
    title.focus({ preventScroll: true });
    pages.intro.play(play);
  }

  /** Chromium keeps every key inside a film's own controls; what it asks to close it lets know (as a back gesture). */
  function watch() {
    if (watcher || !window.CloseWatcher) return;
    watcher = new CloseWatcher();
    watcher.onclose = () => {
      watcher = null;
      if (detail) onClose();
    };
  }

  function hide() {
    if (!detail) return;
    watcher?.destroy();
    watcher = null;
    // A hidden button keeps the focus until the next frame: let go of it now.
    const inside = element.contains(document.activeElement);
    if (inside) document.activeElement.blur();
    silence();
    tabs.reset();
    element.hidden = true;
    detail = null;
    if (inside && returnTo?.isConnected) returnTo.focus({ preventScroll: true });
    returnTo = null;
  }

  words.follow(render);
  return {
    element,
    show,
    hide,
    /** New content of the exhibit on display; anything else is ignored. */
    update(next) {
      if (detail?.id !== next.id) return;
      detail = next;
      render();
    },
    answered(id) {
      answered.add(id);
      render();
    },
    detail: () => detail,
  };
}
