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
 * {rate, loop, frames, count, torso, bones, worn, limbs, noise, m0, rounds, points, cloth, m, delta, lost} of a file's bytes.
 *
 * points: 3 · count numbers [m] a frame, cloth: 3 · worn.length; m [1], delta [m]: limbs.length a frame; torso: a Set of
 * points of X1; bones: [[joint, joint]]; worn: the points that have one on the garment; lost: count a frame, 0 or 1.
 * Throws where they are none.
 */
export async function readPoints(buffer) {
  const bytes = new Uint8Array(buffer), begin = MARK.length + 4;
  if (bytes.length < begin || String.fromCharCode(...bytes.subarray(0, MARK.length)) !== MARK) throw new Error("no points");
  const length = new DataView(buffer).getUint32(MARK.length, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(begin, begin + length)));
  if (header.format !== FORMAT) throw new Error("points of another format – load the page again");
  const still = new Still(await inflated(bytes.subarray(begin + length)));
  const { rate, loop, frames, points: count, bones, worn, limbs, noise, m0, rounds, origin, steps } = header;
  const rows = (columns) => still.wholeNumbers(frames, columns);
  const points = measures(rows(3 * count), steps.place, origin);
  const cloth = measures(rows(3 * worn.length), steps.place, origin);
  const m = measures(rows(limbs.length), steps.m), delta = measures(rows(limbs.length), steps.delta);
  const lost = Uint8Array.from(rows(count)), torso = new Set(header.torso);
  return { rate, loop, frames, count, torso, bones, worn, limbs, noise, m0, rounds, points, cloth, m, delta, lost };
}
