// Settings: the picture's quality and the music's volume.

import { createDialog } from "./dialogs.js";
import { el, setAttribute } from "../elements.js";
import { createVolume } from "../bar/volume.js";

/** createSettings({words, music, choices, onQuality}) -> {element, open, quality({choice, level} | null)} */
export function createSettings({ words, music, choices, onQuality }) {
  const dialog = createDialog({ words, titleKey: "settings.title", testid: "settings-dialog", kind: "settings" });
  const inputs = new Map();
  let state = null;

  function option(choice) {
    const input = el("input", { type: "radio", name: "quality", value: choice, testid: `quality-${choice}` });
    input.addEventListener("change", () => onQuality(choice));
    const about = el("span", { class: "option-about" });
    words.follow(() => (about.textContent = describe(choice)));
    inputs.set(choice, { input, about });
    const text = el("span", { class: "option-text" }, words.text(el("strong"), `settings.${choice}`), about);
    return el("label", { class: "option" }, input, text);
  }

  function describe(choice) {
    if (choice !== "auto" || !state) return words.t(`settings.${choice}_about`);
    return words.t("settings.auto_now", { level: words.t(`settings.${state.level}`) });
  }

  const legend = words.text(el("legend", { class: "settings-heading" }), "settings.quality");
  const options = el("fieldset", { class: "options" }, legend, ...choices.map(option));
  const volume = el(
    "label",
    { class: "settings-volume" },
    words.text(el("span", { class: "settings-heading" }), "settings.volume"),
    createVolume({ words, music, testid: "volume" }),
  );
  dialog.body.append(options, volume);
  music.follow(() => setAttribute(volume, "hidden", !music.available));

  function quality(next) {
    state = next && { choice: next.choice, level: next.level };
    setAttribute(options, "hidden", !state);
    if (!state) return;
    inputs.get(state.choice).input.checked = true;
    inputs.get("auto").about.textContent = describe("auto");
  }
  quality(null);
  return { element: dialog.element, open: dialog.open, quality };
}
