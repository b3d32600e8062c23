// Modes as they move: which one, how large, test and model, their difference. Given the data of the shapes.

import { button, check, field, fill, fixed, h, palette, select, table } from "./dom.js";
import { models, Scene, VIEWS } from "./scene.js";

/** Put a viewer of shapes into an element. Returns {show(page), stop(), recolour(), close(), list, canvas, scene()}. */
export function viewer(root, { kept = false } = {}) {
  const canvas = h("canvas", {
    tabindex: "0",
    role: "img",
    "aria-label": "the structure as it moves; arrow keys turn it, plus and minus zoom",
  });
  const tip = h("div", { class: "tip", hidden: true });
  const frame = h("div", { class: "canvas" }, canvas, tip);
  const picker = h("div", { class: "row", role: "group", "aria-label": "modes" }),
    tools = h("div", { class: "row" });
  const legend = h("p", { class: "muted", "aria-live": "polite" }),
    list = h("div");
  root.append(picker, tools, frame, legend);
  const view = { mode: 0, options: { model: "over", which: 0, difference: false, arrows: false, rest: false }, page: null, scene: null };

  function show(page) {
    view.page = page;
    if (!page.modes.length) return;
    view.mode = Math.min(view.mode, page.modes.length - 1);
    view.models = models(page);
    if (view.options.which >= view.models.length) view.options.which = 0;
    if (!view.scene && !view.flat) {
      try {
        view.scene = new Scene(canvas, palette(), { kept });
        if (matchMedia("(prefers-reduced-motion: reduce)").matches) view.scene.play(false);
      } catch {
        view.flat = true;
        frame.hidden = true;
      }
    }
    view.scene?.recolour(palette());
    view.scene?.show(page);
    tooled();
    chosen(view.mode);
    listed();
  }

  const again = () => chosen(view.mode);
  const slider = (name, key, most) =>
    field(
      name,
      h("input", {
        type: "range",
        min: "0.1",
        max: most,
        step: "0.1",
        value: String(view.scene[key]),
        input: (e) => {
          view.scene[key] = Number(e.target.value);
          view.scene.dirty = true;
        },
      }),
    );
  const tick = (name, key) =>
    check(
      name,
      view.options[key],
      (on) => {
        view.options[key] = on;
        again();
      },
      { id: key },
    );

  function tooled() {
    const scene = view.scene;
    if (!scene) return;
    const turn = () => {
      scene.play(!scene.playing);
      tooled();
    };
    const places = [
      ["over", "over the test"],
      ["beside", "beside the test"],
      ["no", "not shown"],
    ];
    const placed = (value) => {
      view.options.model = value;
      again();
    };
    const named = (value) => {
      view.options.which = Number(value);
      again();
      listed();
    };
    fill(
      tools,
      button(scene.playing ? "Pause" : "Play", turn, { id: "play" }),
      slider("Amplitude", "amplitude", "3"),
      slider("Speed", "speed", "2"),
      h(
        "span",
        { class: "row tight", role: "group", "aria-label": "view" },
        Object.keys(VIEWS).map((name) => button(name, () => scene.look(name), { class: "small", "data-view": name })),
      ),
      tick("undeformed", "rest"),
      tick("directions measured", "arrows"),
      view.models.length > 1
        ? field(
            "Model",
            select(
              view.models.map((one, i) => [i, one.name]),
              view.options.which,
              named,
              { id: "model-which" },
            ),
          )
        : null,
      view.page.model
        ? field(
            view.models.length > 1 ? "Where" : "Model",
            select(places, view.options.model, placed, { id: "model-shown" }),
          )
        : null,
      view.page.model ? tick("colour the difference", "difference") : null,
    );
  }

  function chosen(mode) {
    view.mode = mode;
    const page = view.page;
    fill(
      picker,
      page.modes.map((m, i) =>
        button(`${m.mode}: ${fixed(m.frequency_hz, 2)} Hz`, () => chosen(i), {
          "aria-pressed": i === mode ? "true" : "false",
          class: "pill",
        }),
      ),
    );
    view.scene?.choose(mode, view.options);
    fill(legend, caption(page, mode, view));
  }

  function listed() {
    const columns = COLUMNS.slice(0, view.page.model ? 8 : 3).map((name) => ({ name, number: true }));
    const which = view.models.length > 1 ? `; model ${view.models[view.options.which].name}` : "";
    const caption = `Shapes at ${view.page.nodes.length - view.page.still} points, ${view.page.arrows.length} directions${which}`;
    fill(
      list,
      table(
        caption,
        columns,
        view.page.modes.map((m, i) => row(m, view.models[view.options.which]?.modes[i]).slice(0, columns.length)),
      ),
    );
  }

  canvas.addEventListener("pointermove", (event) => {
    const found = event.buttons ? null : view.scene?.pick(event);
    tip.hidden = !found;
    if (!found) return;
    fill(tip, named(view.page, view.mode, found.index));
    const room = frame.clientWidth - tip.offsetWidth - 4;
    tip.style.left = `${Math.max(4, Math.min(found.x + 12, room))}px`;
    tip.style.top = `${found.y + 12}px`;
  });
  canvas.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });

  /** Stand still, to be drawn at. */
  function stop() {
    view.scene?.play(false);
    tooled();
  }

  return {
    show,
    stop,
    canvas,
    scene: () => view.scene,
    list,
    recolour: () => view.page && show(view.page),
    close: () => view.scene?.close(),
  };
}

const COLUMNS = ["mode", "test [Hz]", "MPC", "model mode", "model [Hz]", "error [%]", "MAC", "largest difference [%]"];

function row(mode, model) {
  const own = [mode.mode, fixed(mode.frequency_hz, 3), fixed(mode.mpc, 3)];
  if (!model) return [...own, "–", "–", "–", "–", "–"];
  const { frequency_hz: hertz, error_percent: error, mac } = model;
  return [
    ...own,
    model.mode,
    fixed(hertz, 3),
    fixed(error, 3),
    fixed(mac, 3),
    fixed(100 * Math.max(...model.difference), 1),
  ];
}

/** Say what is seen. */
function caption(page, mode, view) {
  const shape = page.modes[mode];
  const whole = view.models[view.options.which];
  const model = whole?.modes[mode];
  const whose = view.models.length > 1 ? ` (${whole.name})` : "";
  const complex = shape.mpc < 0.95 ? ", complex: its points pass through rest one after another" : "";
  const parts = [`Mode ${shape.mode} at ${fixed(shape.frequency_hz, 3)} Hz, MPC ${fixed(shape.mpc, 3)}${complex}.`];
  if (view.flat) parts.push("This browser cannot draw in three dimensions (no WebGL).");
  if (model) {
    const error = `${model.error_percent > 0 ? "+" : ""}${fixed(model.error_percent, 2)} %`;
    const grey = view.options.model === "over" ? ", grey" : "";
    parts.push(
      `Model${whose}: mode ${model.mode} at ${fixed(model.frequency_hz, 3)} Hz (${error}), MAC ${fixed(model.mac, 3)}${grey}.`,
    );
  } else if (whole) parts.push(`No mode of the model${whose} is its partner.`);
  if (model && view.options.difference)
    parts.push("Colours: difference from the model, green none to red 30 % of the largest motion.");
  if (page.still)
    parts.push(
      page.still === 1
        ? "One point of the lines was not measured and is drawn at rest."
        : `${page.still} points of the lines were not measured and are drawn at rest.`,
    );
  if (page.lines_from === "grid" && page.lines.length) parts.push("The file has no lines; neighbours on the grid are joined.");
  if (page.why) parts.push(`${page.why[0].toUpperCase()}${page.why.slice(1)}.`);
  if (page.no_model && page.no_model !== "the study has no [model]") parts.push(`No model: ${page.no_model}`);
  return parts.join(" ");
}

/** Return what is known of a point: its number, place, and how far it moves along each axis. */
function named(page, mode, index) {
  const shape = page.modes[mode];
  const largest = Math.max(1e-300, ...shape.re.map((v, i) => Math.hypot(...v, ...shape.im[i])));
  const motion = [0, 1, 2]
    .map((k) => ["XYZ"[k], Math.hypot(shape.re[index][k], shape.im[index][k]) / largest])
    .filter(([, value]) => value > 0.0005)
    .map(([axis, value]) => `${axis} ${(100 * value).toFixed(1)} %`);
  const place = page.placed ? ` at ${page.places[index].map((v) => v.toPrecision(4)).join(", ")} m` : "";
  const unknown = index >= page.nodes.length - page.still;
  return `point ${page.nodes[index]}${place}: ${unknown ? "not measured" : motion.join(", ") || "at rest"}`;
}
