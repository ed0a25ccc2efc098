// Directions of a surface at its vertices, of the simulated mesh: twins along a seam of a model share theirs.

/** Area-weighted unit normals into `out`; positions, out: 3 numbers a vertex, faces: 3 a face. Without area: up. */
export function normalsOf(positions, faces, out) {
  out.fill(0);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const x = positions[a], y = positions[a + 1], z = positions[a + 2];
    const ux = positions[b] - x, uy = positions[b + 1] - y, uz = positions[b + 2] - z;
    const vx = positions[c] - x, vy = positions[c + 1] - y, vz = positions[c + 2] - z;
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    out[a] += nx; out[a + 1] += ny; out[a + 2] += nz;
    out[b] += nx; out[b + 1] += ny; out[b + 2] += nz;
    out[c] += nx; out[c + 1] += ny; out[c + 2] += nz;
  }
  for (let k = 0; k < out.length; k += 3) {
    const size = Math.sqrt(out[k] * out[k] + out[k + 1] * out[k + 1] + out[k + 2] * out[k + 2]);
    if (size > 0) {
      out[k] /= size; out[k + 1] /= size; out[k + 2] /= size;
    } else out[k + 1] = 1;
  }
}
