// Long work: a button to start it, its stages as they begin, a button that stops it.

import { get } from "../api.js";
import { button, fill, h } from "../dom.js";

/** Say how long work has gone on and, where the last time is known, how long it still will. */
function timed({ seconds, remaining_s: left }) {
  const since = `${seconds.toFixed(0)} s`;
  if (left === null) return since;
  return left < 1 ? `${since}, longer than last time` : `${since}, about ${left.toFixed(0)} s left, judged by the last run`;
}

const OFTEN = 400; // milliseconds between questions for what a stage is at

/** Return a panel for one kind of work; `done(result, running, asks, found)` shows what came of it, or has so far. */
export function worker(app, kind, { start, again, done }) {
  const controls = h("div", { class: "row" }),
    stages = h("ol", { class: "stages", "aria-live": "polite" });
  const element = h("div", { class: "work" }, controls, stages);
  let timer = null;
  let closed = false;

  async function update() {
    clearTimeout(timer);
    const found = await get("work", { kind });
    if (closed) return;
    const job = found.job;
    const running = job?.state === "running";
    fill(
      controls,
      button(found.result ? again : typeof start === "function" ? start() : start, () => app.change("start", { kind }), {
        disabled: running,
        class: "primary",
        id: `start-${kind}`,
      }),
      running && job.kind === kind
        ? button("Stop", () => app.change("stop"), { id: `stop-${kind}`, class: "danger" })
        : null,
      running && job.kind === kind && job.remaining_s !== null
        ? h("progress", { max: String(job.seconds + job.remaining_s), value: String(job.seconds), "aria-label": `${kind}: progress` })
        : null,
      running
        ? h(
            "span",
            { class: "muted" },
            job.kind === kind ? timed(job) : `waits: ${job.kind} is running`,
          )
        : null,
      job?.state === "stopped" ? h("span", { class: "muted" }, "Stopped; no result was kept.") : null,
      job?.state === "failed" ? h("span", { class: "error" }, job.error) : null,
    );
    fill(
      stages,
      running && job.kind === kind
        ? (job.stages.length ? job.stages : [{ name: "starting", at_s: 0 }]).map((s, i) =>
            h(
              "li",
              { class: i === job.stages.length - 1 ? "now" : "" },
              `${s.name} `,
              h("small", {}, `from ${s.at_s.toFixed(1)} s`),
            ),
          )
        : null,
    );
    stages.hidden = !running || job.kind !== kind;
    await done(found.result, running, found.asks, running && job.kind === kind ? job.found : []);
    if (running) timer = setTimeout(() => app.quiet(update()), OFTEN);
  }

  return {
    element,
    update,
    start: () => app.change("start", { kind }),
    close: () => {
      closed = true;
      clearTimeout(timer);
    },
  };
}
