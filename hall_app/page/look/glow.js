// Exhibits light up: a swell when a visitor comes near, so that it is seen which one is meant, then hardly anything, since
// whoever stands before silk wants to see its folds; a little more under the pointer.

import { meshesOf, requestRender } from "../viser/viser_adapter.js";

const STEADY = 0.05, UNDER_POINTER = 0.14, SWELL = 0.3; // strength, in the exhibit's own colours
const RISE = 350, FALL = 1300; // [ms]

/** createGlow({wake, onHover}) -> {near(node, on), frame(now, nodes)}; onHover(node | null). */
export function createGlow({ wake, onHover }) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const since = new Map(); // node -> when its visitor came near
  const shown = new Map(); // node -> strength on display
  let hovered = null;

  function strength(node, now) {
    const rest = node === hovered ? UNDER_POINTER : since.has(node) ? STEADY : 0;
    const age = now - (since.get(node) ?? -Infinity);
    if (calm.matches || age > RISE + FALL) return rest;
    wake(100);
    requestRender();
    const swell = age < RISE ? age / RISE : 1 - (age - RISE) / FALL;
    return rest + (SWELL - rest) * Math.max(0, swell) ** 2;
  }

  function lightUp(node, value) {
    for (const mesh of meshesOf(node)) {
      for (const material of [mesh.material].flat()) {
        if (!material.emissive) continue;
        const still = (material.userData.still ??= { hex: material.emissive.getHex(), strength: material.emissiveIntensity });
        // In its own colours, so that dark lacquer stays lacquer.
        if (value && material.map && !material.emissiveMap) {
          material.emissiveMap = material.map;
          material.needsUpdate = true;
        }
        material.emissive.setHex(value ? material.color.getHex() : still.hex);
        material.emissiveIntensity = value || still.strength;
      }
    }
  }

  // viser marks what is under the pointer with a yellow outline: ours is the glow.
  function underPointer(nodes) {
    let found = null;
    for (const node of nodes) {
      for (const mesh of meshesOf(node)) {
        if (mesh.material.uniforms?.thickness === undefined) continue;
        mesh.material.visible = false;
        if (mesh.parent.visible) found = node;
      }
    }
    return found;
  }

  return {
    near(node, on) {
      if (on) since.set(node, performance.now());
      else since.delete(node);
      wake();
      requestRender();
    },
    /** Ahead of every picture; nodes: names of the exhibits' nodes. */
    frame(now, nodes) {
      const under = underPointer(nodes);
      if (under !== hovered) {
        hovered = under;
        requestRender();
        onHover(hovered);
      }
      for (const node of nodes) {
        const value = strength(node, now);
        if (value === (shown.get(node) ?? 0) && value === 0) continue;
        shown.set(node, value);
        lightUp(node, value);
      }
    },
  };
}
