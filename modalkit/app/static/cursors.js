// Two cursors of a chart of FRFs: set by a click or by a number, read out beneath.

import { colour, fill, h } from "./dom.js";

const NAMES = ["A", "B"];
const states = new WeakMap(); // by chart: places [Hz], which comes next, its curves

/** Return the marks of a chart's cursors, and what sets the next of them at a place. */
export function cursors(element, curves, unit) {
  const state = states.get(element) ?? made(element);
  Object.assign(state, { curves, unit });
  read(state);
  return [marks(state), (x) => moved(element, state, state.next, x)];
}

function made(element) {
  const state = { places: [null, null], next: 0, out: h("span", { class: "muted", "aria-live": "polite" }) };
  state.inputs = NAMES.map((name, i) =>
    h("input", {
      type: "text",
      inputmode: "decimal",
      size: 8,
      "aria-label": `cursor ${name} [Hz]`,
      change: (event) => moved(element, state, i, Number.parseFloat(event.target.value)),
    }),
  );
  const fields = NAMES.map((name, i) => h("label", { class: "check" }, name, state.inputs[i], "Hz"));
  element.after(h("div", { class: "row cursors" }, fields, state.out));
  states.set(element, state);
  return state;
}

function moved(element, state, which, x) {
  const others = (element.layout.shapes ?? []).filter((one) => !NAMES.includes(one.name));
  state.places[which] = Number.isFinite(x) ? x : null;
  state.next = 1 - which;
  read(state);
  window.Plotly.relayout(element, { shapes: [...others, ...marks(state)] });
}

const marks = ({ places }) =>
  places.flatMap((x, i) =>
    x === null
      ? []
      : [
          {
            name: NAMES[i],
            type: "line",
            x0: x,
            x1: x,
            yref: "paper",
            y0: 0,
            y1: 1,
            line: { color: colour(i ? "green" : "red"), width: 1.2, dash: "dash" },
            label: { text: NAMES[i], textposition: "end", textangle: 0, font: { color: colour("ink"), size: 11 } },
          },
        ],
  );

/** Write frequency and value of every curve at both cursors, and how far these are apart. */
function read({ places, inputs, curves, unit, out }) {
  places.forEach((x, i) => (inputs[i].value = x === null ? "" : String(Number(x.toPrecision(7)))));
  const values = places.map((x) => (x === null ? null : curves.slice(0, MOST).map((one) => one.y[nearest(one.x, x)])));
  const lines = NAMES.flatMap((name, i) =>
    values[i] ? [`${name}: ${values[i].map((v, k) => `${curves[k].name} ${v?.toPrecision(4)}`).join(", ")} ${unit}`] : [],
  );
  if (values[0] && values[1]) {
    const level = 20 * Math.log10(values[1][0] / values[0][0]);
    lines.push(`B − A: ${Number((places[1] - places[0]).toPrecision(5))} Hz, ${curves[0].name} ${level.toFixed(2)} dB`);
  }
  fill(out, lines.length ? lines.join(" · ") : "click the chart to set a cursor");
}

const MOST = 4; // curves that are read out; levels are compared of the first

function nearest(x, at) {
  let best = 0;
  for (let i = 1; i < x.length; i++) if (Math.abs(x[i] - at) < Math.abs(x[best] - at)) best = i;
  return best;
}
