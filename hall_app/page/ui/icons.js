// Line icons of the overlay, drawn by us on a 24 x 24 grid.

import { svg } from "./elements.js";

const PATHS = {
  close: "M6 6 18 18 M18 6 6 18",
  help: "M9 9.2a3 3 0 1 1 4.4 2.6c-.9.5-1.4 1.1-1.4 2.2 M12 17.4v.2",
  list: "M4.5 6.5h3v3h-3z M4.5 14.5h3v3h-3z M11 8h8.5 M11 16h8.5",
  map: "M4 6.5 9.3 4.5v13L4 19.5z M9.3 4.5 14.7 6.5v13L9.3 17.5 M14.7 6.5 20 4.5v13L14.7 19.5",
  fold: "M6 9.5 12 15.5 18 9.5",
  music:
    "M9.5 17.5V6l8.5-1.8v11.3 M9.5 17.5a2.5 2.2 0 1 1-5 0 2.5 2.2 0 0 1 5 0z M18 15.5a2.5 2.2 0 1 1-5 0 2.5 2.2 0 0 1 5 0z",
  mute: "M9.5 17.5V6l8.5-1.8v11.3 M9.5 17.5a2.5 2.2 0 1 1-5 0 2.5 2.2 0 0 1 5 0z M18 15.5a2.5 2.2 0 1 1-5 0 2.5 2.2 0 0 1 5 0z M4 4 20.5 20.5",
  pause: "M8.5 5.5v13 M15.5 5.5v13",
  play: "M8 5 18.5 12 8 19z",
  enlarge: "M13.5 4.5h6v6 M19.5 4.5 13 11 M10.5 19.5h-6v-6 M4.5 19.5 11 13",
  previous: "M14.5 5.5 8 12l6.5 6.5",
  next: "M9.5 5.5 16 12l-6.5 6.5",
  walk: "M13.2 4.6v.2 M12.6 8.4 10.6 13l3 2.4.8 4.6 M10.6 13 9.4 16.6 6.8 20 M12.6 8.4l-3.2 1.2-1 2.8 M12.6 8.4l1.9 2.5 2.9.9",
  survey: "M6 4h12v16H6z M9 8.5h6 M9 12h6 M9 15.5h3.5",
  settings: "M4 8h9.5 M18.5 8H20 M4 16h1.5 M10.5 16H20 M18.5 8a2.5 2.5 0 1 1-5 0 2.5 2.5 0 0 1 5 0z M10.5 16a2.5 2.5 0 1 1-5 0 2.5 2.5 0 0 1 5 0z",
  keep: "M7 4.5h10v15.5l-5-4.2-5 4.2z",
  check: "M5 12.5 10 17.5 19.5 7",
};

/** An inline icon that takes the colour of the text around it. */
export function icon(name) {
  const shape = { d: PATHS[name], fill: "none", stroke: "currentColor", "stroke-width": 1.8 };
  return svg(
    "svg",
    { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", focusable: "false" },
    svg("path", { ...shape, "stroke-linecap": "round", "stroke-linejoin": "round" }),
  );
}
