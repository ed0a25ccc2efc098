// Exhibits that move by a clip: each is fetched when it is first seen (again after a while where the line was lost), read
// once, and plays where it is seen, in the hall and in its close-up, whose finer model has a clip of its own.

import { createPresence, inSight } from "../sight.js";
import { readClip } from "./clip_file.js";
import { createPlayback } from "./playback.js";

/** The nodes of the model in the close-up, and of what it compares there. */
export const CLOSEUP = "/closeup", COMPARISON = "/comparison";
const SOONEST = 2e3, LONGEST = 60e3; // [ms] until what did not come is asked for again, longer every time

async function fetched(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer.arrayBuffer();
}

/**
 * createClips({clock, wake}) -> {frame(scene, {x, z, yaw}, opened, compared), playing(), shown(exhibit)}
 *
 * frame() is called ahead of every picture; opened: id of the exhibit in the close-up, or null; compared: null, or
 * {clip: its address, or null} of what the close-up compares instead. playing(): nodes that a
 * clip has been written into; shown(): the frame that an exhibit shows in its close-up, null where its
 * clip does not move that.
 */
export function createClips({ clock, wake }) {
  const present = createPresence();
  const clips = new Map(); // address -> {clip: null while it comes, nodes: node -> playback, tries, again: when [ms]}
  clock.watch(() => wake());

  async function load(url, entry) {
    const data = await fetched(url).catch((error) => {
      console.warn("an exhibit stands still for now:", error);
      entry.again = performance.now() + Math.min(LONGEST, SOONEST * 2 ** entry.tries++);
    });
    if (!data) return;
    try {
      entry.clip = await readClip(data);
      wake();
    } catch (error) {
      console.warn("an exhibit stands still:", error);
    }
  }

  function play(motion, node) {
    if (clock.stopped && !clips.has(motion)) return; // nothing is fetched for who wants no motion
    const entry = clips.get(motion) ?? { clip: null, nodes: new Map(), tries: 0, again: 0 };
    clips.set(motion, entry);
    if (performance.now() >= entry.again) {
      entry.again = Infinity;
      load(motion, entry);
    }
    const { clip, nodes } = entry;
    if (!clip) return;
    if (!nodes.has(node)) nodes.set(node, createPlayback(clip, node));
    nodes.get(node).frame(clock.seconds(), true);
    if (!clock.stopped) wake();
  }

  return {
    frame(scene, from, opened, compared) {
      if (document.hidden || !present()) return;
      if (compared) {
        if (compared.clip) play(compared.clip, COMPARISON);
        return;
      }
      for (const exhibit of scene.exhibits) {
        const { id, motion, close_motion } = exhibit;
        if (!motion) continue;
        if (id === opened) play(close_motion ?? motion, CLOSEUP);
        else if (opened === null && inSight(exhibit, from)) play(motion, `/exhibits/${id}`);
      }
    },
    playing: () => [...clips.values()].flatMap(({ nodes }) => [...nodes].filter(([, one]) => one.bound()).map(([node]) => node)),
    shown: ({ motion, close_motion }) => clips.get(close_motion ?? motion)?.nodes.get(CLOSEUP)?.shown() ?? null,
  };
}
