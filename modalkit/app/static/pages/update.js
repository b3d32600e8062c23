// Update: which parameters, by which data; progress, and the answer.

import { get } from "../api.js";
import { field, fill, fixed, h, raised, select, table, withoutModel } from "../dom.js";
import { warned } from "../asked.js";
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

  async function shown(found, running, asks) {
    result.hidden = !found;
    if (!found) return;
    const d = found.document;
    fill(
      answer,
      h("p", { class: "big", id: "update-answer" }, found.answer),
      warned(app, d.warnings, asks, () => work.start()),
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
        ["parameter", "before", "after", "σ", "unit", "factor", "bounds", "at bound"].map((name, i) => ({
          name,
          number: [1, 2, 3, 5].includes(i),
        })),
        (found.rows ?? []).map((p) => [
          p.name,
          p.initial,
          p.value,
          p.sigma,
          raised(p.unit),
          p.factor,
          p.bounds,
          p.at_bound === "no" ? "no" : h("strong", { class: "error" }, p.at_bound),
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
          p.used ? "yes" : "no",
        ]),
      ),
      h("details", {}, h("summary", {}, "The report of the fit"), h("pre", { tabindex: "0" }, found.text)),
    );
    const mark = JSON.stringify([app.state.key, found.written]);
    if (mark === seen) return;
    const all = await drawings(mark);
    seen = mark;
    charted(gap, all, ["gap"]);
    charted(turned, all, ["factors", "frac", "correlations"]);
  }

  return { update, close: work.close };
}
