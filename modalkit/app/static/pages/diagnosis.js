// Diagnosis: progress by stages, the answer as in the report, a cause accepted, what to measure next, planning.

import { button, fill, fixed, h, table, withoutModel } from "../dom.js";
import { warned } from "../asked.js";
import { charted, drawer, placed } from "../drawings.js";
import { worker } from "./work.js";

const ELSE = "something_else"; // the effect of a row that stands for a cause in no library

export function open(root, app) {
  const answer = h("div"),
    gap = h("div"),
    place = h("div"),
    probable = h("div"),
    causes = h("div"),
    closing = h("div"),
    frfs = h("div"),
    closes = h("p"),
    rest = h("div"),
    planned = h("div"),
    compared = h("div", { id: "so-far" }),
    inside = h("div");
  const panel = (title, ...inside) => h("section", { class: "panel" }, h("h2", {}, title), ...inside);
  const where = panel("Where it sits", place),
    overlaid = panel("FRFs before and after", frfs);
  const result = h(
    "div",
    { hidden: true },
    panel("The answer", answer),
    panel("How large the gap is", gap),
    where,
    panel("What causes it", probable, causes),
    panel("How far it closes", closing, closes),
    overlaid,
    panel("What next", rest),
  );
  const drawings = drawer("diagnose");
  let standing = null;
  let seen = null;
  let listed = "[]";
  const work = worker(app, "diagnose", {
    start: () => (app.state.accepted.length ? "Diagnose the rest" : "Diagnose"),
    again: "Diagnose again",
    done: shown,
  });
  const plan = worker(app, "plan", { start: "Plan the next test", again: "Plan again", done: forecast });
  root.append(
    h(
      "section",
      { class: "panel" },
      h("h2", {}, "Diagnosis"),
      h(
        "p",
        { class: "muted" },
        "Which effect missing in the model causes the gap, where it lies, and how far the gap closes once it is included.",
      ),
      inside,
      work.element,
      compared,
    ),
    result,
    h(
      "section",
      { class: "panel" },
      h("h2", {}, "Planning"),
      h("p", { class: "muted" }, "Which effects a test with this setup separates, and which change of it gains most."),
      plan.element,
      planned,
    ),
  );

  async function update() {
    if (!app.state.has_model) {
      fill(root, withoutModel("Diagnosis", "diagnose"));
      return;
    }
    await work.update();
    await plan.update();
  }

  /** Show the single causes that are compared already. */
  function provisional(singles) {
    const mark = JSON.stringify(singles);
    if (mark === listed) return; // the table stays as it was sorted
    listed = mark;
    const rows = [...singles].sort((a, b) => b.power - a.power);
    fill(
      compared,
      rows.length > 1
        ? [
            table(
              `${rows.length - 1} single causes compared so far`,
              [{ name: "cause" }, { name: "log₁₀ evidence", number: true }, { name: "fit p", number: true }],
              rows.map((one) => [
                one.name.replaceAll("_", " ") || "no cause",
                one.power === null ? "–" : fixed(one.power, 1),
                one.p,
              ]),
            ),
            h("p", { class: "muted" }, "Evidence relative to no cause, in powers of ten. Provisional: the most probable causes are still refined, and sets of causes follow if no single cause explains the data."),
          ]
        : null,
    );
  }

  async function shown(found, running, asks, singles) {
    result.hidden = !found;
    provisional(singles);
    const { accepted } = app.state;
    fill(
      inside,
      accepted.length && !running
        ? h(
            "p",
            { class: "done", id: "accepted" },
            `Accepted: ${accepted.join("; ")}. `,
            found ? "The answer below explains the remaining gap." : "It is part of the study now; diagnose the rest.",
          )
        : null,
    );
    if (!found) return;
    const d = found.document;
    fill(
      answer,
      h("p", { class: "big", id: "diagnosis-answer" }, found.answer),
      h(
        "dl",
        { class: "summary" },
        Object.entries(found.summary).map(([k, v]) => [h("dt", {}, k), h("dd", {}, v)]),
      ),
      h(
        "p",
        {},
        h("a", { href: "report/diagnose", target: "_blank", rel: "noopener" }, "The whole report"),
        " opens in a page of its own.",
      ),
    );
    const rows = [...found.rows.entries()]; // a cause in no library has no row of its own there
    const ranking = d.cause.ranking.map((row) => (row.effects[0] === ELSE ? [row] : [row, ...rows.shift()])).slice(0, 10);
    const answered = d.cause.verdict === "named" || d.cause.verdict === "class";
    const columns = ["causes", "probability", "parameters", "fit p", "model"].map((name, i) => ({
      name,
      number: i === 1 || i === 3,
      wide: i === 2,
    }));
    fill(
      causes,
      table(
        "Explanations, most probable first",
        columns,
        ranking.map(([row, i, own]) => [
          row.effects.join(" + ").replaceAll("_", " ") || "tolerances alone",
          own?.probability ?? (row.probability < 0.0005 ? "< 0.1 %" : `${fixed(100 * row.probability, 1)} %`),
          own?.parameters ?? "",
          own?.p ?? "",
          own?.entries
            ? button("Accept", () => app.change("accept", { row: i }), {
                class: "small",
                "aria-label": `put ${row.effects.join(" and ")} into the model`,
                id: `accept-${i}`,
              })
            : "",
        ]),
      ),
      [...new Set(ranking.map(([, , own]) => own?.why_not).filter(Boolean))].map((why) =>
        h("p", { class: "muted" }, `Cannot be accepted: ${why}.`),
      ),
      h(
        "p",
        { class: "muted" },
        answered
          ? "Accept puts a row into the model, with the values found; the rest can then be diagnosed."
          : "No row is the answer; accept one only if you know better.",
      ),
    );
    fill(
      closes,
      `On modes held out the gap goes from ${found.closes.before} to ${found.closes.after}; the noise floor is ${found.closes.floor}.`,
    );
    fill(
      rest,
      found.next.length
        ? table(
            "What to measure next",
            [{ name: "measure", wide: true }, { name: "separates", wide: true }, { name: "σ", number: true }],
            found.next.map((t) => [t.measure, t.separates.replaceAll("_", " "), fixed(t.sigma, 1)]),
          )
        : h("p", {}, "No further test is proposed."),
      Object.keys(d.not_examined).length
        ? h(
            "details",
            {},
            h("summary", {}, `${Object.keys(d.not_examined).length} effects were not examined`),
            h(
              "ul",
              {},
              Object.entries(d.not_examined).map(([k, v]) => h("li", {}, `${k.replaceAll("_", " ")}: ${v}`)),
            ),
          )
        : null,
      warned(app, d.warnings, asks, () => work.start()),
    );
    await drawn(found);
  }

  /** Draw the result as its report does, once for each result. */
  async function drawn(found) {
    const mark = JSON.stringify([app.state.key, found.written]);
    if (mark === seen) {
      standing?.recolour();
      return;
    }
    const all = await drawings(mark);
    seen = mark;
    charted(gap, all, ["gap"]);
    charted(probable, all, ["causes"]);
    charted(closing, all, ["closing"]);
    overlaid.hidden = !charted(frfs, all, ["frfs"]);
    where.hidden = !all?.place && !charted(place, all, ["place"]);
    standing?.close();
    standing = all?.place ? await placed(place, all.place) : null;
  }

  async function forecast(found) {
    fill(
      planned,
      found
        ? h(
            "ul",
            { class: "plain-list", id: "plan-lines" },
            found.lines.map((text) => h("li", {}, text.replace(/\s+/g, " "))),
          )
        : null,
    );
  }

  return {
    update,
    close: () => {
      work.close();
      plan.close();
      standing?.close();
    },
  };
}
