// The marks of a chart as SVG: lines, points, bars, bands, cells. Colours are classes, so that the page's scheme rules.

const SPACE = "http://www.w3.org/2000/svg";

/** Return an element of a drawing. */
export function s(tag, attributes = {}, text = null) {
  const element = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes))
    if (value !== null && value !== undefined) element.setAttribute(name, value);
  if (text !== null) element.textContent = text;
  return element;
}

const SYMBOLS = {
  dot: (x, y, r) => `M${x - r},${y}a${r},${r} 0 1,0 ${2 * r},0a${r},${r} 0 1,0 ${-2 * r},0`,
  square: (x, y, r) => `M${x - r},${y - r}h${2 * r}v${2 * r}h${-2 * r}z`,
  diamond: (x, y, r) => `M${x},${y - 1.3 * r}L${x + 1.3 * r},${y}L${x},${y + 1.3 * r}L${x - 1.3 * r},${y}z`,
  down: (x, y, r) => `M${x - 1.1 * r},${y - r}h${2.2 * r}L${x},${y + r}z`,
  up: (x, y, r) => `M${x - 1.1 * r},${y + r}h${2.2 * r}L${x},${y - r}z`,
  cross: (x, y, r) => `M${x - r},${y - r}L${x + r},${y + r}M${x - r},${y + r}L${x + r},${y - r}`,
};

const n = (v) => v.toFixed(1);

/** Draw a series into a group; return what can be pointed at: [{x, y, text, series}]. */
export function mark(group, series, at) {
  return KINDS[series.kind](group, series, at) ?? [];
}

const KINDS = { line, points, bars, bands: band, links: link, cells };

function line(group, series, { x, y }) {
  let path = "";
  let on = false;
  series.x.forEach((v, i) => {
    const [a, b] = [x.at(v), series.y[i] === null ? NaN : y.at(series.y[i])];
    const known = Number.isFinite(a) && Number.isFinite(b);
    if (known) path += `${on ? "L" : "M"}${n(a)},${n(b)}`;
    on = known;
  });
  group.append(s("path", { d: path, class: `line ${series.colour}${series.dash ? " dash" : ""}`, style: series.width && `stroke-width: ${series.width}` }));
}

function points(group, series, { x, y }) {
  const symbol = SYMBOLS[series.symbol] ?? SYMBOLS.dot;
  const hollow = series.hollow ? " hollow" : "";
  let [path, bars] = ["", ""];
  const targets = [];
  series.x.forEach((v, i) => {
    if (v === null || series.y[i] === null) return;
    const [a, b] = [x.at(v), y.at(series.y[i])];
    if (!Number.isFinite(a) || !Number.isFinite(b)) return;
    path += symbol(Number(n(a)), Number(n(b)), series.sizes?.[i] ?? series.size ?? 4);
    const error = series.error?.[i];
    if (error) bars += `M${n(a)},${n(y.at(series.y[i] - error))}L${n(a)},${n(y.at(series.y[i] + error))}`;
    if (series.top) bars += `M${n(a)},${n(y.at(series.bottom[i]))}L${n(a)},${n(y.at(series.top[i]))}`;
    targets.push({ x: a, y: b, i, series });
  });
  if (bars) group.append(s("path", { d: bars, class: `line ${series.colour}` }));
  group.append(s("path", { d: path, class: `mark ${series.colour}${hollow}` }));
  return targets;
}

/** Bars from zero: upright, or lying where the y axis has names. */
function bars(group, series, { x, y }) {
  const targets = [];
  const lying = Boolean(y.step);
  const wide = Math.min(22, 0.55 * (lying ? y.step : x.step || 30));
  series.x.forEach((v, i) => {
    if (v === null || series.y[i] === null) return;
    const [a, b] = [x.at(v), y.at(series.y[i])];
    const zero = lying ? x.at(0) : y.at(0);
    const box = lying
      ? { x: Math.min(a, zero), y: b - wide / 2, width: Math.max(1, Math.abs(a - zero)), height: wide }
      : { x: a - wide / 2, y: Math.min(b, zero), width: wide, height: Math.max(1, Math.abs(b - zero)) };
    const shade = series.colours?.[i] ?? series.colour;
    group.append(s("rect", { ...rounded(box), class: `fill ${shade}`, rx: 2 }));
    targets.push({ x: a, y: b, i, series });
  });
  return targets;
}

const rounded = (box) => Object.fromEntries(Object.entries(box).map(([k, v]) => [k, n(v)]));

/** Bands about a row, or between two heights over all x. */
function band(group, series, { x, y }) {
  series.y.forEach((v, i) => {
    if (v === null || series.low[i] === null) return;
    const [a, b] = [x.at(series.low[i]), x.at(series.high[i])];
    const tall = 0.7 * y.step;
    const box = { x: a, y: y.at(v) - tall / 2, width: Math.max(1, b - a), height: tall };
    group.append(s("rect", { ...rounded(box), class: `fill ${series.colour}` }));
  });
}

function link(group, series, { x, y }) {
  const path = series.y.map((v, i) =>
    series.low[i] === null || series.high[i] === null
      ? ""
      : `M${n(x.at(series.low[i]))},${n(y.at(v))}L${n(x.at(series.high[i]))},${n(y.at(v))}`,
  );
  group.append(s("path", { d: path.join(""), class: `line ${series.colour} thick` }));
}

/** From this share of full colour on, black text is easier to read than white on the cells of the dark scheme. */
const BRIGHT = 0.65;

/** Rectangles that have a value from 0 to 1, written into those that have room. */
function cells(group, series, { x, y }) {
  const targets = [];
  series.value.forEach((value, i) => {
    const [a, b] = [x.at(series.low[i]), x.at(series.high[i])].sort((p, q) => p - q);
    const [c, d] = [y.at(series.bottom[i]), y.at(series.top[i])].sort((p, q) => p - q);
    const box = { x: a + 0.5, y: c + 0.5, width: Math.max(1, b - a - 1), height: Math.max(1, d - c - 1) };
    const shade = value === null ? "none" : value < 0 ? "orange" : "blue";
    group.append(s("rect", { ...rounded(box), class: "cell" }));
    const size = Math.min(1, Math.abs(value ?? 0));
    group.append(s("rect", { ...rounded(box), class: `fill ${shade}`, opacity: (0.92 * size).toFixed(3) }));
    const text = series.written?.[i];
    if (text && 7 * text.length + 8 < b - a && d - c > 13)
      group.append(
        s("text", { x: n((a + b) / 2), y: n((c + d) / 2 + 4), class: size > BRIGHT ? "in strong" : "in" }, text),
      );
    targets.push({ x: (a + b) / 2, y: (c + d) / 2, i, series, box });
  });
  return targets;
}
