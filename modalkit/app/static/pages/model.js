// Model: what the study states, sliders for effects and factors, pairs found and pairs stated.

import { get, post } from "../api.js";
import { drawFrf, line } from "../charts.js";
import { charted } from "../drawings.js";
import { warned } from "../asked.js";
import { button, field, fill, fixed, h, select, short, table } from "../dom.js";
import { form } from "./form.js";

export function open(root, app) {
  const notes = h("div"),
    fields = h("div", { class: "fields" }),
    inside = h("div"),
    sliders = h("div"),
    pairs = h("div"),
    frf = h("div"),
    mac = h("div"),
    chooser = h("div", { class: "row" });
  const made = h("div");
  const text = h("textarea", { rows: "18", spellcheck: false, "aria-label": "the study as text", id: "study-text" });
  const comparing = h("section", { class: "panel" }, h("h2", {}, "Test beside model"), pairs);
  const moving = h("section", { class: "panel" }, h("h2", {}, "What if"), sliders);
  const drawn = h("section", { class: "panel" }, h("h2", {}, "FRF"), chooser, frf);
  const matrix = h("section", { class: "panel" }, h("h2", {}, "MAC"), mac);
  const stated = h(
    "section",
    { class: "panel" },
    h("h2", {}, "The study"),
    fields,
    inside,
    h(
      "details",
      {},
      h("summary", {}, "Study as text"),
      text,
      h(
        "div",
        { class: "row" },
        button("Apply", () => app.act("text", { text: text.value }), { id: "study-take" }),
      ),
    ),
  );
  root.append(
    notes,
    made,
    h("div", { class: "two stacked" }, h("div", {}, moving, drawn), h("div", {}, comparing, matrix)),
    stated,
  );
  const view = { page: null, frf: null, region: "", effect: "", form: 0, values: {}, factors: {}, asked: 0, running: false };

  async function update() {
    view.page = await get("model");
    const page = view.page;
    for (const one of [comparing, moving, drawn, matrix]) one.hidden = !page.correlation;
    fill(
      notes,
      page.correlation
        ? warned(app, page.correlation.warnings, page.asks)
        : h("p", { class: app.state.has_model ? "error" : "muted" }, `No model beside the test: ${page.why}.`),
    );
    if (!page.form) fill(made);
    else if (!made.firstChild) fill(made, form(app, page.form, page.test)); // what was typed stays over other changes
    text.value = page.text;
    fielded();
    if (!page.correlation) return;
    view.frf = Math.min(view.frf ?? page.first, Math.max(0, page.frfs.length - 1));
    slid();
    fill(
      chooser,
      page.frfs.length
        ? h(
            "label",
            {},
            "Response / force ",
            select(
              page.frfs.map((n, i) => [i, n]),
              view.frf,
              (v) => {
                view.frf = Number(v);
                app.quiet(moved());
              },
            ),
          )
        : null,
    );
    await moved();
  }

  function fielded() {
    fill(
      fields,
      view.page.fields.map((f) => {
        const id = `field-${f.path.join("-")}`;
        const set = (value) => app.act("set", { path: f.path, value });
        if (f.choices)
          return field(
            f.label,
            select(
              f.choices.map((name) => [name, name]),
              f.value ?? f.default,
              set,
              { id },
            ),
          );
        const input = h("input", {
          type: "text",
          value: f.value === null ? "" : written(f.value, f.times),
          placeholder: f.default === null ? "" : written(f.default, f.times),
          id,
          change: () => set(read(input.value, f)),
        });
        return field(f.label, input, f.unit);
      }),
    );
    fill(
      inside,
      view.page.effects.length
        ? [
            h("h3", {}, "Effects put into the model"),
            h(
              "ul",
              {},
              view.page.effects.map((e, i) =>
                h(
                  "li",
                  {},
                  `${e.name}: ${
                    Object.entries(e)
                      .filter(([k]) => k !== "name")
                      .map(([k, v]) => `${k} = ${typeof v === "number" ? short(v) : v}`)
                      .join(", ") || "no parameters"
                  } `,
                  button("Take out", () => app.act("remove", { index: i }), { class: "small" }),
                ),
              ),
            ),
          ]
        : null,
    );
  }

  /** A number in the unit of its field; what was written with a unit has that unit behind it. */
  const written = (value, times) =>
    typeof value === "number" ? String(Number((value / times).toPrecision(12))) : String(value);

  /** A number has the unit behind its field; anything else, "376 mm" for instance, is read by the study with its own. */
  function read(value, { unit, bare }) {
    const text = value.trim();
    if (text === "" || !Number.isFinite(Number(text))) return text;
    return bare ? Number(text) : `${text} ${unit}`;
  }

  function slid() {
    const page = view.page;
    const effect = page.sliders.find((s) => s.name === view.effect);
    const anything = effect || Object.values(view.factors).some((v) => v !== 1);
    fill(
      sliders,
      page.factors.filter((f) => !f.region).map(factored),
      regioned(),
      choice(
        "Effect",
        select(
          [["", "none"], ...page.sliders.map((s) => [s.name, s.name])],
          view.effect,
          (v) => {
            view.effect = v;
            view.form = 0;
            view.values = {};
            slid();
            app.quiet(moved());
          },
          { id: "effect" },
        ),
      ),
      effect
        ? [
            h("p", { class: "muted" }, effect.summary),
            effect.forms.length > 1
              ? field(
                  "Where",
                  select(
                    effect.forms.map((f, i) => [i, Object.values(f.names).join(", ") || "at a point"]),
                    view.form,
                    (v) => {
                      view.form = Number(v);
                      view.values = {};
                      slid();
                      app.quiet(moved());
                    },
                    { id: "effect-where" },
                  ),
                )
              : null,
            movable(effect).map((p) =>
              slider(
                p.name,
                p.unit === "-" ? "" : p.unit,
                p,
                view.values[p.name] ?? formOf(effect).start[p.name],
                (v) => {
                  view.values[p.name] = v;
                },
                `effect-${p.name}`,
              ),
            ),
          ]
        : null,
      h(
        "div",
        { class: "row" },
        button(
          "Back to the study",
          () => {
            view.region = view.effect = "";
            view.values = {};
            view.factors = {};
            slid();
            app.quiet(moved());
          },
          { disabled: !anything, id: "slide-reset" },
        ),
        effect ? button("Put the effect into the model", () => app.quiet(put(effect)), { id: "slide-put" }) : null,
      ),
    );
  }

  const factored = (f) =>
    slider(
      `${f.name} ×`,
      "",
      f,
      view.factors[f.name] ?? 1,
      (v) => {
        view.factors[f.name] = v;
      },
      `factor-${f.name}`,
    );

  const choice = (name, made) => h("div", { class: "row" }, field(name, made));

  /** The factors of one region; those of the others stay as they were moved, and the list states so. */
  function regioned() {
    const all = view.page.factors.filter((f) => f.region);
    const names = [...new Set(all.map((f) => f.region))];
    if (!names.includes(view.region)) view.region = "";
    const touched = (name) => all.some((f) => f.region === name && (view.factors[f.name] ?? 1) !== 1);
    if (!names.length) return null;
    return [
      choice(
        "Region",
        select(
          [["", "none"], ...names.map((name) => [name, touched(name) ? `${name} (moved)` : name])],
          view.region,
          (v) => {
            view.region = v;
            slid();
          },
          { id: "region" },
        ),
      ),
      all.filter((f) => f.region === view.region).map(factored),
    ];
  }

  /** Where an effect acts, by the names of the user's own model; a page read anew may have fewer places. */
  const formOf = (effect) => effect.forms[view.form] ?? effect.forms[0];

  const movable = (effect) => effect.parameters.filter((p) => p.name in formOf(effect).start);

  /** An effect with its place and values; what is unbounded as long as nobody moves it is left out. */
  function entryOf(effect) {
    const { names, start } = formOf(effect);
    const values = movable(effect).map((p) => [p.name, view.values[p.name] ?? start[p.name]]);
    return { name: effect.name, ...names, ...Object.fromEntries(values.filter(([, value]) => value !== null)) };
  }

  async function put(effect) {
    const entry = entryOf(effect);
    view.effect = "";
    view.values = {};
    await app.act("accept", { effects: [entry] });
  }

  function slider(name, unit, range, value, set, id) {
    const log10 = range.log && range.low > 0;
    const to = (v) => (log10 ? Math.log10(v) : v),
      from = (v) => (log10 ? 10 ** v : v);
    const out = h("output", {}, value === null ? "unbounded" : `${short(value)} ${unit}`);
    const span = to(range.high) - to(range.low);
    const input = h("input", {
      type: "range",
      min: String(to(range.low)),
      max: String(to(range.high)),
      step: String(span / 400),
      id,
      input: () => {
        const v = from(Number(input.value));
        set(v);
        out.textContent = `${short(v)} ${unit}`;
        app.quiet(moved());
        root.querySelector("#slide-reset").disabled = false;
      },
    });
    input.value = String(to(value ?? range.high));
    return h("label", { class: "slider" }, h("span", {}, name), input, out);
  }

  /** Ask for what the sliders say; while an answer is awaited only the last position counts. */
  async function moved() {
    view.asked += 1;
    if (view.running) return;
    view.running = true;
    try {
      let mine = 0;
      while (mine !== view.asked) {
        mine = view.asked;
        const effect = view.page.sliders.find((s) => s.name === view.effect);
        const effects = effect ? [entryOf(effect)] : [];
        const begun = performance.now();
        try {
          const found = await post("moved", { effects, factors: view.factors, index: view.frf });
          root.dataset.moved = String(performance.now() - begun);
          await shown(found);
          app.notice("");
        } catch (error) {
          app.notice(error.message, "error");
        }
      }
    } finally {
      view.running = false;
    }
  }

  async function shown(found) {
    const page = view.page;
    const was = new Map(page.correlation.pairs.map((p) => [p.test_mode, p]));
    const stated = [
      ["", "as found"],
      ["0", "none"],
      ...page.model_hz.map((f, i) => [i + 1, `${i + 1}: ${fixed(f, 1)} Hz`]),
    ];
    const every = [
      ...page.correlation.pairs,
      ...page.correlation.unpaired_test.map((u) => ({ test_mode: u.mode, test_hz: u.frequency_hz })),
    ].map(({ test_mode, test_hz }) => ({ test_mode, test_hz, model_mode: null }));
    const rows = [...found.pairs, ...every.filter((u) => !found.pairs.some((p) => p.test_mode === u.test_mode))].sort(
      (a, b) => a.test_mode - b.test_mode,
    );
    const columns = ["test", "test [Hz]", "model [Hz]", "error [%]", "as stated [%]", "MAC", "partner"].map(
      (name, i) => ({ name, number: i < 6 }),
    );
    fill(
      pairs,
      found.why ? h("p", { class: "error" }, found.why) : null,
      h(
        "p",
        { class: "big", id: "rms" },
        found.pairs.length ? `${fixed(rms(found.pairs), 3)} % r.m.s. over ${found.pairs.length} pairs` : "no pairs",
      ),
      table(
        "Pairs of test and model",
        columns,
        rows.map((p) => [
          p.test_mode,
          fixed(p.test_hz, 3),
          fixed(p.model_hz, 3),
          fixed(p.error_percent, 3),
          fixed(was.get(p.test_mode)?.error_percent, 3),
          fixed(p.mac, 3),
          select(
            stated,
            p.model_mode ?? "0",
            (v) => app.act("pair", { hertz: p.test_hz, model: v === "" ? null : Number(v) }),
            { "aria-label": `partner of test mode ${p.test_mode}`, "data-pair": p.test_mode },
          ),
        ]),
      ),
    );
    if (found.frf) {
      const { x, unit } = found.frf;
      const both = (measured, model) => [
        line("measured", x, measured, "muted", { line: { width: 2.2 } }),
        line("model", x, model, "blue"),
      ];
      await drawFrf(frf, {
        magnitude: both(found.frf.measured, found.frf.model),
        phase: both(found.frf.measured_phase, found.frf.model_phase),
        unit,
      });
    }
    drawn.hidden = !found.frf;
    matrix.hidden = !charted(mac, { charts: found }, ["mac"]);
  }

  const rms = (those) => Math.sqrt(those.reduce((sum, p) => sum + p.error_percent ** 2, 0) / those.length);
  return { update };
}
