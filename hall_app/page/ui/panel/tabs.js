// Tabs after the ARIA pattern: arrows move between them, Home and End jump, only the chosen one is in the tab order.

import { el, setAttribute } from "../elements.js";

/**
 * createTabs(words, pages) -> {list, body, render(detail), select(name), reset()}
 *
 * pages: {name: {element, filled, render, silence, enter, leave}}; enter, leave: where it matters that the page is chosen.
 */
export function createTabs(words, pages) {
  const names = Object.keys(pages);
  let chosen = names[0];
  const buttons = Object.fromEntries(names.map((name) => [name, tabButton(name)]));
  const sheets = Object.fromEntries(names.map((name) => [name, tabSheet(name)]));
  const list = el("div", { class: "tabs", role: "tablist" }, ...Object.values(buttons));
  const body = el("div", { class: "panel-body" }, ...Object.values(sheets));
  words.follow(() => {
    list.setAttribute("aria-label", words.t("panel.tabs"));
    for (const name of names) buttons[name].textContent = words.t(`panel.${name}`);
  });

  function tabButton(name) {
    const wiring = { role: "tab", id: `tab-${name}`, "aria-controls": `sheet-${name}` };
    return el("button", {
      type: "button",
      class: "tab",
      testid: `tab-${name}`,
      ...wiring,
      on: { click: () => select(name) },
    });
  }

  function tabSheet(name) {
    const wiring = { role: "tabpanel", id: `sheet-${name}`, "aria-labelledby": `tab-${name}`, tabindex: 0 };
    return el("div", { class: "sheet", testid: `sheet-${name}`, ...wiring }, pages[name].element);
  }

  const offered = () => names.filter((name) => !buttons[name].hidden);

  function select(name) {
    if (name !== chosen) {
      pages[chosen].silence();
      pages[chosen].leave?.();
      pages[name].enter?.();
      body.scrollTop = 0;
    }
    chosen = name;
    for (const other of names) {
      buttons[other].setAttribute("aria-selected", String(other === name));
      buttons[other].tabIndex = other === name ? 0 : -1;
      setAttribute(sheets[other], "hidden", other !== name);
    }
  }

  list.addEventListener("keydown", (event) => {
    const all = offered();
    const at = all.indexOf(chosen);
    const goal = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1 }[event.key];
    if (goal === undefined) return;
    event.preventDefault();
    const name = all[(goal + all.length) % all.length];
    select(name);
    buttons[name].focus();
  });

  function render(detail) {
    for (const name of names) {
      pages[name].render(detail);
      setAttribute(buttons[name], "hidden", !pages[name].filled());
    }
    select(buttons[chosen].hidden ? names[0] : chosen);
  }

  return { list, body, render, select, reset: () => select(names[0]) };
}
