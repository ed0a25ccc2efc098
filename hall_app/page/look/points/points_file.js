// Reads what was tracked of a wearer in motion: hall_app/content/models/tracked.py writes it and tells its bytes.

import { inflated, Still } from "../clip/clip_file.js";

const MARK = "HALLPNTS", FORMAT = 1;

/** Whole numbers of T rows as measures: whole · step + origin, axis by axis where there are three. */
function measures(numbers, step, origin = [0]) {
  const found = new Float32Array(numbers.length);
  for (let k = 0; k < found.length; k++) found[k] = origin[k % origin.length] + step * numbers[k];
  return found;
}

/**
 * {rate, loop, frames, begin, rows, count, torso, bones, worn, limbs, noise, m0, rounds, points, cloth, m, delta, lost} of a file's bytes.
 *
 * Row `begin` is the clip's first frame; the ones before it tell how the model stands. points: 3 · count numbers [m] a
 * row, cloth: 3 · worn.length; m [1], delta [m]: limbs.length; torso: a Set of points of X1; bones: [[joint, joint]];
 * worn: the points that have one on the garment; lost: count a row, 0 or 1.
 * Throws where they are none.
 */
export async function readPoints(buffer) {
  const bytes = new Uint8Array(buffer), from = MARK.length + 4;
  if (bytes.length < from || String.fromCharCode(...bytes.subarray(0, MARK.length)) !== MARK) throw new Error("no points");
  const length = new DataView(buffer).getUint32(MARK.length, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(from, from + length)));
  if (header.format !== FORMAT) throw new Error("points of another format – load the page again");
  const still = new Still(await inflated(bytes.subarray(from + length)));
  const { rate, loop, rows, begin, points: count, bones, worn, limbs, noise, m0, rounds, origin, steps } = header;
  const table = (columns) => still.wholeNumbers(rows, columns);
  const points = measures(table(3 * count), steps.place, origin);
  const cloth = measures(table(3 * worn.length), steps.place, origin);
  const m = measures(table(limbs.length), steps.m), delta = measures(table(limbs.length), steps.delta);
  const lost = Uint8Array.from(table(count)), torso = new Set(header.torso);
  const told = { rate, loop, frames: rows - begin, begin, rows, count, torso, bones, worn, limbs, noise, m0, rounds };
  return { ...told, points, cloth, m, delta, lost };
}
