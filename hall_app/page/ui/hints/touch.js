// A virtual stick for thumbs. It appears with the first touch or on devices without a fine pointer.

import { el } from "../elements.js";

const REACH = 44; // [px] from the middle to full speed
const DEAD = 0.15; // a resting thumb does not creep

/** createStick({words, move}) -> element; move(forward, right), each -1..1, (0, 0) on release. */
export function createStick({ words, move }) {
  const knob = el("span", { class: "stick-knob" });
  const element = el("div", { class: "stick", testid: "stick", role: "img" }, knob);
  words.follow(() =>
    element.setAttribute("aria-label", `${words.t("hints.stick")} · ${words.t("hints.walk")}`),
  );
  let held = null;

  function steer(event) {
    const box = element.getBoundingClientRect();
    const x = (event.clientX - box.left - box.width / 2) / REACH;
    const y = (event.clientY - box.top - box.height / 2) / REACH;
    const length = Math.hypot(x, y);
    const scale = length < DEAD ? 0 : 1 / Math.max(1, length);
    knob.style.transform = `translate(${x * scale * REACH}px, ${y * scale * REACH}px)`;
    move(-y * scale, x * scale);
  }

  function release(event) {
    if (event && event.pointerId !== held) return;
    held = null;
    element.classList.remove("is-held");
    knob.style.transform = "";
    move(0, 0);
  }

  element.addEventListener("pointerdown", (event) => {
    if (held !== null) return;
    held = event.pointerId;
    element.setPointerCapture(held);
    element.classList.add("is-held");
    event.preventDefault();
    steer(event);
  });
  element.addEventListener("pointermove", (event) => event.pointerId === held && steer(event));
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    element.addEventListener(end, release);
  addEventListener("blur", () => held !== null && release());
  return element;
}

/** Marks the overlay as touched, once: style and wording follow. */
export function noticeTouch(onTouch) {
  if (matchMedia("(hover: none) and (pointer: coarse)").matches) return onTouch();
  const listener = (event) => {
    if (event.pointerType !== "touch") return;
    removeEventListener("pointerdown", listener, true);
    onTouch();
  };
  addEventListener("pointerdown", listener, true);
}
