// Key hints at the bottom. They fade once the visitor has shown to know them; the help window keeps them all.

import { el } from "../elements.js";

// [keys, text]; a key in {braces} is a text of the group "hints".
const HINTS = {
  walk: [
    [["W", "A", "S", "D"], "walk"],
    [["{drag}", "Q", "E"], "look"],
    [["{open_key}"], "open"],
  ],
  touch: [
    [["{stick}"], "walk"],
    [["{touch_drag}"], "look"],
    [["{tap}"], "open"],
  ],
  orbit: [
    [["{orbit_key}"], "orbit"],
    [["{zoom_key}"], "zoom"],
    [["{twice}"], "yarns"],
    [["{back_key}"], "back"],
  ],
  orbit_touch: [
    [["{touch_drag}"], "orbit"],
    [["{pinch}"], "zoom"],
    [["{twice_tap}"], "yarns"],
  ],
};
const WALKED = 8; // [m] and
const TURNED = 2.5; // [rad] until the walking hints fade
const SEEN = 12000; // [ms] until the close-up's hints fade

/** createHints(words) -> {element, pose, closeup(open), touch} */
export function createHints(words) {
  const element = el("div", { class: "hints glass", testid: "hints" });
  let touched = false;
  let closeup = false;
  let timer = 0;
  let last = null;
  let walked = 0;
  let turned = 0;

  function render() {
    const kind = closeup ? (touched ? "orbit_touch" : "orbit") : touched ? "touch" : "walk";
    const cap = (key) =>
      el("kbd", { text: key.startsWith("{") ? words.t(`hints.${key.slice(1, -1)}`) : key });
    const hints = HINTS[kind].map(([keys, text]) =>
      el("span", { class: "hint" }, ...keys.map(cap), words.t(`hints.${text}`)),
    );
    element.replaceChildren(...hints);
  }

  const known = () => walked > WALKED && turned > TURNED;
  const fade = (faded) => element.classList.toggle("is-faded", faded);

  function pose({ x, z, yaw }) {
    if (last && !known()) {
      walked += Math.min(0.5, Math.hypot(x - last.x, z - last.z)); // a teleport teaches nothing
      turned += Math.min(0.5, Math.abs(yaw - last.yaw));
      if (known()) fade(true);
    }
    last = { x, z, yaw };
  }

  words.follow(render);
  return {
    element,
    pose,
    closeup(open) {
      closeup = open;
      render();
      clearTimeout(timer);
      fade(!open && known());
      if (open) timer = setTimeout(() => fade(true), SEEN);
    },
    touch() {
      touched = true;
      render();
    },
  };
}
