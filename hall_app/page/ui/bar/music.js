// Background music: starts with the visitor's first gesture, remembers on/off and volume, steps back while a film sounds.

import { recall, remember } from "../words.js";

const ON = "hall.music";
const VOLUME = "hall.volume";
const FADE = 0.9; // seconds from silence to full volume
const DUCKED = 0.15;

/** The first format this browser plays, or "". scene.music_sources: [{url, type}]; scene.music: one address or null. */
function playable(audio, { music_sources: sources, music }) {
  const found = sources?.find(({ type }) => audio.canPlayType(type));
  const url = found?.url ?? music;
  return url ? new URL(url, location.href).href : "";
}

/** createMusic(scene) -> {on, volume, available, start, toggle, setVolume, duck, updateScene, follow} */
export function createMusic(scene) {
  const audio = new Audio();
  audio.loop = true;
  audio.preload = "none";
  const listeners = new Set();
  let entered = false;
  let ducked = false;
  let timer = 0;
  const stored = Number.parseFloat(recall(VOLUME) ?? "");
  const music = {
    on: recall(ON) !== "off",
    volume: stored >= 0 && stored <= 1 ? stored : 0.5,
    available: false,
    follow(listener) {
      listeners.add(listener);
      listener();
    },
  };
  const tell = () => listeners.forEach((listener) => listener());

  /** Moves the loudness to its goal in small steps; a jump clicks in the loudspeaker. */
  function fade() {
    clearInterval(timer);
    timer = setInterval(() => {
      const goal = music.on ? music.volume * (ducked ? DUCKED : 1) : 0;
      const step = 0.04 / FADE;
      const next = audio.volume + Math.max(-step, Math.min(step, goal - audio.volume));
      audio.volume = Math.max(0, Math.min(1, next));
      if (Math.abs(goal - audio.volume) > 1e-3) return;
      clearInterval(timer);
      if (goal === 0 && !music.on) audio.pause();
    }, 40);
  }

  async function play() {
    if (!music.available || !music.on || !entered) return;
    if (audio.paused) audio.volume = 0;
    try {
      await audio.play();
      fade();
    } catch (error) {
      // No gesture counted yet: the next one starts it. Any other failure leaves the hall silent, which is harmless.
      if (error.name === "NotAllowedError") addEventListener("pointerdown", play, { once: true });
    }
  }

  music.start = () => {
    entered = true;
    return play();
  };
  music.toggle = () => {
    music.on = !music.on;
    remember(ON, music.on ? "on" : "off");
    if (music.on) play();
    else fade();
    tell();
  };
  music.setVolume = (value) => {
    music.volume = Math.max(0, Math.min(1, value));
    remember(VOLUME, music.volume);
    if (!audio.paused) fade();
    tell();
  };
  music.duck = (value) => {
    ducked = value;
    if (!audio.paused) fade();
  };
  music.updateScene = (next) => {
    const url = playable(audio, next);
    if (url === audio.src) return;
    if (url) audio.src = url;
    else audio.removeAttribute("src");
    music.available = Boolean(url);
    play();
    tell();
  };
  music.updateScene(scene);
  return music;
}
