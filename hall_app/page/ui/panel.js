// The exhibit's panel: title, tabs, content, two buttons. It follows language and content without losing the open tab.

import { el, setAttribute } from "./elements.js";
import { icon } from "./icons.js";
import { createDataPage } from "./panel_data.js";
import { createMediaPage } from "./panel_media.js";
import { createPicturesPage } from "./panel_pictures.js";
import { createTabs } from "./tabs.js";

/** The one door for HTML: the server has sanitised the curator's text. */
function createTextPage(words) {
  const element = el("div", { class: "prose", testid: "exhibit-text" });
  let shown = null;
  return {
    element,
    filled: () => true,
    render(detail) {
      const html = words.pick(detail.text);
      if (html === shown) return;
      shown = html;
      element.lang = detail.text?.[words.lang] ? words.lang : words.other;
      if (html) element.innerHTML = html;
      else element.replaceChildren(el("p", { class: "quiet", text: words.t("panel.no_text") }));
    },
    silence() {},
  };
}

function createPages(words, { onEnlarge, onSounding }) {
  return {
    intro: createTextPage(words),
    pictures: createPicturesPage(words, onEnlarge),
    film: createMediaPage(words, "video", onSounding),
    sound: createMediaPage(words, "audio", onSounding),
    data: createDataPage(words),
  };
}

/** createPanel({words, onClose, onSurvey, onEnlarge, onSounding}) -> {element, show, update, hide, answered, detail} */
export function createPanel({ words, onClose, onSurvey, onEnlarge, onSounding }) {
  let detail = null;
  let returnTo = null;
  let watcher = null;
  const answered = new Set();
  const title = el("h2", { id: "panel-title", class: "panel-title", tabindex: -1 });
  const second = el("p", { class: "panel-second" });
  const shut = el(
    "button",
    { type: "button", class: "icon-button", testid: "panel-close", on: { click: () => onClose() } },
    icon("close"),
  );
  words.label(shut, "panel.close");
  const pages = createPages(words, { onEnlarge, onSounding });
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
    el("kbd", { text: "Esc" }),
  );
  const element = el(
    "aside",
    { class: "panel paper", testid: "panel", role: "dialog", "aria-labelledby": "panel-title", hidden: true },
    el("header", { class: "panel-head" }, el("div", {}, title, second), shut),
    tabs.list,
    tabs.body,
    el("footer", { class: "panel-foot" }, survey, back),
  );

  function render() {
    if (!detail) return;
    title.textContent = words.pick(detail.title);
    second.textContent = words.pick(detail.title, words.other);
    second.lang = words.other;
    tabs.render(detail);
    setAttribute(survey, "hidden", !detail.questionnaire);
    const done = answered.has(detail.id);
    surveyText.textContent = words.t(done ? "panel.answered" : "panel.survey");
    survey.classList.toggle("is-done", done);
  }

  /** options.play starts the exhibit's film at once (behaviour "play_clip"). */
  function show(next, { play = false } = {}) {
    const other = detail?.id !== next.id;
    if (!detail) returnTo = document.activeElement;
    if (other) tabs.reset();
    detail = next;
    render();
    element.hidden = false;
    watch();
    if (other) title.focus({ preventScroll: true });
    if (play && pages.film.play()) tabs.select("film");
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
    for (const page of Object.values(pages)) page.silence();
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
