// A chart made of data: drawn as wide as its place, its numbers read by mouse, finger or arrow keys, and handed over.

import { button, fill, h, select } from "./dom.js";
import { s, mark } from "./marks.js";
import { plot } from "./plot.js";
import { hand, near, stops, table } from "./reading.js";

/** Draw a chart in a figure, and again whenever its width changes. */
export function chart(figure, given) {
  const place = figure.querySelector(".plot");
  const state = { chosen: 0, at: -1, stops: null };
  const tip = h("div", { class: "tip", hidden: true });
  const heard = h("p", { class: "unseen", "aria-live": "polite" });
  const legend = h("p", { class: "key" });
  const tools = h("div", { class: "tools" });
  place.before(legend);
  place.after(heard, tools);
  place.append(tip);
  if (given.choices)
    legend.before(
      h(
        "label",
        { class: "choice" },
        `${given.choices.name} `,
        select(
          given.choices.items.map((item, i) => [i, item.name]),
          0,
          (value) => {
            state.chosen = Number(value);
            draw();
          },
        ),
      ),
    );
  tools.append(button("Data (CSV)", () => hand(`${given.name}.csv`, table(given)), { class: "small" }));

  function draw() {
    const drawn = plot(place, given, state.chosen);
    Object.assign(state, { drawn, stops: null, at: -1 });
    tip.hidden = true;
    fill(legend, key(drawn.series));
    drawn.svg.addEventListener("pointermove", (event) => show(near(given, drawn, event)));
    drawn.svg.addEventListener("pointerdown", (event) => show(near(given, drawn, event)));
    drawn.svg.addEventListener("pointerleave", () => show(null));
    drawn.svg.addEventListener("keydown", keyed);
    drawn.svg.addEventListener("blur", () => show(null));
  }

  function show(found) {
    tip.hidden = !found;
    state.ring?.remove();
    if (!found) return;
    state.ring = s("circle", { cx: found.x, cy: found.y, r: 7, class: "ring" });
    state.drawn.svg.append(state.ring);
    fill(
      tip,
      found.lines.map((text, i) => h(i ? "div" : "strong", {}, text)),
    );
    const room = place.clientWidth - tip.offsetWidth - 4;
    tip.style.left = `${Math.max(4, Math.min(found.x + 12, room))}px`;
    tip.style.top = `${found.y + 14}px`;
  }

  function keyed(event) {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (event.key === "Escape") show(null);
    if (!step) return;
    event.preventDefault();
    const all = (state.stops ??= stops(given, state.drawn));
    if (!all.length) return;
    state.at = (state.at + step + all.length) % all.length;
    const found = all[state.at];
    show(found);
    fill(heard, found.lines.join("; "));
  }

  let width = 0;
  new ResizeObserver(() => {
    if (Math.abs(place.clientWidth - width) < 2) return;
    width = place.clientWidth;
    draw();
  }).observe(place);
  draw();
}

/** Return the key: a sign and a name for each series that has one. */
function key(series) {
  const seen = new Set();
  return series
    .filter((one) => one.name && !one.unnamed && !seen.has(one.name) && seen.add(one.name))
    .map((one) => {
      const svg = s("svg", { viewBox: "0 0 22 12", width: 22, height: 12, "aria-hidden": "true" });
      const at = { x: { at: (v) => v, step: 0 }, y: { at: (v) => v, step: 14 } };
      const sign = { ...one, error: null, colours: null, x: [11], y: [6] };
      if (one.kind === "line") mark(svg, { ...sign, x: [1, 21], y: [6, 6] }, at);
      else if (one.kind === "links") mark(svg, { ...sign, y: [6], low: [2], high: [20] }, at);
      else if (one.kind === "bands") mark(svg, { ...sign, low: [2], high: [20] }, at);
      else if (one.kind === "points") mark(svg, sign, at);
      else svg.append(s("rect", { x: 3, y: 1, width: 16, height: 10, class: `fill ${one.colour}` }));
      return h("span", {}, svg, ` ${one.name}`);
    });
}
