// The Enter screen over the live hall: title, progress, and the button whose click allows music to start.

import { el, setAttribute } from "./elements.js";

/** createEnter({words, scene, onEnter}) -> {element, actions, progress, ready, fail, leave, updateScene} */
export function createEnter({ words, scene, onEnter }) {
  let current = scene;
  let label = "enter.preparing";
  let failure = null;
  const title = el("h1", { class: "enter-title" });
  const second = el("p", { class: "enter-second" });
  const lead = el("p", { class: "enter-lead" });
  const about = el("p", { class: "enter-about" });
  const fill = el("span", { class: "enter-fill" });
  const bar = el(
    "div",
    { class: "enter-bar", role: "progressbar", "aria-valuemin": 0, "aria-valuemax": 100 },
    fill,
  );
  const said = el("span", { testid: "progress-label" });
  const percent = el("span", { class: "enter-percent" });
  const state = el("p", { class: "enter-state", role: "status" }, said, percent);
  const trouble = el("div", { class: "enter-trouble", role: "alert", testid: "enter-failure", hidden: true });
  const button = words.text(
    el("button", { type: "button", class: "button primary large", testid: "enter", disabled: true }),
    "enter.button",
  );
  const catalogue = words.text(
    el("a", { class: "button ghost large", href: "/catalogue", testid: "catalogue" }),
    "enter.catalogue",
  );
  const actions = el("div", { class: "enter-actions" }, button, catalogue);
  const hint = words.text(el("p", { class: "enter-hint" }), "enter.music");
  const card = el(
    "div",
    { class: "enter-card" },
    title,
    second,
    lead,
    about,
    bar,
    state,
    trouble,
    actions,
    hint,
  );
  const element = el("section", { class: "enter", testid: "enter-screen" }, card);

  function render() {
    const { pick, count } = words;
    title.textContent = pick(current.title);
    second.textContent = pick(current.title, words.other);
    second.lang = words.other;
    lead.textContent = [pick(current.subtitle), count("count.exhibit", current.exhibits.length)]
      .filter(Boolean)
      .join(" · ");
    about.textContent = pick(current.about) || words.t("enter.about");
    setAttribute(hint, "hidden", !current.music);
    said.textContent = words.has(label) ? words.t(label) : label;
    bar.setAttribute("aria-label", words.t("enter.progress"));
    if (failure) renderFailure();
  }

  function renderFailure() {
    const key = `fail.${failure}`;
    const again = el("button", {
      type: "button",
      class: "button ghost",
      text: words.t("enter.retry"),
      testid: "retry",
    });
    again.addEventListener("click", () => location.reload());
    trouble.replaceChildren(
      el("strong", { text: words.t("fail.title") }),
      el("p", { text: words.has(key) ? words.t(key) : failure }),
      again,
    );
  }

  /** fraction 0…1; text: a key such as "rooms" (progress.rooms) or any wording. */
  function progress(fraction, text) {
    const whole = Math.round(100 * Math.max(0, Math.min(1, fraction)));
    fill.style.transform = `scaleX(${whole / 100})`;
    bar.setAttribute("aria-valuenow", whole);
    percent.textContent = `${whole} %`;
    if (text) label = words.has(`progress.${text}`) ? `progress.${text}` : text;
    said.textContent = words.has(label) ? words.t(label) : label;
  }

  function ready() {
    if (failure) fail(null);
    progress(1, "enter.ready");
    element.classList.add("is-ready");
    button.disabled = false;
    // Whoever is on the language switch or the catalogue link stays there.
    if (!element.contains(document.activeElement)) button.focus({ preventScroll: true });
  }

  /** reason: "load", "webgl", "full" or any wording; null takes the notice away. */
  function fail(reason) {
    failure = reason;
    trouble.hidden = reason === null;
    element.classList.toggle("is-failed", reason !== null);
    for (const part of [bar, state]) setAttribute(part, "hidden", reason !== null);
    if (reason !== null) {
      button.disabled = true;
      renderFailure();
    }
  }

  /** Fades out and leaves the document, so that no hidden button stays in the tab order. */
  function leave() {
    element.inert = true;
    element.classList.add("is-leaving");
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    setTimeout(() => element.remove(), still ? 0 : 700);
  }

  button.addEventListener("click", () => onEnter());
  words.follow(render);
  progress(0);
  const updateScene = (next) => {
    current = next;
    render();
  };
  return { element, actions, progress, ready, fail, leave, updateScene };
}
