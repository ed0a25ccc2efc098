// The interface language: one state for texts, captions, questionnaires and screen readers.

export const LANGUAGES = ["zh", "en"];

/** What the visitor chose, kept in the browser as far as it allows (door.js). */
export const recall = (key) => window.HALL.memory.recall(key);
export const remember = (key, value) => window.HALL.memory.remember(key, value);

/** texts: {zh: {group: {key: text}}, en: …} -> the words object every part of the overlay receives. */
export function createWords(texts, lang) {
  const listeners = new Set();
  const words = {
    lang,
    get other() {
      return words.lang === "zh" ? "en" : "zh";
    },
    /** The text of "group.key" with {name} filled in; an unknown key shows itself, so that it is noticed. */
    t(key, values = {}, lang = words.lang) {
      const [group, name] = key.split(".");
      const entry = name === undefined ? texts[lang]?.[group] : texts[lang]?.[group]?.[name];
      if (typeof entry !== "string") return key;
      return entry.replace(/\{(\w+)\}/g, (hole, field) => values[field] ?? hole);
    },
    has: (key) => words.t(key) !== key,
    /** Singular or plural of "count.<noun>" and the like. */
    count: (key, n) => words.t(`${key}_${n === 1 ? "one" : "other"}`, { n }),
    /** {zh, en} or a plain string -> text in the present language (or in the only one there is). */
    pick: (value, wanted = words.lang) =>
      value == null
        ? ""
        : typeof value === "object"
          ? value[wanted] || value.zh || value.en || ""
          : String(value),
    /** Calls `listener` now and whenever the language changes. */
    follow(listener) {
      listeners.add(listener);
      listener();
    },
    /** Keeps a node's text in the present language. */
    text(node, key) {
      words.follow(() => (node.textContent = words.t(key)));
      return node;
    },
    /** Keeps a node's aria-label and tooltip in the present language. */
    label(node, key) {
      words.follow(() => {
        node.setAttribute("aria-label", words.t(key));
        node.title = words.t(key);
      });
      return node;
    },
    setLang(next) {
      if (!LANGUAGES.includes(next) || next === words.lang) return false;
      words.lang = next;
      for (const listener of listeners) listener();
      return true;
    },
  };
  return words;
}
