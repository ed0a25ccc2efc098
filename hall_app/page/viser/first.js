// Runs before viser's script, so that a frame's first callback runs ours ahead of its renderer: what the page sets is
// drawn in the same frame and not in the next one, which costs a software renderer a tenth of a second.
{
  const request = window.requestAnimationFrame.bind(window);
  let latest = -1;
  window.requestAnimationFrame = (callback) => request((now) => {
    if (now !== latest) { latest = now; window.HALL.beforeFrame?.(now); }
    callback(now);
  });
  // viser draws a picture every second whether or not something moved; the page says when that may be left out.
  const repeat = window.setInterval.bind(window);
  const heartbeat = (act, every) => every === 1000 && /^\(\)=>\w+\(\)$/.test(String(act).replace(/\s/g, ""));
  window.setInterval = (act, every, ...rest) =>
    repeat(heartbeat(act, every) ? () => { if (!window.HALL.mayRest?.()) act(); } : act, every, ...rest);
  // viser makes a sorter for Gaussian splats at once. It wants eval, which our policy forbids; the hall has no splats.
  const ask = window.fetch.bind(window);
  window.fetch = (what, ...rest) =>
    String(what).startsWith("data:application/wasm") ? new Promise(() => {}) : ask(what, ...rest);
  // Where viser's script finds its decoder; door.js fetches it.
  window.HALL.giveDecoder = (module) => { globalThis.__viserZstdWasm = module; };
}
