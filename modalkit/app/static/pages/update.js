// Update: which parameters, by which data; progress, and the answer.

import { get } from "../api.js";
import { axis, colour, draw } from "../charts.js";
import { field, fill, fixed, h, select, table, warnings, withoutModel } from "../dom.js";
import { worker } from "./work.js";

export function open(root, app) {
  const what = h("div", { class: "row" }),
    answer = h("div"),
    chart = h("div"),
    tables = h("div");
  const result = h("section", { class: "panel", hidden: true }, h("h2", {}, "The answer"), answer, chart, tables);
  const work = worker(app, "update", { start: "Update", again: "Update again", done: shown });
  const setting = h("section", { class: "panel" }, h("h2", {}, "Update"), what, work.element);
  root.append(setting, result);

  async function update() {
    if (!app.state.has_model) {
      fill(root, withoutModel("Update", "update"));
      return;
    }
    const page = await get("model");
    const table_ = page.update;
    const names = h("input", {
      type: "text",
      value: (table_.parameters ?? []).join(", "),
      placeholder: table_.stages ? "by the stages of the study" : "E",
      id: "parameters",
      size: 34,
      change: () => app.act("set", { path: ["update", "parameters"], value: list(names.value) }),
    });
    fill(
      what,
      field("Parameters", names),
      field(
        "By",
        select(
          [
            ["eigenvalue", "frequencies and shapes"],
            ["frf", "FRFs"],
          ],
          table_.method,
          (v) => app.act("set", { path: ["update", "method"], value: v }),
          { id: "method" },
        ),
      ),
    );
    await work.update();
  }

  const list = (text) => {
    const found = text
      .split(",")
      .map((t) => t.trim())
      .filter(Boolean);
    return found.length ? found : null;
  };

  async function shown(found) {
    result.hidden = !found;
    if (!found) return;
    const d = found.document;
    fill(
      answer,
      h("p", { class: "big", id: "update-answer" }, found.answer),
      h(
        "p",
        {},
        h("a", { href: "report/update", target: "_blank", rel: "noopener" }, "The whole report"),
        " opens in a page of its own.",
      ),
    );
    const mode = d.pairs.map((p) => `${p.test_mode}`);
    const error = (key) => d.pairs.map((p) => 100 * (p[key] / p.test_hz - 1));
    await draw(
      chart,
      [
        ["before", "before_hz", "orange", "circle-open"],
        ["after", "after_hz", "blue", "circle"],
      ].map(([name, key, shade, symbol]) => ({
        type: "scatter",
        mode: "markers",
        name,
        x: mode,
        y: error(key),
        marker: { color: colour(shade), size: 9, symbol },
        hovertemplate: `mode %{x}, ${name}: %{y:.3f} %<extra></extra>`,
      })),
      {
        height: 280,
        xaxis: axis("test mode", { type: "category" }),
        yaxis: axis("frequency error [%]", { zeroline: true, zerolinecolor: colour("muted") }),
      },
    );
    fill(
      tables,
      table(
        "Parameters",
        ["parameter", "value", "unit", "σ", "factor", "at bound"].map((name, i) => ({
          name,
          number: [1, 3, 4].includes(i),
        })),
        d.parameters.map((p) => [
          p.name,
          digits(p.value),
          p.unit,
          digits(p.sigma),
          p.factor === null ? "–" : fixed(p.factor, 5),
          p.at_bound ? "yes" : "",
        ]),
      ),
      d.undetermined.length ? h("p", {}, `Not determined by these data: ${d.undetermined.join(", ")}.`) : null,
      table(
        "Pairs",
        ["test", "model", "test [Hz]", "before [Hz]", "after [Hz]", "MAC", "used"].map((name, i) => ({
          name,
          number: i < 6,
        })),
        d.pairs.map((p) => [
          p.test_mode,
          p.model_mode,
          fixed(p.test_hz, 3),
          fixed(p.before_hz, 3),
          fixed(p.after_hz, 3),
          fixed(p.mac, 4),
          p.used ? "" : "no",
        ]),
      ),
      h("details", {}, h("summary", {}, "The report of the fit"), h("pre", { tabindex: "0" }, found.text)),
      warnings(d.warnings),
    );
  }

  /** Six digits, as the command prints them: to be computed with. */
  const digits = (value) =>
    value === null
      ? "–"
      : Math.abs(value) >= 1e6 || (value !== 0 && Math.abs(value) < 1e-4)
        ? value.toExponential(5)
        : String(Number(value.toPrecision(6)));
  return { update, close: work.close };
}
