// Exhibits that move by a clip: each is fetched when it is first seen (again after a while where the line was lost), read
// once, and plays where it is seen, in the hall and in its close-up if that shows the same model.

import { createPresence, inSight } from "../sight.js";
import { readClip } from "./clip_file.js";
import { createPlayback } from "./playback.js";

const CLOSEUP = "/closeup";
const SOONEST = 2e3, LONGEST = 60e3; // [ms] until what did not come is asked for again, longer every time

async function fetched(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer.arrayBuffer();
}

/**
 * createClips({clock, wake}) -> {frame(scene, {x, z, yaw}, opened), playing()}
 *
 * frame() is called ahead of every picture; opened: id of the exhibit in the close-up, or null. playing(): nodes that a
 * clip has been written into.
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

  function play({ motion }, node) {
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
    frame(scene, from, opened) {
      if (document.hidden || !present()) return;
      for (const exhibit of scene.exhibits) {
        if (!exhibit.motion) continue;
        if (exhibit.id === opened) play(exhibit, CLOSEUP);
        else if (opened === null && inSight(exhibit, from)) play(exhibit, `/exhibits/${exhibit.id}`);
      }
    },
    playing: () => [...clips.values()].flatMap(({ nodes }) => [...nodes].filter(([, one]) => one.bound()).map(([node]) => node)),
  };
}
