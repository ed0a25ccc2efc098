// What hangs before the hall while it cannot be drawn: a calm ground and a sentence. Everything else goes on working.

import { el, setAttribute } from "../elements.js";

/** createCurtain({words}) -> {ground, note, set(state)}; state: "drawn", "lost" (waiting for it) or "gone" (given up). */
export function createCurtain({ words }) {
  let state = "drawn";
  const said = el("span");
  const reload = words.text(
    el("button", { type: "button", class: "button primary", testid: "curtain-reload" }),
    "picture.reload",
  );
  reload.addEventListener("click", () => location.reload());
  const ground = el("div", { class: "curtain", testid: "curtain", hidden: true });
  const note = el("div", { class: "curtain-note glass", role: "alert", testid: "curtain-note", hidden: true }, said, reload);

  function render() {
    if (state !== "drawn") said.textContent = words.t(`picture.${state}`);
    note.dataset.state = state;
    for (const part of [ground, note]) setAttribute(part, "hidden", state === "drawn");
    setAttribute(reload, "hidden", state !== "gone");
  }

  words.follow(render);
  return {
    ground,
    note,
    set(next) {
      state = next;
      render();
    },
  };
}
