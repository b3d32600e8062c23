// Import of text and of recorder files: files chosen, columns guessed and corrected, what would be read, layout and study written.

import { get, post } from "../api.js";
import { button, check, field, fill, h, select, table } from "../dom.js";

const PAUSE = 300; // milliseconds after the last correction until the files are read with it
const DIRECTIONS = ["+x", "-x", "+y", "-y", "+z", "-z", "+rx", "-rx", "+ry", "-ry", "+rz", "-rz"].map((d) => [d, d]);
const PARTS = ["real", "imag", "magnitude", "phase"].map((p) => [p, p]);
const MAT = [
  ["frfs", "FRFs are in"],
  ["frequency", "Frequencies are in"],
  ["axes", "Dimensions"],
  ["quantity", "Quantity", ["accelerance", "mobility", "receptance"].map((q) => [q, q])],
  ["unit", "Unit"],
  ["responses", "Measured at"],
  ["references", "Hit at"],
]; // of an array of FRFs in a MATLAB file: key, label, choices
const AXES = ["", "time", "frequency"]; // what a column can be without being read as a signal

export function open(root, app) {
  const list = h("div"),
    count = h("span", { class: "muted", id: "import-count" }),
    writing = h("div", { class: "row" }),
    lines = h("pre", { id: "import-lines", tabindex: "0" }),
    once = h("div", { class: "fields" }),
    columns = h("div"),
    read = h("div", { id: "import-read", "aria-live": "polite" }),
    making = h("div", { class: "row" });
  const view = { page: null, files: new Set(), form: null, written: {}, asked: 0, timer: null, closed: false };
  const panel = (title, ...inside) => h("section", { class: "panel" }, h("h2", {}, title), ...inside);
  const columned = panel("Columns", once, columns),
    last = panel("What is read", read, making),
    shown = panel("First lines", writing, lines);
  root.append(panel("Files", list), shown, columned, last);

  async function update() {
    if (view.page) return;
    view.page = await get("import");
    view.files = new Set(view.page.chosen);
    listed();
    written();
    await proposed();
  }

  const chosen = () => view.page.files.filter((name) => view.files.has(name));

  function listed() {
    const pattern = h("input", { type: "text", id: "import-pattern", placeholder: "P*_*.csv, P1/*", size: 14 });
    const again = (names) => {
      view.files = new Set(names);
      listed();
      app.quiet(proposed());
    };
    const matched = () => pattern.value && again(view.page.files.filter(glob(pattern.value)));
    pattern.addEventListener("keydown", (event) => event.key === "Enter" && matched());
    fill(
      list,
      h("p", { class: "muted" }, `Choose the files of one test in ${view.page.folder}.`),
      view.page.why ? h("details", {}, h("summary", {}, "Why the file is not opened as it is"), view.page.why) : null,
      h(
        "div",
        { class: "row" },
        field("Names", pattern),
        button("Choose", matched, { id: "import-match" }),
        button("All", () => again(view.page.files)),
        button("None", () => again([])),
        count,
      ),
      h(
        "div",
        { class: "scroll files", tabindex: "0", role: "region", "aria-label": "files" },
        view.page.files.map((name) =>
          check(
            name,
            view.files.has(name),
            (on) => {
              if (on) view.files.add(name);
              else view.files.delete(name);
              counted();
              app.quiet(proposed());
            },
            { "data-file": name },
          ),
        ),
      ),
    );
    counted();
  }

  const counted = () => fill(count, `${view.files.size} of ${view.page.files.length} chosen`);

  /** Fields for how numbers are written; each change has the columns guessed anew. */
  function written() {
    const keep = (key) => (value) => {
      view.written[key] = value;
      app.quiet(proposed());
    };
    const skip = h("input", {
      type: "number",
      min: "0",
      value: "0",
      id: "import-skip",
      style: "width: 5rem",
      change: (event) => keep("skip")(event.target.value),
    });
    const separators = ["auto", "comma", "semicolon", "tab", "space"].map((s) => [s, s === "auto" ? "as found" : s]);
    const decimals = [
      ["auto", "as found"],
      [".", "point"],
      [",", "comma"],
    ];
    fill(
      writing,
      field("Lines to skip", skip),
      field("Separator", select(separators, "auto", keep("separator"), { id: "import-separator" })),
      field("Decimal sign", select(decimals, "auto", keep("decimal"), { id: "import-decimal" })),
    );
  }

  async function proposed() {
    const asked = ++view.asked;
    const files = chosen();
    const found = files.length
      ? await app.working("guessing the columns", () => post("proposed", { files, written: view.written }))
      : { lines: [], form: null, error: "No file is chosen." };
    if (asked !== view.asked || view.closed) return;
    writing.hidden = Boolean(found.recorded);
    shown.querySelector("h2").textContent = found.recorded ? "Channels in the first file" : "First lines";
    fill(lines, found.lines.map((text, i) => `${String(i + 1).padStart(3)}  ${text}\n`));
    lines.setAttribute("aria-label", `first lines of ${found.file ?? "no file"}`);
    view.form = found.form;
    columned.hidden = making.hidden = !found.form;
    if (!found.form) {
      fill(read, h("p", { class: "error" }, found.error));
      return;
    }
    topped();
    rowed();
    made();
    await checked();
  }

  /** Read the files with the form as it is, once nothing was changed for a moment. */
  function corrected() {
    clearTimeout(view.timer);
    view.timer = setTimeout(() => app.quiet(checked()), PAUSE);
  }

  const input = (object, key, more = {}) =>
    h("input", {
      type: "text",
      value: String(object[key] ?? ""),
      size: 8,
      input: (event) => {
        object[key] = event.target.value;
        corrected();
      },
      ...more,
    });
  const choice = (object, key, options, more = {}, then = corrected) =>
    select(
      options,
      object[key],
      (value) => {
        object[key] = value;
        then();
      },
      more,
    );

  function topped() {
    const form = view.form;
    const belongs = [["", ofFrfs() ? "where it was hit" : "the force"]].concat(
      form.rows.map((row, i) => [String(i), row.name]).filter(([i]) => !AXES.includes(form.rows[i].role) && form.rows[i].role !== "force"),
    );
    const of = form.rows.findIndex((row) => row.key === form.match_column);
    const why = (key) => (form.why[key] ? h("small", { class: "muted" }, form.why[key]) : null);
    fill(
      once,
      ofFrfs() && !form.mat ? null : h("div", {}, field("Sampling rate", input(form, "rate", { id: "import-rate" }), "Hz"), why("rate"), why("time_column")),
      ofFrfs() && !form.mat ? null : field(form.mat ? "Samples transformed" : "Cut records to", input(form, "samples", { placeholder: form.mat ? "" : "all" }), "samples"),
      field("Decay of an exponential window", input(form, "decay", { placeholder: "0" }), "1/s"),
      h("div", {}, field("Nodes from file names", input(form, "match", { id: "import-node-names", size: 16, placeholder: "P{node}_*.csv" })), why("match")),
      form.mat ? MAT.map(([key, label, options]) => h("div", {}, field(label, options ? choice(form.mat, key, options, { id: `import-${key}` }) : input(form.mat, key, { id: `import-${key}`, size: 24 })), why(key))) : null,
      form.mat ? null : field(
        "These are the nodes of",
        select(belongs, of < 0 ? "" : String(of), (value) => {
          form.match_column = value === "" ? "" : form.rows[Number(value)].key;
          corrected();
        }),
      ),
    );
  }

  const ofFrfs = () => Boolean(view.form.mat) || view.form.rows.some((row) => row.role === "frequency");

  function rowed() {
    columns.hidden = Boolean(view.form.mat);
    if (view.form.mat) return;
    const frfs = ofFrfs();
    const names = ["column", "holds", "first numbers", "unit", "scale"].concat(
      frfs ? ["part", "measured at", "direction", "hit at", "direction hit"] : ["node", "direction"],
      "why",
    );
    fill(
      columns,
      table(
        `${view.form.rows.length} columns; a column "not read" is left out`,
        names.map((name) => ({ name, wide: name === "why", number: name === "first numbers" })),
        view.form.rows.map((row, i) => cells(row, i, frfs)),
      ),
    );
  }

  function cells(row, i, frfs) {
    const named = (what) => ({ "aria-label": `${what} of ${row.name}`, id: `import-${what.replaceAll(" ", "-")}-${i}` });
    const holds = choice(row, "role", Object.entries(view.page.roles), named("quantity"), () => {
      topped();
      rowed();
      corrected();
      document.getElementById(`import-quantity-${i}`)?.focus();
    });
    const first = row.values.join(", ");
    const gap = Array(frfs ? 7 : 4).fill("");
    if (AXES.includes(row.role)) return [row.name, holds, first, ...gap, row.why.join("; ")];
    return [
      row.name,
      holds,
      first,
      input(row, "unit", { placeholder: "SI", ...named("unit") }),
      input(row, "scale", { placeholder: "1", ...named("scale") }),
      ...(frfs ? [choice(row, "part", PARTS, named("part"))] : []),
      input(row, "node", { size: 4, inputmode: "numeric", placeholder: "?", required: "", ...named("node") }),
      choice(row, "direction", DIRECTIONS, named("direction")),
      ...(frfs
        ? [
            input(row, "reference_node", { size: 4, inputmode: "numeric", ...named("node hit") }),
            choice(row, "reference_direction", DIRECTIONS, named("direction hit")),
          ]
        : []),
      row.why.join("; "),
    ];
  }


  async function checked() {
    const asked = ++view.asked;
    const found = await app.working("reading the files", () => post("checked", { files: chosen(), form: view.form }));
    if (asked !== view.asked || view.closed) return;
    making.querySelector("#import-write").disabled = Boolean(found.error);
    fill(
      read,
      found.error
        ? h("p", { class: "error", id: "import-error" }, found.error)
        : [
            h("p", { class: "big", id: "import-usable" }, found.usable.join("; ")),
            table(
              "Values by point. Values far from those expected indicate a wrong unit.",
              found.columns.map((name, k) => ({ name, number: k !== 0 && name !== "measured at" })),
              found.table.map((row) => row.map(String)),
            ),
          ],
    );
  }

  function made() {
    if (making.firstChild) return;
    const { page } = view;
    const write = async () => {
      clearTimeout(view.timer);
      const body = { files: chosen(), form: view.form, title: page.title, layout: page.layout, study: page.study };
      try {
        app.opened(await app.working("writing", () => post("write", body)));
      } catch {
        /* stated in the notice */
      }
    };
    const typed = (key) => h("input", { type: "text", value: page[key], id: `import-${key}`, input: (e) => (page[key] = e.target.value) });
    fill(
      making,
      field("Title", typed("title")),
      field("Layout", typed("layout")),
      field("Study", typed("study")),
      button("Write layout and study", write, { class: "primary", id: "import-write" }),
    );
  }

  return {
    update,
    close: () => {
      view.closed = true;
      clearTimeout(view.timer);
    },
  };
}

/** Return whether a name fits a pattern in which * stands for any text and ? for one character. */
function glob(pattern) {
  const literal = pattern.trim().replace(/[.+^${}()|[\]\\]/g, "\\$&");
  const expression = new RegExp(`^${literal.replaceAll("*", ".*").replaceAll("?", ".")}$`, "i");
  return (name) => expression.test(name);
}
