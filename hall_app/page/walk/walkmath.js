// Walking in the page: the server's mover on samples of its clearance grid, and the prediction on top of it.
// No DOM, no network: the tests run this very file. The maths is explained in hall_app/walk/README.md.

export const WALK = {
  speed: 1.6, // [m/s]
  radius: 0.3, // [m]
  skin: 0.01, // [m] rest distance: the reserve for the grid's error
  maxDt: 0.25, // [s] longest input the server takes
  touch: 1e-4, // [m] above the skin that still counts as contact
  slide: 0.025, // [m] of wished path per step along a contact
  steep: 1e-4, // sin² between wish and normal below which the visitor rests
  slack: 2e-5, // [m] of clearance the grid's interpolation may lose in a slide
  keep: 0.003, // [m] a disagreement with the server below this moves nothing on the screen while standing
  settle: 0.0005, // [m] where a decaying disagreement counts as settled
  decay: 12, // [1/s] of a disagreement above `keep`
  jump: 1.0, // [m] beyond it the display jumps
};

/** Grid from int16 little-endian samples; meta {x0, z0, cell, nx, nz, scale} as the server describes them. */
export function loadGrid(buffer, meta) {
  const count = meta.nx * meta.nz;
  if (buffer.byteLength !== 2 * count) {
    throw new Error(`walking grid: ${buffer.byteLength} bytes for ${meta.nx} x ${meta.nz} samples – reload the page`);
  }
  const view = new DataView(buffer);
  const samples = new Float64Array(count);
  for (let i = 0; i < count; i++) samples[i] = view.getInt16(2 * i, true) * meta.scale;
  return { samples, x0: meta.x0, z0: meta.z0, cell: meta.cell, nx: meta.nx, nz: meta.nz };
}

const MOST_PENDING = 600; // inputs kept while the server is silent

// Catmull-Rom weights and their derivative at t in 0..1.
const weights = (t) => [
  t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t),
];
const slopes = (t) => [-0.5 + t * (2 - 1.5 * t), t * (-5 + 4.5 * t), 0.5 + t * (4 - 4.5 * t), t * (-1 + 1.5 * t)];

/**
 * [clearance m, nx, nz] at (x, z); the unit normal points away from the nearest solid, (0, 0) outside the grid.
 * Distance round a corner is smooth and convex: there the bicubic value is right, where bilinear samples promise
 * up to cell²/8r too much (1 mm). Where two solids are equally near it has a ridge that any smooth value blurs
 * (by up to cell/4): there the planes continued from both sides meet in it.
 */
export function clearance(grid, x, z) {
  const u = (x - grid.x0) / grid.cell, v = (z - grid.z0) / grid.cell;
  const i = Math.floor(u), j = Math.floor(v);
  if (!(i >= 1 && j >= 1 && i + 2 < grid.nx && j + 2 < grid.nz)) return [-WALK.radius, 0, 0];
  const at = (j - 1) * grid.nx + i - 1;
  const [value, gx, gz] = ridged(grid, at) ? ridge(grid, at, u - i, v - j) : bicubic(grid, at, u - i, v - j);
  const length = Math.hypot(gx, gz);
  return length < 1e-9 ? [value, 0, 0] : [value, gx / length, gz / length];
}

// Does the 4 x 4 patch from sample `at` bend downwards anywhere by more than rounding?
function ridged({ samples: s, nx, cell }, at) {
  const least = -0.01 * cell;
  for (let b = 0; b < 4; b++) {
    const r = at + b * nx, c = at + b;
    if (s[r] - 2 * s[r + 1] + s[r + 2] < least || s[r + 1] - 2 * s[r + 2] + s[r + 3] < least) return true;
    if (s[c] - 2 * s[c + nx] + s[c + 2 * nx] < least) return true;
    if (s[c + nx] - 2 * s[c + 2 * nx] + s[c + 3 * nx] < least) return true;
  }
  return false;
}

function bicubic({ samples: s, nx }, at, fu, fv) {
  const wu = weights(fu), wv = weights(fv), su = slopes(fu), sv = slopes(fv);
  let value = 0, gx = 0, gz = 0;
  for (let b = 0; b < 4; b++) {
    const r = at + b * nx;
    const along = wu[0] * s[r] + wu[1] * s[r + 1] + wu[2] * s[r + 2] + wu[3] * s[r + 3];
    value += wv[b] * along;
    gz += sv[b] * along;
    gx += wv[b] * (su[0] * s[r] + su[1] * s[r + 1] + su[2] * s[r + 2] + su[3] * s[r + 3]);
  }
  return [value, gx, gz];
}

// The least of the planes through the cell's four corners with the slopes outside the cell, but not less than the
// bilinear value: exact between straight walls.
function ridge({ samples: s, nx }, at, fu, fv) {
  const k = at + nx + 1;
  let value = Infinity, gx = 0, gz = 0;
  for (const b of [0, 1]) {
    for (const a of [0, 1]) {
      const corner = k + a + b * nx;
      const dx = a ? s[corner + 1] - s[corner] : s[corner] - s[corner - 1];
      const dz = b ? s[corner + nx] - s[corner] : s[corner] - s[corner - nx];
      const plane = s[corner] + (fu - a) * dx + (fv - b) * dz;
      if (plane < value && Math.hypot(dx, dz) > 0) [value, gx, gz] = [plane, dx, dz];
    }
  }
  const near = s[k] + fu * (s[k + 1] - s[k]), far = s[k + nx] + fu * (s[k + nx + 1] - s[k + nx]);
  return [Math.max(value < Infinity ? value : -Infinity, near + fv * (far - near)), gx, gz];
}

/** Unit direction [wx, wz] of the held keys at this yaw and their strength 0..1. */
export function direction(forward, right, yaw) {
  const length = Math.hypot(forward, right);
  if (length === 0) return [0, 0, 0];
  const f = forward / length, r = right / length, sin = Math.sin(yaw), cos = Math.cos(yaw);
  return [-f * sin + r * cos, -f * cos - r * sin, Math.min(length, 1)];
}

/** {x, z} after dt [s] of the held keys from pose {x, z}: slides along solids, never enters them. */
export function move(grid, pose, forward, right, yaw, dt, opts = {}) {
  const o = { ...WALK, ...opts };
  const [wx, wz, strength] = direction(forward, right, yaw);
  let left = strength * o.speed * dt;
  let { x, z } = pose;
  if (!(left > 0)) return { x, z };
  let [c, nx, nz] = clearance(grid, x, z);
  if (c < 0) return { x, z }; // inside something: the server will say where we are
  const turns = 16 + Math.floor(left / 0.01);
  for (let turn = 0; turn < turns && left > 1e-6; turn++) {
    if (0.9 * (c - o.skin) >= left) return { x: x + left * wx, z: z + left * wz };
    if (c - o.skin > o.touch) {
      const h = approach(grid, x, z, wx, wz, left, c, o);
      x += h * wx; z += h * wz; left -= h;
      [c, nx, nz] = clearance(grid, x, z);
      continue;
    }
    const next = slide(grid, x, z, wx, wz, left, c, nx, nz, o);
    if (!next) break;
    ({ x, z, c, nx, nz } = next);
    left -= next.used;
  }
  return { x, z };
}

function approach(grid, x, z, wx, wz, left, c, o) {
  const leap = 2 * Math.sqrt((o.radius + o.skin) ** 2 - o.radius ** 2);
  const safe = 0.9 * (c - o.skin);
  let h = Math.max(safe, Math.min(left, leap));
  for (let i = 0; i < 5; i++) {
    const [c2] = clearance(grid, x + h * wx, z + h * wz);
    if (c2 >= o.skin) return h;
    h *= (c - o.skin - o.touch / 2) / (c - Math.min(c2, o.skin - 1e-6));
    if (h <= safe) break;
  }
  return safe;
}

function slide(grid, x, z, wx, wz, left, c, nx, nz, o) {
  const into = Math.min(0, wx * nx + wz * nz);
  let tx = wx - into * nx, tz = wz - into * nz;
  const share = Math.hypot(tx, tz);
  if (share * share <= o.steep) return null;
  tx /= share; tz /= share;
  const least = Math.min(c, o.skin) - o.slack;
  let h = Math.min(left, o.slide) * share;
  for (let i = 0; i < 5; i++) {
    let x2 = x + h * tx, z2 = z + h * tz;
    let [c2, nx2, nz2] = clearance(grid, x2, z2);
    const gap = o.skin - c2;
    if ((gap > 0 || wx * nx2 + wz * nz2 < 0) && Math.abs(gap) < h) {
      x2 += gap * nx2; z2 += gap * nz2;
      [c2, nx2, nz2] = clearance(grid, x2, z2);
    }
    if (c2 >= least) {
      // Towards the wish, not counting the return from where p itself was off the skin: none in a wedge.
      const progress = (x2 - x) * wx + (z2 - z) * wz - (o.skin - c) * (nx * wx + nz * wz);
      return progress > 1e-3 * h ? { x: x2, z: z2, used: h / share, c: c2, nx: nx2, nz: nz2 } : null;
    }
    h /= 2;
  }
  return null;
}

/**
 * Shows at once what the server will most likely answer, and mends the difference out of sight.
 * push(input) -> displayed {x, z, yaw, eye}, input = {seq, dt, forward, right, yaw, eye}; acknowledge(seq, x, z)
 * takes the server's word. Plain values in and out; the caller owns clock, socket and camera.
 */
export class Predictor {
  /** grid from loadGrid; opts: start place x, z and any of WALK. */
  constructor(grid, { x = 0, z = 0, ...opts } = {}) {
    this.grid = grid;
    this.opts = { ...WALK, ...opts };
    this.heading = { yaw: 0, eye: 1.6 };
    this.teleport(x, z);
  }

  /** Jump to (x, z); inputs under way are forgotten, their answers still count. */
  teleport(x, z) {
    this.pose = { x, z }; // what the server will say, predicted
    this.shown = { x, z };
    this.pending = []; // inputs the server has not answered, with what was shown after each
    this.answered = null; // where the server last stood
    this.rest = null; // {wx, wz, x, z}: direction in which the server stands still, and where
    this.settling = false; // the display is on its way to the predicted place
    this.worst = 0; // [m] largest distance so far between an answer and what was shown for it
  }

  /** Walk one input at once; returns the displayed pose {x, z, yaw, eye}. */
  push(input) {
    this.heading = { yaw: input.yaw, eye: input.eye };
    const before = this.pose;
    this.pose = this.#walk(before, input);
    let ox = this.shown.x - before.x, oz = this.shown.z - before.z;
    // A disagreement melts away while walking, where nobody sees it; standing, only if it is too large to keep.
    const walked = Math.hypot(this.pose.x - before.x, this.pose.z - before.z) > 1e-6;
    if (walked || this.settling) {
      const left = Math.exp(-this.opts.decay * input.dt);
      ox *= left; oz *= left;
      if (Math.hypot(ox, oz) < this.opts.settle) this.settling = false;
    }
    this.#show(this.pose.x + ox, this.pose.z + oz);
    this.pending.push({ ...input, shown: this.shown });
    if (this.pending.length > MOST_PENDING) this.pending.shift();
    return this.display();
  }

  /** Input seq stays here: it moves nothing and is not sent. */
  skip(seq) {
    this.pending = this.pending.filter((input) => input.seq !== seq);
  }

  /** The displayed pose. */
  display() {
    return { ...this.shown, ...this.heading };
  }

  /**
   * The server stands at (x, z) after input seq. Returns the distance [m] to what was shown after that input,
   * null where that is no longer known.
   */
  acknowledge(seq, x, z) {
    const answered = this.pending.filter((input) => input.seq <= seq);
    this.pending = this.pending.filter((input) => input.seq > seq);
    this.#noticeRest(answered, x, z);
    let place = { x, z };
    for (const input of this.pending) place = this.#walk(place, input);
    this.pose = place;
    const off = Math.hypot(this.shown.x - place.x, this.shown.z - place.z);
    if (off > this.opts.jump) this.#show(place.x, place.z);
    else if (off > this.opts.keep) this.settling = true;
    const last = answered.at(-1);
    if (last?.seq !== seq) return null;
    const miss = Math.hypot(last.shown.x - x, last.shown.z - z);
    this.worst = Math.max(this.worst, miss);
    return miss;
  }

  // A rest is a fixed point of the server's mover: where it stood still for a direction it will stand still for
  // the inputs under way too. Replaying them on the grid instead would make the display creep and tremble.
  #noticeRest(answered, x, z) {
    const last = answered.at(-1);
    if (!last) return;
    const [wx, wz, strength] = direction(last.forward, last.right, last.yaw);
    const stood = this.answered && Math.hypot(x - this.answered.x, z - this.answered.z) < 1e-7;
    const same = answered.every((input) => aligned(input, wx, wz, strength));
    this.rest = stood && same && strength > 0 ? { wx, wz, x, z } : null;
    this.answered = { x, z };
  }

  #walk(place, input) {
    const { rest } = this;
    if (rest && aligned(input, rest.wx, rest.wz, 1) && place.x === rest.x && place.z === rest.z) {
      return { x: place.x, z: place.z };
    }
    return move(this.grid, place, input.forward, input.right, input.yaw, input.dt, this.opts);
  }

  // Display (x, z), pushed out of the skin's inner half if the disagreement would carry it in there.
  #show(x, z) {
    for (let i = 0; i < 3; i++) {
      const [c, nx, nz] = clearance(this.grid, x, z);
      const gap = 0.5 * this.opts.skin - c;
      if (gap <= 0) break;
      x += gap * nx; z += gap * nz;
    }
    this.shown = { x, z };
  }
}

function aligned(input, wx, wz, strength) {
  const [vx, vz, held] = direction(input.forward, input.right, input.yaw);
  return held > 0 === strength > 0 && Math.hypot(vx - wx, vz - wz) < 1e-9;
}
