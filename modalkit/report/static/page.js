// The report in the browser: every chart is drawn where it stands, structures in space once they come into view.

import { chart } from "./chart.js";
import { fill, h } from "./dom.js";

const moving = new Set();

/** Draw all figures of the data. */
export function begin(data, load) {
  for (const given of data.charts) chart(document.getElementById(given.name), given);
  const watcher = new IntersectionObserver(
    (entries) => {
      for (const entry of entries.filter((e) => e.isIntersecting)) {
        watcher.unobserve(entry.target);
        space(entry.target, data.space[entry.target.id], load);
      }
    },
    { rootMargin: "300px" },
  );
  for (const id of Object.keys(data.space)) watcher.observe(document.getElementById(id));
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  scheme.addEventListener("change", () => moving.forEach((one) => one.recolour()));
}

/** Put a structure into its figure. */
async function space(figure, given, load) {
  const place = figure.querySelector(".space");
  try {
    const made =
      given.kind === "moving"
        ? (await load("viewer.js")).viewer(place, { kept: true })
        : (await load("structure.js")).structure(place, { kept: true });
    made.show(given.page);
    if (made.list) place.append(made.list);
    moving.add(made);
  } catch (error) {
    fill(place, h("p", { class: "muted" }, "This browser cannot draw in three dimensions."));
    console.warn(error);
  }
}
