// Help: every key and gesture, the pages to read and the hall's own questionnaire.

import { createDialog } from "./dialogs.js";
import { el, setAttribute } from "../elements.js";

// [keys, text]; a key in {braces} is a text of the group "help".
const SECTIONS = {
  keyboard: [
    [["W", "↑"], "forward"],
    [["S", "↓"], "backward"],
    [["A", "←"], "left"],
    [["D", "→"], "right"],
    [["Q", "Shift ←"], "turn_left"],
    [["E", "Shift →"], "turn_right"],
    [["Home"], "level"],
    [["Enter"], "open"],
    [["←", "→"], "turn"],
    [["+", "−"], "nearer"],
    [["Z", "0"], "yarns"],
    [["P"], "motion"],
    [["Esc"], "back"],
    [["?"], "show_help"],
  ],
  mouse: [
    [["{left_drag}"], "look"],
    [["{middle_drag}"], "eye"],
    [["{click_key}"], "click"],
    [["{twice_key}"], "yarns"],
    [["{map_key}"], "map"],
  ],
  touch: [
    [["{stick_key}"], "stick"],
    [["{swipe_key}"], "look"],
    [["{tap_key}"], "click"],
    [["{map_tap_key}"], "map"],
    [["{turn_key}"], "turn"],
    [["{pinch_key}"], "nearer"],
    [["{twice_tap_key}"], "yarns"],
  ],
};

function section(words, name) {
  const rows = SECTIONS[name].flatMap(([keys, text]) => [
    el("dt", {}, ...keys.map((key) => keycap(words, key))),
    words.text(el("dd"), `help.${text}`),
  ]);
  return el(
    "section",
    { class: `help-${name}` },
    words.text(el("h3"), `help.${name}`),
    el("dl", { class: "keys" }, ...rows),
  );
}

function keycap(words, key) {
  return key.startsWith("{")
    ? words.text(el("kbd", { class: "long" }), `help.${key.slice(1, -1)}`)
    : el("kbd", { text: key });
}

/** createHelp({words, scene, onSurvey}) -> {element, open, updateScene} */
export function createHelp({ words, scene, onSurvey }) {
  const dialog = createDialog({ words, titleKey: "help.title", testid: "help-dialog", kind: "help" });
  const survey = words.text(
    el("button", { type: "button", class: "button quiet-button", testid: "help-survey" }),
    "help.survey",
  );
  survey.addEventListener("click", () => {
    dialog.close();
    onSurvey();
  });
  const catalogue = words.text(el("a", { href: "/catalogue" }), "help.catalogue");
  const culture = words.text(el("a", { href: "/culture" }), "help.culture");
  dialog.body.append(
    el(
      "div",
      { class: "help-columns" },
      section(words, "keyboard"),
      el("div", {}, section(words, "mouse"), section(words, "touch")),
    ),
    el("footer", { class: "help-foot" }, catalogue, culture, survey),
  );
  const updateScene = (next) => setAttribute(survey, "hidden", !next.questionnaire);
  updateScene(scene);
  return { element: dialog.element, open: dialog.open, updateScene };
}
