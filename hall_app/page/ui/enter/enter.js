// The Enter screen over the live hall. The server writes it (door.html) and door.js leads it while the rest is fetched;
// here the overlay takes it over: same nodes, so nothing flickers, and whoever stands on a button stays there.

const HELD = { queue: "enter.queue", full: "enter.full", refused: "connection.refused" };

/** createEnter({words, scene, onEnter}) -> {element, actions, ready, wait, fail, leave, updateScene} */
export function createEnter({ words, scene, onEnter }) {
  const { door } = window.HALL;
  const element = document.querySelector(".enter");
  const find = (selector) => element.querySelector(selector);
  const both = (say) => ({ zh: say("zh"), en: say("en") });
  const button = find("[data-testid=enter]");
  const actions = find(".enter-actions");

  let stands = false; // the hall, and its picture

  takeOver();
  button.addEventListener("click", () => onEnter());
  words.follow(() => door.speak(words.lang));

  /** The overlay brings its own language switch; the focus goes with the nodes. */
  function takeOver() {
    const focused = element.contains(document.activeElement) ? document.activeElement : null;
    const wrapper = element.parentElement;
    find(".segments").remove();
    queueMicrotask(() => {
      wrapper.remove();
      const same = focused?.isConnected ? focused : focused && find(`[data-testid=${focused.dataset.testid}]`);
      same?.focus({ preventScroll: true });
    });
  }

  function updateScene(next) {
    const { pick } = words;
    door.pair(find(".enter-title"), both((lang) => pick(next.title, lang)));
    door.pair(find(".enter-second"), both((lang) => pick(next.title, lang === "zh" ? "en" : "zh")));
    const n = next.exhibits.length, count = `count.exhibit_${n === 1 ? "one" : "other"}`;
    const lead = (lang) => [pick(next.subtitle, lang), words.t(count, { n }, lang)].filter(Boolean).join(" · ");
    door.pair(find(".enter-lead"), both(lead));
    door.pair(find(".enter-about"), both((lang) => pick(next.about, lang) || words.t("enter.about", {}, lang)));
    find(".enter-hint").hidden = !next.music;
  }

  /** The state of the connection, as notices.js takes it: what keeps the visitor out is said here, calmly. */
  function wait(state, place) {
    const key = HELD[state];
    if (key && door.failed === "load") door.fail(null); // it does answer
    door.hold(key ? both((lang) => words.t(key, { place }, lang)) : null);
    button.disabled = !stands || Boolean(key);
    find("[data-testid=catalogue]").target = key ? "_blank" : ""; // to leave this page is to leave the queue
  }

  function ready() {
    stands = true;
    if (door.failed) door.fail(null);
    door.show(1, both((lang) => words.t("enter.ready", {}, lang)));
    door.open();
    element.classList.add("is-ready");
    button.disabled = false;
    // Whoever is on the language switch or the catalogue link stays there.
    if (!element.contains(document.activeElement)) button.focus({ preventScroll: true });
  }

  /** Fades out and leaves the document, so that no hidden button stays in the tab order. */
  function leave() {
    element.inert = true;
    element.classList.add("is-leaving");
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    setTimeout(() => element.remove(), still ? 0 : 700);
  }

  updateScene(scene);
  return { element, actions, ready, wait, fail: door.fail, leave, updateScene };
}
