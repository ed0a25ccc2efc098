// How loud the music plays.

import { el } from "../elements.js";

/** createVolume({words, music, testid}) -> a range input bound to the music. */
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
