// Plays a clip on the meshes of a model: writes their vertices in place, whole frames, as they were simulated and checked.
// What nobody sees costs nothing; between two frames nothing is asked for.

import { drawBehind } from "../../picture/behind.js";
import { meshesOf, requestRender } from "../../viser/viser_adapter.js";
import { creased } from "./creases.js";
import { normalsOf } from "./normals.js";
import { createSkin } from "./skin.js";

const AROUND = 0.15; // [m] more than the sampled frames of a figure reach
const SAMPLES = 16; // frames of a figure that tell how far it reaches
const BEHIND = 0.008; // [m] that a figure is drawn behind its place: by what thinned cloth may err as it moves

/** A node's name as three.js' loader writes it. */
const loaded = (name) => name.replace(/\s/g, "_").replace(/[[\].:/]/g, "");

/** Whether the loader has numbered a mesh, since the scene or another node has its name, too. */
const renamed = (mesh, name) => mesh.name.startsWith(`${name}_`) && /^\d+$/.test(mesh.name.slice(name.length + 1));

/** The frame at a time [s]: round and round, or, of a clip that is no loop, to its end and from the begin again. */
export const frameAt = ({ frames, period, rate }, seconds) =>
  Math.min(frames - 1, Math.floor((((seconds % period) + period) % period) * rate + 1e-6));

/** A mesh of the clip: its vertices and their directions in a frame; along creases of the model each side has its own. */
function createSurface(mesh, place) {
  const positions = new Float32Array(3 * mesh.count);
  let normals = new Float32Array(3 * mesh.count), corners = positions, creases = null;
  return {
    drawn: mesh.drawn.map(({ node, index }) => ({ name: loaded(node), index })),
    positions,
    normals: () => normals,
    place: (frame) => place(frame, positions),
    /** parts: what it is drawn by, as the model came; gives which direction each vertex of each of them takes. */
    creaseAs(parts) {
      creases = creased(parts, mesh.count);
      const size = 3 * (mesh.count + (creases?.from.length ?? 0));
      normals = new Float32Array(size);
      corners = creases ? new Float32Array(size) : positions;
      return creases?.ids ?? parts.map(({ index }) => index);
    },
    shade() {
      if (creases) {
        corners.set(positions);
        creases.from.forEach((vertex, k) => corners.copyWithin(3 * (mesh.count + k), 3 * vertex, 3 * vertex + 3));
      }
      normalsOf(corners, creases?.faces ?? mesh.faces, normals);
    },
  };
}

function byVertices({ steps, vertices, origin, step }, { begin, count }) {
  return (frame, out) => {
    const from = 3 * (frame * vertices + begin), [x, y, z] = origin;
    for (let k = 0; k < 3 * count; k += 3) {
      out[k] = x + step * steps[from + k];
      out[k + 1] = y + step * steps[from + k + 1];
      out[k + 2] = z + step * steps[from + k + 2];
    }
  };
}

/** {centre, radius} of a ball round a surface in these frames. */
function ball(surface, frames, more) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const frame of frames) {
    surface.place(frame);
    surface.positions.forEach((value, k) => {
      low[k % 3] = Math.min(low[k % 3], value);
      high[k % 3] = Math.max(high[k % 3], value);
    });
  }
  const centre = low.map((value, axis) => (value + high[axis]) / 2);
  return { centre, radius: Math.hypot(...high.map((value, axis) => value - centre[axis])) + more };
}

/** Write a surface into the vertices of a drawn mesh; index, shades: the vertex, and the direction, each of them takes. */
function write(surface, { index, shades }, { geometry }) {
  const positions = surface.positions, normals = surface.normals();
  const place = geometry.attributes.position, normal = geometry.attributes.normal;
  const to = place.array, lit = normal?.array;
  for (let p = 0; p < index.length; p++) {
    const from = 3 * index[p], at = 3 * p;
    to[at] = positions[from]; to[at + 1] = positions[from + 1]; to[at + 2] = positions[from + 2];
    if (!lit) continue;
    const shade = 3 * shades[p];
    lit[at] = normals[shade]; lit[at + 1] = normals[shade + 1]; lit[at + 2] = normals[shade + 2];
  }
  place.needsUpdate = true;
  if (normal) normal.needsUpdate = true;
}

/**
 * createPlayback(clip, node) -> {frame(seconds, seen), bound(), shown()}; node: the scene's node of the model; clip: of readClip.
 *
 * frame() is called ahead of every picture, seconds: of the hall's clock, seen: whether a visitor can see it. viser makes
 * new meshes whenever a model changes or its socket connects again: they are found anew. Returns whether it wrote a frame.
 */
export function createPlayback(clip, node) {
  const surfaces = clip.meshes.map((mesh) => createSurface(mesh, byVertices(clip, mesh)));
  const figure = clip.figure && createSurface(clip.figure, createSkin(clip.figure, clip.poses));
  if (figure) surfaces.push(figure);
  const every = Math.max(1, Math.floor(clip.frames / SAMPLES));
  const sampled = Array.from({ length: Math.ceil(clip.frames / every) }, (_, k) => k * every);
  const balls = surfaces.map((surface) => ball(surface, sampled, AROUND));
  let bound = []; // [{mesh, surface, index}]
  let shown = null;

  /** True where the meshes are others than those that were written last. */
  function bind() {
    const meshes = meshesOf(node), found = [];
    surfaces.forEach((surface, number) => {
      for (const { name, index } of surface.drawn) {
        const fits = (one) => one.geometry.attributes.position.count === index.length;
        const mesh = meshes.find((one) => one.name === name && fits(one)) ?? meshes.find((one) => renamed(one, name) && fits(one));
        if (mesh) found.push({ mesh, geometry: mesh.geometry, surface, index, ball: balls[number] });
      }
    });
    const same = found.length === bound.length && found.every((one, k) => one.geometry === bound[k].geometry);
    if (same) return false;
    bound = found;
    for (const surface of new Set(bound.map((one) => one.surface))) {
      const parts = bound.filter((one) => one.surface === surface);
      surface.creaseAs(parts).forEach((shades, k) => (parts[k].shades = shades));
    }
    for (const { mesh, surface, geometry, ball: { centre, radius } } of bound) {
      if (surface === figure) drawBehind(mesh.material, BEHIND);
      if (!geometry.boundingSphere) geometry.computeBoundingSphere();
      geometry.boundingSphere.center.set(...centre);
      geometry.boundingSphere.radius = radius;
      geometry.boundingBox = null; // it would hide from the pointer what left it
    }
    return true;
  }

  return {
    frame(seconds, seen) {
      if (!seen || document.hidden) return false;
      const now = frameAt(clip, seconds);
      if (!bind() && now === shown) return false;
      shown = now;
      for (const surface of new Set(bound.map((one) => one.surface))) {
        surface.place(now);
        surface.shade();
      }
      for (const one of bound) write(one.surface, one, one.mesh);
      if (bound.length) requestRender();
      return bound.length > 0;
    },
    bound: () => bound.length,
    /** The frame that is in the meshes, null where there are none. */
    shown: () => (bound.length ? shown : null),
  };
}
