"""What a page shows, measured: contrast of its texts, size of its targets, what lies over what."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

# Every visible run of text: where its letters stand and what colour they have. Text that is being faded out, or is
# meant for screen readers alone, is not seen.
TEXTS = """
() => {
  const found = [], range = document.createRange();
  const walker = document.createTreeWalker(document.querySelector("#hall-ui") ?? document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    if (!node.data.trim()) continue;
    const parent = node.parentElement;
    if (!parent.checkVisibility({opacityProperty: true, visibilityProperty: true}) || parent.closest(".unseen, style"))
      continue;
    if (document.querySelector("dialog[open]") && document.querySelector("#hall-ui") && !parent.closest("dialog[open]"))
      continue;
    range.selectNodeContents(node);
    const seen = [0, 0, innerWidth, innerHeight]; // of what scrolls, the part that shows
    for (let e = parent; e; e = e.parentElement) {
      if (getComputedStyle(e).overflow === "visible") continue;
      const b = e.getBoundingClientRect();
      [b.left, b.top].forEach((edge, i) => { seen[i] = Math.max(seen[i], edge); });
      [b.right, b.bottom].forEach((edge, i) => { seen[i + 2] = Math.min(seen[i + 2], edge); });
    }
    const boxes = [...range.getClientRects()].filter((b) => b.right <= innerWidth && b.bottom <= innerHeight)
      .map((b) => [Math.max(b.left, seen[0]), Math.max(b.top, seen[1]),
        Math.min(b.right, seen[2]), Math.min(b.bottom, seen[3])].map(Math.round));
    const inside = boxes.filter(([l, t, r, b]) => l >= 0 && t >= 0 && r <= innerWidth && b <= innerHeight
      && r > l && b > t && parent.contains(document.elementFromPoint((l + r) / 2, (t + b) / 2)));
    if (inside.length) found.push({text: node.data.trim().slice(0, 40), colour: getComputedStyle(parent).color,
      boxes: inside});
  }
  return found;
}
"""

# Only what lies behind the letters, over one plain colour in place of the hall.
BARE = """
(colour) => {
  const style = new CSSStyleSheet(); // an element would fall to the page's own policy
  style.replaceSync(`#root canvas { visibility: hidden }
    html:has(#hall-ui), body:has(#hall-ui), #root, #root * { background: ${colour} !important }
    * { transition: none !important; caret-color: transparent !important }
    #hall-ui, #hall-ui *, body:not(:has(#hall-ui)) * { color: transparent !important; text-shadow: none !important }
    #hall-ui svg, body:not(:has(#hall-ui)) svg { visibility: hidden }`);
  document.adoptedStyleSheets = [style];
}
"""

TARGETS = """
() => [...document.querySelectorAll(
    "#hall-ui :is(button, a[href], input, select, textarea, summary, [tabindex='0'], label, .plan, .stick)")]
  .filter((e) => e.checkVisibility({opacityProperty: true, visibilityProperty: true}) && !e.closest("[inert]"))
  .filter((e) => !document.querySelector("dialog[open]") || e.closest("dialog[open]"))
  // A field is as large as its label; a link within a sentence as large as its words.
  .filter((e) => !(e.matches("input") && e.closest("label")) && !e.matches("p a, li a, .prose a"))
  .map((e) => { const b = e.getBoundingClientRect();
    return {name: e.dataset.testid ?? e.className, width: b.width, height: b.height, left: b.left, right: b.right}; })
  .filter((e) => e.width > 0)
"""

# Pairs of things that lie over each other although neither holds the other; and what is wider than its place.
CROWDED = """
() => {
  const shown = (e) => e.checkVisibility({opacityProperty: true, visibilityProperty: true});
  const parts = [...document.querySelectorAll("#hall-ui :is(.brand, .tools, .map, .stick, .caption, .hints, .panel, "
    + ".problems, .connection, .toast)")].filter(shown).map((e) => [e.className, e.getBoundingClientRect()]);
  const over = [];
  for (let i = 0; i < parts.length; i++) for (let j = i + 1; j < parts.length; j++) {
    const [[a, p], [b, q]] = [parts[i], parts[j]];
    const across = p.left < q.right - 1 && q.left < p.right - 1;
    if (across && p.top < q.bottom - 1 && q.top < p.bottom - 1) over.push(`${a} | ${b}`);
  }
  const wide = [...document.querySelectorAll("#hall-ui, #hall-ui :is(.enter, .dialog-body, .panel-body, .tools, "
    + ".hints, .panel-foot, .button, .segment, .tool, .caption, .tabs, kbd)")].filter(shown)
    .filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.className || e.id);
  const inside = (p) => p.left > -1 && p.right < innerWidth + 1 && p.top > -1 && p.bottom < innerHeight + 1;
  const out = parts.filter(([, p]) => !inside(p)).map(([name]) => name);
  return {over, wide, out, page: document.documentElement.scrollWidth > innerWidth};
}
"""


def luminance(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative luminance (WCAG 2) of sRGB colours (..., 3) 0..255."""
    part = np.asarray(colour, float) / 255
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def contrast(text: NDArray[np.float64], ground: NDArray[np.float64]) -> NDArray[np.float64]:
    """Contrast ratio (WCAG 2) of a colour (3,) with each of the grounds (..., 3)."""
    a, b = luminance(text), luminance(ground)
    return (np.maximum(a, b) + 0.05) / (np.minimum(a, b) + 0.05)


def faint_texts(page, least: float = 4.5) -> list[str]:
    """Texts whose contrast with what lies behind them, over white or over black, is less than `least`."""
    texts = page.evaluate(TEXTS)
    assert texts, "no text to be seen"
    grounds = []
    for colour in ("#ffffff", "#000000"):
        page.evaluate(BARE, colour)
        shot = page.screenshot()
        grounds.append(np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), float))
    page.evaluate("() => { document.adoptedStyleSheets = []; }")
    faint = []
    for text in texts:
        *colour, alpha = _rgba(text["colour"])
        for ground in grounds:
            for left, top, right, bottom in text["boxes"]:
                behind = ground[top:bottom, left:right].reshape(-1, 3)
                seen = alpha * np.asarray(colour) + (1 - alpha) * behind
                worst = float(np.percentile(contrast(seen, behind), 2))
                if worst < least:
                    faint.append(f"{worst:.2f} {text['text']!r} {text['colour']} on {behind.mean(0).round()}")
    return faint


def _rgba(text: str) -> list[float]:
    """The computed colour 'rgb(r, g, b)' or 'rgba(r, g, b, a)'."""
    values = [float(part) for part in text[text.index("(") + 1 : -1].replace("/", ",").split(",")]
    return values if len(values) == 4 else [*values, 1.0]
