// The questionnaire in a window: the survey's own page in a frame, which tells us when an answer is stored.

import { createDialog } from "./dialogs.js";
import { el } from "../elements.js";

/** createSurveyDialog({words, onSubmitted}) -> {element, open(questionnaire, exhibit | null), close} */
export function createSurveyDialog({ words, onSubmitted }) {
  const dialog = createDialog({ words, titleKey: "survey.title", testid: "survey-dialog", kind: "survey" });
  const wait = words.text(el("p", { class: "survey-wait" }), "survey.loading");
  let frame = null;
  let asked = null;

  function load({ questionnaire, exhibit, lang }) {
    const query = new URLSearchParams({ lang, ...(exhibit ? { exhibit } : {}) });
    frame = el("iframe", {
      class: "survey-frame",
      testid: "survey-frame",
      src: `/questionnaires/${encodeURIComponent(questionnaire)}?${query}`,
    });
    frame.title = words.t("survey.title");
    frame.addEventListener("load", () => (wait.hidden = true));
    wait.hidden = false;
    dialog.body.replaceChildren(wait, frame);
  }

  addEventListener("message", (event) => {
    if (event.origin !== location.origin || event.source !== frame?.contentWindow) return;
    // A frame keeps its keys to itself, so the form passes Esc on; its thanks lead back by closing the window.
    if (event.data?.type === "survey-escape" || event.data?.type === "survey-close") dialog.close();
    if (event.data?.type !== "survey-submitted") return;
    asked = { ...asked, done: true };
    onSubmitted(asked.exhibit);
  });

  /** Half-filled answers stay when the window is closed and opened again for the same exhibit in the same language. */
  function open(questionnaire, exhibit) {
    const next = { questionnaire, exhibit, lang: words.lang };
    const same = asked && !asked.done && Object.keys(next).every((key) => asked[key] === next[key]);
    if (!same) {
      asked = next;
      load(next);
    }
    dialog.open();
  }

  return { element: dialog.element, open, close: dialog.close };
}
