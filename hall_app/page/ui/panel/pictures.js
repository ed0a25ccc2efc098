// The exhibit's pictures in the panel, and the window that enlarges them.

import { createDialog } from "../dialogs/dialogs.js";
import { el, setAttribute, setLabel } from "../elements.js";
import { icon } from "../icons.js";

/** Pictures of an exhibit: [{src, alt, caption}] with both languages kept. */
function picturesOf(detail) {
  return detail.media
    .filter((item) => item.kind === "picture")
    .map((item) => ({ src: item.sources[0]?.url, alt: item.alt, caption: item.caption }))
    .filter((picture) => picture.src);
}

/** A page of the panel; onEnlarge(pictures, index). */
export function createPicturesPage(words, onEnlarge) {
  const element = el("div", { class: "pictures" });
  let signature = "";
  let figures = [];

  function build(pictures) {
    figures = pictures.map((picture, index) => {
      const image = el("img", { src: picture.src, loading: "lazy", decoding: "async" });
      const button = el(
        "button",
        { type: "button", class: "picture", testid: `picture-${index}` },
        image,
        icon("enlarge"),
      );
      button.addEventListener("click", () =>
        onEnlarge(
          figures.map((figure) => figure.picture),
          index,
        ),
      );
      const caption = el("figcaption");
      return { picture, image, button, caption, element: el("figure", {}, button, caption) };
    });
    element.replaceChildren(...figures.map((figure) => figure.element));
  }

  function render(detail) {
    const pictures = picturesOf(detail);
    const next = pictures.map((picture) => picture.src).join("\n");
    if (next !== signature) build(pictures);
    signature = next;
    figures.forEach((figure, index) => {
      figure.picture = pictures[index];
      const alt = words.pick(pictures[index].alt);
      figure.image.alt = alt;
      setLabel(figure.button, words.t("panel.enlarge", { alt }));
      figure.caption.textContent = words.pick(pictures[index].caption);
    });
  }

  return { element, render, filled: () => figures.length > 0, silence() {} };
}

/** createViewer({words}) -> {element, open(pictures, index), close} */
export function createViewer({ words }) {
  let pictures = [];
  let at = 0;
  const dialog = createDialog({ words, titleKey: "viewer.title", testid: "viewer", kind: "viewer" });
  const image = el("img", { class: "viewer-image", testid: "viewer-image" });
  const caption = el("p", { class: "viewer-caption" });
  const position = el("p", { class: "viewer-position", role: "status" });
  const step = (by) => {
    at = (at + by + pictures.length) % pictures.length;
    render();
  };
  const turn = (name, by) =>
    words.label(
      el(
        "button",
        { type: "button", class: "icon-button", testid: `viewer-${name}`, on: { click: () => step(by) } },
        icon(name),
      ),
      `viewer.${name}`,
    );
  const steps = el("div", { class: "viewer-steps" }, turn("previous", -1), position, turn("next", 1));
  dialog.body.append(image, el("div", { class: "viewer-foot" }, caption, steps));

  function render() {
    const picture = pictures[at];
    if (!picture) return;
    image.src = picture.src;
    image.alt = words.pick(picture.alt);
    caption.textContent = words.pick(picture.caption);
    position.textContent = words.t("viewer.position", { n: at + 1, total: pictures.length });
    setAttribute(steps, "hidden", pictures.length < 2);
  }

  dialog.element.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by && pictures.length > 1) step(by);
  });
  words.follow(render);
  return {
    element: dialog.element,
    close: dialog.close,
    open(next, index) {
      [pictures, at] = [next, index];
      render();
      dialog.open();
    },
  };
}
