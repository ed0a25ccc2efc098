// A modal window on paper: title, close button, body. The browser traps and restores the focus and handles Esc.

import { el } from "../elements.js";
import { icon } from "../icons.js";

/** createDialog({words, titleKey, testid, kind}) -> {element, head, title, body, open(), close()} */
export function createDialog({ words, titleKey, testid, kind = "" }) {
  const title = el("h2", { id: `${testid}-title`, class: "dialog-title" });
  if (titleKey) words.text(title, titleKey);
  const shut = words.label(
    el("button", { type: "button", class: "icon-button", testid: `${testid}-close` }, icon("close")),
    "dialog.close",
  );
  const head = el("div", { class: "dialog-head" }, title, shut);
  const body = el("div", { class: "dialog-body" });
  const element = el(
    "dialog",
    { class: `dialog ${kind}`, testid, "aria-labelledby": title.id },
    el("div", { class: "dialog-sheet" }, head, body),
  );
  const close = () => element.open && element.close();
  shut.addEventListener("click", close);
  // The sheet fills the dialog, so a click whose target is the dialog itself fell on the backdrop.
  element.addEventListener("click", (event) => event.target === element && close());
  const open = () => !element.open && element.showModal();
  return { element, head, title, body, open, close };
}
