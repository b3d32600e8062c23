// The form of a study without a model: the type of the model, its values, the test, the tolerances.

import { button, check, field, fill, h, select } from "../dom.js";

const GROUPS = { model: "The model", test: "The test", tolerances: "Tolerances, relative 1σ" };

/** Return the form; `test` is what the study states of its test already. */
export function form(app, page, test) {
  let type = Object.keys(page.types)[0];
  const typed = {}; // by path; what two types share stays when the type is changed
  for (const f of page.fields)
    if (f.group === "test") typed[f.path] = text(f, test[f.path.split(".")[1]]);
  const inside = h("div");
  const files = h(
    "datalist",
    { id: "form-files" },
    page.files.map((name) => h("option", { value: name })),
  );

  const own = () => page.fields.filter((f) => !f.types.length || f.types.includes(type));

  function filled() {
    fill(
      inside,
      Object.entries(GROUPS).map(([group, title]) =>
        h(
          "fieldset",
          { class: "group" },
          h("legend", {}, title),
          h(
            "div",
            { class: "fields" },
            own()
              .filter((f) => f.group === group)
              .map((f) => labelled(f, typed)),
          ),
        ),
      ),
    );
  }

  function make() {
    const values = Object.fromEntries(own().map((f) => [f.path, valueOf(f)]));
    return app.act("model", { type, values });
  }

  const valueOf = (f) => (f.kind === "several" ? (typed[f.path] ?? []).filter((c) => f.choices.includes(c)) : f.kind === "choice" && !f.choices.includes(typed[f.path]) ? "" : (typed[f.path] ?? ""));

  filled();
  return h(
    "section",
    { class: "panel", id: "new-model" },
    h("h2", {}, "New model"),
    h("p", { class: "muted" }, "A number may have its own unit: 376 mm, 30 Mpsi. A number shown in grey is taken where the field is left empty; lists in grey are examples. x0 is the end at x = 0, from where places are measured."),
    h(
      "div",
      { class: "row" },
      field(
        "Type",
        select(
          Object.entries(page.types),
          type,
          (v) => {
            type = v;
            filled();
          },
          { id: "form-type" },
        ),
      ),
    ),
    files,
    inside,
    h("div", { class: "row" }, button("Make the model", make, { class: "primary", id: "form-make" })),
  );
}

function labelled(f, typed) {
  if (f.kind === "several")
    return h(
      "div",
      { class: "field", role: "group", "aria-label": f.label },
      h("span", {}, f.label),
      h(
        "span",
        { class: "with-unit" },
        f.choices.map((name) =>
          check(
            name,
            (typed[f.path] ?? []).includes(name),
            (on) => {
              const others = (typed[f.path] ?? []).filter((one) => one !== name);
              typed[f.path] = on ? [...others, name] : others;
            },
            { id: `form-${f.path}-${name}` },
          ),
        ),
      ),
    );
  const keep = (event) => (typed[f.path] = event.target.value);
  const given = { id: `form-${f.path}`, input: keep, value: typed[f.path] ?? "" };
  const label = f.needed ? `${f.label} *` : f.label;
  if (f.kind === "choice") return field(label, select(f.choices.map((c) => [c, c]), typed[f.path], (v) => (typed[f.path] = v), { id: given.id }));
  if (f.kind === "places") return field(label, h("textarea", { rows: "3", placeholder: f.hint, ...given }));
  const more = f.kind.startsWith("file") ? { list: "form-files" } : {};
  return field(label, h("input", { type: "text", placeholder: f.hint, ...given, ...more }), f.unit);
}

/** Return a value of the study as it is typed. */
function text(f, value) {
  if (value === undefined || value === null) return "";
  const entries = typeof value === "object" ? Object.entries(value) : [];
  if (f.kind === "places") return entries.map(([point, at]) => `${point}: ${at.join(", ")}`).join("\n");
  if (f.kind === "masses") return entries.map(([point, mass]) => `${point}: ${mass}`).join(", ");
  return typeof value === "number" ? String(Number((value / f.times).toPrecision(12))) : String(value);
}
