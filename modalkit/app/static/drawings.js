// The charts of a result as its report has them, with their titles and their data to download.

import { get } from "./api.js";
import { chart } from "./chart.js";
import { fill, h } from "./dom.js";

/** Put charts of a result into an element, those of the names that it has; tell whether there are any. */
export function charted(root, drawings, names) {
  const found = names.map((name) => drawings?.charts[name]).filter(Boolean);
  figured(root, found);
  return found.length > 0;
}

/** Put charts into an element. */
export function figured(root, charts) {
  const figures = charts.map((given) => figure(given, "plot"));
  fill(root, figures);
  charts.forEach((given, i) => chart(figures[i], given));
}

/** Return a figure with its title and what it shows, and a place for the drawing. */
export function figure(given, kind) {
  return h(
    "figure",
    { class: "drawing", role: "group", "aria-label": given.title },
    h("figcaption", {}, h("strong", {}, given.title), h("span", {}, given.text)),
    h("div", { class: kind }),
  );
}

/** Put the user's own structure into an element, its regions coloured by where the cause sits. */
export async function placed(root, given) {
  const made = figure(given, "space");
  fill(root, made);
  try {
    const { structure } = await import("./structure.js");
    const view = structure(made.querySelector(".space"), {});
    view.show(given.page);
    return view;
  } catch {
    fill(made.querySelector(".space"), h("p", { class: "muted" }, "This browser cannot draw in three dimensions."));
    return null;
  }
}

/** Ask for the drawings of a result once: they stay the same as long as the state and the time of its end do. */
export function drawer(kind) {
  let kept = { mark: null, drawings: null };
  return async (mark) => {
    if (mark !== kept.mark) kept = { mark, drawings: await get("drawings", { kind }) };
    return kept.drawings;
  };
}
