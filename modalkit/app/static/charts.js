// Charts in the colours of the page; plotly is loaded when the first is drawn.

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

export const log = { type: "log", exponentformat: "power", dtick: 1 };

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
  responsive: true,
  modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"],
  toImageButtonOptions: { format: "svg" },
};

/** Draw, or draw anew, a chart in an element. */
export async function draw(element, traces, given = {}) {
  const library = await plotly();
  if (!element.isConnected) return;
  element.classList.add("chart");
  await library.react(element, traces, layout(given), OPTIONS);
}

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

/** Return the trace of a matrix of MACs. */
export function macMatrix(matrix, rows, columns) {
  return {
    type: "heatmap",
    z: matrix,
    x: columns,
    y: rows,
    zmin: 0,
    zmax: 1,
    xgap: 1,
    ygap: 1,
    colorscale: [
      [0, colour("panel")],
      [1, colour("blue")],
    ],
    colorbar: { title: { text: "MAC" }, thickness: 10, outlinewidth: 0 },
    hovertemplate: "%{y} with %{x}: MAC %{z:.3f}<extra></extra>",
  };
}

/** Plotly reads a few tags in its texts; a text from a file must not hold any. */
export const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
