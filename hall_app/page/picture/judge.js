// Which picture quality a machine bears, judged by the time its pictures take. Pure: numbers in, a level out.
//
// Going down is quick, since a slow hall annoys at once. Going up asks for more evidence, and a level that proved too
// much is left alone for a while, twice as long each time: otherwise the picture would change to and fro.

export const LEVELS = ["low", "medium", "high"];

const SLOW = 42; // [ms] a picture: less than 24 a second
const CRAWLING = 100; // [ms] no half measures
const FLUENT = 22; // [ms] 50 Hz displays included
const LOOK = 1000; // [ms] of drawing for a verdict, and
const FEWEST = 5; // pictures
const LONG_LOOK = 2500; // [ms] a verdict on fewer than that, but
const LEAST = 3; // pictures
const ABSENT = 3000; // [ms] that is no picture's time: the tab was hidden, or the machine asleep
const SETTLE = 400; // [ms] of drawing after a change that do not count: shaders are built, buffers made
const EVIDENCE = 2; // fluent verdicts in a row before going up
const REST = 60e3; // [ms] a level that was too much is left alone for; doubles each time
const LONGEST_REST = 3600e3;

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** A judge's memory. `cautious`: the level was found earlier on this machine, so the next one may wait. */
export function newJudgement(level, { now = 0, cautious = false } = {}) {
  const above = LEVELS[LEVELS.indexOf(level) + 1];
  return {
    level,
    times: [],
    skip: SETTLE,
    fluent: 0,
    falls: {},
    restUntil: cautious && above ? { [above]: now + REST } : {},
  };
}

/**
 * Judgement after one more picture that took `ms` and was drawn right after another; `now` [ms] is any steady clock.
 * Returns the given judgement changed; `level` says what to draw from now on.
 */
export function judge(state, ms, now) {
  if (ms > ABSENT) return state;
  if (state.skip > 0) {
    state.skip -= ms;
    return state;
  }
  state.times.push(ms);
  const total = state.times.reduce((sum, time) => sum + time, 0);
  if (total < LOOK || state.times.length < (total < LONG_LOOK ? FEWEST : LEAST)) return state;
  const typical = median(state.times);
  state.times = [];
  const at = LEVELS.indexOf(state.level);
  state.fluent = typical <= FLUENT ? state.fluent + 1 : 0;
  if (typical > SLOW && at > 0) {
    const falls = (state.falls[state.level] = (state.falls[state.level] ?? 0) + 1);
    state.restUntil[state.level] = now + Math.min(LONGEST_REST, REST * 2 ** (falls - 1));
    change(state, typical > CRAWLING ? 0 : at - 1);
  } else if (state.fluent >= EVIDENCE && at + 1 < LEVELS.length && now >= (state.restUntil[LEVELS[at + 1]] ?? 0)) {
    change(state, at + 1);
  }
  return state;
}

function change(state, to) {
  state.level = LEVELS[to];
  state.fluent = 0;
  state.skip = SETTLE;
}
