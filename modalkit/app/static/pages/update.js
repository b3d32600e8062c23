// Update: which parameters, by which data; progress, and the answer.

import { get } from "../api.js";
import { field, fill, fixed, h, raised, select, table, warnings, withoutModel } from "../dom.js";
import { charted, drawer } from "../drawings.js";
import { worker } from "./work.js";

export function open(root, app) {
  const what = h("div", { class: "row" }),
    answer = h("div"),
    gap = h("div"),
    turned = h("div"),
    tables = h("div");
  const result = h("section", { class: "panel", hidden: true }, h("h2", {}, "The answer"), answer, gap, turned, tables);
  const drawings = drawer("update");
  let seen = null;
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
          raised(p.unit),
          digits(p.sigma),
          p.factor === null ? "–" : fixed(p.factor, 5),
          p.at_bound ? "yes" : "",
        ]),
      ),
      d.undetermined.length ? h("p", {}, `Not determined by these data: ${d.undetermined.join(", ")}.`) : null,
      d.held.length ? h("p", {}, `Held by the tolerance, against the data: ${d.held.join(", ")}; see the warnings.`) : null,
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
    const mark = JSON.stringify([app.state.key, found.written]);
    if (mark === seen) return;
    const all = await drawings(mark);
    seen = mark;
    charted(gap, all, ["gap"]);
    charted(turned, all, ["factors", "frac", "correlations"]);
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
