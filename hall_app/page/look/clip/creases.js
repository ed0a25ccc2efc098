// Which corners of drawn meshes share a direction. Along a crease the model's own directions differ from side to side;
// twins along a seam have the same.

const ONE = 0.9; // cosine of the angle within which two directions are one

/**
 * creased(parts, count) -> {faces, from, ids} of corners, or null where no vertex has two directions.
 *
 * parts: [{index, geometry}] of all drawn meshes of a surface of `count` vertices, index: the surface's vertex of each of
 * the mesh's, geometry: as the model has it. faces: 3 corners a face, of all parts; from: the vertex of each corner beyond
 * the first of its vertex (corner k < count is vertex k's first); ids: of each part, the corner of each of its vertices.
 */
export function creased(parts, count) {
  if (parts.some(({ geometry }) => !geometry.attributes.normal || !geometry.index)) return null;
  const told = new Float32Array(3 * count), known = new Uint8Array(count);
  const more = []; // [corner's direction, the next corner of its vertex]
  const next = new Int32Array(count).fill(-1), from = [];
  const fits = (x, y, z, nx, ny, nz) => x * nx + y * ny + z * nz > ONE;

  function cornerOf(vertex, x, y, z) {
    if (!known[vertex]) {
      known[vertex] = 1;
      told.set([x, y, z], 3 * vertex);
      return vertex;
    }
    if (fits(x, y, z, ...told.subarray(3 * vertex, 3 * vertex + 3))) return vertex;
    let at = next[vertex], last = -1;
    while (at >= 0) {
      if (fits(x, y, z, ...more[at].told)) return count + at;
      last = at;
      at = more[at].next;
    }
    more.push({ told: [x, y, z], next: -1 });
    from.push(vertex);
    if (last < 0) next[vertex] = more.length - 1;
    else more[last].next = more.length - 1;
    return count + more.length - 1;
  }

  const ids = parts.map(({ index, geometry }) => {
    const lit = geometry.attributes.normal.array;
    return Int32Array.from(index, (vertex, p) => cornerOf(vertex, lit[3 * p], lit[3 * p + 1], lit[3 * p + 2]));
  });
  if (from.length === 0) return null;
  const corners = parts.flatMap(({ geometry }, part) => Array.from(geometry.index.array, (p) => ids[part][p]));
  return { faces: Uint32Array.from(corners), from: Int32Array.from(from), ids };
}
