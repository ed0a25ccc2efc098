// What an exhibit compares: while this page is chosen, its meshes stand side by side in the close-up and turn together.

import { el, setAttribute } from "../elements.js";

const COLUMNS = ["name", "vertices", "hausdorff", "time"];
const DIGITS = { vertices: 0, hausdorff: 1, time: 1 };

/** A page of the panel; onCompare(on): the close-up shows the meshes, or the exhibit again; clock: of what moves. */
export function createComparePage(words, { onCompare, clock }) {
  const text = el("p", { class: "compare-text" });
  const heads = Object.fromEntries(COLUMNS.map((column) => [column, words.text(el("th", { scope: "col" }), `compare.${column}`)]));
  const rows = el("tbody");
  const caption = words.text(el("caption"), "compare.caption");
  const table = el("table", { class: "compare-table", testid: "compare-table" }, caption, el("thead", {}, el("tr", {}, ...Object.values(heads))), rows);
  const note = words.text(el("p", { class: "compare-note" }), "compare.note");
  const stopped = words.text(el("p", { class: "compare-note", testid: "compare-stopped" }), "compare.stopped");
  const element = el("div", { class: "compare", testid: "compare" }, table, text, note, stopped);
  let told = null;

  clock.watch((on) => setAttribute(stopped, "hidden", !on || !told?.clip));

  function figure(value, column) {
    const digits = DIGITS[column];
    return value.toLocaleString(words.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits });
  }

  function row({ name, colour, vertices, hausdorff_mm, milliseconds }) {
    const mark = el("i", { class: "compare-mark", "aria-hidden": "true" });
    mark.style.background = colour;
    return el(
      "tr",
      {},
      el("th", { scope: "row" }, mark, el("span", { text: words.pick(name) })),
      el("td", { text: figure(vertices, "vertices") }),
      el("td", { text: hausdorff_mm === null ? words.t("compare.reference") : figure(hausdorff_mm, "hausdorff") }),
      el("td", { text: figure(milliseconds, "time") }),
    );
  }

  function write() {
    if (!told) return;
    rows.replaceChildren(...told.sides.map(row));
    setAttribute(text, "hidden", !told.text);
    if (told.text) text.textContent = words.pick(told.text);
    setAttribute(stopped, "hidden", !clock.stopped || !told.clip);
  }

  words.follow(write);
  return {
    element,
    filled: () => told !== null,
    render(detail) {
      told = detail.comparison ?? null;
      write();
    },
    enter: () => onCompare(true),
    leave: () => onCompare(false),
    silence() {},
  };
}
