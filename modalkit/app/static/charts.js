// Charts in the colours of the page; plotly is loaded when the first is drawn.

import { cursors } from "./cursors.js";
import { colour } from "./dom.js";

export { colour };

let loading = null;

function plotly() {
  loading ??= new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = "static/plotly-cartesian.min.js";
    script.onload = () => done(window.Plotly);
    script.onerror = () => failed(new Error("the charts could not be loaded"));
    document.head.append(script);
  });
  return loading;
}

export function axis(title, more = {}) {
  return {
    title: { text: title, standoff: 6 },
    gridcolor: colour("grid"),
    linecolor: colour("line"),
    zeroline: false,
    tickcolor: colour("line"),
    ticks: "outside",
    ticklen: 4,
    automargin: true,
    ...more,
  };
}

/** Return a logarithmic axis for curves: no more than DECADES below the largest, so that a curve of noise shows too. */
export function logAxis(title, ...curves) {
  const sizes = curves.flat().filter((v) => v > 0);
  if (!sizes.length) return axis(title, { type: "log" });
  const top = Math.log10(sizes.reduce((a, b) => Math.max(a, b)));
  const low = Math.max(Math.log10(sizes.reduce((a, b) => Math.min(a, b))), top - DECADES);
  const edge = 0.04 * (top - low) + 0.02;
  return axis(title, {
    type: "log",
    exponentformat: "power",
    dtick: top - low > 6 ? 2 : 1,
    range: [low - edge, top + edge],
    tickfont: { size: 10 }, // plotly writes powers a quarter larger than it is told
  });
}

const DECADES = 8;

/** Return phases within the turn in which they jump least: most lie about 0 and 180 degrees, some about 90 and -90. */
function branch(traces) {
  const [first] = [-90, -180]
    .map((low) => {
      const moved = traces.map((t) => ({ ...t, y: t.y.map((v) => (v < low ? v + 360 : v >= low + 360 ? v - 360 : v)) }));
      const jumps = moved.flatMap((t) => t.y.slice(1).map((v, i) => Math.abs(v - t.y[i]) > 180));
      return { low, traces: moved, jumps: jumps.filter(Boolean).length };
    })
    .sort((a, b) => a.jumps - b.jumps);
  return { ...first, ticks: [-180, -90, 0, 90, 180, 270].filter((v) => v >= first.low && v <= first.low + 360) };
}

/** Draw FRFs: magnitude, and beneath it on the same frequencies phase and coherence where they are given. */
export async function drawFrf(element, { magnitude, phase = [], coherence = [], unit, height = 300, shapes = [], ...more }) {
  const narrow = window.innerWidth < 600;
  const turned = branch(phase);
  const below = [
    [turned.traces, "phase [°]", { range: [turned.low - 10, turned.low + 370], tickvals: turned.ticks }],
    [coherence, "coherence", { range: [0, 1.05], tickvals: [0, 0.5, 1] }],
  ].filter(([traces]) => traces.length);
  const small = 90;
  const whole = height + below.length * (small + 14);
  const rows = below.map(([traces, title, given], i) => ({
    key: `yaxis${i + 2}`,
    traces: traces.map((t) => ({ ...t, yaxis: `y${i + 2}`, showlegend: false })),
    axis: axis(title, {
      ...given,
      domain: [(below.length - 1 - i) * ((small + 14) / whole), (below.length - 1 - i) * ((small + 14) / whole) + small / whole],
      automargin: false,
      title: { text: title, standoff: 6, font: { size: 11 } },
    }),
  }));
  const x = magnitude[0].x;
  const [marks, attach] = cursors(element, magnitude, unit);
  await draw(element, [...magnitude, ...rows.flatMap((r) => r.traces)], {
    height: whole + 60,
    margin: { l: narrow ? 54 : 66, r: 14, t: 10, b: 40 },
    xaxis: axis("frequency [Hz]", { range: [x[0], x[x.length - 1]], anchor: below.length ? `y${below.length + 1}` : "y" }),
    yaxis: {
      ...logAxis(`|H| [${unit}]`, ...magnitude.map((t) => t.y)),
      domain: [below.length * ((small + 14) / whole), 1],
      automargin: false,
    },
    ...Object.fromEntries(rows.map((r) => [r.key, r.axis])),
    hovermode: "x",
    shapes: [...shapes.map((one) => ({ ...one, yref: "paper", y0: 0, y1: 1 })), ...marks],
    uirevision: `${x[0]} ${x[x.length - 1]}`, // the part looked at stays, as long as the lines do
    ...more,
  });
  await onclick(element, (point) => attach(point.x));
}

function layout(given) {
  const narrow = window.innerWidth < 600;
  return {
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    height: narrow ? 280 : 320,
    font: { family: "system-ui, sans-serif", size: 12, color: colour("ink") },
    hovermode: "closest",
    hoverlabel: {
      bgcolor: colour("panel"),
      bordercolor: colour("line"),
      font: { color: colour("ink") },
      align: "left",
    },
    margin: { l: narrow ? 44 : 56, r: 14, t: 10, b: 40 },
    dragmode: narrow ? false : "zoom",
    legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", xanchor: "left", font: { size: 11.5 } },
    ...given,
  };
}

const OPTIONS = {
  displaylogo: false,
  modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"],
  showSendToCloud: false, // nothing is uploaded to anybody
  plotlyServerURL: "",
  toImageButtonOptions: { format: "svg" },
};

/** Draw, or draw anew, a chart in an element. */
export async function draw(element, traces, given = {}) {
  const library = await plotly();
  if (!element.isConnected) return;
  element.classList.add("chart");
  await library.react(element, traces, { ...layout(given), width: element.clientWidth || undefined }, OPTIONS);
  if (observed.has(element)) return;
  observed.add(element);
  const fitted = () => {
    const wide = element.clientWidth; // 0 while the panel is hidden
    if (wide && element.layout && element.layout.width !== wide) library.relayout(element, { width: wide });
  };
  new ResizeObserver(fitted).observe(element); // plotly's own follows the window alone, and gives up the height
}

const observed = new WeakSet();

/** Call back with the place and the trace of what is clicked in a chart. */
export async function onclick(element, call) {
  await plotly();
  element.removeAllListeners?.("plotly_click");
  element.on?.("plotly_click", (event) => call(event.points[0]));
}

export const line = (name, x, y, shade, more = {}) => ({
  type: "scatter",
  mode: "lines",
  name,
  x,
  y,
  line: { color: colour(shade), width: 1.4, ...(more.line ?? {}) },
  ...without(more, "line"),
});

function without(object, key) {
  const { [key]: _, ...rest } = object;
  return rest;
}

/** Plotly reads a few tags in its texts; a text from a file must not hold any. */
export const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
