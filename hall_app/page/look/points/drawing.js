// Draws a row of tracked points as a camera sees them: bones as thin lines, X1 red, X2 green, hollow ones of the garment.
// They are drawn over the picture, so cloth hides none.

const RED = "#d8342c", GREEN = "#35c46a"; // as the paper has them; of unlike brightness, for who sees no red
const EDGE = "rgb(20 16 14 / .72)", BONE = "rgb(255 250 240 / .85)", TIE = "rgb(255 250 240 / .4)";
const SIZE = 0.0085, JOINT = 1.35; // [m] radius of a point on the figure; times, of a joint
const LEAST = 1.4, MOST = 7, RING = 2.6; // [px] of a point; the least of a hollow one

/** c = a · b of 4 × 4 matrices as three.js keeps them, column by column. */
export function product(a, b) {
  const c = new Float64Array(16);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

/**
 * Places [px] in a picture of places [m]: x, y and how deep [m] into `out`, three numbers a point; behind the eye: NaN.
 * matrix: from the model to what the picture shows; from, count: which of `places`.
 */
export function project(matrix, { places, from, count }, { width, height }, out) {
  for (let k = 0; k < 3 * count; k += 3) {
    const x = places[from + k], y = places[from + k + 1], z = places[from + k + 2];
    const w = matrix[3] * x + matrix[7] * y + matrix[11] * z + matrix[15];
    const ahead = w > 1e-6;
    out[k] = ahead ? ((matrix[0] * x + matrix[4] * y + matrix[8] * z + matrix[12]) / w + 1) * (width / 2) : NaN;
    out[k + 1] = ahead ? (1 - (matrix[1] * x + matrix[5] * y + matrix[9] * z + matrix[13]) / w) * (height / 2) : NaN;
    out[k + 2] = w;
  }
}

function dot(pen, x, y, radius) {
  pen.moveTo(x + radius, y);
  pen.arc(x, y, radius, 0, 7);
}

/** createDrawing(data) -> {draw(pen, size, matrix, row, focal), drawn()}; data: of readPoints, pen: a canvas' 2-D context. */
export function createDrawing(data) {
  const { count, worn, bones, torso, points, cloth, lost } = data;
  const own = new Float32Array(3 * count), garment = new Float32Array(3 * worn.length);
  const joints = 1 + Math.max(...bones.flat());
  const sets = [[GREEN, (k) => !torso.has(k)], [RED, (k) => torso.has(k)]]; // the trunk's lie on top

  /** How large a point is drawn [px]; focal: pixels of a metre, one metre away. */
  const radiusOf = (places, k, focal) => Math.min(MOST, Math.max(LEAST, (SIZE * focal) / places[3 * k + 2]));

  function lines(pen, pairs, colour, width) {
    pen.beginPath();
    for (const [a, i, b, j] of pairs) {
      pen.moveTo(a[3 * i], a[3 * i + 1]);
      pen.lineTo(b[3 * j], b[3 * j + 1]);
    }
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.stroke();
  }

  const limbs = bones.map(([a, b]) => [own, a, own, b]), ties = worn.map((k, n) => [own, k, garment, n]);

  function rings(pen, colour, mine, focal) {
    pen.beginPath();
    worn.forEach((k, n) => {
      if (mine(k)) dot(pen, garment[3 * n], garment[3 * n + 1], Math.max(RING, radiusOf(garment, n, focal)));
    });
    for (const [stroke, width] of [[EDGE, 2.6], [colour, 1.3]]) Object.assign(pen, { strokeStyle: stroke, lineWidth: width }).stroke();
  }

  function dots(pen, colour, mine, focal, row) {
    for (const unseen of [true, false]) {
      pen.beginPath();
      for (let k = count - 1; k >= 0; k--) {
        if (!mine(k) || Boolean(lost[row * count + k]) !== unseen) continue;
        dot(pen, own[3 * k], own[3 * k + 1], radiusOf(own, k, focal) * (k < joints ? JOINT : 1));
      }
      Object.assign(pen, { strokeStyle: EDGE, lineWidth: 1.5, fillStyle: colour, globalAlpha: unseen ? 0.35 : 1 }).stroke();
      pen.fill();
    }
    pen.globalAlpha = 1;
  }

  return {
    draw(pen, size, matrix, row, focal) {
      project(matrix, { places: points, from: 3 * count * row, count }, size, own);
      project(matrix, { places: cloth, from: 3 * worn.length * row, count: worn.length }, size, garment);
      lines(pen, ties, TIE, 1);
      lines(pen, limbs, EDGE, 3);
      lines(pen, limbs, BONE, 1.25);
      for (const [colour, mine] of sets) rings(pen, colour, mine, focal);
      for (const [colour, mine] of sets) dots(pen, colour, mine, focal, row);
    },
    /** Where they were drawn last [px, px, m]. */
    drawn: () => ({ points: own, cloth: garment }),
  };
}
