// Where a ray from the eye through a place of the picture meets a model: the nearest of all its triangles.

/** A 4 x 4 matrix (16 numbers, column by column) times a point, divided by its fourth coordinate. */
function moved(m, [x, y, z]) {
  const w = m[3] * x + m[7] * y + m[11] * z + m[15];
  return [0, 1, 2].map((k) => (m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k]) / w);
}

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** How far along `ahead` from `eye` a triangle is met (Möller and Trumbore 1997), Infinity where it is not. */
function met(eye, ahead, a, b, c) {
  const one = minus(b, a), other = minus(c, a), side = cross(ahead, other), scale = dot(one, side);
  if (Math.abs(scale) < 1e-14) return Infinity;
  const from = minus(eye, a), u = dot(from, side) / scale;
  if (u < 0 || u > 1) return Infinity;
  const up = cross(from, one), v = dot(ahead, up) / scale;
  if (v < 0 || u + v > 1) return Infinity;
  const far = dot(other, up) / scale;
  return far > 0 ? far : Infinity;
}

/** The point [x, y, z] of `meshes` that is seen at (x, y), -1 to 1 from the picture's lower left, by the camera `lens`. */
export function touched(meshes, lens, [x, y]) {
  const world = lens.matrixWorld.elements, through = lens.projectionMatrixInverse.elements;
  const [begin, end] = [-1, 0.9].map((depth) => moved(world, moved(through, [x, y, depth])));
  const ahead = minus(end, begin);
  let nearest = Infinity;
  for (const { geometry, matrixWorld, visible } of meshes) {
    const places = geometry.attributes.position;
    if (!visible || !places) continue;
    const corner = (k) => moved(matrixWorld.elements, [places.getX(k), places.getY(k), places.getZ(k)]);
    const index = geometry.index, count = index ? index.count : places.count;
    for (let k = 0; k + 2 < count; k += 3) {
      const [a, b, c] = [k, k + 1, k + 2].map((place) => corner(index ? index.getX(place) : place));
      nearest = Math.min(nearest, met(begin, ahead, a, b, c));
    }
  }
  return nearest === Infinity ? null : [0, 1, 2].map((k) => begin[k] + nearest * ahead[k]);
}
