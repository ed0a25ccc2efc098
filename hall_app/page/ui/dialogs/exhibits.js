// The list of all exhibits: the second door for whoever does not want to walk.

import { createDialog } from "./dialogs.js";
import { el, setLabel } from "../elements.js";
import { icon } from "../icons.js";
import { bayAt, standBefore } from "../map/geometry.js";
import { sealCharacter } from "../bar/top_bar.js";

/** A picture, or a character on silk where the exhibit has none. */
function thumbnail(exhibit) {
  if (!exhibit.thumbnail)
    return el("span", {
      class: "thumb",
      lang: "zh",
      "aria-hidden": "true",
      text: sealCharacter(exhibit.title),
    });
  return el("img", { class: "thumb", src: exhibit.thumbnail, alt: "", loading: "lazy", decoding: "async" });
}

/** createExhibitsList({words, scene, onOpen, onGo}) -> {element, open, close, updateScene} */
export function createExhibitsList({ words, scene, onOpen, onGo }) {
  let current = scene;
  const dialog = createDialog({ words, titleKey: "list.title", testid: "list-dialog", kind: "side" });
  const list = el("ul", { class: "exhibits" });
  dialog.body.append(list);

  function entry(exhibit) {
    const title = words.pick(exhibit.title);
    const bay = bayAt([exhibit.x, exhibit.z], current.bays);
    const open = el(
      "button",
      {
        type: "button",
        class: "exhibit",
        testid: `list-item-${exhibit.id}`,
      },
      thumbnail(exhibit),
      el(
        "span",
        { class: "exhibit-text" },
        el("strong", { text: title }),
        el("span", { lang: words.other, text: words.pick(exhibit.title, words.other) }),
        bay && el("span", { class: "exhibit-bay", text: words.pick(bay.name) }),
      ),
    );
    const go = el(
      "button",
      { type: "button", class: "icon-button", testid: `list-go-${exhibit.id}` },
      icon("walk"),
    );
    setLabel(go, `${words.t("list.go")} · ${title}`);
    open.addEventListener("click", () => {
      dialog.close();
      onOpen(exhibit.id);
    });
    go.addEventListener("click", () => {
      dialog.close();
      const stand = standBefore(exhibit, current);
      onGo(stand.x, stand.z, stand.yaw, stand.pitch);
    });
    return el("li", {}, open, go);
  }

  function render() {
    const entries = current.exhibits.map(entry);
    list.replaceChildren(
      ...(entries.length ? entries : [el("li", { class: "quiet", text: words.t("list.empty") })]),
    );
  }

  words.follow(render);
  const updateScene = (next) => {
    current = next;
    render();
  };
  return { element: dialog.element, open: dialog.open, close: dialog.close, updateScene };
}
