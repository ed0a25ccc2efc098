// The door: the Enter screen as the server wrote it, in both languages, at once. Its first paint waits for nothing but
// the page itself; then this fetches what is large, says truly how far it is, and offers to try again where it fails.
// No module: it stands in the page. Everything later finds it as HALL.door.
(() => {
  const settings = JSON.parse(document.getElementById("hall-settings").textContent);
  const { texts, files } = settings;
  const root = document.documentElement;
  const screen = document.querySelector(".enter"); // kept: whoever is in the hall may still change the language
  const find = (selector) => screen.querySelector(selector);
  const PIECE_TRIES = 4; // again, after 1, 2, 4 and 8 s
  const SILENCE = 45000; // [ms] without a byte, while some are awaited, that count as a failure

  // --- memory and language -------------------------------------------------------------------------------------

  /** localStorage may be forbidden (private windows, embedded pages); the hall then forgets, but works. */
  const memory = {
    recall(key) {
      try {
        return localStorage.getItem(key);
      } catch {
        return null;
      }
    },
    remember(key, value) {
      try {
        localStorage.setItem(key, String(value));
      } catch {
        // forgetting is fine
      }
    },
  };

  /** The address' language, the remembered one, the browser's or the hall's. */
  function chosenLanguage() {
    const asked = [new URLSearchParams(location.search).get("lang"), memory.recall("hall.lang")];
    return [...asked, navigator.language.slice(0, 2)].find((lang) => lang in texts) ?? settings.language;
  }

  let lang = chosenLanguage();

  /** The address keeps the language where it has named one: it is stronger than the remembered one on the next visit. */
  function nameLanguage() {
    const url = new URL(location.href);
    if (!url.searchParams.has("lang") || url.searchParams.get("lang") === lang) return;
    url.searchParams.set("lang", lang);
    history.replaceState(history.state, "", url);
  }

  /** Style shows the words of the document's language; what only one attribute holds is set here. */
  function speak(next) {
    lang = next;
    nameLanguage();
    root.lang = texts[lang].tag;
    document.title = settings.title[lang];
    find(".enter-bar").setAttribute("aria-label", texts[lang].progress);
    find(".segments")?.setAttribute("aria-label", texts[lang].language);
    for (const button of screen.querySelectorAll(".segment"))
      button.setAttribute("aria-pressed", String(button.dataset.testid === `lang-${lang}`));
  }

  /** Fill the pair of spans in `node` with {zh, en}. */
  function pair(node, said) {
    for (const span of node.querySelectorAll(":scope > [data-in]")) span.textContent = said[span.dataset.in];
  }

  // --- progress and failure ------------------------------------------------------------------------------------

  // In the order in which they are named: what is first and not finished is what is being loaded.
  const parts = [
    { name: "viewer", weight: files.viewer.weight, done: 0 },
    { name: "models", weight: files.models.weight, done: 0 },
    { name: "drawing", weight: 0.15 * (files.viewer.weight + files.models.weight), done: 0 },
  ];
  const all = parts.reduce((sum, part) => sum + part.weight, 0);
  let held = null, saying = null, shown = 0, failed = null, flowed = performance.now(), awaited = 0;

  /** Show `fraction` 0…1, never less than before, and {zh, en} of what is being done. */
  function show(fraction, said) {
    shown = Math.max(shown, Math.floor(100 * Math.min(1, fraction)));
    find(".enter-fill").style.transform = `scaleX(${shown / 100})`;
    find(".enter-bar").setAttribute("aria-valuenow", shown);
    find(".enter-percent").textContent = `${shown} %`;
    saying = said;
    hold(held);
  }

  /** Say {zh, en} in place of the progress, null no longer. */
  function hold(said) {
    held = said;
    screen.classList.toggle("is-held", held !== null);
    pair(find("[data-testid=progress-label]"), held ?? saying);
  }

  const both = (group, key) => ({ zh: texts.zh[group][key], en: texts.en[group][key] });

  /** So much of a part (0…1) is there. */
  function progress(name, fraction) {
    const part = parts.find((candidate) => candidate.name === name);
    part.done = Math.max(part.done, Math.min(1, fraction));
    const now = parts.find((candidate) => candidate.done < 1) ?? parts.at(-1);
    const sum = parts.reduce((total, { weight, done }) => total + weight * done, 0);
    show(Math.min(0.99, sum / all), both("loading", now.name));
  }

  /** reason: "load", "webgl" or any wording; null takes the notice away. */
  function fail(reason) {
    failed = reason;
    find(".enter-trouble").hidden = reason === null;
    screen.classList.toggle("is-failed", reason !== null);
    for (const part of [find(".enter-bar"), find(".enter-state")]) part.hidden = reason !== null;
    if (reason === null) return;
    find("[data-testid=enter]").disabled = true;
    const known = reason in texts.zh.fail;
    pair(find(".enter-reason"), known ? both("fail", reason) : { zh: reason, en: reason });
  }

  function failedToLoad(error) {
    console.error(error);
    if (failed === null) fail("load");
  }

  // --- fetching ------------------------------------------------------------------------------------------------

  async function ask(url, options) {
    const answer = await fetch(url, options);
    if (!answer.ok) throw Object.assign(new Error(`${url}: ${answer.status}`), { status: answer.status });
    return answer;
  }

  /** Read an answer as it comes; heard(chunk, bytes so far, bytes in all or 0). */
  async function read(url, heard) {
    awaited += 1;
    try {
      const answer = await ask(url);
      const coded = answer.headers.has("content-encoding");
      const total = coded ? 0 : Number(answer.headers.get("content-length"));
      const reader = answer.body.getReader();
      for (let got = 0; ; ) {
        const { done, value } = await reader.read();
        flowed = performance.now();
        if (done) break;
        got += value.length;
        heard(value, got, total);
      }
    } finally {
      awaited -= 1;
    }
  }

  setInterval(() => {
    if (awaited && performance.now() - flowed > SILENCE) failedToLoad(new Error("no byte has come for a long time"));
  }, 5000);

  /** viser's script into the browser's store, counted; run from there. */
  async function fetchViewer() {
    const { script, bytes } = files.viewer;
    await read(script, (chunk, got) => progress("viewer", got / bytes));
    progress("viewer", 1);
  }

  const pieces = new Map(); // name -> bytes
  const waiting = new Map(); // name -> call when it is there
  let index = null; // of the pack: [[name, bytes], …]

  /** The pack's index and frames, as far as they have come; show/pieces.py has the form. */
  async function fetchModels() {
    let data = new Uint8Array(files.models.weight * 2), at = 0, next = 0;
    await read(files.models.pack, (chunk, got, total) => {
      if (got > data.length) {
        const larger = new Uint8Array(Math.max(total, got * 2));
        larger.set(data);
        data = larger;
      }
      data.set(chunk, got - chunk.length);
      if (!index && got > 4) {
        const length = new DataView(data.buffer).getUint32(0, true);
        if (got < 4 + length) return;
        index = JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + length)));
        at = 4 + length;
      }
      for (; index && next < index.length && at + index[next][1] <= got; next += 1) {
        const [name, length] = index[next];
        pieces.set(name, data.slice(at, (at += length)));
        waiting.get(name)?.();
      }
      progress("models", total ? got / total : 0.5 * (1 - Math.exp(-got / files.models.weight)));
    });
    progress("models", 1);
  }

  /** The bytes of a piece: of the pack, or fetched by its name once that is there. */
  async function piece(name) {
    if (!pieces.has(name) && !settled) await new Promise((tell) => waiting.set(name, tell));
    if (pieces.has(name)) return pieces.get(name).buffer;
    for (let tried = 0; ; tried += 1)
      try {
        return await (await ask(`${files.models.piece}${name}`, { priority: "low" })).arrayBuffer();
      } catch (error) {
        // Without it the whole scene would begin anew.
        if (tried === PIECE_TRIES || error.status === 404) throw error;
        await new Promise((done) => setTimeout(done, 1000 * 2 ** tried));
      }
  }

  function element(tag, attributes, ahead = null) {
    const made = Object.assign(document.createElement(tag), attributes);
    const done = new Promise((loaded, broken) => {
      made.onload = loaded;
      made.onerror = () => broken(new Error(`${attributes.src ?? attributes.href} did not load`));
    });
    document.head.insertBefore(made, ahead);
    return done;
  }

  /** Ahead of the style that stands in the page, as they would be if it took them in. */
  const style = (href) => element("link", { rel: "stylesheet", href }, document.getElementById("hall-style"));

  let settled = false; // the pack is there, or will not come
  const fetched = fetchViewer();
  const models = fetchModels().finally(() => {
    settled = true;
    for (const tell of waiting.values()) tell();
  });
  const json = async (url) => (await ask(url, { cache: "no-cache" })).json();
  const decoder = ask(files.viewer.decoder)
    .then((answer) => answer.arrayBuffer())
    .then(WebAssembly.compile);
  const scene = json("/api/scene");
  const words = json("/api/texts");
  const ahead = element("script", { src: files.ahead });
  const page = element("script", { type: "module", src: files.page });
  const styles = Promise.all([style(files.rest), element("link", { rel: "stylesheet", href: files.viewer.style })]);
  const viewer = Promise.all([fetched, decoder, ahead, styles]).then(([, module]) => {
    window.HALL.giveDecoder(module); // viser/first.js
    return element("script", { type: "module", src: files.viewer.script });
  });
  for (const part of [viewer, models, scene, words, page]) part.catch(failedToLoad);

  window.HALL = {
    withoutHooks: settings.withoutHooks,
    memory,
    door: {
      viewer, models, scene, texts: words, piece,
      get lang() { return lang; },
      get failed() { return failed; },
      speak, pair, progress, show, hold, fail,
      /** The hall stands behind the door: the still picture goes. */
      open() {
        const still = document.getElementById("hall-still");
        still?.classList.add("is-gone");
        setTimeout(() => still?.remove(), 1000);
      },
    },
  };

  speak(lang);
  progress("viewer", 0);
  find("[data-testid=retry]").addEventListener("click", () => location.reload());
  for (const next of Object.keys(texts))
    find(`[data-testid=lang-${next}]`).addEventListener("click", () => {
      memory.remember("hall.lang", next);
      speak(next);
    });
})();
