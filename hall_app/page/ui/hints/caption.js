// The bubble that names the exhibit beside the visitor (or under the pointer) and opens it.

import { el, setAttribute } from "../elements.js";

/** createCaption({words, scene, onOpen}) -> {element, near(id), hover(id), id(), updateScene, touch} */
export function createCaption({ words, scene, onOpen }) {
  let current = scene;
  let beside = null;
  let under = null;
  let touched = false;
  const title = el("strong");
  const line = el("span", { class: "caption-line" });
  const how = el("span", { class: "caption-how" });
  const element = el(
    "button",
    { type: "button", class: "caption glass", testid: "caption", hidden: true },
    title,
    line,
    how,
  );
  element.addEventListener("click", () => shown() && onOpen(shown()));
  const shown = () => under ?? beside;

  function render() {
    const exhibit = current.exhibits.find(({ id }) => id === shown());
    setAttribute(element, "hidden", !exhibit);
    if (!exhibit) return;
    title.textContent = words.pick(exhibit.title);
    line.textContent = words.pick(exhibit.caption);
    setAttribute(line, "hidden", !line.textContent);
    how.textContent = words.t(touched ? "caption.tap" : "caption.closer");
  }

  words.follow(render);
  const set = (change) => (value) => {
    change(value);
    render();
  };
  return {
    element,
    near: set((id) => (beside = id)),
    hover: set((id) => (under = id)),
    touch: set(() => (touched = true)),
    updateScene: set((next) => (current = next)),
    /** The exhibit it names, which Enter opens. */
    id: shown,
  };
}
