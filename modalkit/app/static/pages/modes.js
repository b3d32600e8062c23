// Modes: the stabilisation chart with a reason for every pole, the table, the fit over an FRF, the auto-MAC.

import { get } from "../api.js";
import { warned } from "../asked.js";
import { axis, draw, drawFrf, line, logAxis, onclick } from "../charts.js";
import { figured } from "../drawings.js";
import { button, check, field, fill, fixed, h, select, sigma, table } from "../dom.js";
import { stabilisation } from "./stabilisation.js";

const FEW = 600; // poles up to which letters stand beside them before anybody asks: each letter takes time to draw

// what the curves behind the poles show
const BEHIND = {
  CMIF: "CMIF: a peak of the first curve is a mode; a peak of the second at the same frequency is a second mode there.",
  MvMIF: "MvMIF, from 0 to 1: a minimum of the first curve is a mode; one of the second at the same frequency is a second mode there.",
};

export function open(root, app) {
  const chart = h("div"),
    fit = h("div"),
    mac = h("div"),
    damping = h("div"),
    rows = h("div"),
    controls = h("div", { class: "controls" }),
    chooser = h("div", { class: "row" }),
    notes = h("div");
  const letters = h("p", { class: "muted small" });
  const behind = h("p", { class: "muted small", id: "behind-meaning" });
  const readout = h("p", { class: "muted", "aria-live": "polite", id: "readout" });
  const picking = h("section", { class: "panel" }, h("h2", {}, "Stabilisation chart"), controls, chart, behind, letters, readout);
  const fitted = h("section", { class: "panel" }, h("h2", {}, "Fit"), chooser, fit);
  const damped = h("section", { class: "panel", hidden: true }, h("h2", {}, "Damping"), damping);
  const matrix = h("section", { class: "panel" }, h("h2", {}, "Auto-MAC"), mac);
  root.append(
    notes,
    picking,
    h("section", { class: "panel" }, h("h2", {}, "Modes"), rows),
    h("div", { class: "two wide-left" }, fitted, matrix),
    damped,
  );
  // typed: limits of the band that are not set yet, which other changes leave in their fields
  const view = { page: null, frf: null, over: "sum", lettered: null, curve: null, indicators: null, typed: {} };

  async function update() {
    readout.textContent = ""; // what it stated was of the state before
    if (!view.page) await measured();
    try {
      view.page = await get("modes");
    } finally {
      readout.textContent = "";
    }
    const page = view.page;
    view.lettered ??= window.innerWidth >= 600 && (page.chart?.order.length ?? 0) <= FEW;
    picking.hidden = fitted.hidden = !page.identified;
    fill(notes, warned(app, page.warnings, page.asks));
    listed(page.table);
    if (page.identified) controlled();
    view.indicators = null; // those of the state before
    matrix.hidden = !page.mac;
    figured(mac, page.mac ? [page.mac] : []);
    await Promise.all([page.identified ? indicated().then(() => charted(page.table)) : null, page.identified ? overlaid() : null]);
    await damp(); // last: it may have to solve the model
  }

  /** Draw the FRFs as long as nothing is identified yet. */
  async function measured() {
    const found = await get("measured");
    if (!found) return;
    readout.textContent = "The FRFs as measured; poles and modes follow.";
    matrix.hidden = true;
    fill(chooser, h("p", { class: "muted" }, `${found.frf.name}, measured`));
    const { sum, band, frf } = found;
    await Promise.all([
      draw(chart, [line("Σ|H|", sum.x, sum.sum, "muted")], {
        height: window.innerWidth < 600 ? 380 : 460,
        xaxis: axis("frequency [Hz]", { range: band }),
        yaxis: logAxis(`Σ|H| [${found.unit}]`, sum.sum),
      }),
      drawFrf(fit, {
        magnitude: [line("measured", frf.x, frf.magnitude, "muted", { line: { width: 2.4 } })],
        phase: [line("measured", frf.x, frf.phase, "muted", { line: { width: 2.4 } })],
        unit: frf.unit,
      }),
    ]);
  }

  function controlled() {
    const page = view.page;
    const entered = (then) => (event) => event.key === "Enter" && then();
    const banded = async (limits) => {
      const typed = view.typed;
      view.typed = {};
      if (await app.act("band", limits)) return;
      view.typed = typed; // refused: to be mended where it was typed
      controlled();
    };
    const rounded = (value) => String(Number(value.toPrecision(6)));
    const limited = (input, value) => (input.value === rounded(value) ? value : number(input)); // untouched: all digits
    const bandNow = () => banded({ low: limited(low, page.band[0]), high: limited(high, page.band[1]) });
    const orderNow = () => app.act("order", { order: order.value ? Number(order.value) : null });
    const limit = (end, value) =>
      h("input", {
        type: "text",
        inputmode: "decimal",
        value: view.typed[end] ?? rounded(value),
        size: 7,
        "aria-label": `${end}est frequency of the band`,
        id: `band-${end}`,
        keydown: entered(bandNow),
        input: (event) => (view.typed[end] = event.target.value),
      });
    const [low, high] = [limit("low", page.band[0]), limit("high", page.band[1])];
    const order = h("input", {
      type: "number",
      min: "2",
      max: "400",
      value: page.order ?? "",
      placeholder: "60",
      "aria-label": "highest model order",
      title: "largest number of poles sought, over all references",
      id: "order",
      keydown: entered(orderNow),
    });
    const hertz = h("input", {
      type: "text",
      inputmode: "decimal",
      size: 9,
      "aria-label": "frequency to pick",
      id: "pick-hertz",
    });
    const pickNow = () => {
      if (Number(hertz.value) > 0) app.quiet(picked(Number(hertz.value)));
    };
    hertz.addEventListener("keydown", entered(pickNow));
    const chips = [
      ...page.picked.map((f) => ["picked", f, "drop"]),
      ...page.dropped.map((f) => ["dropped", f, "pick"]),
    ];
    fill(
      controls,
      h(
        "div",
        { class: "row" },
        field("Band", h("span", {}, low, " to ", high), "Hz"),
        button("Set", bandNow, { id: "band-set" }),
        page.band_stated ? button("Band of the force", () => banded({})) : null,
        field("Order", order),
        button("Set", orderNow, { id: "order-set" }),
        field(
          "Background curve",
          select(
            [
              ["sum", "sum of |H|"],
              ["CMIF", "CMIF"],
              ["MvMIF", "MvMIF"],
            ],
            view.over,
            (v) => {
              view.over = v;
              app.quiet(indicated().then(() => charted(page.table)));
            },
            { id: "behind" },
          ),
        ),
        check(
          "letters of stability",
          view.lettered,
          (on) => {
            view.lettered = on;
            app.quiet(charted(page.table));
          },
          { id: "letters" },
        ),
      ),
      h(
        "div",
        { class: "row" },
        field("Pick at", hertz, "Hz"),
        button("Pick", pickNow, { id: "pick" }),
        h("span", { class: "muted" }, "or click a pole, or the curve, in the chart"),
        chips.map(([word, f, back]) =>
          button(`${word} ${Number(f.toPrecision(6))} Hz ×`, () => app.act(back, { hertz: f }), {
            class: "chip",
            title: "undo this",
          }),
        ),
      ),
      page.references.length > 1
        ? h(
            "details",
            {},
            h(
              "summary",
              {},
              `References: ${page.references.filter((r) => r.used).length} of ${page.references.length}`,
            ),
            h(
              "div",
              { class: "row" },
              page.references.map((r) => check(r.name, r.used, (on) => referenced(r.name, on))),
            ),
          )
        : null,
    );
  }

  const number = (input) => Number(input.value.replace(",", "."));

  function referenced(name, used) {
    const names = view.page.references.filter((r) => (r.name === name ? used : r.used)).map((r) => r.name);
    return app.act("references", { names: names.length === view.page.references.length ? [] : names });
  }

  /** Pick a mode: a picture at once from what is factorised already, the last digits when they are there. */
  async function picked(hertz) {
    const begun = performance.now();
    try {
      const found = await get("provisional", { hertz, index: view.frf });
      const near = found.frequency_hz.reduce(
        (a, b) => (Math.abs(b - hertz) < Math.abs(a - hertz) ? b : a),
        found.frequency_hz[0] ?? hertz,
      );
      const k = found.frequency_hz.indexOf(near);
      await overlaid(found.fit);
      root.dataset.pictured = String(performance.now() - begun);
      await charted([
        ...view.page.table,
        {
          mode: "new",
          frequency_hz: near,
          damping_ratio: found.damping_ratio[k],
          origin: "named",
          whence: "being refined",
        },
      ]);
      readout.textContent = `${near.toFixed(3)} Hz, being refined …`;
    } catch (error) {
      app.notice(error.message, "error");
      return;
    }
    const done = await app.act("pick", { hertz });
    root.dataset.settled = String(performance.now() - begun);
    const near = view.page.table.reduce((best, m) =>
      Math.abs(m.frequency_hz - hertz) < Math.abs(best.frequency_hz - hertz) ? m : best,
    );
    readout.textContent = done
      ? `Picked mode ${near.mode}: ${fixed(near.frequency_hz, 4)} ± ${fixed(near.frequency_sigma_hz, 5)} Hz.`
      : `No mode is kept at ${hertz.toPrecision(6)} Hz.`;
  }

  /** Ask for the mode indicator functions, where they are to be seen. */
  async function indicated() {
    if (view.over !== "sum") view.indicators ??= await get("indicators");
  }

  async function charted(modes) {
    const page = { ...view.page, lettered: view.lettered, indicators: view.indicators };
    const { traces, layout } = stabilisation(page, view.over, modes);
    await draw(chart, traces, layout);
    const lacking = view.over !== "sum" && view.indicators?.why;
    behind.textContent = lacking ? `No ${view.over}: ${lacking}.` : (BEHIND[view.over] ?? "");
    letters.textContent = view.lettered
      ? `${Object.entries(view.page.chart.letters).map((one) => one.join(" ")).join(", ")}; within 1 % in frequency, 5 % in damping, 0.98 in MAC of the order below.`
      : "";
    await onclick(chart, (point) => {
      const mode = point.customdata;
      if (mode !== null && mode !== undefined && Number.isFinite(mode)) {
        chosenRow(mode);
        return;
      }
      app.quiet(picked(point.x));
    });
  }

  function chosenRow(mode) {
    rows.querySelectorAll("tr.chosen").forEach((one) => one.classList.remove("chosen"));
    rows.querySelector(`tbody tr[data-row="${mode}"]`)?.classList.add("chosen"); // the page stays where it is
    const m = view.page.table[mode];
    if (m) readout.textContent = `Mode ${m.mode}: ${fixed(m.frequency_hz, 4)} Hz, ${m.whence}.`;
  }

  function listed(modes) {
    const columns = [
      { name: "mode", number: true },
      { name: "frequency [Hz]", number: true },
      { name: "σ [Hz]", number: true },
      { name: "damping [%]", number: true },
      { name: "σ [%]", number: true },
      { name: "MPC", number: true },
      { name: "origin", wide: true },
      ...(view.page.identified ? [{ name: "change" }] : []),
    ];
    const percent = (v) => (v === null ? null : 100 * v);
    fill(
      rows,
      table(
        `${modes.length} modes${view.page.scaled ? ", shapes mass-normalised" : ""}`,
        columns,
        modes.map((m) => [
          m.mode,
          fixed(m.frequency_hz, 4),
          sigma(m.frequency_sigma_hz, 5),
          fixed(percent(m.damping_ratio), 4),
          sigma(percent(m.damping_sigma), 5),
          fixed(m.mpc, 3),
          m.whence,
          ...(view.page.identified
            ? [
                button("Drop", () => app.act("drop", { hertz: m.frequency_hz }), {
                  "aria-label": `drop mode ${m.mode}`,
                  class: "small",
                }),
              ]
            : []),
        ]),
      ),
      view.page.rejected?.length ? h("p", { class: "muted" }, `left out: ${view.page.rejected.join("; ")}`) : null,
    );
  }

  async function overlaid(provisional = null) {
    const names = view.page.frfs;
    view.frf = Math.min(view.frf ?? view.page.first, names.length - 1);
    fill(
      chooser,
      h(
        "label",
        {},
        "Response / force ",
        select(
          names.map((n, i) => [i, n]),
          view.frf,
          (v) => {
            view.frf = Number(v);
            app.quiet(overlaid());
          },
          { id: "fit-frf" },
        ),
      ),
    );
    const found =
      provisional && view.curve
        ? { ...view.curve, fitted: provisional.fitted, fitted_phase: provisional.fitted_phase, x2: provisional.x }
        : await get("fit", { index: view.frf });
    if (!provisional) view.curve = found;
    const traces = [
      line("measured", found.x, found.measured, "muted", { line: { width: 2.4 } }),
      line(provisional ? "fit, being refined" : "fit", found.x2 ?? found.x, found.fitted, "blue"),
      provisional ? null : line("residual", found.x, found.residual, "orange", { line: { width: 1 } }),
      found.noise ? line("noise, 1σ", found.x, found.noise, "faint", { line: { width: 1 } }) : null,
    ].filter(Boolean);
    await drawFrf(fit, {
      magnitude: traces,
      phase: [
        line("measured", found.x, found.phase, "muted", { line: { width: 2.4 } }),
        line("fit", found.x2 ?? found.x, found.fitted_phase, "blue"),
      ],
      unit: found.unit,
    });
  }

  async function damp() {
    const given = await get("damping");
    damped.hidden = !given;
    figured(damping, given ? [given] : []);
  }

  return { update };
}
