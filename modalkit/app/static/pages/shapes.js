// Shapes: the structure as it moves in a mode, test and model, their difference.

import { get } from "../api.js";
import { fill, h } from "../dom.js";
import { joining } from "../joining.js";
import { viewer } from "../viewer.js";

export function open(root, app) {
  const nothing = h("div"),
    drawn = h("section", { class: "panel" }, h("h2", {}, "Shapes"));
  const view = viewer(drawn);
  const lines = joining(app, view);
  drawn.append(lines.element);
  const listed = h("section", { class: "panel" }, view.list);
  root.append(nothing, drawn, listed);
  let closed = false;

  async function update() {
    const page = await get("shapes");
    if (closed) return;
    drawn.hidden = listed.hidden = !page.modes.length;
    fill(nothing, page.modes.length ? null : h("p", {}, page.why));
    view.show(page);
    lines.show(page);
  }

  return {
    update,
    close: () => {
      closed = true;
      view.close();
    },
  };
}
