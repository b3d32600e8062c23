// Lines drawn by hand: two points clicked, or named, are joined; points that are joined are parted.

import { button, check, field, fill, h, select } from "./dom.js";

const STILL = 5; // pixels that a pointer may move in a click

/** Return {element, show(page)}: what draws lines in the viewer of shapes. */
export function joining(app, view) {
  const element = h("div", { class: "row", id: "joining" });
  let page = null;
  let on = false;
  let first = null; // number of the point clicked first
  let pressed = null;

  async function join(a, b) {
    first = null;
    const drawn = page.lines.map((pair) => pair.map((i) => page.nodes[i]));
    await app.act("join", { points: [page.nodes[a], page.nodes[b]], drawn });
  }

  view.canvas.addEventListener("pointerdown", (event) => {
    pressed = [event.clientX, event.clientY];
  });
  view.canvas.addEventListener("pointerup", (event) => {
    if (!on || !pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > STILL) return;
    const found = view.scene()?.pick(event);
    if (!found) return;
    if (first === null) marked(found.index);
    else if (first === found.index) marked(null);
    else app.quiet(join(first, found.index));
  });

  function marked(index) {
    first = index;
    view.scene()?.mark(index);
    tooled();
  }

  function tooled() {
    const points = page.nodes.map((node, i) => [i, node]);
    const ends = ["from", "to"].map((name, i) =>
      select(points, i === 0 ? (first ?? 0) : Math.min(1, points.length - 1), () => {}, { id: `join-${name}` }),
    );
    fill(
      element,
      check(
        "draw lines",
        on,
        (value) => {
          on = value;
          if (on) view.stop();
          view.scene()?.alone(on);
          marked(null);
        },
        { id: "join-on" },
      ),
      on
        ? [
            field("Point", ends[0]),
            field("and", ends[1]),
            button("Connect or disconnect", () => app.quiet(join(...ends.map((one) => Number(one.value)))), { id: "join" }),
            h(
              "span",
              { class: "muted", "aria-live": "polite" },
              first === null
                ? "or click two points to connect them, or to disconnect them if they are connected"
                : `from point ${page.nodes[first]}: click another one`,
            ),
          ]
        : null,
      page.stated
        ? button("Lines as found", () => app.act("set", { path: ["test", "lines"], value: "" }), { id: "join-reset" })
        : null,
    );
  }

  /** Show the tools for a page of shapes; points without places are not joined. */
  function show(given) {
    page = given;
    first = null;
    element.hidden = !page.modes.length || !page.placed || page.nodes.length < 2;
    if (!element.hidden) tooled();
  }

  return { element, show };
}
