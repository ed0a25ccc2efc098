// The questionnaire's page: keeps what was chosen, sends it, and goes on sending until it is committed.
// One answer has one id from the first click to the receipt, so that sending twice never makes two answers.
"use strict";

const settings = JSON.parse(document.getElementById("settings").textContent);
const words = settings.words;
const form = byId("form");
const KEY = `survey:${settings.id}:${settings.exhibit ?? ""}`;
const SENT = "survey-sent"; // [trace of an id, when it was sent], of all the questionnaires' tabs on this device
const KEPT_DAYS = 7; // an older draft is somebody else's on a shared device
const TIMEOUT = 15000; // [ms] until an unanswered request counts as lost
const WAITS = [2, 4, 8, 15, 30, 60]; // [s] between attempts

let draft = restored() ?? fresh();
let attempt = 0;
let timer = 0;

function byId(id) { return document.getElementById(id); }

// Items and modules may be called as JavaScript's own properties are: "constructor", "length".
function has(table, key) { return Object.prototype.hasOwnProperty.call(table, key); }

function radios(item) { return form.querySelectorAll(`input[name="score-${item}"]`); }

function say(key, values = {}) {
  return words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? ""));
}

function uuid() {
  // randomUUID exists on https and localhost only; a hall in a local network is plain http.
  if (crypto.randomUUID) return crypto.randomUUID();
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const hex = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})(.{12})$/, "$1-$2-$3-$4-$5");
}

// ---- the draft, kept on this device -------------------------------------------------------------------------

function fresh() { return { id: uuid(), saved: 0, scores: {}, suggestions: {}, pending: null }; }

function restored() {
  if (settings.preview) return null;
  try {
    const found = JSON.parse(localStorage.getItem(KEY));
    if (!found || Date.now() - found.saved > KEPT_DAYS * 86400e3 || wasSent(found.id)) return null;
    return { ...fresh(), ...found };
  } catch { return null; }
}

function keep() {
  if (settings.preview || wasSent(draft.id)) return;
  draft.saved = Date.now();
  // Storage may be full or forbidden; the page then works without it.
  try { localStorage.setItem(KEY, JSON.stringify(draft)); } catch { /* nothing to keep it in */ }
}

function forget() {
  if (!settings.preview) try { localStorage.removeItem(KEY); } catch { /* there was nothing */ }
  draft = fresh();
}

// An id is the code that withdraws its answer, so on a shared device only 32 bits of it stay behind.
function trace(id) {
  let hash = 0x811c9dc5; // FNV-1a
  for (const sign of id) hash = Math.imul(hash ^ sign.charCodeAt(0), 0x01000193) >>> 0;
  return hash;
}

function sentOnes() {
  try {
    return JSON.parse(localStorage.getItem(SENT)).filter(([, at]) => Date.now() - at < KEPT_DAYS * 86400e3);
  } catch { return []; }
}

function wasSent(id) {
  const mine = trace(id);
  return sentOnes().some(([one]) => one === mine);
}

function markSent(id) {
  const all = [...sentOnes().slice(-99), [trace(id), Date.now()]];
  try { localStorage.setItem(SENT, JSON.stringify(all)); } catch { /* the server tells an id that comes twice */ }
}

// Two tabs open the same draft. Once one has sent it, the other must not keep it for another go under the same id.
function dropSent() {
  if (settings.preview || draft.pending || !wasSent(draft.id)) return false;
  draft = restored() ?? fresh();
  fillIn();
  byId("consent").checked = false;
  byId("restored").hidden = byId("errors").hidden = true;
  remark([]);
  showState(words.sent_elsewhere, []);
  return true;
}

addEventListener("storage", (event) => { if (event.key === SENT) dropSent(); });

// ---- the form ------------------------------------------------------------------------------------------------

const items = [...form.querySelectorAll(".item")].map((element) => element.dataset.item);

function fillIn() {
  for (const item of items) {
    const value = has(draft.scores, item) ? String(draft.scores[item]) : null;
    for (const input of radios(item)) input.checked = input.value === value;
  }
  for (const field of form.querySelectorAll("textarea")) {
    const module = field.dataset.module;
    field.value = has(draft.suggestions, module) ? draft.suggestions[module] : "";
  }
  showProgress();
}

function readOut() {
  for (const item of items) {
    const chosen = [...radios(item)].find((input) => input.checked);
    if (chosen) draft.scores[item] = chosen.value === "null" ? null : Number(chosen.value);
  }
  for (const field of form.querySelectorAll("textarea")) {
    if (field.value.trim()) draft.suggestions[field.dataset.module] = field.value;
    else delete draft.suggestions[field.dataset.module];
  }
}

function showProgress() {
  const done = items.filter((item) => has(draft.scores, item)).length;
  byId("bar").style.width = `${(100 * done) / items.length}%`;
  const text = say("progress", { done, all: items.length });
  if (byId("count").textContent !== text) byId("count").textContent = text;
}

function mark(element, wrong, lacking) {
  element.classList.toggle("lacking", lacking);
  byId(wrong).hidden = !lacking;
}

function lacking() {
  const missing = settings.required.filter((item) => !has(draft.scores, item));
  return byId("consent").checked ? missing : [...missing, "consent"];
}

function remark(missing) {
  for (const item of items) mark(byId(`item-${item}`), `wrong-${item}`, missing.includes(item));
  mark(byId("consent-box"), "wrong-consent", missing.includes("consent"));
}

function showMissing(missing) {
  const box = byId("errors");
  const list = document.createElement("ul");
  for (const key of missing) {
    const link = document.createElement("a");
    const input = key === "consent" ? byId("consent") : radios(key)[0];
    link.href = key === "consent" ? "#consent-box" : `#item-${key}`;
    link.textContent = key === "consent" ? words.consent_title : labelOf(key);
    link.addEventListener("click", (event) => { event.preventDefault(); goTo(input); });
    const entry = document.createElement("li");
    entry.append(link);
    list.append(entry);
  }
  const title = document.createElement("strong");
  title.textContent = say("errors_title", { n: missing.length });
  box.replaceChildren(title, list);
  box.hidden = false;
  box.scrollIntoView({ block: "center" });
  box.focus({ preventScroll: true });
}

function labelOf(item) {
  const module = byId(`item-${item}`).closest("section").querySelector("h2");
  return `${module.lastChild.textContent} · ${byId(`label-${item}`).textContent}`;
}

function goTo(input) {
  (input.closest(".item, .consent") ?? input).scrollIntoView({ block: "center" });
  input.focus({ preventScroll: true });
}

form.addEventListener("input", () => {
  if (dropSent()) return;
  readOut();
  keep();
  showProgress();
  if (!byId("errors").hidden) {
    remark(lacking());
    byId("errors").hidden = lacking().length === 0;
  }
});

form.addEventListener("submit", (event) => {
  event.preventDefault();
  if (dropSent()) return;
  readOut();
  const missing = lacking();
  remark(missing);
  if (missing.length) return showMissing(missing);
  byId("errors").hidden = true;
  if (settings.preview) return showState(words.preview_done, []);
  draft.pending = {
    id: draft.id, version: settings.version, language: settings.language, consent: true,
    scores: Object.fromEntries(items.filter((item) => has(draft.scores, item)).map((item) => [item, draft.scores[item]])),
    suggestions: draft.suggestions,
    ...(settings.exhibit ? { exhibit: settings.exhibit } : {}),
  };
  keep();
  attempt = 0;
  send();
});

byId("restart").addEventListener("click", () => {
  forget();
  fillIn();
  byId("consent").checked = false;
  byId("restored").hidden = true;
  form.querySelector("input").focus();
});

// ---- sending -------------------------------------------------------------------------------------------------

async function send() {
  clearTimeout(timer);
  form.setAttribute("aria-busy", "true");
  form.inert = true;
  showState(words.sending, []);
  let response;
  try {
    response = await fetch(settings.submissions, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(draft.pending),
      signal: AbortSignal.timeout ? AbortSignal.timeout(TIMEOUT) : undefined,
    });
  } catch { return sendLater("offline"); }
  if (response.ok) return finish(null);
  // 409: an earlier attempt had arrived although its receipt was lost, and was edited since.
  if (response.status === 409) {
    const refusal = await explanation(response);
    return refusal.field === "id" ? finish(words.already) : giveBack(words.outdated, true);
  }
  if (response.status === 410) return finish(words.withdrawn_already);
  if (response.status >= 500 || response.status === 408 || response.status === 429) return sendLater("busy");
  const refusal = await explanation(response);
  if (refusal.field === "version") return giveBack(words.outdated, true);
  giveBack(say("refused", { problem: [refusal.field, refusal.problem, refusal.remedy].filter(Boolean).join(" – ") }));
}

async function explanation(response) {
  try { return await response.json(); } catch { return { problem: `HTTP ${response.status}` }; }
}

function sendLater(why) {
  let left = WAITS[Math.min(attempt, WAITS.length - 1)];
  attempt += 1;
  const buttons = [[words.retry, send], [words.edit, () => giveBack(null)]];
  const text = showState(say(why, { seconds: left }), buttons);
  const tick = () => {
    left -= 1;
    if (left <= 0) return send();
    text.textContent = say(why, { seconds: left });
    timer = setTimeout(tick, 1000);
  };
  timer = setTimeout(tick, 1000);
}

window.addEventListener("online", () => { if (draft.pending && form.inert) send(); });

// Back to the form with everything in it. The id stays: if an attempt had arrived after all, it is not doubled.
function giveBack(message, reload = false) {
  clearTimeout(timer);
  draft.pending = null;
  keep();
  form.removeAttribute("aria-busy");
  form.inert = false;
  if (dropSent()) return;
  if (message) showState(message, reload ? [[words.reload, () => location.reload()]] : []);
  else byId("state").hidden = true;
}

function showState(message, buttons) {
  const box = byId("state");
  const text = document.createElement("p");
  text.textContent = message;
  const row = document.createElement("div");
  row.className = "buttons";
  for (const [label, act] of buttons) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "plain";
    button.textContent = label;
    button.addEventListener("click", act);
    row.append(button);
  }
  box.replaceChildren(text, ...(buttons.length ? [row] : []));
  box.hidden = false;
  box.scrollIntoView({ block: "nearest" });
  return text;
}

function finish(note) {
  const code = draft.id;
  markSent(code);
  forget();
  form.hidden = true;
  form.inert = false;
  form.removeAttribute("aria-busy");
  for (const part of ["state", "restored"]) byId(part).hidden = true;
  document.querySelector(".progress").hidden = true;
  document.querySelector(".intro").hidden = true;
  byId("switch").hidden = true; // it loads the page anew, and the code would be gone
  byId("code").textContent = code;
  if (byId("keep-code")) byId("keep-code").value = code;
  byId("thanks-note").textContent = note ?? "";
  byId("thanks-note").hidden = !note;
  byId("thanks").hidden = false;
  byId("thanks-title").focus();
  window.scrollTo(0, 0);
  if (window.parent !== window) {
    window.parent.postMessage({ type: "survey-submitted", id: settings.id }, location.origin);
  }
}

// In the hall's window the hall is behind it: closing the window is the way back, and keeps the visitor's place.
byId("home")?.addEventListener("click", (event) => {
  if (window.parent === window) return;
  event.preventDefault();
  window.parent.postMessage({ type: "survey-close", id: settings.id }, location.origin);
});

byId("again").addEventListener("click", () => location.reload());

byId("copy").addEventListener("click", async () => {
  try { await navigator.clipboard.writeText(byId("code").textContent); } catch {
    getSelection().selectAllChildren(byId("code")); // plain http: the visitor copies what is now selected
    return;
  }
  byId("copy").textContent = words.copied;
});

// ---- taking an answer back -----------------------------------------------------------------------------------

byId("withdraw").addEventListener("submit", async (event) => {
  event.preventDefault();
  const code = byId("withdraw-code").value.trim();
  let told = "withdraw_failed";
  try {
    const response = await fetch(`${settings.submissions}/${encodeURIComponent(code)}`, { method: "DELETE" });
    if (response.ok) told = response.status === 202 ? "withdraw_soon" : "withdraw_done";
    else if (response.status === 409) told = "withdraw_frozen";
    else if (response.status < 500) told = "withdraw_unknown";
  } catch { /* no connection: told so */ }
  byId("withdraw-state").textContent = words[told];
});

// ---- start ---------------------------------------------------------------------------------------------------

if (window.parent !== window) {
  document.documentElement.classList.add("embedded");
  // A frame keeps its key presses to itself; the hall closes its dialog on this message.
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") window.parent.postMessage({ type: "survey-escape", id: settings.id }, location.origin);
  });
}
fillIn();
if (draft.pending?.version === settings.version) {
  byId("consent").checked = true;
  send();
} else {
  draft.pending = null;
  byId("restored").hidden = Object.keys(draft.scores).length + Object.keys(draft.suggestions).length === 0;
}
