// Warnings with what they ask for: a field that writes the key into the study, a button that leaves out a hit.

import { button, field, h } from "./dom.js";

/** Return warnings, the first of many, which counts most, before the list of the others; `after` runs once a key is
 * written, as work that is to be done again. */
export function warned(app, list, asks = {}, after = null) {
  if (!list?.length) return null;
  const [first, ...others] = list;
  if (others.length < 2) return listed(app, list, asks, after);
  return [h("div", { class: "first-warning" }, first, answering(app, asks[first], after)), listed(app, others, asks, after, "more ")];
}

function listed(app, list, asks, after, more = "") {
  return h(
    "details",
    { class: "warnings", open: list.length < 3 || list.some((text) => asks[text]) },
    h("summary", {}, `${list.length} ${more}${list.length > 1 ? "warnings" : "warning"}`),
    h(
      "ul",
      {},
      list.map((text) => h("li", {}, text, answering(app, asks[text], after))),
    ),
  );
}

/** Return the fields for what one warning asks for; null where it only informs. */
export function answering(app, asked, after) {
  if (!asked) return null;
  const change = async (name, values) => (await app.act(name, values)) && after?.();
  const [point, hit] = asked.hit ?? [];
  return h(
    "div",
    { class: "row asked" },
    asked.keys.map((key) => keyed(key, (value) => change("set", { path: key.path.split("."), value }), after)),
    asked.hit
      ? button(`Leave out hit ${hit} at ${point}`, () =>
          change("hit", { point, hit, used: false, proposed: true }),
        )
      : null,
  );
}

function keyed(key, write, after) {
  const input = h("input", {
    type: "text",
    value: key.proposed,
    size: 9,
    id: `ask-${key.path}`,
    keydown: (event) => event.key === "Enter" && input.value && write(input.value),
  });
  return [
    field(key.label, input, key.unit),
    button(after ? "Set and run again" : "Set", () => input.value && write(input.value), { id: `ask-${key.path}-set` }),
  ];
}
