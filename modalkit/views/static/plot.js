// The picture of a chart as SVG, as wide as it is told: margins, axes, and the marks of all series.

import { s, mark } from "./marks.js";
import { minus, scale } from "./scales.js";

const LETTER = 6.9; // mean width of a letter [px]
const LINE = 14; // from one turned name to the next [px]

/** Draw the picture. Returns the drawing, its series and scales, and what can be pointed at. */
export function plot(place, given, chosen) {
  const series = [...(given.series ?? []), ...(given.choices?.items[chosen].series ?? [])].map((one) => ({
    ...one,
    x: one.x ?? given.choices?.x,
  }));
  const width = Math.max(260, place.clientWidth);
  const box = framed(given, width);
  const { left, right, top, bottom, height } = box;
  const title = `${given.title}. ${given.text} Arrow keys read the numbers.`;
  const svg = s("svg", {
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    tabindex: "0",
    "aria-label": title,
    class: "drawn",
  });
  const scales = {
    x: scale(given.x, of(series, "x", ["low", "high"]), left, width - right),
    y: upright(given.y, of(series, "y", ["bottom", "top"], "error"), top, height - bottom, box.above),
  };
  axes(svg, given, scales, { ...box, width });
  const cut = `cut-${given.name}`;
  const clip = s("clipPath", { id: cut });
  clip.append(
    s("rect", { x: left - 6, y: top - 6, width: width - left - right + 12, height: height - top - bottom + 12 }),
  );
  const inner = s("g", { "clip-path": `url(#${cut})` });
  svg.append(clip, inner);
  for (const one of [...(given.lines ?? []), ...(given.modes ?? [])]) {
    const at = scales.x.at(one);
    inner.append(s("path", { d: `M${at},${top}V${height - bottom}`, class: "line muted dot" }));
  }
  const targets = [];
  for (const one of series) {
    const own = one.right ? { x: scales.x, y: besides(series, height - bottom, top) } : scales;
    targets.push(...mark(inner, one, own));
  }
  place.querySelector("svg")?.remove();
  place.prepend(svg);
  const curves = series.filter((one) => one.kind === "line" && !one.right && one.name && one.colour !== "clamp");
  return { svg, series, scales, targets, curves, from: left, to: width - right };
}

/** Return the scale of the upright axis: names from above to below, numbers from below to above. */
function upright(axis, values, top, base, above) {
  return axis.names ? scale({ ...axis, above }, values, top, base) : scale(axis, values, base, top);
}

/** Return the scale of the curves behind, which has no ticks. */
function besides(series, from, to) {
  const values = series.filter((one) => one.right).flatMap((one) => one.y);
  return scale({ log: true }, values, from, to);
}

/** Return all values of an axis. */
function of(series, key, pair, error) {
  const found = [];
  for (const one of series) {
    if (one.right && key === "y") continue;
    if (one.kind === "cells") found.push(...one[pair[0]], ...one[pair[1]]);
    else {
      if (!(one.kind === "bands" || one.kind === "links") || key === "y") found.push(...(one[key] ?? []));
      if (key === "x" && one.low) found.push(...one.low, ...one.high);
      if (error && one.error) one.error.forEach((e, i) => e && found.push(one.y[i] - e, one.y[i] + e));
      if (one.kind === "bars") found.push(0);
    }
  }
  return found.filter((v) => v !== null && v !== undefined);
}

/** Return margins and height: what the names of the axes need. */
function framed(given, width) {
  const names = given.y.names ?? [];
  const name = given.y.title ? 16 : 0;
  const beside = names.length ? 14 + LETTER * longest(names) : 62;
  const most = 0.38 * width;
  const above = names.length > 0 && !given.cell && beside > most; // long names stand above their rows
  const left = above ? 12 : (given.cell ? Math.min(beside, most) : beside) + name;
  const space = width - left - 12;
  const room = given.cell ? Math.min(space, given.cell * given.x.names.length) : space;
  const slant = given.x.names && given.x.names.length * (LETTER * longest(given.x.names) + 8) > room;
  const below = slant ? 14 + 5 * Math.min(16, longest(given.x.names)) : given.bare ? 0 : 20;
  const bottom = below + (given.x.title ? 22 : 4);
  const tall = width < 520 ? Math.min(given.height, 260) : given.height;
  const body = names.length * ((given.row ?? 26) + (above ? 18 : 0)) || (given.equal ?? 0) * space || tall;
  const right = width - left - room;
  return { left: given.bare ? 12 : left, right, top: 12, bottom, height: 12 + body + bottom, slant, above };
}

const longest = (names) => Math.max(...names.map((text) => text.length));

function axes(svg, given, { x, y }, { left, right, top, bottom, width, height, slant, above }) {
  const base = height - bottom;
  const quiet = given.bare ? [] : y.ticks;
  for (const tick of quiet) {
    if (!tick.name) svg.append(s("path", { d: `M${left},${tick.at}H${width - right}`, class: "grid" }));
    if (above) label(svg, tick, { x: left, y: tick.name - 3 }, width - 20);
    else label(svg, tick, { x: left - 6, y: tick.at + 4, "text-anchor": "end" }, left - 4 - (given.y.title ? 16 : 0));
  }
  const every = slant ? Math.ceil(LINE / Math.abs(x.ticks[1].at - x.ticks[0].at)) : 1; // turned names need a line each
  for (const [i, tick] of (given.bare ? [] : x.ticks).entries()) {
    if (i % every) continue;
    if (!tick.name) svg.append(s("path", { d: `M${tick.at},${top}V${base}`, class: "grid" }));
    const turned = slant
      ? { x: tick.at + 4, y: base + 12, "text-anchor": "end", transform: `rotate(-60 ${tick.at + 4} ${base + 12})` }
      : { x: Math.min(tick.at, width - 14), y: base + 16, "text-anchor": "middle" };
    label(svg, tick, turned, slant ? 100 : 999);
  }
  if (!given.bare && !given.y.names) svg.append(s("path", { d: `M${left},${top}V${base}`, class: "axis" }));
  if (!given.bare) svg.append(s("path", { d: `M${left},${base}H${width - right}`, class: "axis" }));
  if (given.zero) svg.append(s("path", { d: `M${x.at(0)},${top}V${base}`, class: "axis" }));
  if (given.x.title)
    svg.append(
      s(
        "text",
        { x: (left + width - right) / 2, y: height - 4, class: "name", "text-anchor": "middle" },
        given.x.title,
      ),
    );
  if (given.y.title) {
    const middle = (top + base) / 2;
    svg.append(
      s(
        "text",
        { x: 13, y: middle, class: "name", "text-anchor": "middle", transform: `rotate(-90 13 ${middle})` },
        given.y.title,
      ),
    );
  }
}

/** Write a tick; a power of ten has its exponent raised, a long name is cut. */
function label(svg, tick, at, room) {
  const text = s("text", { ...at, class: "tick" }, tick.power === undefined ? cut(tick.text, room) : "10");
  if (tick.power !== undefined) text.append(s("tspan", { dy: -5, class: "raised" }, minus(String(tick.power))));
  else if (cut(tick.text, room) !== tick.text) text.append(s("title", {}, tick.text));
  svg.append(text);
}

const cut = (text, room) =>
  LETTER * text.length <= room ? text : `${text.slice(0, Math.max(1, Math.floor(room / LETTER) - 1))}…`;
