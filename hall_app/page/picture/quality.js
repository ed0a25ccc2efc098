// Picture quality: resolution, sharpness of slanted textures, reflections. The visitor's choice, or the judge's.

import { drawAt, framesDrawn, meshesOf, nodeNames, seenFrom } from "../viser/viser_adapter.js";
import { layerBeneath } from "./behind.js";
import { boxAbout, drawSeen, ownBox } from "./hidden.js";
import { judge, LEVELS, newJudgement } from "./judge.js";
import { aimLamp } from "./lamp.js";
import { awayFrom, showLevel } from "./levels.js";
import { layLight, plainTones, reflect, sharpen } from "./light.js";
import { shadeBySight } from "./sides.js";
import { gleam } from "./silk.js";

export const CHOICES = ["auto", ...LEVELS];
const { recall, remember } = window.HALL.memory;
const CLOSE = ["/closeup", "/comparison"]; // nodes of what is seen from close by
const CHOSEN = "hall.quality", FOUND = "hall.quality.found";

const SETTINGS = {
  low: { anisotropy: 1, blend: false, reflections: false },
  medium: { anisotropy: 4, blend: true, reflections: false },
  high: { anisotropy: 8, blend: true, reflections: true },
};

/** Pixels drawn per CSS pixel, of a screen with `ratio` of them. */
export function resolution(level, ratio) {
  const high = Math.min(ratio, 2);
  const medium = Math.min(high, Math.max(1, 0.75 * high));
  return { low: Math.min(medium, Math.max(0.66, 0.5 * high)), medium, high }[level];
}

/** createQuality(shown, onChange) -> {choice, level, choose, frame}; shown() is the scene as it is described now;
 *  onChange() when choice or level is another. */
export function createQuality(shown, onChange = () => {}) {
  let choice = CHOICES.includes(recall(CHOSEN)) ? recall(CHOSEN) : "auto";
  const found = LEVELS.includes(recall(FOUND)) ? recall(FOUND) : null;
  const first = found ?? (window.HALL.softwareDraws() ? "low" : "medium"); // no use in finding that out by trial
  let judgement = newJudgement(first, { now: performance.now(), cautious: Boolean(found) });
  let last = null, drawn = framesDrawn(), running = false;
  const level = () => (choice === "auto" ? judgement.level : choice);

  /** Time between two pictures that followed each other without a rest. */
  function watch(now) {
    const count = framesDrawn(), drew = count !== drawn;
    drawn = count;
    if (drew && running && last !== null && choice === "auto") {
      const before = judgement.level;
      judge(judgement, now - last, now);
      if (judgement.level !== before) {
        remember(FOUND, judgement.level);
        onChange();
      }
    }
    running = drew;
    last = now;
  }

  return {
    get choice() { return choice; },
    get level() { return level(); },
    choose(next) {
      if (!CHOICES.includes(next)) return;
      choice = next;
      remember(CHOSEN, next);
      onChange();
    },
    /** Ahead of every picture: viser's client and a changed content bring new meshes and put old settings back. */
    frame(now) {
      watch(now);
      const { anisotropy, blend, reflections } = SETTINGS[level()], { exhibits, opaque } = shown();
      const room = meshesOf("/room");
      plainTones();
      layLight(room);
      reflect(reflections);
      sharpen(room, anisotropy, blend);
      const eye = seenFrom();
      if (eye) {
        drawSeen(room, opaque, eye, ownBox);
        drawSeen(meshesOf("/studio"), [], eye, boxAbout);
      }
      for (const name of nodeNames()) {
        if (!name.startsWith("/exhibits/") && !CLOSE.includes(name)) continue;
        const meshes = meshesOf(name);
        sharpen(meshes, anisotropy, blend);
        shadeBySight(meshes);
        gleam(meshes, blend);
        const lit = exhibits.find((exhibit) => name === `/exhibits/${exhibit.id}`);
        if (lit) aimLamp(meshes, lit);
        if (CLOSE.includes(name)) continue;
        layerBeneath(meshes);
        showLevel(meshes, awayFrom(name));
        if (eye) drawSeen(meshes, opaque, eye, boxAbout);
      }
      drawAt(resolution(level(), window.devicePixelRatio));
    },
  };
}
