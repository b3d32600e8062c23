// From numbers to pixels: linear, logarithmic and named axes, their ticks, and how a number is written.

/** Return a number in a few digits, as 12.35, 0.00231 or 4.1e-7. */
export function written(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return minus(value.toExponential(digits - 1).replace(/\.?0+e/, "e"));
  return minus(String(Number(value.toPrecision(digits))));
}

export const minus = (text) => text.replaceAll("-", "−");

/** Return a scale of an axis {title, log, range, names} over values, between two pixels. */
export function scale(axis, values, from, to) {
  if (axis.names) return named(axis, from, to);
  const known = values.filter((v) => Number.isFinite(v) && (!axis.log || v > 0));
  let [low, high] = axis.range ?? [Math.min(...known), Math.max(...known)];
  if (!known.length && !axis.range) [low, high] = axis.log ? [1, 10] : [0, 1];
  return axis.log ? logarithmic(low, high, from, to, !axis.range) : linear(axis, low, high, from, to);
}

function named(axis, from, to) {
  const step = (to - from) / axis.names.length;
  const at = (v) => from + (v + (axis.above ? 0.7 : 0.5)) * step;
  const room = Math.abs(step) * (axis.above ? 0.6 : 1);
  const ticks = axis.names.map((text, i) => ({ at: at(i), text, name: from + (i + 0.4) * step }));
  return { at, step: room, ticks };
}

function linear(axis, low, high, from, to) {
  if (!axis.range) {
    const edge = 0.06 * (high - low || Math.abs(high) || 1);
    const zero = axis.zero && low >= 0;
    [low, high] = [zero ? 0 : low - edge, high + edge];
  }
  const at = (v) => from + ((v - low) / (high - low)) * (to - from);
  const wanted = Math.max(2, Math.abs(to - from) / (axis.dense ? 45 : 80));
  const raw = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw * 0.7) ?? 10 * power;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1)
    ticks.push({ at: at(k * step), text: written(Number((k * step).toPrecision(12)), 6) });
  return { at, ticks, step: 0 };
}

function logarithmic(low, high, from, to, padded) {
  let [a, b] = [Math.log10(low), Math.log10(high)];
  if (padded) [a, b] = [a - 0.04 * (b - a || 1), b + 0.06 * (b - a || 1)];
  const at = (v) => from + ((Math.log10(v) - a) / (b - a)) * (to - from);
  const every = Math.max(1, Math.ceil((b - a) / Math.max(2, Math.abs(to - from) / 36)));
  const ticks = [];
  for (let k = Math.ceil(a); k <= b; k += every) ticks.push({ at: at(10 ** k), power: k });
  if (ticks.length < 2) {
    ticks.length = 0;
    for (let k = Math.floor(a); k <= b; k += 1)
      for (const m of [1, 2, 5])
        if (m * 10 ** k >= 10 ** a && m * 10 ** k <= 10 ** b)
          ticks.push({ at: at(m * 10 ** k), text: written(m * 10 ** k, 3) });
  }
  return { at: (v) => (v > 0 ? at(v) : NaN), ticks, step: 0 };
}
