// The exhibit's record, its measured figures and its licence. All values come from the server, none is written here.

import { el } from "../elements.js";

function table(words, heading, rows) {
  if (!rows?.length) return [];
  const entries = rows.flatMap(({ label, value }) => [
    el("dt", { text: words.pick(label) }),
    el("dd", { text: words.pick(value) }),
  ]);
  return [el("h3", { text: heading }), el("dl", { class: "record" }, ...entries)];
}

/** A page of the panel. */
export function createDataPage(words) {
  const element = el("div", { class: "data" });
  let filled = false;

  function render(detail) {
    const licence = words.pick(detail.licence);
    const parts = [
      ...table(words, words.t("panel.record"), detail.record),
      ...table(words, words.t(detail.scanned ? "panel.scanned" : "panel.measured"), detail.measured),
      ...(licence
        ? [el("h3", { text: words.t("panel.licence") }), el("p", { class: "licence", text: licence })]
        : []),
    ];
    filled = parts.length > 0;
    element.replaceChildren(...parts);
  }

  return { element, render, filled: () => filled, silence() {} };
}
