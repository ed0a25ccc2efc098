// Building DOM nodes. Text always goes through textContent; HTML from the server has its own, single door (panel/panel.js).

const SVG = "http://www.w3.org/2000/svg";

/** el("button", {class, text, testid, on: {click}, ...attributes}, ...children) -> HTMLElement */
export function el(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** The same for SVG nodes. */
export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

function fill(node, { text, testid, on = {}, ...attributes }, children) {
  if (text != null) node.textContent = text;
  if (testid) node.dataset.testid = testid;
  for (const [name, value] of Object.entries(attributes)) setAttribute(node, name, value);
  for (const [name, listener] of Object.entries(on)) node.addEventListener(name, listener);
  node.append(...children.filter((child) => child != null));
  return node;
}

/** null and false remove an attribute, true sets it empty. */
export function setAttribute(node, name, value) {
  if (value == null || value === false) node.removeAttribute(name);
  else node.setAttribute(name, value === true ? "" : value);
}

/** aria-label and tooltip of a button that shows only an icon. */
export function setLabel(node, text) {
  node.setAttribute("aria-label", text);
  node.title = text;
}

const OWN_KEYS = "input, textarea, select, video, audio, [contenteditable], [role=tablist], [data-own-keys]";

/** Whether an event's target (or an open dialog) needs the arrow keys and letters itself, so that they must not walk. */
export function ownsKeys(target) {
  if (document.querySelector("dialog[open]")) return true;
  return target instanceof Element && target.closest(OWN_KEYS) !== null;
}

/** Whether Enter on this target already means something (a button, a link, a field). */
export function ownsEnter(target) {
  if (ownsKeys(target)) return true;
  return target instanceof Element && target.closest("button, a[href], summary, iframe") !== null;
}
