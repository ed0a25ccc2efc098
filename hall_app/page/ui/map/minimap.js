// The plan of the hall: walls, rooms, exhibits, the visitor's place and heading. SVG units are metres, up is -z.

import { el, setAttribute, svg } from "../elements.js";
import { icon } from "../icons.js";
import { bayAt, nearestExhibit, planBounds, spreadApart, standBefore } from "./geometry.js";

const REACH = 24; // [px] how far from a dot a tap still means that dot: targets of 48 px that share crowded ground
const NARROWEST = 200; // [px] that the open plan is drawn on, on any screen
const APART = 26; // [px] between two dots on it: a finger needs 24
const BAY_EVERY = 200; // [ms] between two looks at which room the visitor is in

const points = (polygon) => polygon.map((corner) => corner.join(",")).join(" ");

function drawPlan(scene, bounds) {
  const solids = scene.solids.map((solid) =>
    solid.round
      ? svg("circle", {
          class: `solid ${solid.kind}`,
          cx: solid.round[0],
          cy: solid.round[1],
          r: solid.round[2],
        })
      : svg("polygon", { class: `solid ${solid.kind}`, points: points(solid.polygon) }),
  );
  const bays = scene.bays.map((bay) => svg("polygon", { class: "bay", points: points(bay.polygon) }));
  const arrow = svg(
    "g",
    { class: "visitor", testid: "minimap-arrow" },
    svg("path", { class: "sight", d: "M0 0 -1.9 -3.6 A4.1 4.1 0 0 1 1.9 -3.6Z" }),
    svg("path", { class: "body", d: "M0 -.95 .68 .72 0 .36 -.68 .72Z" }),
  );
  const drawing = svg(
    "svg",
    {
      class: "plan-drawing",
      viewBox: `${bounds.x} ${bounds.z} ${bounds.width} ${bounds.depth}`,
      "aria-hidden": "true",
    },
    svg("polygon", { class: "floor", points: points(scene.outline) }),
    ...bays,
    ...solids,
    svg("polygon", { class: "outline", points: points(scene.outline) }),
    arrow,
  );
  return { drawing, arrow, bays };
}

/** createMinimap({words, scene, goTo, onBay}) -> {element, pose, mark, updateScene}; goTo(x, z, yaw | undefined) */
export function createMinimap({ words, scene, goTo, onBay }) {
  let current = scene;
  let bounds = null;
  let drawn = null;
  let dots = new Map();
  let places = []; // of the dots
  let bay;
  let lookedAt = 0;
  let later = 0;
  let shown = "";
  const plan = el("div", { class: "plan", testid: "minimap-plan" });
  const tip = el("p", { class: "plan-tip", hidden: true });
  const place = el("span", { class: "map-place", testid: "minimap-place" });
  const toggle = el(
    "button",
    { type: "button", class: "map-toggle", testid: "minimap-toggle" },
    icon("map"),
    place,
    icon("fold"),
  );
  const element = el("section", { class: "map glass", testid: "minimap" }, tip, plan, toggle);

  function build() {
    bounds = planBounds(current.outline);
    drawn = drawPlan(current, bounds);
    plan.style.setProperty("--plan-ratio", bounds.width / bounds.depth);
    places = spreadApart(current.exhibits, (APART * bounds.width) / NARROWEST);
    dots = new Map(current.exhibits.map((exhibit, at) => [exhibit.id, dot(exhibit, places[at])]));
    plan.replaceChildren(drawn.drawing, ...dots.values());
    bay = undefined;
    shown = "";
  }

  function dot(exhibit, place) {
    const button = el("button", { type: "button", class: "dot", testid: `dot-${exhibit.id}` });
    button.style.left = `${(100 * (place.x - bounds.x)) / bounds.width}%`;
    button.style.top = `${(100 * (place.z - bounds.z)) / bounds.depth}%`;
    button.addEventListener("focus", () => showTip(exhibit));
    button.addEventListener("blur", () => showTip(null));
    return button;
  }

  function translate() {
    element.setAttribute("aria-label", words.t("map.label"));
    for (const exhibit of current.exhibits) {
      dots
        .get(exhibit.id)
        .setAttribute("aria-label", words.t("map.go", { title: words.pick(exhibit.title) }));
    }
    name();
    labelToggle();
  }

  function name() {
    place.textContent = bay ? words.pick(bay.name) : words.t("map.nowhere");
  }

  function labelToggle() {
    const open = !element.classList.contains("is-folded");
    toggle.setAttribute("aria-expanded", String(open));
    toggle.setAttribute("aria-label", `${words.t(open ? "map.hide" : "map.show")} · ${place.textContent}`);
  }

  function fold(folded) {
    element.classList.toggle("is-folded", folded);
    labelToggle();
  }

  function showTip(exhibit) {
    setAttribute(tip, "hidden", exhibit === null);
    if (exhibit) tip.textContent = words.pick(exhibit.title);
    for (const [id, button] of dots) button.classList.toggle("is-aimed", id === exhibit?.id);
  }

  /** Plan coordinates [m] under a pointer event, and the exhibit close enough to be meant. */
  function aim(event) {
    const box = plan.getBoundingClientRect();
    const metres = bounds.width / box.width;
    const point = [
      bounds.x + (event.clientX - box.left) * metres,
      bounds.z + (event.clientY - box.top) * metres,
    ];
    const meant = nearestExhibit(point, places, REACH * metres);
    return { point, exhibit: meant && current.exhibits.find(({ id }) => id === meant.id) };
  }

  function choose(event) {
    // A click by keyboard has no place of its own: it means the dot that holds the focus.
    const focused = event.detail === 0 && current.exhibits.find(({ id }) => dots.get(id) === event.target);
    const { point, exhibit } = focused ? { point: null, exhibit: focused } : aim(event);
    if (exhibit) {
      const stand = standBefore(exhibit, current);
      goTo(stand.x, stand.z, stand.yaw, stand.pitch);
    } else {
      goTo(point[0], point[1]);
    }
  }

  /** Names the room at most every BAY_EVERY, and once more after the last step. */
  function lookAround(x, z) {
    clearTimeout(later);
    const wait = bay === undefined ? 0 : lookedAt + BAY_EVERY - performance.now();
    if (wait > 0) {
      later = setTimeout(() => lookAround(x, z), wait);
      return;
    }
    lookedAt = performance.now();
    const next = bayAt([x, z], current.bays);
    if (next === bay) return;
    bay = next;
    drawn.bays.forEach((shape, i) => shape.classList.toggle("is-here", current.bays[i] === bay));
    name();
    labelToggle();
    onBay(bay);
  }

  /** The visitor's pose; called every frame, touches the page only when something moved. */
  function pose({ x, z, yaw }) {
    const next = `translate(${x.toFixed(2)} ${z.toFixed(2)}) rotate(${((-yaw * 180) / Math.PI).toFixed(0)})`;
    if (next === shown) return;
    shown = next;
    drawn.arrow.setAttribute("transform", next);
    lookAround(x, z);
  }

  plan.addEventListener("click", choose);
  plan.addEventListener(
    "pointermove",
    (event) => event.pointerType === "mouse" && showTip(aim(event).exhibit),
  );
  plan.addEventListener("pointerleave", () => showTip(null));
  toggle.addEventListener("click", () => fold(!element.classList.contains("is-folded")));
  words.label(plan, "map.help");
  plan.setAttribute("role", "group");
  build();
  words.follow(translate);
  const cramped = matchMedia("(max-width: 720px), (max-height: 420px)");
  cramped.addEventListener("change", () => fold(cramped.matches));
  fold(cramped.matches);
  pose({ ...scene.start, yaw: scene.start?.yaw ?? 0 });
  return {
    element,
    pose,
    fold,
    /** Rings the exhibit the visitor is near, or none. */
    mark: (id) => dots.forEach((button, key) => button.classList.toggle("is-near", key === id)),
    updateScene(next) {
      const standing = shown;
      current = next;
      build();
      translate();
      drawn.arrow.setAttribute("transform", standing);
    },
  };
}
