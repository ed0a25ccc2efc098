// Walking ahead of the server's word: how far the page may, what it still has to send, and whether it has waited too
// long for an answer. Pure like walkmath.js: no DOM, no socket, the clock is handed in. See hall_app/walk/README.md.

import { Predictor } from "./walkmath.js";

export const PACE = {
  horizon: 0.95, // [s] of walking shown that the server has not answered: less than its bucket, so it takes all of it
  patience: 1.0, // [s] without an answer until the visitor is told
  crumb: 0.001, // [s] of walking that is not worth an input
};

/**
 * The server's bucket as the page must fear it to be. It refuses nothing as long as, for every moment past, what is
 * walked since what was answered then is at most the bucket and the time gone by since: a bucket of our own, that
 * time fills and walking empties, never fuller than the horizon less what is not answered yet.
 */
export class Pace {
  constructor(now) {
    this.credit = PACE.horizon; // [s]
    this.ahead = 0; // [s] walked and not answered
    this.unanswered = []; // {seq, dt, at}
    this.now = now; // [s] any monotonic clock
    this.lived = 0; // [s] of frames: time in which this page itself stood still is nobody's silence
  }

  /** A frame of `dt` [s] at `now` [s]: how much of it may be walked. */
  allow(dt, now) {
    this.#fill(now);
    return this.credit > PACE.crumb ? Math.min(dt, this.credit) : 0;
  }

  /** Input `seq` has walked `dt` [s]. */
  spend(seq, dt) {
    this.credit -= dt;
    this.ahead += dt;
    this.unanswered.push({ seq, dt, at: this.lived });
  }

  answer(seq, now) {
    this.#fill(now); // by what was owed until now
    this.unanswered = this.unanswered.filter((input) => input.seq > seq);
    this.ahead = this.unanswered.reduce((sum, { dt }) => sum + dt, 0);
  }

  live(dt) { this.lived += dt; }

  get waiting() {
    return this.unanswered.length > 0 && this.lived - this.unanswered[0].at >= PACE.patience;
  }

  #fill(now) {
    this.credit = Math.min(this.credit + Math.max(0, now - this.now), PACE.horizon - this.ahead);
    this.now = Math.max(now, this.now);
  }
}

/** One visitor's walk as the page shows it. grid, opts {x, z, …} as Predictor takes them; every `now` in [s]. */
export class Prediction {
  constructor(grid, opts, now) {
    this.predictor = new Predictor(grid, opts);
    this.pace = new Pace(now);
    this.sequence = 0;
    this.outgoing = []; // [seq, dt, forward, right, yaw, eye]
  }

  /** A frame of `dt` [s] with these keys; returns the place {x, z} to show. Long frames go in pieces the server takes. */
  walk(dt, forward, right, yaw, eye, now) {
    this.pace.live(dt);
    const walked = forward !== 0 || right !== 0 ? this.pace.allow(dt, now) : 0;
    for (let left = walked; left > 1e-6; left -= this.predictor.opts.maxDt) {
      const part = Math.min(left, this.predictor.opts.maxDt);
      this.#push(part, forward, right, yaw, eye);
      this.pace.spend(this.sequence, part);
      this.outgoing.push([this.sequence, part, forward, right, yaw, eye]);
    }
    if (walked === 0 && this.predictor.settling) {
      this.#push(dt, 0, 0, yaw, eye);
      this.predictor.skip(this.sequence);
    }
    return this.predictor.shown;
  }

  /** The server stands at (x, z) after input `seq`. */
  answer(seq, x, z, now) {
    this.pace.answer(seq, now);
    this.predictor.acknowledge(seq, x, z);
  }

  /** The server has put the visitor at (x, z); what is under way is still to be answered. */
  moved(x, z) { this.predictor.teleport(x, z); }

  /** What is to be sent now. */
  take() { return this.outgoing.splice(0); }

  get waiting() { return this.pace.waiting; }

  get ahead() { return this.pace.ahead; } // [s] walked that the server has not answered

  #push(dt, forward, right, yaw, eye) {
    this.sequence += 1;
    this.predictor.push({ seq: this.sequence, dt, forward, right, yaw, eye });
  }
}
