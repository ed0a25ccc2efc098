// Held keys. Movement by physical position (event.code: AZERTY safe); typing in a field never walks.

const FORWARD = new Set(["KeyW", "ArrowUp"]);
const BACK = new Set(["KeyS", "ArrowDown"]);
const LEFT = new Set(["KeyA", "ArrowLeft"]);
const RIGHT = new Set(["KeyD", "ArrowRight"]);
// Q and E fly in viser's own client; a visitor walks.
const OURS = new Set([...FORWARD, ...BACK, ...LEFT, ...RIGHT, "KeyQ", "KeyE"]);

function typing(target) {
  return target instanceof Element
    && Boolean(target.closest("input, textarea, select, audio, video, [contenteditable], [role=tablist], dialog[open]"));
}

/** Listens in the capture phase, before viser's own listeners. `active()` says whether keys walk at all. */
export function createKeys(active, onPress) {
  const held = new Set();
  let since = 0; // [ms] when the first of the held keys went down
  const any = (codes) => [...codes].some((code) => held.has(code));

  addEventListener("keydown", (event) => {
    if (!OURS.has(event.code) || event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
    event.stopImmediatePropagation();
    if (!active()) return;
    event.preventDefault();
    if (event.repeat) return;
    if (held.size === 0) since = event.timeStamp;
    held.add(event.code);
    onPress?.(event.code);
  }, true);
  addEventListener("keyup", (event) => {
    if (held.delete(event.code)) event.stopImmediatePropagation();
  }, true);
  const release = () => held.clear();
  addEventListener("blur", release);
  document.addEventListener("visibilitychange", release);
  document.addEventListener("focusin", (event) => { if (typing(event.target)) release(); });

  return {
    release,
    since: () => since,
    forward: () => Number(any(FORWARD)) - Number(any(BACK)),
    right: () => Number(any(RIGHT)) - Number(any(LEFT)),
  };
}
