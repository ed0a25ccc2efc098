// A small chart over a motion: the median and the largest of several values a frame, a limit, and where it stands now.

import { el, setAttribute, svg } from "../elements.js";

const WIDTH = 300, HEIGHT = 100; // of the drawing, which is stretched to its box

/** Median and largest of `wide` values a frame: {middle, most}, a number a frame each. */
export function summarised(values, wide) {
  const frames = Math.floor(values.length / wide), middle = [], most = [];
  for (let k = 0; k < frames; k++) {
    const sorted = Array.from(values.subarray(k * wide, (k + 1) * wide)).sort((a, b) => a - b);
    middle.push((sorted[(wide - 1) >> 1] + sorted[wide >> 1]) / 2);
    most.push(sorted[wide - 1]);
  }
  return { middle, most };
}

/** A scale by powers of ten that holds all of these, and a tick at each: {share(value) from the bottom, ticks}. */
export function decades(values) {
  const low = Math.floor(Math.log10(Math.max(1e-6, Math.min(...values)))), high = Math.ceil(Math.log10(Math.max(...values, 1e-6)));
  const whole = Math.max(1, high - low);
  const share = (value) => Math.min(1, Math.max(0, (Math.log10(Math.max(value, 1e-9)) - low) / whole));
  return { share, ticks: Array.from({ length: whole + 1 }, (_, k) => Number((10 ** (low + k)).toPrecision(1))) };
}

/** The same from zero, to a round number. */
export function fromZero(values) {
  const most = Math.max(...values, 1e-9), power = 10 ** Math.floor(Math.log10(most));
  const high = [1, 2, 4, 6, 10].map((k) => k * power).find((one) => one >= most);
  return { share: (value) => value / high, ticks: [0, high / 2, high] };
}

/**
 * createChart(name) -> {element, head, load({middle, most}, scale, limit), at(frame), label(text), values(text)}
 *
 * limit: a value that a line is drawn at, or null; label: what who does not see it hears.
 */
export function createChart(testid) {
  const name = el("span", { class: "chart-name" }), values = el("span", { class: "chart-values" });
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img" });
  const marks = el("div", { class: "chart-marks", "aria-hidden": "true" });
  const cursor = el("div", { class: "chart-cursor" });
  const box = el("div", { class: "chart-box" }, drawing, cursor);
  const element = el("figure", { class: "chart", testid }, el("figcaption", {}, name, values), el("div", { class: "chart-plot" }, marks, box));
  let frames = 1;

  const x = (frame) => ((frame + 0.5) / frames) * WIDTH;

  function load({ middle, most }, { share, ticks }, limit = null) {
    frames = middle.length;
    const y = (value) => HEIGHT * (1 - share(value));
    const line = (series) => series.map((value, k) => `${x(k).toFixed(1)} ${y(value).toFixed(1)}`);
    const path = (kind, d) => svg("path", { class: kind, d });
    drawing.replaceChildren(
      ...ticks.map((tick) => path("chart-tick", `M0 ${y(tick)}H${WIDTH}`)),
      path("chart-band", `M${[...line(most), ...line(middle).reverse()].join("L")}Z`),
      ...(limit === null ? [] : [path("chart-limit", `M0 ${y(limit)}H${WIDTH}`)]),
      path("chart-most", `M${line(most).join("L")}`),
      path("chart-middle", `M${line(middle).join("L")}`),
    );
    marks.replaceChildren(
      ...ticks.map((tick) => {
        const mark = el("span", { text: String(tick) });
        mark.style.top = `${100 * (1 - share(tick))}%`;
        return mark;
      }),
    );
  }

  return {
    element,
    load,
    /** Below 0: nowhere along it. */
    at(frame) {
      setAttribute(cursor, "hidden", frame < 0);
      cursor.style.left = `${(100 * x(frame)) / WIDTH}%`;
    },
    label: (text) => drawing.setAttribute("aria-label", text),
    name: (text) => (name.textContent = text),
    values: (text) => (values.textContent = text),
  };
}
