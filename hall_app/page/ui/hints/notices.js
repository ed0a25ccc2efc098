// What the hall has to say besides its exhibits: toasts, the state of the connection, faulty content, and the screen reader's voice.

import { el, setAttribute } from "../elements.js";
import { icon } from "../icons.js";

const TOAST = 5000; // [ms]
const PATIENCE = 800; // [ms] a hiccup of the connection is not worth a banner
const DESPAIR = 20000; // [ms] until the visitor is offered to load the page again

/** createToasts() -> {element, toast(text)} */
export function createToasts() {
  const element = el("div", { class: "toasts", role: "status", "aria-live": "polite" });
  function toast(text) {
    const note = el("p", { class: "toast glass", testid: "toast", text });
    element.append(note);
    while (element.children.length > 3) element.firstElementChild.remove();
    note.addEventListener("click", () => note.remove());
    setTimeout(() => note.remove(), TOAST);
  }
  return { element, toast };
}

/**
 * createConnection({words, onRestored}) -> {element, set(state, place)}; state: "open", "waiting" (for an answer),
 * "lost" (being tried again), "queue" (at `place`), "full" (the queue too), "refused" (this page asked too much) or
 * "away" (for so long that the place went to somebody who waited).
 */
export function createConnection({ words, onRestored }) {
  const said = el("span");
  const reload = words.text(el("button", { type: "button", class: "link-button" }), "connection.reload");
  reload.addEventListener("click", () => location.reload());
  const element = el(
    "div",
    { class: "connection", role: "alert", testid: "connection", hidden: true },
    said,
    reload,
  );
  let state = "open";
  let stage = "open"; // what is shown: open, waiting, reconnecting, lost, queue, full, refused, away
  let place = 0;
  let timers = [];

  function show(next) {
    stage = next;
    render();
  }

  function render() {
    if (stage !== "open") said.textContent = words.t(`connection.${stage}`, { place });
    setAttribute(reload, "hidden", stage !== "lost");
    element.dataset.state = stage;
    setAttribute(element, "hidden", stage === "open");
  }

  function set(next, at = 0) {
    if (next === state && at === place) return;
    const shown = stage !== "open";
    const gone = shown && stage !== "waiting" && stage !== "queue";
    state = next;
    place = at;
    timers.forEach(clearTimeout);
    timers = [];
    if (next !== "lost") show(next);
    else timers = [setTimeout(show, shown ? 0 : PATIENCE, "reconnecting"), setTimeout(show, DESPAIR, "lost")];
    if (next === "open" && gone) onRestored();
  }

  words.follow(render);
  return { element, set };
}

/** createProblems(words) -> {element, set(count)}: a discreet line that faulty content was left out. */
export function createProblems(words) {
  let count = 0;
  const said = el("span");
  const dismiss = words.label(
    el("button", { type: "button", class: "icon-button small" }, icon("close")),
    "content.dismiss",
  );
  const element = el(
    "div",
    { class: "problems glass", testid: "problems", role: "status", hidden: true },
    said,
    dismiss,
  );
  dismiss.addEventListener("click", () => (element.hidden = true));
  words.follow(() => (said.textContent = words.count("content.problems", count)));
  return {
    element,
    set(next) {
      count = next;
      said.textContent = words.count("content.problems", count);
      setAttribute(element, "hidden", count === 0);
    },
  };
}

/** createVoice() -> {element, say(text)}: read out by screen readers, seen by nobody. */
export function createVoice() {
  const element = el("p", { class: "unseen", "aria-live": "polite", testid: "announcement" });
  return { element, say: (text) => (element.textContent = text) };
}
