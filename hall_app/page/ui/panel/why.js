// Why an exhibit moves as it does: its wearer's feature points over the close-up, M and Delta along the motion.

import { createChart, decades, fromZero, summarised } from "./chart.js";
import { el, setAttribute } from "../elements.js";

const MM = 1e3; // of a metre
const KINDS = ["torso", "limbs", "cloth"];

/** What a motion is told by, a row each: M and Delta [mm]. */
function figuresOf({ m, delta, limbs }) {
  return { m: summarised(m, limbs.length), delta: summarised(delta.map((one) => one * MM), limbs.length) };
}

/** The rows of a clip's frames alone. */
const moving = ({ middle, most }, { begin }) => ({ middle: middle.slice(begin), most: most.slice(begin) });

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
  let url = null, entered = false, loaded = null, figures = null, now = { data: null, row: 0, failed: false };

  input.addEventListener("change", () => points.draw(input.checked));
  clock.watch((on) => setAttribute(stopped, "hidden", !on));

  function load() {
    const { data } = now;
    figures = figuresOf(data);
    const m = moving(figures.m, data), delta = moving(figures.delta, data);
    charts.m.load(m, decades([data.m0 / 2, ...m.middle, ...m.most]), data.m0);
    charts.delta.load(delta, fromZero(delta.most));
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
      const { middle, most } = moving(figures[kind], data), value = (one) => one.toFixed(digits);
      const spread = { low: value(Math.min(...middle)), high: value(Math.max(...middle)), most: value(Math.max(...most)) };
      charts[kind].name(words.t(`why.${kind}`));
      charts[kind].label(words.t(`why.${kind}_label`, { ...spread, m0: data.m0 }));
    }
  }

  /** What the model shows at this moment. */
  function point() {
    const { data, row } = now, frame = row - data.begin;
    for (const [kind, digits] of [["m", 2], ["delta", 1]]) {
      const { middle, most } = figures[kind];
      charts[kind].at(frame);
      charts[kind].values(words.t(`why.${kind}_now`, { middle: middle[row].toFixed(digits), most: most[row].toFixed(digits) }));
    }
    const seconds = { at: (frame / data.rate).toFixed(2), whole: (data.frames / data.rate).toFixed(2) };
    moment.textContent = words.t(frame < 0 ? "why.standing" : "why.moment", { ...seconds, frame: frame + 1, frames: data.frames });
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
