// Films and sounds of an exhibit. A player is rebuilt only when its files change: a new caption must not restart a film.

import { el, setAttribute } from "../elements.js";

const signatureOf = (items) =>
  JSON.stringify(items.map(({ sources, poster }) => [sources.map(({ url }) => url), poster]));

function player(kind, item, onSounding) {
  const media = el(kind, {
    controls: true,
    preload: "metadata",
    poster: kind === "video" ? item.poster : null,
    playsinline: kind === "video",
    testid: kind,
  });
  media.append(...item.sources.map(({ url, type }) => el("source", { src: url, type })));
  // One voice at a time: whatever else plays in the panel stops, the hall's music steps back.
  media.addEventListener("play", () => {
    for (const other of document.querySelectorAll("#hall-ui video, #hall-ui audio"))
      if (other !== media) other.pause();
    onSounding(!media.muted);
  });
  media.addEventListener("volumechange", () => media.paused || onSounding(!media.muted));
  for (const end of ["pause", "ended", "emptied"]) media.addEventListener(end, () => onSounding(false));
  return media;
}

/** One medium with its caption, its transcript and what is shown when no source can be played. */
function createItem(words, kind, item, onSounding) {
  const media = player(kind, item, onSounding);
  const caption = el("p", { class: "media-caption" });
  const summary = el("summary");
  const transcript = el("div", { class: "transcript-text" });
  const details = el("details", { class: "transcript", testid: "transcript" }, summary, transcript);
  const trouble = el("p", { class: "media-trouble", hidden: true });
  // The browser has tried every source once the last one reports an error.
  media.lastElementChild?.addEventListener("error", () => {
    trouble.hidden = false;
    media.hidden = true;
  });

  function render(next) {
    media.setAttribute("aria-label", words.pick(next.alt) || words.pick(next.caption));
    caption.textContent = words.pick(next.caption);
    summary.textContent = words.t("panel.transcript");
    const spoken = words.pick(next.transcript);
    transcript.replaceChildren(...spoken.split(/\n{2,}/).map((text) => el("p", { text })));
    setAttribute(details, "hidden", !spoken);
    const links = next.sources.map(({ url, type }) =>
      el("a", {
        href: url,
        download: true,
        text: `${words.t("panel.download")} (${(type ?? "").split(/[/;]/)[1] ?? "…"})`,
      }),
    );
    const reason = kind === "video" ? "panel.no_video" : "panel.no_audio";
    trouble.replaceChildren(words.t(reason), ...links.flatMap((link) => [" ", link]));
  }

  return { element: el("div", { class: `medium ${kind}` }, media, trouble, caption, details), media, render };
}

/** A page of the panel; kind: "video" or "audio"; onSounding(true | false). */
export function createMediaPage(words, kind, onSounding) {
  const element = el("div", { class: "media" });
  let signature = "";
  let items = [];

  function render(detail) {
    const wanted = detail.media.filter((item) => item.kind === kind);
    const next = signatureOf(wanted);
    if (next !== signature) {
      silence();
      items = wanted.map((item) => createItem(words, kind, item, onSounding));
      element.replaceChildren(...items.map((item) => item.element));
    }
    signature = next;
    items.forEach((item, index) => item.render(wanted[index]));
  }

  function silence() {
    for (const { media } of items) media.pause();
  }

  return { element, render, silence, filled: () => items.length > 0 };
}

/**
 * The exhibit's first film above its text, muted: {element, render(detail), play(wanted), silence}. play(true) shows
 * and starts it; for whoever asked the system for less motion it stands still until it is started by hand.
 */
export function createClip(words, onSounding) {
  const element = el("div", { class: "clip", testid: "clip", hidden: true });
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let signature = "";
  let media = null;

  function render(detail) {
    const film = detail.media.find((item) => item.kind === "video");
    const next = film ? signatureOf([film]) : "";
    if (next !== signature) {
      media?.pause();
      media = film ? player("video", film, onSounding) : null;
      element.replaceChildren(...(media ? [media] : []));
      // What this browser cannot play is told on the film's own page.
      media?.lastElementChild?.addEventListener("error", () => (element.hidden = true));
    }
    signature = next;
    media?.setAttribute("aria-label", words.pick(film.alt) || words.pick(film.caption));
  }

  function play(wanted) {
    setAttribute(element, "hidden", !wanted || !media);
    if (element.hidden) return;
    media.muted = true; // the hall's music goes on, and browsers let a silent film start
    media.currentTime = 0;
    if (!calm.matches) media.play().catch(() => {}); // a refusal leaves it ready to be started by hand
  }

  return { element, render, play, silence: () => media?.pause() };
}
