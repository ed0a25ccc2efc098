// The top edge: brand with seal on the left; language, exhibits, music, feedback and help on the right.

import { el, setAttribute, setLabel } from "./elements.js";
import { icon } from "./icons.js";
import { LANGUAGES } from "./words.js";

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
  const name = el("span", { class: "brand-name" });
  const second = el("span", { class: "brand-second" });
  const element = el(
    "div",
    { class: "brand glass", testid: "brand" },
    seal,
    el("span", { class: "brand-text" }, name, second),
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
      on: { click: () => onChoose(lang) },
    }),
  );
  const element = el("div", { class: "segments", role: "group" }, ...buttons);
  words.follow(() => {
    element.setAttribute("aria-label", words.t("bar.language"));
    for (const button of buttons) button.setAttribute("aria-pressed", String(button.lang === words.lang));
  });
  return element;
}

/** A range input bound to the music; the bar and the help window each hold one. */
export function createVolume({ words, music, testid }) {
  const slider = el("input", { type: "range", class: "volume", min: 0, max: 100, step: 5, testid });
  slider.addEventListener("input", () => {
    music.setVolume(slider.valueAsNumber / 100);
    if (!music.on) music.toggle();
  });
  words.label(slider, "bar.volume");
  music.follow(() => {
    const shown = music.on ? Math.round(100 * music.volume) : 0;
    slider.value = shown;
    slider.style.setProperty("--level", `${shown}%`);
  });
  return slider;
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

/** createTools({words, music, onList, onHelp, onSurvey, hasSurvey}) -> {element, updateScene} */
export function createTools({ words, music, onList, onHelp, onSurvey, scene }) {
  const list = tool({ words, name: "list", key: "bar.list", testid: "list", onClick: onList });
  const survey = tool({ words, name: "survey", key: "bar.survey", testid: "hall-survey", onClick: onSurvey });
  const help = tool({ words, name: "help", key: "bar.help", testid: "help", onClick: onHelp });
  const volume = createVolume({ words, music, testid: "volume" });
  survey.classList.add("wide-only");
  const element = el("nav", { class: "tools glass" }, list, musicTool(words, music), volume, survey, help);
  words.follow(() => element.setAttribute("aria-label", words.t("bar.tools")));
  music.follow(() => setAttribute(volume, "hidden", !music.available));
  const updateScene = (next) => setAttribute(survey, "hidden", !next.questionnaire);
  updateScene(scene);
  return { element, updateScene };
}
