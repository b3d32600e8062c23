// The stabilisation chart: every pole by what became of it, every mode by where it comes from.

import { axis, colour, escaped, line } from "../charts.js";

// what became of a pole, in words, and how it is drawn
const KINDS = [
  ["new", "new at its order", "x-thin", 5, "faint"],
  ["short", "chain too short", "circle-open", 5, "faint"],
  ["outside", "outside the band", "triangle-up-open", 6, "muted"],
  ["pruned", "rejected by the fit", "square-open", 6, "orange"],
  ["background", "not determined by the data", "diamond-open", 6, "orange"],
  ["dropped", "dropped by you", "cross-thin", 7, "red"],
  ["mode", "a mode", "circle", 5, "blue"],
];
// where a mode comes from, above the chart
const SYMBOLS = { chain: "triangle-down", refinement: "diamond", named: "star" };

/** Return traces and layout of the chart of a page of modes; behind it stands the sum of the FRFs, or an indicator. */
export function stabilisation(page, over, modes) {
  const { chart: found, sum, band, indicators } = page;
  const named = Object.keys(indicators ?? {}).filter((k) => k.startsWith(`${over} `));
  const behind = named.length ? named.map((k) => [k, indicators.x, indicators[k]]) : [["Σ|H|", sum.x, sum.sum]];
  const bounded = over === "MvMIF" && named.length > 0; // from 0 to 1, whatever the FRFs are
  const traces = behind.map(([name, x, y], i) =>
    line(name, x, y, i ? "faint" : "muted", {
      yaxis: "y2",
      hoverinfo: "x",
      opacity: i ? 0.7 : 0.9,
    }),
  );
  for (const [kind, name, symbol, size, shade] of KINDS) {
    const keep = found.reason.flatMap((r, i) => (found.reasons[r].kind === kind ? [i] : []));
    if (!keep.length) continue;
    traces.push({
      type: "scatter",
      mode: page.lettered ? "markers+text" : "markers",
      text: keep.map((i) => found.letter[i]),
      textposition: "middle right",
      textfont: { size: 9, color: colour("muted") },
      name,
      x: keep.map((i) => found.frequency[i]),
      y: keep.map((i) => found.order[i]),
      marker: { symbol, size, color: colour(shade), line: { color: colour(shade), width: 1 } },
      hovertext: keep.map(
        (i) =>
          escaped(
            `${found.frequency[i].toFixed(3)} Hz, damping ${(100 * found.damping[i]).toFixed(3)} %, order ${found.order[i]}`,
          ) +
          `<br>${found.letter[i]}: ${found.letters[found.letter[i]]}` +
          "<br>" +
          escaped(wrapped(found.reasons[found.reason[i]].text)).replaceAll("\n", "<br>"),
      ),
      customdata: keep.map((i) => found.reasons[found.reason[i]].mode),
      hovertemplate: "%{hovertext}<extra></extra>",
    });
  }
  const top = Math.max(...found.orders) * 1.07;
  for (const [origin, symbol] of Object.entries(SYMBOLS)) {
    const those = modes.filter((m) => m.origin === origin);
    if (those.length)
      traces.push({
        type: "scatter",
        mode: "markers",
        showlegend: origin !== "chain",
        name: origin === "refinement" ? "mode added by the refinement" : "mode picked by you",
        x: those.map((m) => m.frequency_hz),
        y: those.map(() => top),
        marker: {
          symbol,
          size: 11,
          color: colour(origin === "chain" ? "blue" : origin === "named" ? "green" : "orange"),
        },
        customdata: those.map((m) => m.mode - 1),
        text: those.map(
          (m) =>
            escaped(`mode ${m.mode}: ${m.frequency_hz.toFixed(3)} Hz`) +
            "<br>" +
            escaped(wrapped(m.whence)).replaceAll("\n", "<br>"),
        ),
        hovertemplate: "%{text}<extra></extra>",
      });
  }
  const layout = {
    height: window.innerWidth < 600 ? 380 : 460,
    xaxis: axis("frequency [Hz]", { range: band }),
    yaxis: axis(found.references > 1 ? `model order (${found.references} poles each)` : "model order", {
      range: [0, top * 1.04],
    }),
    uirevision: String(band),
    yaxis2: {
      overlaying: "y",
      side: "right",
      ...(bounded ? { type: "linear", range: [0, 1.04] } : { type: "log", autorange: true }),
      showgrid: false,
      showticklabels: false,
      title: { text: "" },
    },
    shapes: modes.map((m) => ({
      type: "line",
      x0: m.frequency_hz,
      x1: m.frequency_hz,
      yref: "paper",
      y0: 0,
      y1: 1,
      layer: "below",
      line: { color: colour(m.origin === "named" ? "green" : "blue"), width: 1, dash: "dot" },
    })),
  };
  return { traces, layout };
}

/** Break a text into lines of some fifty characters. */
function wrapped(text) {
  return text.replace(/(.{1,50})(\s|$)/g, "$1\n").trim();
}
