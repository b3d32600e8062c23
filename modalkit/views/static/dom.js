// Elements made of data: every text goes in as text, never as markup.

/** Return an element. Attributes that are functions are listeners; children are nodes, texts, or lists of these. */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name, value);
    else if (name in element && typeof value !== "string") element[name] = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

function append(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
}

/** Put children in place of those an element has. */
export function fill(element, ...children) {
  element.replaceChildren();
  append(element, children);
}

/**
 * Return a table in a frame that scrolls. Columns are {name, number?}; cells are texts or nodes. A click on a column
 * sorts by it, a second one the other way round; the table can be copied into a spreadsheet.
 */
export function table(caption, columns, rows, options = {}) {
  const lines = rows.map((row, i) =>
    h(
      "tr",
      { "data-row": String(i), ...(options.row ? options.row(i) : {}) },
      row.map((cell, k) =>
        h(
          k ? "td" : "th",
          { scope: k ? null : "row", class: columns[k].number ? "n" : columns[k].wide ? "wide" : null },
          cell,
        ),
      ),
    ),
  );
  const body = h("tbody", {}, lines);
  const heads = columns.map((c, k) =>
    h("th", { scope: "col", class: c.number ? "n" : null }, button(c.name, () => sorted(k), { class: "sort" })),
  );
  const copying = button("Copy", () => copied(copying, [heads, ...body.rows].map(cells)), {
    class: "small copy",
    title: "copy the table for a spreadsheet",
  });

  function sorted(k) {
    const down = heads[k].getAttribute("aria-sort") === "ascending";
    heads.forEach((one) => one.removeAttribute("aria-sort"));
    heads[k].setAttribute("aria-sort", down ? "descending" : "ascending");
    body.append(...[...lines].sort((a, b) => (down ? -1 : 1) * compared(written(a.cells[k]), written(b.cells[k]))));
  }

  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    h(
      "table",
      {},
      h("caption", {}, h("span", {}, caption), rows.length ? copying : null),
      h("thead", {}, h("tr", {}, heads)),
      body,
    ),
  );
}

/** Return the text of a cell; of a list of choices the chosen one, of a button nothing. */
function written(cell) {
  const list = cell.querySelector("select");
  if (list) return list.selectedOptions[0]?.textContent ?? "";
  return cell.tagName === "TD" && cell.querySelector("button") ? "" : cell.textContent.trim();
}

const cells = (row) => [...(row.cells ?? row)].map(written);

/** Compare two texts as numbers where both begin with one, else as texts. */
function compared(a, b) {
  const [p, q] = [a, b].map((text) => parseFloat(text.replace(/^[<>]\s*/, "").replace("−", "-")));
  if (Number.isNaN(p) || Number.isNaN(q)) return Number.isNaN(p) - Number.isNaN(q) || a.localeCompare(b);
  return p - q;
}

async function copied(mark, lines) {
  const text = lines.map((line) => line.join("\t")).join("\n");
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = h("textarea", { value: text }); // a page without leave to write
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  mark.textContent = "Copied";
  setTimeout(() => (mark.textContent = "Copy"), 1500);
}

/** Return a field with its label. */
export function field(label, input, unit = "") {
  return h(
    "label",
    { class: "field" },
    h("span", {}, label),
    h("span", { class: "with-unit" }, input, unit ? h("span", { class: "unit" }, unit) : null),
  );
}

export function button(text, onclick, attributes = {}) {
  return h("button", { type: "button", click: onclick, ...attributes }, text);
}

export function select(options, value, onchange, attributes = {}) {
  const element = h(
    "select",
    { change: () => onchange(element.value), ...attributes },
    options.map(([v, text]) => h("option", { value: v, selected: String(v) === String(value) }, text)),
  );
  return element;
}

/** Return a check box with its text behind it; what it becomes is passed on. */
export function check(text, checked, onchange, attributes = {}) {
  const change = (event) => onchange(event.target.checked);
  return h("label", { class: "check" }, h("input", { type: "checkbox", checked, change, ...attributes }), text);
}

/** Return numbers as the tables of the command line have them. */
export const fixed = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits));
/** Return a standard deviation with so many decimals, or where these would be nothing, with two digits. */
export const sigma = (value, digits) =>
  value > 0 && value < 10 ** -digits ? value.toExponential(1) : fixed(value, digits);
/** Return a unit with its exponents raised: m² for m^2. */
export const raised = (unit) => unit.replace(/\^(-?\d+)/g, (_, digits) => [...digits].map((c) => RAISED[c]).join(""));
const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
export const short = (value) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(4))));

/** Return the panel of a page that needs a model where the study has none. */
export function withoutModel(title, purpose) {
  const text = `There is no model to ${purpose}: open a study that has one, or make one on the page of the model.`;
  return h("section", { class: "panel" }, h("h2", {}, title), h("p", {}, text));
}

/** Return a colour of the page by its name in style.css. */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Return the colours that a scene needs. */
export const palette = () =>
  Object.fromEntries(["blue", "orange", "green", "red", "muted", "middle", "ink", "panel"].map((name) => [name, colour(name)]));
