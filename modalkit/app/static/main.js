// The page: which part of the way of the work is shown, undo and redo, what runs.

import { get, post } from "./api.js";
import { button, fill, h } from "./dom.js";
import * as diagnosis from "./pages/diagnosis.js";
import * as hits from "./pages/hits.js";
import * as importing from "./pages/import.js";
import * as model from "./pages/model.js";
import * as modes from "./pages/modes.js";
import * as shapes from "./pages/shapes.js";
import * as update from "./pages/update.js";

const PAGES = {
  hits: ["Hits", hits],
  modes: ["Modes", modes],
  shapes: ["Shapes", shapes],
  model: ["Model", model],
  update: ["Update", update],
  diagnosis: ["Diagnosis", diagnosis],
};
const NEEDS_MODEL = new Set(["update", "diagnosis"]);

const byId = (id) => document.getElementById(id);

/** What pages are given: the state, ways to change it, and to say what happens. */
const app = {
  state: null,
  shown: null,
  page: "",
  act(name, args = {}) {
    return counted(changed(() => post("act", { name, arguments: args })));
  },
  change(name, body = {}) {
    return counted(changed(() => post(name, body)));
  },
  async working(text, work) {
    notice(text, "busy");
    const watch = setInterval(watched, WATCH);
    try {
      const found = await counted(work());
      if (byId("notice").className === "busy") notice("");
      return found;
    } catch (error) {
      notice(error.message, "error");
      throw error;
    } finally {
      clearInterval(watch);
    }
  },
  /** Go on with the study that an import has written. */
  opened(state) {
    app.state = state;
    if (location.hash === "#hits") app.quiet(show());
    else location.hash = "hits"; // which shows the page
  },
  notice,
  quiet(promise) {
    counted(promise).catch(() => {});
  },
};

const WATCH = 1000; // milliseconds between questions for what is computed

/** State what is computed, for how long, and how long it will take by the last time; it can be stopped. */
async function watched() {
  const doing = await get("doing").catch(() => null);
  if (!doing?.what || byId("notice").className !== "busy") return;
  const left = doing.remaining_s > 1 ? `, about ${doing.remaining_s.toFixed(0)} s left` : "";
  notice(
    [
      `${doing.what}, ${doing.seconds.toFixed(0)} s${left} `,
      button("Stop", () => post("interrupt"), { id: "interrupt", class: "small danger" }),
    ],
    "busy",
  );
}

let pending = 0;

/** Mark the page as busy until the promise, and every other one that is counted, is settled. */
async function counted(promise) {
  pending += 1;
  byId("page").setAttribute("aria-busy", "true");
  try {
    return await promise;
  } finally {
    pending -= 1;
    if (!pending) byId("page").setAttribute("aria-busy", "false");
  }
}

function notice(text, kind = "") {
  const place = byId("notice");
  place.className = kind;
  fill(
    place,
    text
      ? [
          kind === "busy" ? h("span", { class: "spinner", "aria-hidden": "true" }) : null,
          text,
          kind === "error"
            ? button("×", () => notice(""), { class: "close", "aria-label": "close the message" })
            : null,
        ]
      : null,
  );
}

/** Make a change; a refused one leaves everything as it is and states why. */
async function changed(send) {
  let state;
  try {
    state = await app.working("working", send);
  } catch (error) {
    await show();
    notice(error.message, "error");
    return false;
  }
  app.state = state;
  head();
  await show();
  return true;
}

function head() {
  const state = app.state;
  document.title = `${state.title} – modalkit`;
  fill(byId("title"), state.title);
  fill(byId("file"), state.file);
  const theme = button(dark() ? "Light" : "Dark", turned, { id: "theme", title: "light or dark" });
  if (state.importing) {
    fill(byId("tools"), theme);
    fill(byId("tabs"));
    return;
  }
  fill(
    byId("tools"),
    button("↶ Undo", () => app.change("undo"), {
      disabled: !state.undo,
      title: state.undo ? `undo: ${state.undo}` : "nothing to undo",
      id: "undo",
    }),
    button("↷ Redo", () => app.change("redo"), {
      disabled: !state.redo,
      title: state.redo ? `redo: ${state.redo}` : "nothing to redo",
      id: "redo",
    }),
    button("Export", exported, {
      id: "export",
      title: "study, UFF, JSON, CSV and report into a folder beside the study",
    }),
    theme,
  );
  fill(
    byId("tabs"),
    Object.entries(PAGES).map(([name, [title]]) =>
      h(
        "a",
        {
          href: `#${name}`,
          "aria-current": name === app.page ? "page" : null,
          class: NEEDS_MODEL.has(name) && !state.has_model ? "idle" : null,
        },
        title,
      ),
    ),
  );
}

async function exported() {
  try {
    const found = await app.working("writing", () => post("export"));
    const missing = found.missing.map(
      ({ kind, change }) =>
        ` NOT in it: the result of ${kind}, which belongs to the study before "${change}"; run ${kind} again, or undo.`,
    );
    notice(`written to ${found.folder}: ${found.files.join(", ")}.${missing.join("")}`, missing.length ? "warn" : "done");
  } catch {
    /* said already */
  }
}

const dark = () => document.documentElement.dataset.theme === "dark";
const system = matchMedia("(prefers-color-scheme: dark)");

/** Take the scheme that the user has chosen here, else that of the system. */
function themed() {
  let kept = null;
  try {
    kept = localStorage.getItem("theme");
  } catch {
    /* a browser without storage */
  }
  document.documentElement.dataset.theme = kept ?? (system.matches ? "dark" : "light");
}

function turned() {
  document.documentElement.dataset.theme = dark() ? "light" : "dark";
  try {
    localStorage.setItem("theme", document.documentElement.dataset.theme);
  } catch {
    /* as above */
  }
  head();
  app.quiet(show());
}

/** Show the page that the address names; the same page is only brought up to date. */
async function show() {
  const named = location.hash.slice(1);
  const usual = named in PAGES ? named : app.state.has_files ? "hits" : "modes";
  const name = app.state.importing ? "import" : usual;
  if (name !== app.page) {
    app.shown?.close?.();
    app.page = name;
    head();
    const root = byId("page");
    root.replaceChildren();
    const inner = h("div", { class: `page-${name}` });
    root.append(inner);
    app.shown = (app.state.importing ? importing : PAGES[name][1]).open(inner, app);
  }
  const here = app.shown;
  try {
    await app.working("computing", () => here.update());
  } catch (error) {
    console.warn(error.message);
  }
}

function keys(event) {
  if (!(event.ctrlKey || event.metaKey) || /^(INPUT|TEXTAREA)$/.test(event.target.tagName)) return;
  const key = event.key.toLowerCase();
  if (key === "z" && !event.shiftKey && app.state.undo) {
    event.preventDefault();
    app.change("undo");
  }
  if ((key === "y" || (key === "z" && event.shiftKey)) && app.state.redo) {
    event.preventDefault();
    app.change("redo");
  }
}

async function begin() {
  themed();
  app.state = await app.working("opening", () => get("state"));
  head();
  window.addEventListener("hashchange", () => app.quiet(show()));
  window.addEventListener("keydown", keys);
  system.addEventListener("change", () => {
    themed();
    head();
    app.quiet(show());
  });
  await show();
}

app.quiet(begin());
