// The numbers of a chart: of the mark under the mouse, of all curves at a line, and all of them as CSV.

import { h } from "./dom.js";
import { written } from "./scales.js";

const REACH = 28; // pixels within which a mark is meant

/** Return what is said of a mark. */
function words(given, { series, i }) {
  if (series.text) return series.text[i].split("\n");
  const x = given.x.names ? given.x.names[series.x[i]] : `${given.x.title} ${written(series.x[i], 6)}`;
  const y = given.y.names ? given.y.names[series.y[i]] : `${given.y.title} ${written(series.y[i])}`;
  const error = series.error?.[i] ? ` ± ${written(series.error[i], 2)}` : "";
  return [series.name, given.y.names ? y : x, given.y.names ? x : y + error].filter(Boolean);
}

/** Return the mark nearest to the mouse, else what the curves are where it stands: {x, y, lines}; null over nothing. */
export function near(given, drawn, event) {
  const box = drawn.svg.getBoundingClientRect();
  const ratio = drawn.svg.viewBox.baseVal.width / box.width;
  const [px, py] = [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
  let best = null;
  for (const target of drawn.targets) {
    const distance = far(target, px, py);
    if (distance < (best?.distance ?? REACH)) best = { ...target, distance };
  }
  return best ? { ...best, lines: words(given, best) } : slide(given, drawn, px);
}

/** Return how far the mouse is from a mark; inside a cell all other marks come first. */
function far({ x, y, box }, px, py) {
  if (!box) return Math.hypot(x - px, y - py);
  const inside = px >= box.x && px <= box.x + box.width && py >= box.y && py <= box.y + box.height;
  return inside ? 0.5 * REACH : Infinity;
}

/** Return all curves at the line nearest to a pixel. */
function slide(given, { curves, scales, from, to }, px) {
  if (!curves.length || px < from - 4 || px > to + 4) return null;
  const nearest = (values, distance) =>
    values.reduce((best, v, i) => (distance(v) < distance(values[best]) ? i : best), 0);
  const first = curves[0];
  const best = nearest(first.x, (v) => Math.abs(scales.x.at(v) - px));
  const value = first.x[best];
  const at = (one) => (one.x === first.x ? best : nearest(one.x, (v) => Math.abs(v - value)));
  const heights = curves.map((one) => scales.y.at(one.y[at(one)] ?? NaN)).filter(Number.isFinite);
  const lines = curves.map((one) => `${one.name}: ${written(one.y[at(one)])}`);
  return {
    x: scales.x.at(value),
    y: heights.length ? Math.min(...heights) : 20,
    lines: [`${given.x.title} ${written(value, 6)}`, ...lines],
  };
}

/** Return what the arrow keys go through: all marks in their order, else the curves at sixty places. */
export function stops(given, drawn) {
  if (drawn.targets.length) {
    const order = given.y.names ? (a, b) => a.y - b.y || a.x - b.x : (a, b) => a.x - b.x;
    return [...drawn.targets].sort(order).map((target) => ({ ...target, lines: words(given, target) }));
  }
  const places = Array.from({ length: 60 }, (_, k) => drawn.from + ((drawn.to - drawn.from) * k) / 59);
  return places.map((px) => slide(given, drawn, px)).filter(Boolean);
}

/** Return the data of a chart as CSV, one row for each number drawn. */
export function table(given) {
  const rows = [["series", given.x.title || "x", given.y.title || "y", "low", "high", "value", "note"]];
  const put = (prefix, series) => {
    const count = (series.value ?? series.y).length;
    for (let i = 0; i < count; i += 1) {
      const x = (series.x ?? given.choices?.x)?.[i];
      const y = series.y?.[i];
      rows.push([
        prefix + series.name,
        given.x.names ? (given.x.names[x] ?? "") : x,
        given.y.names ? (given.y.names[y] ?? "") : y,
        series.low?.[i] ?? (series.error ? y - series.error[i] : ""),
        series.high?.[i] ?? (series.error ? y + series.error[i] : ""),
        series.value?.[i],
        series.text?.[i]?.replaceAll("\n", "; "),
      ]);
    }
  };
  for (const series of given.series ?? []) put("", series);
  for (const item of given.choices?.items ?? []) for (const series of item.series) put(`${item.name}: `, series);
  return `${rows.map((row) => row.map(quoted).join(",")).join("\n")}\n`;
}

/** Write a cell: quoted where it must be; a text that a spreadsheet would take for a formula stays a text. */
function quoted(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "number") return String(value);
  const text = /^[=+\-@\t\r]/.test(value) ? `'${value}` : value;
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Hand a text to the user as a file. */
export function hand(name, text) {
  const link = h("a", { href: URL.createObjectURL(new Blob([text], { type: "text/csv" })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
