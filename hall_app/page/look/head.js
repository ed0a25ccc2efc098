// Turning the head by keys. Pure: no DOM, the clock is handed in. A held key turns by a function of the time it has been
// held, so slow and fast pictures turn equally far; a tap turns by one step exactly, and taps add up.

const degrees = (angle) => (angle * Math.PI) / 180;

export const TURN = {
  rate: degrees(90), // [rad/s] while held
  ease: 0.2, // [s] until that rate is reached
  tap: 0.2, // [s] a key that comes up sooner was tapped
  step: degrees(15), // [rad] a tap
  finish: degrees(240), // [rad/s] of what a tap still owes, and of levelling
};

/** [rad] turned by a key held for `seconds`. */
export function turned(seconds) {
  const t = Math.max(0, seconds);
  return TURN.rate * (t < TURN.ease ? (t * t) / (2 * TURN.ease) : t - TURN.ease / 2);
}

/** gaze {yaw, pitch} [rad] is turned in place; `calm()`: whether the system asks for less motion. Times in [s]. */
export class Head {
  constructor(gaze, calm = () => false) {
    this.gaze = gaze;
    this.calm = calm;
    this.keys = new Map(); // code -> {sign, since, done}
    this.owed = 0; // [rad] of taps
    this.levelling = false;
    this.now = 0;
  }

  /** `sign` 1 turns left, -1 right. */
  press(code, sign, now) { this.keys.set(code, { sign, since: now, done: 0 }); }

  /** Whether the key was one that turned. */
  lift(code, now) {
    const key = this.keys.get(code);
    if (!key) return false;
    this.keys.delete(code);
    this.#advance(key, now);
    if (now - key.since < TURN.tap) this.owed += key.sign * (TURN.step - key.done);
    return true;
  }

  release() { this.keys.clear(); }

  level() { this.levelling = true; }

  /** Neither taps nor levelling are finished: the visitor looks elsewhere now. */
  forget() {
    this.owed = 0;
    this.levelling = false;
  }

  /** A frame of `dt` [s] at `now`; of a longer time since the last one nobody saw the rest, and it turns nothing. */
  frame(dt, now) {
    const unseen = Math.max(0, now - this.now - dt);
    for (const key of this.keys.values()) {
      key.since = key.since < this.now ? key.since + unseen : Math.max(key.since, now - dt);
      this.#advance(key, now);
    }
    this.now = now;
    const most = this.calm() ? Infinity : TURN.finish * dt;
    const part = Math.max(-most, Math.min(most, this.owed));
    this.gaze.yaw += part;
    this.owed -= part;
    if (!this.levelling) return;
    this.gaze.pitch -= Math.max(-most, Math.min(most, this.gaze.pitch));
    this.levelling = this.gaze.pitch !== 0;
  }

  get busy() { return this.keys.size > 0 || this.owed !== 0 || this.levelling; }

  #advance(key, now) {
    const angle = Math.max(key.done, turned(now - key.since));
    this.gaze.yaw += key.sign * (angle - key.done);
    key.done = angle;
  }
}
