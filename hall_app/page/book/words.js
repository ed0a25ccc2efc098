// Explains a word of the craft where it stands: by mouse, by keyboard, by touch; Escape takes it away (WCAG 1.4.13).
// Without this script a word is a link to the glossary, and the page's end lists what its words mean.
(() => {
  const tip = document.createElement("div");
  tip.id = "tip";
  tip.hidden = true;
  tip.setAttribute("role", "tooltip");
  document.querySelector("main").append(tip);
  let open = null; // the word that is explained
  let leaving = 0;

  const said = (word) => document.getElementById(`said-${word.dataset.word}`);

  function show(word) {
    const meaning = said(word);
    clearTimeout(leaving);
    if (!meaning || open === word) return;
    open = word;
    const name = document.createElement("b");
    name.textContent = [...meaning.previousElementSibling.childNodes].map((one) => one.textContent).join(" ");
    tip.replaceChildren(name, meaning.textContent);
    tip.hidden = false;
    place(word);
  }

  function place(word) {
    const line = word.getClientRects()[0] ?? word.getBoundingClientRect();
    const room = document.documentElement.clientWidth;
    const left = Math.max(16, Math.min(line.left, room - tip.offsetWidth - 16));
    const below = line.bottom + 8 + tip.offsetHeight < innerHeight || line.top < tip.offsetHeight + 16;
    tip.style.left = `${left + scrollX}px`;
    tip.style.top = `${(below ? line.bottom + 8 : line.top - tip.offsetHeight - 8) + scrollY}px`;
  }

  function hide() {
    clearTimeout(leaving);
    open = null;
    tip.hidden = true;
  }

  const soon = () => {
    clearTimeout(leaving);
    leaving = setTimeout(hide, 250); // time to move onto the explanation
  };

  for (const word of document.querySelectorAll("a.word")) {
    let touched = false;
    word.addEventListener("pointerenter", (event) => event.pointerType === "mouse" && show(word));
    word.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && soon());
    word.addEventListener("pointerdown", (event) => {
      touched = event.pointerType !== "mouse" && open !== word;
    });
    word.addEventListener("focus", () => show(word));
    word.addEventListener("blur", soon);
    word.addEventListener("click", (event) => {
      if (!touched || !said(word)) return; // the second touch follows the link
      touched = false;
      event.preventDefault();
      show(word);
    });
  }
  tip.addEventListener("pointerenter", () => clearTimeout(leaving));
  tip.addEventListener("pointerleave", soon);
  addEventListener("keydown", (event) => event.key === "Escape" && hide());
  addEventListener("pointerdown", (event) => open && !tip.contains(event.target) && event.target !== open && hide());
  addEventListener("resize", hide);
})();
