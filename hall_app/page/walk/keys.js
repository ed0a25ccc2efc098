// Held keys: walking, turning, looking level. By physical position (event.code: AZERTY safe); typing in a field does neither.

import { ownsKeys } from "../ui/elements.js";

const FORWARD = new Set(["KeyW", "ArrowUp"]);
const BACK = new Set(["KeyS", "ArrowDown"]);
const LEFT = new Set(["KeyA", "ArrowLeft"]);
const RIGHT = new Set(["KeyD", "ArrowRight"]);
const WALK = new Set([...FORWARD, ...BACK, ...LEFT, ...RIGHT]);
// Q and E fly in viser's own client; a visitor turns the head. 1 is to the left.
const TURN = new Map([["KeyQ", 1], ["KeyE", -1]]);
const TURN_SHIFTED = new Map([["ArrowLeft", 1], ["ArrowRight", -1]]);
const LEVEL = "Home";

/**
 * Listens in the capture phase, before viser's own listeners. `active()` says whether keys mean anything at all,
 * `head` is turned by them; onPress() hears of every press, onRelease() when all are let go at once.
 */
export function createKeys({ active, head, onPress, onRelease }) {
  const held = new Set();
  let since = 0; // [ms] when the first of the held keys went down
  const any = (codes) => [...codes].some((code) => held.has(code));
  const ours = ({ code }) => WALK.has(code) || TURN.has(code) || (code === LEVEL && active());

  addEventListener("keydown", (event) => {
    const { code, ctrlKey, metaKey, altKey, shiftKey, timeStamp } = event;
    if (!ours(event) || ctrlKey || metaKey || altKey || ownsKeys(event.target)) return;
    event.stopImmediatePropagation();
    if (!active()) return;
    event.preventDefault();
    if (event.repeat) return;
    const turn = TURN.get(code) ?? (shiftKey ? TURN_SHIFTED.get(code) : undefined);
    if (code === LEVEL) head.level();
    else if (turn) head.press(code, turn, timeStamp / 1000);
    else {
      if (held.size === 0) since = timeStamp;
      held.add(code);
    }
    onPress();
  }, true);
  addEventListener("keyup", (event) => {
    const turned = head.lift(event.code, event.timeStamp / 1000);
    if (held.delete(event.code) || turned) event.stopImmediatePropagation();
  }, true);
  function release() {
    held.clear();
    head.release();
    onRelease();
  }
  addEventListener("blur", release);
  document.addEventListener("visibilitychange", release);
  document.addEventListener("focusin", (event) => { if (ownsKeys(event.target)) release(); });

  return {
    release,
    since: () => since,
    forward: () => Number(any(FORWARD)) - Number(any(BACK)),
    right: () => Number(any(RIGHT)) - Number(any(LEFT)),
  };
}
