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
  // viser asks for four samples a pixel. A software renderer pays for each of them, nearly half of a picture: whoever has
  // not chosen a finer picture gets smoother walking instead of smoother edges. Samples are a context's for good.
  const software = /swiftshader|llvmpipe|softpipe|software|basic render/i;
  const take = HTMLCanvasElement.prototype.getContext;
  let slow;
  function softwareDraws() {
    if (slow === undefined) {
      const probe = take.call(document.createElement("canvas"), "webgl2");
      const names = probe?.getExtension("WEBGL_debug_renderer_info");
      slow = Boolean(names) && software.test(String(probe.getParameter(names.UNMASKED_RENDERER_WEBGL)));
      probe?.getExtension("WEBGL_lose_context")?.loseContext();
    }
    return slow;
  }
  window.HALL.softwareDraws = softwareDraws;
  HTMLCanvasElement.prototype.getContext = function getContext(kind, wishes, ...rest) {
    if (!wishes?.antialias) return take.call(this, kind, wishes, ...rest);
    const { recall } = window.HALL.memory, chosen = recall("hall.quality") ?? "auto"; // as picture/quality.js keeps it
    const level = chosen === "auto" ? recall("hall.quality.found") ?? "low" : chosen;
    const antialias = level !== "low" || !softwareDraws();
    return take.call(this, kind, { ...wishes, antialias }, ...rest);
  };
}
