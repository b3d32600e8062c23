// Shapes: the structure as it moves in a mode, test and model, their difference.

import { get } from "../api.js";
import { colour } from "../charts.js";
import { button, field, fill, fixed, h, select, table } from "../dom.js";
import { Scene } from "../scene.js";

export function open(root, app) {
  const canvas = h("canvas", {
    tabindex: "0",
    role: "img",
    "aria-label": "the structure as it moves; arrow keys turn it, plus and minus bring it near",
  });
  const frame = h("div", { class: "canvas" }, canvas);
  const picker = h("div", { class: "row", role: "group", "aria-label": "modes" }),
    tools = h("div", { class: "row" });
  const legend = h("p", { class: "muted", "aria-live": "polite" }),
    list = h("div"),
    nothing = h("div");
  const drawn = h("section", { class: "panel" }, h("h2", {}, "Shapes"), picker, tools, frame, legend);
  root.append(nothing, drawn, h("section", { class: "panel" }, list));
  const view = { mode: 0, options: { model: "over", difference: false, arrows: false }, page: null, scene: null };

  async function update() {
    view.page = await get("shapes");
    if (view.closed) return;
    const page = view.page;
    drawn.hidden = !page.modes.length;
    fill(nothing, page.modes.length ? null : h("p", {}, page.why));
    if (!page.modes.length) return;
    view.mode = Math.min(view.mode, page.modes.length - 1);
    if (!view.scene) {
      try {
        view.scene = new Scene(canvas, colours());
      } catch {
        fill(legend, "This browser draws nothing in three dimensions (no WebGL).");
      }
      const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
      if (view.scene && calm) view.scene.play(false);
    }
    view.scene?.recolour(colours());
    view.scene?.show(page);
    tooled();
    chosen(view.mode);
    listed();
  }

  const colours = () =>
    Object.fromEntries(
      ["blue", "orange", "green", "red", "muted", "middle", "ink"].map((name) => [name, colour(name)]),
    );

  function tooled() {
    const page = view.page;
    const scene = view.scene;
    const again = () => chosen(view.mode);
    fill(
      tools,
      button(
        scene?.playing ? "Pause" : "Play",
        () => {
          scene.play(!scene.playing);
          tooled();
        },
        { id: "play" },
      ),
      field(
        "Amplitude",
        h("input", {
          type: "range",
          min: "0.1",
          max: "3",
          step: "0.1",
          value: String(scene?.amplitude ?? 1),
          input: (e) => {
            scene.amplitude = Number(e.target.value);
            scene.dirty = true;
          },
        }),
      ),
      field(
        "Speed",
        h("input", {
          type: "range",
          min: "0.1",
          max: "2",
          step: "0.1",
          value: String(scene?.speed ?? 0.8),
          input: (e) => {
            scene.speed = Number(e.target.value);
          },
        }),
      ),
      h(
        "label",
        { class: "check" },
        h("input", {
          type: "checkbox",
          checked: view.options.arrows,
          change: (e) => {
            view.options.arrows = e.target.checked;
            again();
          },
        }),
        "directions measured",
      ),
      page.model
        ? field(
            "Model",
            select(
              [
                ["over", "over the test"],
                ["beside", "beside the test"],
                ["no", "not shown"],
              ],
              view.options.model,
              (v) => {
                view.options.model = v;
                again();
              },
              { id: "model-shown" },
            ),
          )
        : null,
      page.model
        ? h(
            "label",
            { class: "check" },
            h("input", {
              type: "checkbox",
              checked: view.options.difference,
              id: "difference",
              change: (e) => {
                view.options.difference = e.target.checked;
                again();
              },
            }),
            "colour the difference",
          )
        : null,
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
    const shape = page.modes[mode];
    const model = page.model?.modes[mode];
    const parts = [
      `Mode ${shape.mode} at ${fixed(shape.frequency_hz, 3)} Hz, MPC ${fixed(shape.mpc, 3)}${shape.mpc < 0.95 ? ", complex: its points pass through rest one after another" : ""}.`,
    ];
    if (model)
      parts.push(
        `Model mode ${model.mode} at ${fixed(model.frequency_hz, 3)} Hz (${model.error_percent > 0 ? "+" : ""}${fixed(model.error_percent, 2)} %), MAC ${fixed(model.mac, 3)}${view.options.model === "over" ? ", grey" : ""}.`,
      );
    else if (page.model) parts.push("No mode of the model is its partner.");
    if (model && view.options.difference)
      parts.push("Colours: difference from the model, green none to red 30 % of the largest motion.");
    if (page.why) parts.push(`${page.why[0].toUpperCase()}${page.why.slice(1)}.`);
    if (page.no_model && page.no_model !== "the study has no [model]") parts.push(`No model: ${page.no_model}`);
    fill(legend, parts.join(" "));
  }

  function listed() {
    const page = view.page;
    const columns = [
      { name: "mode", number: true },
      { name: "test [Hz]", number: true },
      { name: "MPC", number: true },
      ...(page.model
        ? [
            { name: "model mode", number: true },
            { name: "model [Hz]", number: true },
            { name: "error [%]", number: true },
            { name: "MAC", number: true },
            { name: "largest difference [%]", number: true },
          ]
        : []),
    ];
    fill(
      list,
      table(
        `Shapes at ${page.nodes.length} points, ${page.arrows.length} directions`,
        columns,
        page.modes.map((m, i) => {
          const model = page.model?.modes[i];
          return [
            m.mode,
            fixed(m.frequency_hz, 3),
            fixed(m.mpc, 3),
            ...(page.model
              ? model
                ? [
                    model.mode,
                    fixed(model.frequency_hz, 3),
                    fixed(model.error_percent, 3),
                    fixed(model.mac, 3),
                    fixed(100 * Math.max(...model.difference), 1),
                  ]
                : ["–", "–", "–", "–", "–"]
              : []),
          ];
        }),
      ),
    );
  }

  return {
    update,
    close: () => {
      view.closed = true;
      view.scene?.close();
    },
  };
}
