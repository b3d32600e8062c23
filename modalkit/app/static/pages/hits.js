// Hits: every verdict with its reason, the records of one, and the FRF that follows from what is used.

import { get } from "../api.js";
import { warned } from "../asked.js";
import { axis, colour, draw, drawFrf, escaped, line } from "../charts.js";
import { button, check, fill, h, select } from "../dom.js";

const SHADES = ["orange", "green", "red", "muted"]; // of FRFs over one another; their names are at the cursor
const THIN = { line: { width: 1 }, opacity: 0.75 };

export function open(root, app) {
  const list = h("div", { class: "hits-list" });
  const verdict = h("p", { class: "verdict", "aria-live": "polite" });
  const charts = { force: h("div"), spectrum: h("div"), response: h("div"), frf: h("div") };
  const chooser = h("div", { class: "row" });
  const notes = h("div");
  const records = h(
    "section",
    { class: "panel" },
    h("h2", {}, "The hit"),
    verdict,
    h("div", { class: "two" }, titled("Force", charts.force), titled("Spectrum of the force", charts.spectrum)),
    titled("Response", charts.response),
  );
  const heading = h("h2", {}, "FRF of the hits used");
  const picture = h(
    "section",
    { class: "panel" },
    heading,
    chooser,
    charts.frf,
  );
  const side = h("section", { class: "panel side" }, h("h2", {}, "Hits"), list);
  root.append(notes, h("div", { class: "columns" }, side, h("div", {}, records, picture)));
  const view = { overlaid: false, hit: null, frf: null, page: null, before: null };

  async function update() {
    view.page = await get("hits");
    const { hits, frfs } = view.page;
    fill(notes, warned(app, view.page.warnings, view.page.asks));
    records.hidden = !hits.length;
    heading.textContent = hits.length ? "FRF of the hits used" : "FRFs";
    if (!hits.length) {
      fill(
        list,
        h(
          "p",
          {},
          frfs.length
            ? "This file contains FRFs only; there are no hits to check."
            : "The test has modes only, without hits or FRFs. Continue on the page of modes.",
        ),
      );
    } else {
      if (!view.hit || !hits.some(same)) view.hit = hits.find((v) => !v.used) ?? hits[0];
      listed();
    }
    picture.hidden = !frfs.length;
    view.frf = Math.min(view.frf ?? view.page.first, frfs.length - 1);
    if (frfs.length) chosen();
    await Promise.all([hits.length ? record() : null, frfs.length ? frf() : null]);
  }

  const same = (v) => v.point === view.hit.point && v.hit === view.hit.hit;

  function listed() {
    const { hits, force } = view.page;
    const out = hits.filter((v) => !v.used).length;
    const groups = Map.groupBy ? Map.groupBy(hits, (v) => v.point) : grouped(hits);
    fill(
      list,
      h("p", { class: "muted" }, `${hits.length} hits, ${out} left out. ${force ? `Force: ${force}.` : ""}`),
      h(
        "div",
        { class: "scroll tall", tabindex: "0", role: "region", "aria-label": "hits" },
        [...groups].map(([point, those]) =>
          h("fieldset", { class: "point" }, h("legend", {}, point), those.map(item)),
        ),
      ),
    );
  }

  function item(v) {
    const box = h("input", {
      type: "checkbox",
      checked: v.used,
      "aria-label": `use hit ${v.hit} at ${v.point}`,
      "data-hit": `${v.point}:${v.hit}`,
      change: () => app.quiet(judged(v, box.checked)),
    });
    return h(
      "div",
      { class: `hit ${v.used ? "" : "out"} ${same(v) ? "chosen" : ""}` },
      box,
      button(
        h(
          "span",
          {},
          `hit ${v.hit} · ${v.peak}`,
          v.decided ? h("em", {}, " by you") : null,
          v.reasons.length ? h("small", {}, v.reasons.join("; ")) : null,
        ),
        () => {
          view.hit = v;
          listed();
          app.quiet(record());
        },
        { class: "plain", "aria-pressed": same(v) ? "true" : "false" },
      ),
    );
  }

  async function judged(v, used) {
    view.hit = v;
    view.before = view.curve;
    await app.act("hit", { point: v.point, hit: v.hit, used, proposed: v.proposed });
  }

  async function record() {
    const { point, hit } = view.hit;
    const found = await get("record", { point, hit });
    if (view.hit.point !== point || view.hit.hit !== hit) return;
    const v = found.verdict;
    fill(
      verdict,
      h("strong", {}, `Hit ${hit} at ${point}: ${v.used ? "used" : "left out"}. `),
      v.reasons.join("; ") || "No fault was found.",
    );
    const mark = v.used ? "green" : "red";
    const s = found.spectrum;
    await Promise.all([
      draw(charts.force, [line("force", found.force.time, found.force.value, mark)], {
        showlegend: false,
        height: 240,
        xaxis: axis("time [s]", { range: found.force.range }),
        yaxis: axis("force [N]"),
        annotations: [reason(v)],
      }),
      draw(charts.spectrum, [line("force", s.frequency, s.level, mark)], {
        showlegend: false,
        height: 240,
        xaxis: axis("frequency [Hz]"),
        yaxis: axis("level [dB]", { range: [-45, 5] }),
        shapes: [down(s.band10, -10), down(s.band20, -20)].flat(),
        annotations: [
          at(s.band10, -10, `−10 dB: ${v.band10}`, -1),
          at(s.band20, -20, `−20 dB: ${v.band20}`, s.band20 > 0.7 * s.frequency[s.frequency.length - 1] ? -1 : 1),
        ],
      }),
      draw(
        charts.response,
        found.responses.map((r, i) => line(r.dof, r.time, r.value, ["blue", "orange", "green", "red"][i % 4])),
        {
          height: 240,
          showlegend: found.responses.length > 1,
          xaxis: axis("time [s]"),
          yaxis: axis(`response [${found.unit}]`),
        },
      ),
    ]);
  }

  const reason = (v) => ({
    xref: "paper",
    yref: "paper",
    x: 0.99,
    y: 0.97,
    xanchor: "right",
    yanchor: "top",
    showarrow: false,
    align: "right",
    text: escaped(v.used ? "used" : (v.reasons[0] ?? "left out")),
    font: { color: colour(v.used ? "green" : "red"), size: 12 },
  });
  const down = (x, y) => [
    { type: "line", x0: x, x1: x, y0: -45, y1: y, line: { color: colour("muted"), width: 1, dash: "dot" } },
    { type: "line", xref: "paper", x0: 0, x1: 1, y0: y, y1: y, line: { color: colour("grid"), width: 1 } },
  ];
  /** Write a level beside its point, to the right of it (1) or to the left (-1). */
  const at = (x, y, text, side) => ({
    x,
    y,
    text,
    showarrow: true,
    arrowhead: 0,
    arrowcolor: colour("muted"),
    ax: 14 * side,
    ay: 16,
    xanchor: side > 0 ? "left" : "right",
    bgcolor: colour("panel"),
    font: { size: 12 },
  });

  function chosen() {
    fill(
      chooser,
      h(
        "label",
        {},
        "Response / force ",
        select(
          view.page.frfs.map((name, i) => [i, name]),
          view.frf,
          (v) => {
            view.frf = Number(v);
            view.before = null;
            app.quiet(frf());
          },
          { id: "frf" },
        ),
      ),
      h(
        "label",
        {},
        "Estimator ",
        select(
          [
            ["H1", "H1"],
            ["H2", "H2"],
            ["Hv", "Hv"],
          ],
          view.page.estimator,
          (v) => app.act("estimator", { name: v }),
          { disabled: !view.page.hits.length, id: "estimator" },
        ),
      ),
      check(
        "with the other FRFs of the same force or response",
        view.overlaid,
        (on) => {
          view.overlaid = on;
          app.quiet(frf());
        },
        { id: "overlay" },
      ),
    );
  }

  async function frf() {
    const [found, others] = await Promise.all([
      get("frf", { index: view.frf }),
      view.overlaid ? get("others", { index: view.frf }) : { curves: [] },
    ]);
    view.curve = { ...found, index: view.frf };
    const old =
      view.before && view.before.name === found.name && String(view.before.magnitude) !== String(found.magnitude)
        ? view.before
        : null;
    const dotted = { color: colour("muted"), dash: "dot", width: 1 };
    const both = (name, key, shade) =>
      [
        old?.[key] ? line("before", old.x, old[key], "faint") : null,
        found[key] ? line(name, found.x, found[key], shade) : null,
      ].filter(Boolean);
    await drawFrf(charts.frf, {
      magnitude: [
        ...both(found.hits ? `of ${found.hits} hits` : "FRF", "magnitude", "blue").reverse(),
        ...others.curves.map((one, i) => line(one.name, others.x, one.magnitude, SHADES[i % 4], THIN)),
      ],
      phase: both("phase", "phase", "blue"),
      coherence: both("coherence", "coherence", "orange"),
      unit: found.unit,
      showlegend: Boolean(old) || others.curves.length > 0,
      shapes: found.band20 ? [{ type: "line", x0: found.band20, x1: found.band20, line: dotted }] : [],
      annotations: found.band20
        ? [
            {
              x: found.band20,
              yref: "paper",
              y: 1,
              text: "force −20 dB",
              showarrow: false,
              xanchor: found.band20 > 0.8 * found.x[found.x.length - 1] ? "right" : "left",
              yanchor: "top",
              font: { size: 11, color: colour("muted") },
            },
          ]
        : [],
    });
  }

  return { update };
}

const titled = (text, chart) => h("figure", {}, h("figcaption", {}, text), chart);

function grouped(hits) {
  const groups = new Map();
  for (const v of hits) groups.set(v.point, [...(groups.get(v.point) ?? []), v]);
  return groups;
}
