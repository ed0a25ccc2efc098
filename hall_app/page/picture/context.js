// The picture's WebGL context. A driver that starts anew, a machine that sleeps or too many tabs take it away at any
// time; mostly the browser gives it back. three.js then builds everything again, but only when a picture is asked for.

import { framesDrawn, renderer, requestRender } from "../viser/viser_adapter.js";

const PATIENCE = 6000; // [ms] what has not come back by then mostly does not come back
const ASK_EVERY = 250; // [ms]
const ASK_ON = 1500; // [ms] after the first picture: environment and late textures ask for further ones

/** watchContext(tell): tell("lost"), then tell("drawn") once a picture is there again, or tell("gone") until it is. */
export function watchContext(tell) {
  let patience = 0, asking = 0;

  function lost() {
    stop();
    tell("lost");
    patience = setTimeout(tell, PATIENCE, "gone");
  }

  function stop() {
    clearTimeout(patience);
    clearInterval(asking);
  }

  function restored() {
    clearInterval(asking);
    let before = null, since = null;
    asking = setInterval(() => {
      const count = framesDrawn(), now = performance.now();
      if (since === null && before !== null && count !== before) {
        since = now;
        clearTimeout(patience);
        tell("drawn");
      }
      before = count;
      if (since !== null && now - since > ASK_ON) clearInterval(asking);
      requestRender();
    }, ASK_EVERY);
  }

  // The events do not bubble, but on their way down to whichever canvas viser has they pass here.
  const ours = (act) => (event) => event.target.closest?.("#root") && act();
  addEventListener("webglcontextlost", ours(lost), true);
  addEventListener("webglcontextrestored", ours(restored), true);
  if (renderer()?.getContext().isContextLost()) lost();
}
