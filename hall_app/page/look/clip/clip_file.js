// Reads a clip, once: sim_core/garment/clip/clip_file.py writes it and tells its bytes. Numbers are little endian.

const MARK = "HALLCLIP", FORMAT = 1;
const JOINTS = 21, POSE = 4 * JOINTS + 3; // [numbers] of a pose

/** What was deflated, by zlib. */
export async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const unzigzag = (value) => (value >>> 1) ^ -(value & 1);

/** Takes arrays from the part that is the same in all frames, one after the other. */
export class Still {
  constructor(bytes) { Object.assign(this, { bytes, at: 0 }); }

  take(size) {
    if (this.at + size > this.bytes.length) throw new Error("the clip is cut off – load it again");
    return this.bytes.slice(this.at, (this.at += size));
  }

  /** rows × columns whole numbers: differences down each column, zigzag, four planes of bytes. */
  wholeNumbers(rows, columns) {
    const count = rows * columns, planes = this.take(4 * count), found = new Uint32Array(count);
    for (let k = 0; k < count; k++) {
      const told = planes[k] | (planes[k + count] << 8) | (planes[k + 2 * count] << 16) | (planes[k + 3 * count] << 24);
      found[k] = unzigzag(told) + (k < columns ? 0 : found[k - columns]);
    }
    return found;
  }

  mesh({ name, vertices, faces, drawn }) {
    return {
      name,
      count: vertices,
      faces: this.wholeNumbers(faces, 3),
      drawn: drawn.map((one) => ({ node: one.node, index: this.wholeNumbers(one.vertices, 1) })),
    };
  }
}

/** Whole steps of one frame into `steps` (3 numbers a vertex): each vertex guessed as a + b − c of three before it. */
function unfold(planes, order, sources, steps) {
  const count = order.length;
  for (let k = 0; k < count; k++) {
    const to = 3 * order[k], a = 3 * sources[3 * k], b = 3 * sources[3 * k + 1], c = 3 * sources[3 * k + 2];
    for (let axis = 0; axis < 3; axis++) {
      const at = 2 * axis * count + k;
      const guess = a === to ? 0 : steps[a + axis] + steps[b + axis] - steps[c + axis];
      steps[to + axis] = unzigzag(planes[at] | (planes[at + count] << 8)) + guess;
    }
  }
}

function readFigure(told, still) {
  const mesh = still.mesh(told), { count } = mesh;
  const heads = new Float32Array(still.take(12 * JOINTS).buffer);
  const rest = new Float32Array(still.take(12 * count).buffer);
  const shares = new Uint16Array(still.take(2 * JOINTS * count).buffer);
  return { ...mesh, heads, rest, shares, parents: told.parents, linear: told.linear };
}

/**
 * The clip of a file's bytes: {rate, loop, frames, period [s], origin, step, vertices, steps, meshes, figure, poses}.
 *
 * steps: Uint16Array, of frame k those from 3 · k · vertices on; meshes: {name, begin, count, faces, drawn: [{node,
 * index}]}; figure: null, or the like with heads, rest, shares; poses: Float32Array, 21 quaternions and a shift a frame.
 * Throws where they are none.
 */
export async function readClip(buffer) {
  const bytes = new Uint8Array(buffer), view = new DataView(buffer);
  const begin = MARK.length + 8;
  if (bytes.length < begin || String.fromCharCode(...bytes.subarray(0, MARK.length)) !== MARK) throw new Error("no clip");
  const length = view.getUint32(MARK.length, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(begin, begin + length)));
  if (header.format !== FORMAT) throw new Error("a clip of another format – load the page again");
  let at = begin + length;
  const [first, ...parts] = header.sizes.map((size) => bytes.subarray(at, (at += size)));
  if (at !== bytes.length) throw new Error("the clip is cut off – load it again");
  const still = new Still(await inflated(first));
  const vertices = header.meshes.reduce((sum, mesh) => sum + mesh.vertices, 0);
  const order = still.wholeNumbers(vertices, 1), sources = still.wholeNumbers(vertices, 3);
  let next = 0;
  const meshes = header.meshes.map((told) => ({ ...still.mesh(told), begin: (next += told.vertices) - told.vertices }));
  const figure = header.figure && readFigure(header.figure, still);
  const frames = parts.length, own = figure ? POSE : 0;
  const steps = new Uint16Array(3 * vertices * frames), poses = new Float32Array(own * frames);
  for (let k = 0; k < frames; k++) {
    const plain = await inflated(parts[k]);
    if (plain.length !== 6 * vertices + 4 * own) throw new Error("the clip is damaged – load it again");
    unfold(plain, order, sources, steps.subarray(3 * k * vertices, 3 * (k + 1) * vertices));
    if (own) poses.set(new Float32Array(plain.slice(6 * vertices).buffer), k * own);
  }
  const { rate, loop, origin, step } = header;
  const period = Math.max(1, frames) / rate;
  return { rate, loop, frames, period, origin, step, vertices, steps, meshes, figure, poses };
}
