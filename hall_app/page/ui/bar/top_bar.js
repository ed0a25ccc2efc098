// The top edge: brand with seal on the left; language, exhibits, music, feedback, settings and help on the right.

import { el, setAttribute, setLabel } from "../elements.js";
import { icon } from "../icons.js";
import { LANGUAGES } from "../words.js";

const SHORT = { zh: "中文", en: "EN" };

/** The character in the seal: the first Han character of the hall's Chinese title. */
export function sealCharacter(title) {
  const text = typeof title === "string" ? title : (title?.zh ?? "");
  return text.match(/\p{Script=Han}/u)?.[0] ?? "裳";
}

/** createBrand({words, scene}) -> {element, updateScene} */
export function createBrand({ words, scene }) {
  let current = scene;
  const seal = el("span", { class: "seal", "aria-hidden": "true", lang: "zh" });
  const name = el("h1", { class: "brand-name" }); // once the Enter screen's own has gone
  const second = el("p", { class: "brand-second" });
  const element = el(
    "div",
    { class: "brand glass", testid: "brand" },
    seal,
    el("div", { class: "brand-text" }, name, second),
  );
  const render = () => {
    seal.textContent = sealCharacter(current.title);
    name.textContent = words.pick(current.title);
    second.textContent = words.pick(current.title, words.other);
    second.lang = words.other;
  };
  words.follow(render);
  const updateScene = (next) => {
    current = next;
    render();
  };
  return { element, updateScene };
}

/** Two buttons, one pressed. The same element stands on the Enter screen and later in the bar. */
export function createLanguageSwitch({ words, onChoose }) {
  const buttons = LANGUAGES.map((lang) =>
    el("button", {
      type: "button",
      class: "segment",
      lang,
      text: SHORT[lang],
      testid: `lang-${lang}`,
      on: { click: () => choose(lang) },
    }),
  );
  function choose(lang) {
    onChoose(lang);
    // A narrow bar shows only the other language: the focus goes on to it.
    if (document.activeElement?.offsetParent === null) buttons.find((button) => button.lang !== lang).focus();
  }
  const element = el("div", { class: "segments", role: "group" }, ...buttons);
  words.follow(() => {
    element.setAttribute("aria-label", words.t("bar.language"));
    for (const button of buttons) button.setAttribute("aria-pressed", String(button.lang === words.lang));
  });
  return element;
}

function tool({ words, name, key, testid, onClick }) {
  const text = words.text(el("span", { class: "tool-text" }), key);
  const button = el(
    "button",
    { type: "button", class: "tool", testid, on: { click: onClick } },
    icon(name),
    text,
  );
  return words.label(button, key);
}

function musicTool(words, music) {
  const button = el(
    "button",
    { type: "button", class: "tool", testid: "music", on: { click: () => music.toggle() } },
    icon("music"),
    icon("mute"),
    words.text(el("span", { class: "tool-text" }), "bar.music"),
  );
  const show = () => {
    setLabel(button, words.t(music.on ? "bar.music_on" : "bar.music_off"));
    button.setAttribute("aria-pressed", String(music.on));
    setAttribute(button, "hidden", !music.available);
  };
  words.follow(show);
  music.follow(show);
  return button;
}

/** What moves stands still or goes on; the same as the key P. */
function motionTool(words, clock) {
  const button = el(
    "button",
    { type: "button", class: "tool", testid: "motion", "aria-keyshortcuts": "P", on: { click: () => clock.toggle() } },
    icon("pause"),
    icon("play"),
    words.text(el("span", { class: "tool-text" }), "bar.motion"),
  );
  const show = () => {
    setLabel(button, words.t(clock.stopped ? "bar.motion_off" : "bar.motion_on"));
    button.setAttribute("aria-pressed", String(!clock.stopped));
  };
  words.follow(show);
  clock.watch(show);
  return button;
}

/** createTools({words, music, clock, scene, onList, onHelp, onSurvey, onSettings}) -> {element, updateScene} */
export function createTools({ words, music, clock, scene, onList, onHelp, onSurvey, onSettings }) {
  const one = (name, onClick, testid = name) => tool({ words, name, key: `bar.${name}`, testid, onClick });
  const list = one("list", onList);
  const survey = one("survey", onSurvey, "hall-survey");
  const settings = one("settings", onSettings);
  const help = one("help", onHelp);
  const motion = motionTool(words, clock);
  const tools = [list, musicTool(words, music), motion, survey, settings, help];
  const element = el("nav", { class: "tools glass" }, ...tools);
  words.follow(() => element.setAttribute("aria-label", words.t("bar.tools")));
  const updateScene = (next) => {
    setAttribute(survey, "hidden", !next.questionnaire);
    setAttribute(motion, "hidden", !next.exhibits.some((exhibit) => exhibit.moves));
  };
  updateScene(scene);
  return { element, updateScene };
}
