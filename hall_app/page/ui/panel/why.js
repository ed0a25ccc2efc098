// Why an exhibit moves as it does: its wearer's feature points over the close-up, M and Delta along the motion.

import { createChart, decades, fromZero, summarised } from "./chart.js";
import { el, setAttribute } from "../elements.js";

const MM = 1e3; // of a metre
const KINDS = ["torso", "limbs", "cloth"];

/** The figures a motion is told by: M and Delta [mm] a frame, and their extremes. */
function figuresOf({ m, delta, limbs }) {
  const own = summarised(m, limbs.length), away = summarised(delta.map((one) => one * MM), limbs.length);
  return { m: own, delta: away };
}

/** A page of the panel; points: of createPoints, clock: of what moves. */
export function createWhyPage(words, { points, clock }) {
  const text = el("p", { class: "why-text" });
  const input = el("input", { type: "checkbox", role: "switch", checked: true, testid: "why-switch" });
  const toggle = el("label", { class: "why-switch" }, input, words.text(el("span"), "why.show"));
  const counts = Object.fromEntries(KINDS.map((kind) => [kind, el("li", { class: `why-${kind}` })]));
  const legend = el("ul", { class: "why-legend" }, ...Object.values(counts));
  const charts = { m: createChart("why-m"), delta: createChart("why-delta") };
  const moment = el("p", { class: "why-moment", testid: "why-moment" });
  const stopped = words.text(el("p", { class: "why-note", testid: "why-stopped" }), "why.stopped");
  const title = words.text(el("h3"), "why.title");
  const told = [toggle, legend, charts.m.element, charts.delta.element, moment, stopped, title, text];
  const body = el("div", { class: "why-body", hidden: true }, ...told);
  const state = el("p", { class: "quiet", role: "status" });
  const element = el("div", { class: "why", testid: "why" }, state, body);
  let url = null, entered = false, loaded = null, figures = null, now = { data: null, frame: 0, failed: false };

  input.addEventListener("change", () => points.draw(input.checked));
  clock.watch((on) => setAttribute(stopped, "hidden", !on));

  function load() {
    const { data } = now;
    figures = figuresOf(data);
    charts.m.load(figures.m, decades([data.m0 / 2, ...figures.m.middle, ...figures.m.most]), data.m0);
    charts.delta.load(figures.delta, fromZero(figures.delta.most));
    loaded = data;
  }

  /** All that is written of a motion, in the present language. */
  function write() {
    const { data } = now;
    text.textContent = words.t("why.text", { noise: (data.noise * MM).toFixed(0), m0: data.m0, rounds: data.rounds });
    const trunk = data.torso.size;
    const n = { torso: trunk, limbs: data.count - trunk, cloth: data.worn.length };
    for (const kind of KINDS) counts[kind].textContent = words.t(`why.${kind}`, { n: n[kind] });
    for (const [kind, digits] of [["m", 2], ["delta", 1]]) {
      const { middle, most } = figures[kind], value = (one) => one.toFixed(digits);
      const spread = { low: value(Math.min(...middle)), high: value(Math.max(...middle)), most: value(Math.max(...most)) };
      charts[kind].name(words.t(`why.${kind}`));
      charts[kind].label(words.t(`why.${kind}_label`, { ...spread, m0: data.m0 }));
    }
  }

  /** What the model shows at this moment. */
  function point() {
    const { data, frame } = now;
    for (const [kind, digits] of [["m", 2], ["delta", 1]]) {
      const { middle, most } = figures[kind];
      charts[kind].at(frame);
      charts[kind].values(words.t(`why.${kind}_now`, { middle: middle[frame].toFixed(digits), most: most[frame].toFixed(digits) }));
    }
    const seconds = { at: (frame / data.rate).toFixed(2), whole: (data.frames / data.rate).toFixed(2) };
    moment.textContent = words.t("why.moment", { ...seconds, frame: frame + 1, frames: data.frames });
  }

  function show(next, whole = true) {
    now = next;
    setAttribute(body, "hidden", !now.data);
    setAttribute(state, "hidden", Boolean(now.data));
    state.textContent = words.t(now.failed ? "why.failed" : "why.loading");
    if (!now.data) return;
    const other = now.data !== loaded;
    if (other) load();
    if (other || whole) write();
    point();
  }

  points.follow((next) => show(next, false));
  words.follow(() => show(now));
  return {
    element,
    filled: () => url !== null,
    render(detail) {
      const next = detail.points ?? null;
      if (next === url) return;
      url = next;
      if (!entered) return;
      if (url) points.show(url);
      else leave();
    },
    enter() {
      entered = true;
      points.draw(input.checked);
      points.show(url);
    },
    leave,
    silence() {},
  };

  function leave() {
    entered = false;
    points.hide();
  }
}
