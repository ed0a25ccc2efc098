// The close-up: the fine model in its own studio, turned by dragging, by wheel, by two fingers or by keys.

import * as camera from "./camera.js";
import { touched } from "./touched.js";
import { camera as lens, canvas, meshesOf, requestRender } from "../viser/viser_adapter.js";

const TURN = 0.12; // [rad] a key press
const STEP = 0.08; // of the exhibit's size, a key press
const YARNS = 0.1; // [m] from which yarns of cloth are told apart; the wheel goes on to
const NEAREST = 0.012; // [m]

export function createCloseup(ui) {
  let studio = null, drawnAt = null, fitted = 1, node = null, near = false;
  const root = document.documentElement;

  // The model comes over viser's socket: two frames after its meshes stand in the scene it has been drawn.
  function awaitModel(node, patience = performance.now() + 60000) {
    if (!studio || performance.now() > patience) return;
    if (meshesOf(node).length === 0) {
      requestAnimationFrame(() => awaitModel(node, patience));
      return;
    }
    requestRender();
    requestAnimationFrame(() => requestAnimationFrame((now) => {
      drawnAt = now;
      if (studio) root.dataset.closeup = "drawn";
    }));
  }

  // Far enough for the exhibit to fill what panel, bar and hints leave of the picture, with a margin.
  function fitting(radius) {
    const { panel, bottom, top } = ui.visible;
    const free = Math.min(innerWidth - panel, innerHeight - bottom - top) / innerHeight;
    return (1.02 * radius) / (Math.tan(camera.fieldOfView() / 2) * free);
  }

  /** The distance [m] that fits, and gestures that stay around it. */
  function reach() {
    fitted = fitting(studio.radius);
    camera.orbitGestures(studio.radius * 0.1, Math.max(studio.radius * 5, 1.5 * fitted));
    return fitted;
  }

  /** Come to a hand's breadth of what is seen at a place of the window [px]; back to the whole where nothing is. */
  function nearTo(x, y) {
    const eye = lens(), picture = canvas();
    if (!studio || !eye || !picture) return;
    const { left, top, width, height } = picture.getBoundingClientRect();
    const place = [(2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height];
    const point = touched(meshesOf(node), eye, place);
    if (!point) return whole();
    near = true;
    camera.orbitGestures(NEAREST, Math.max(studio.radius * 5, 1.5 * fitted));
    camera.comeNear(point, YARNS);
    root.dataset.closeupNear = "";
    requestRender();
  }

  function whole() {
    near = false;
    delete root.dataset.closeupNear;
    place();
    requestRender();
  }

  /** The middle of what panel, bar and hints leave of the window [px]. */
  function middle() {
    const { panel, bottom, top } = ui.visible;
    return [(innerWidth - panel) / 2, (innerHeight - bottom + top) / 2];
  }

  /** Another window, or a folded panel: the exhibit stays turned and as near as the visitor has it, in what is free now. */
  function reframe() {
    if (!studio) return;
    if (near) return camera.leaveRoom(ui.visible);
    const before = fitted;
    camera.zoom(reach() / before);
    camera.leaveRoom(ui.visible);
  }

  /** A step nearer (1) or farther (-1): of the exhibit's size, or, where cloth is looked at, of the distance. */
  const step = (way) => (near ? camera.zoom(1 - 2 * STEP * way) : camera.dolly(way * studio.radius * STEP));

  function place() {
    const { x, y, z, radius } = studio;
    camera.fitLens(true);
    const distance = reach();
    camera.lookAt([x + distance * 0.25, y + radius * 0.15, z + distance * 0.97], [x, y, z]);
    camera.leaveRoom(ui.visible);
  }

  addEventListener("keydown", (event) => {
    if (!studio || event.target.closest?.("input, textarea, [role=tablist], video, audio, dialog[open]")) return;
    const reading = event.target.closest?.("[role=tabpanel]") && ["ArrowUp", "ArrowDown"].includes(event.code);
    if (reading) return;
    const act = {
      ArrowLeft: () => camera.orbit(-TURN, 0), ArrowRight: () => camera.orbit(TURN, 0),
      ArrowUp: () => camera.orbit(0, -TURN), ArrowDown: () => camera.orbit(0, TURN),
      KeyA: () => camera.orbit(-TURN, 0), KeyD: () => camera.orbit(TURN, 0),
      KeyW: () => step(1), KeyS: () => step(-1), Equal: () => step(1), Minus: () => step(-1),
      KeyZ: () => nearTo(...middle()), Digit0: whole, Numpad0: whole,
    }[event.code];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    act();
  }, true);
  addEventListener("dblclick", (event) => {
    if (studio && event.target === canvas()) nearTo(event.clientX, event.clientY);
  });
  addEventListener("resize", reframe);
  ui.whenCovered(reframe);

  return {
    drawnAt: () => drawnAt,
    enter(message) {
      studio = message.studio;
      node = message.node;
      near = false;
      root.dataset.closeup = "loading";
      place();
      awaitModel(message.node);
    },
    leave() {
      studio = null;
      delete root.dataset.closeup;
      delete root.dataset.closeupNear;
      camera.freeDistances();
      camera.leaveRoom({ panel: 0, bottom: 0, top: 0 });
    },
  };
}
