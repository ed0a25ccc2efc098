// Plane geometry of the floor plan. Points are [x, z] in metres; the plan's up is -z, its right +x. No DOM here.

/** Smallest box around the outline, widened by `margin` [m]: {x, z, width, depth}. */
export function planBounds(outline, margin = 0.4) {
  const xs = outline.map(([x]) => x);
  const zs = outline.map(([, z]) => z);
  const x = Math.min(...xs) - margin;
  const z = Math.min(...zs) - margin;
  return { x, z, width: Math.max(...xs) + margin - x, depth: Math.max(...zs) + margin - z };
}

/** Even-odd rule: whether [x, z] lies inside the polygon. */
export function insidePolygon([x, z], polygon) {
  let inside = false;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [xi, zi] = polygon[i];
    const [xj, zj] = polygon[j];
    if (zi > z !== zj > z && x < ((xj - xi) * (z - zi)) / (zj - zi) + xi) inside = !inside;
  }
  return inside;
}

function segmentDistance([x, z], [ax, az], [bx, bz]) {
  const [dx, dz] = [bx - ax, bz - az];
  const along = ((x - ax) * dx + (z - az) * dz) / (dx * dx + dz * dz || 1);
  const t = Math.max(0, Math.min(1, along));
  return Math.hypot(x - ax - t * dx, z - az - t * dz);
}

/** Distance [m] from a point to a solid of the plan (polygon or round), 0 inside it. */
export function solidDistance(point, solid) {
  if (solid.round) {
    const [x, z, radius] = solid.round;
    return Math.max(0, Math.hypot(point[0] - x, point[1] - z) - radius);
  }
  const { polygon } = solid;
  if (insidePolygon(point, polygon)) return 0;
  return Math.min(
    ...polygon.map((corner, i) => segmentDistance(point, corner, polygon[(i + 1) % polygon.length])),
  );
}

const BEST = 2.4; // [m] a whole garment is in the picture
const NEAREST = 1.6;
const FARTHEST = 4;
const DOWN = -0.12; // [rad] towards its middle

/**
 * Where a visitor stands to see an exhibit whole: in front of it, as near to the best distance as the solids leave
 * `room` [m]. Returns {x, z, yaw, pitch}; the yaw looks at the exhibit (facing is degrees about +y, 0 = +z).
 */
export function standBefore(exhibit, { outline, solids }, room = 0.5) {
  const yaw = ((exhibit.facing ?? 0) * Math.PI) / 180;
  const at = (distance) => [exhibit.x + distance * Math.sin(yaw), exhibit.z + distance * Math.cos(yaw)];
  const free = (point) =>
    insidePolygon(point, outline) && solids.every((solid) => solidDistance(point, solid) >= room);
  const distances = [];
  for (let distance = BEST; distance >= NEAREST; distance -= 0.1) distances.push(distance);
  for (let distance = BEST; distance <= FARTHEST; distance += 0.1) distances.push(distance);
  const [x, z] = at(distances.find((distance) => free(at(distance))) ?? BEST);
  return { x, z, yaw, pitch: DOWN };
}

/** The bay that holds [x, z], or null. */
export function bayAt(point, bays) {
  return bays.find((bay) => insidePolygon(point, bay.polygon)) ?? null;
}

const TURNS = 60; // of pushing apart: a dozen crowded dots rest after ten

/**
 * Places [{id, x, z}] moved no farther than it takes for each two to lie `least` [m] apart along x or along z: what is
 * drawn of them is pressed with a finger, and a corner between two that lie aslant is none. Those that have room stay
 * where they are.
 */
export function spreadApart(places, least) {
  const moved = places.map(({ id, x, z }) => ({ id, x, z }));
  for (let turn = 0, crowded = true; crowded && turn < TURNS; turn += 1) {
    crowded = false;
    for (let i = 0; i < moved.length; i += 1) {
      for (let j = 0; j < i; j += 1) {
        const [a, b] = [moved[i], moved[j]];
        const [dx, dz] = [a.x - b.x, a.z - b.z];
        const axis = Math.abs(dx) >= Math.abs(dz) ? "x" : "z";
        const distance = Math.max(Math.abs(dx), Math.abs(dz));
        if (distance >= least - 1e-3) continue;
        crowded = true;
        const push = ((least - distance) / 2) * (a[axis] < b[axis] ? -1 : 1);
        a[axis] += push;
        b[axis] -= push;
      }
    }
  }
  return moved;
}

/** The exhibit nearest to [x, z] within `reach` [m], or null. */
export function nearestExhibit([x, z], exhibits, reach) {
  let best = null;
  let least = reach;
  for (const exhibit of exhibits) {
    const distance = Math.hypot(exhibit.x - x, exhibit.z - z);
    if (distance <= least) [best, least] = [exhibit, distance];
  }
  return best;
}

const STAYS = 0.15; // [rad] by which another has to be more nearly ahead than the one that is looked at already

/** Of the exhibits with these ids the one that whoever stands at {x, z, yaw} looks at most nearly, or null; it stays `current`
 *  while no other is clearly more nearly ahead. */
export function lookedAt(ids, exhibits, { x, z, yaw }, current = null) {
  let best = null, least = Infinity;
  for (const exhibit of exhibits) {
    if (!ids.has(exhibit.id)) continue;
    const turn = Math.atan2(x - exhibit.x, z - exhibit.z) - yaw;
    const aside = Math.abs(turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI)));
    const off = aside - (exhibit.id === current ? STAYS : 0);
    if (off < least) [best, least] = [exhibit.id, off];
  }
  return best;
}
