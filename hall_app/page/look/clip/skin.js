// A figure goes by its bones, blended as sim_core/body/skinning.py does it: screws of joints (dual quaternions) added by
// their weights, and the moves of the joints named linear (arms of some figures) added as they are.

const JOINTS = 21, POSE = 4 * JOINTS + 3;

/** Which joints move each vertex, and how much: of vertex v those from starts[v] to starts[v + 1]. */
function sparse(shares, count) {
  const starts = new Uint32Array(count + 1), joints = [], weights = [];
  for (let v = 0; v < count; v++) {
    const row = shares.subarray(JOINTS * v, JOINTS * (v + 1));
    const whole = row.reduce((sum, share) => sum + share, 0);
    row.forEach((share, joint) => {
      if (!share) return;
      joints.push(joint);
      weights.push(share / whole);
    });
    starts[v + 1] = joints.length;
  }
  return { starts, joints: Uint8Array.from(joints), weights: Float64Array.from(weights) };
}

/** q ← a · b of quaternions, real part first, each four numbers from its place on. */
function product(a, i, b, j, q, k) {
  const aw = a[i], ax = a[i + 1], ay = a[i + 2], az = a[i + 3];
  const bw = b[j], bx = b[j + 1], by = b[j + 2], bz = b[j + 3];
  q[k] = aw * bw - ax * bx - ay * by - az * bz;
  q[k + 1] = aw * bx + bw * ax + ay * bz - az * by;
  q[k + 2] = aw * by + bw * ay + az * bx - ax * bz;
  q[k + 3] = aw * bz + bw * az + ax * by - ay * bx;
}

/** The rotation matrix of a unit quaternion, nine numbers from `to` on. */
function matrix(q, k, out, to) {
  const w = q[k], x = q[k + 1], y = q[k + 2], z = q[k + 3];
  out[to] = 1 - 2 * (y * y + z * z); out[to + 1] = 2 * (x * y - w * z); out[to + 2] = 2 * (x * z + w * y);
  out[to + 3] = 2 * (x * y + w * z); out[to + 4] = 1 - 2 * (x * x + z * z); out[to + 5] = 2 * (y * z - w * x);
  out[to + 6] = 2 * (x * z - w * y); out[to + 7] = 2 * (y * z + w * x); out[to + 8] = 1 - 2 * (x * x + y * y);
}

/** createSkin(figure, poses) -> pose(frame, out): the figure's vertices in a frame into `out` (3 numbers each). */
export function createSkin({ count, heads, rest, shares, parents, linear }, poses) {
  const { starts, joints, weights } = sparse(shares, count);
  const straight = Uint8Array.from({ length: JOINTS }, (_, joint) => Number(linear.includes(joint)));
  const own = new Float64Array(4), half = new Float64Array(4);
  const real = new Float64Array(4 * JOINTS), dual = new Float64Array(4 * JOINTS);
  const turns = new Float64Array(9 * JOINTS), shifts = new Float64Array(3 * JOINTS);

  function joint(j, frame) {
    const p = parents[j], at = POSE * frame + 4 * j;
    const size = Math.hypot(poses[at], poses[at + 1], poses[at + 2], poses[at + 3]);
    for (let k = 0; k < 4; k++) own[k] = poses[at + k] / size;
    if (p < 0) real.set(own, 4 * j);
    else {
      product(real, 4 * p, own, 0, real, 4 * j);
      let along = 0;
      for (let k = 0; k < 4; k++) along += real[4 * j + k] * real[4 * p + k];
      if (along < 0) for (let k = 0; k < 4; k++) real[4 * j + k] *= -1; // next to its parent's, not to its antipode
    }
    matrix(real, 4 * j, turns, 9 * j);
    for (let k = 0; k < 3; k++) {
      const turned = (b) =>
        turns[9 * b + 3 * k] * heads[3 * j] + turns[9 * b + 3 * k + 1] * heads[3 * j + 1] + turns[9 * b + 3 * k + 2] * heads[3 * j + 2];
      const place = p < 0 ? heads[3 * j + k] + poses[POSE * frame + 4 * JOINTS + k] : turned(p) + shifts[3 * p + k];
      shifts[3 * j + k] = place - turned(j);
      half[k + 1] = shifts[3 * j + k] / 2;
    }
    half[0] = 0;
    product(half, 0, real, 4 * j, dual, 4 * j);
  }

  return function pose(frame, out) {
    for (let j = 0; j < JOINTS; j++) joint(j, frame);
    for (let v = 0; v < count; v++) {
      const x = rest[3 * v], y = rest[3 * v + 1], z = rest[3 * v + 2];
      let ox = 0, oy = 0, oz = 0, share = 0;
      let w = 0, a = 0, b = 0, c = 0, dw = 0, da = 0, db = 0, dc = 0;
      for (let e = starts[v]; e < starts[v + 1]; e++) {
        const j = joints[e], weight = weights[e];
        if (straight[j]) {
          const t = 9 * j;
          ox += weight * (turns[t] * x + turns[t + 1] * y + turns[t + 2] * z + shifts[3 * j]);
          oy += weight * (turns[t + 3] * x + turns[t + 4] * y + turns[t + 5] * z + shifts[3 * j + 1]);
          oz += weight * (turns[t + 6] * x + turns[t + 7] * y + turns[t + 8] * z + shifts[3 * j + 2]);
          continue;
        }
        const q = 4 * j;
        share += weight;
        w += weight * real[q]; a += weight * real[q + 1]; b += weight * real[q + 2]; c += weight * real[q + 3];
        dw += weight * dual[q]; da += weight * dual[q + 1]; db += weight * dual[q + 2]; dc += weight * dual[q + 3];
      }
      if (share > 0) {
        const size = Math.sqrt(w * w + a * a + b * b + c * c);
        w /= size; a /= size; b /= size; c /= size; dw /= size; da /= size; db /= size; dc /= size;
        const ix = b * z - c * y + w * x, iy = c * x - a * z + w * y, iz = a * y - b * x + w * z;
        ox += share * (x + 2 * (b * iz - c * iy + w * da - dw * a + b * dc - c * db));
        oy += share * (y + 2 * (c * ix - a * iz + w * db - dw * b + c * da - a * dc));
        oz += share * (z + 2 * (a * iy - b * ix + w * dc - dw * c + a * db - b * da));
      }
      out[3 * v] = ox; out[3 * v + 1] = oy; out[3 * v + 2] = oz;
    }
  };
}
