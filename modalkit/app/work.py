"""The long work of the app, in a process of its own: ``python -m modalkit.app.work``.

It reads what all kinds of work need, then waits for one line of JSON on its input: ``kind``, ``study``, ``folder``.
It does what the command of that name does to the study file, writes what the command writes, and prints one line of
JSON for every stage. A process can be stopped at once; what it had not finished is not there.
"""

from __future__ import annotations

import importlib
import json
import math
import shlex
import sys
import tomllib
from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acquisition.errors import InputError, ModalkitError
from modalkit.app.digests import digest_of
from modalkit.output.whole import plain, write_text

if TYPE_CHECKING:
    from modalkit.report.document import Document
    from updating.steps import SingleCause

RESULT, REPORT, DRAWINGS = "result.json", "report.html", "drawings.json"

DRAWN = ("gap", "causes", "place", "closing", "frfs", "factors", "frac", "correlations")
"""Charts of the report that the page draws too; those of the test stand on pages of their own."""

NEEDED = (
    "modalkit.report.diagnosis",
    "modalkit.report.updating",
    "modalkit.output.documents",
    "modalkit.workflow.diagnosis",
    "modalkit.workflow.update",
    "scipy.optimize",
)
"""Modules that take long to load and that most work needs."""

Progress = Callable[[str], None]


def diagnose(path: Path, folder: Path, progress: Progress) -> dict[str, Any]:
    """Diagnose a study and write the report."""
    from acquisition.quantities import bare_p, probability
    from modalkit.app.acceptance import offer
    from modalkit.output.documents import diagnosis_document
    from modalkit.output.summary import answers, separates
    from modalkit.output.words import answer, parameters
    from modalkit.report.diagnosis import diagnosis_report
    from modalkit.report.page import page
    from modalkit.study.read import read_study
    from modalkit.workflow.case import open_study
    from modalkit.workflow.diagnosis import diagnose_studies, warnings_of
    from updating.nominal import predictor_of

    progress("reading and identifying")
    study = read_study(path)
    session = open_study(study)
    found = diagnose_studies([session], progress=progress, found=_found)
    progress("writing the report")
    repeated = shlex.join(["modalkit", "diagnose", path.name])
    whole = diagnosis_report(found, [session], when=datetime.now().astimezone(), command=repeated)
    write_text(folder / REPORT, page(whole))
    _draw(folder, whole)
    predictor = predictor_of(session.case)
    there = [name for name, _ in session.case.accepted]
    return {
        "answer": answer(found),
        "summary": answers(found),
        "rows": [
            {
                "probability": probability(row.probability),
                "parameters": parameters(row),
                "p": bare_p(row.p_value),
                **asdict(offer(row, predictor, there, since_baseline=study.baseline is not None)),
            }
            for row in found.ranking
        ],
        "next": [
            {"measure": t.measure, "separates": separates(t), "sigma": t.expected_sigma}
            for t in found.next_test
        ],
        "closes": {
            "before": found.shrink.size(found.shrink.held_before),
            "after": found.shrink.size(found.shrink.held_after),
            "floor": found.shrink.size(found.shrink.floor),
        },
        "document": diagnosis_document(found, warnings_of([session])),
    }


def update(path: Path, folder: Path, progress: Progress) -> dict[str, Any]:
    """Update the model of a study and write the report."""
    from acquisition.quantities import percent
    from modalkit.app.typed_units import parameter_rows
    from modalkit.output.update import to_json
    from modalkit.report.page import page
    from modalkit.report.updating import update_report
    from modalkit.study.read import read_study
    from modalkit.workflow.case import open_study
    from modalkit.workflow.update import update_studies

    progress("reading and identifying")
    session = open_study(read_study(path), with_baseline=False)
    progress("updating")
    found = update_studies([session])
    progress("writing the report")
    repeated = shlex.join(["modalkit", "update", path.name])
    whole = update_report(found, [session], when=datetime.now().astimezone(), command=repeated)
    write_text(folder / REPORT, page(whole))
    _draw(folder, whole)
    before, after = (percent(found.rms_percent(when)) for when in ("before", "after"))
    state = "converged" if found.converged else "NOT converged"
    document = to_json(found)
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    return {
        "answer": f"{before} → {after} r.m.s., {state} after {found.iterations} iterations",
        "text": found.report(),
        "rows": parameter_rows(content, plain(document["parameters"])),
        "document": document,
    }


def _draw(folder: Path, whole: Document) -> None:
    """Write what the page draws of a result: the charts of the report, where the cause sits, the model as it became."""
    from modalkit.report.document import Moving, Standing
    from modalkit.views.chart import Chart

    parts = list(whole.parts())
    found = {
        "charts": {
            part.name: part.data() for part in parts if isinstance(part, Chart) and part.name in DRAWN
        },
        "place": next(
            ({"title": p.title, "text": p.text, "page": p.page} for p in parts if isinstance(p, Standing)),
            None,
        ),
        "models": [model for p in parts if isinstance(p, Moving) for model in p.page["changed"]],
    }
    write_text(folder / DRAWINGS, json.dumps(plain(found), allow_nan=False))


def plan(path: Path, folder: Path, progress: Progress) -> dict[str, Any]:
    """Forecast which effects the test of a study separates."""
    from modalkit.planning import forecast
    from modalkit.planning.document import to_json
    from modalkit.planning.note import note
    from modalkit.planning.own import bench_of
    from modalkit.study.read import read_study

    progress("reading the test")
    bench = bench_of(read_study(path))
    progress(f"solving {bench.basis}")
    found = forecast(bench)
    return {"lines": note(found), "document": to_json(found)}


KINDS: dict[str, Callable[[Path, Path, Progress], dict[str, Any]]] = {
    "diagnose": diagnose,
    "update": update,
    "plan": plan,
}

UNREAD: dict[str, tuple[str, ...]] = {"diagnose": ("update",), "plan": ("update",)}
"""Tables of a study that a kind of work does not read."""


def run(kind: str, path: Path, folder: Path) -> int:
    """Do one kind of work; an error on purpose is a line as well."""
    from modalkit.study.read import read_study

    def begun(name: str) -> None:
        _line(stage=name)

    try:
        files = read_study(path).inputs()
        before = digest_of(files)
        result = KINDS[kind](path, folder, begun)
        if digest_of(files) != before:
            raise InputError("a file of the study was changed meanwhile; start this again")
    except ModalkitError as error:
        (folder / REPORT).unlink(missing_ok=True)
        _line(error=str(error))
        return 2
    written = {"written": datetime.now().astimezone().isoformat()}
    write_text(folder / RESULT, json.dumps(plain(result | written), allow_nan=False))
    _line(done=True)
    return 0


def _found(one: SingleCause) -> None:
    """Print a single cause as it is compared: its evidence over that of no cause in powers of ten, its fit."""
    from acquisition.quantities import bare_p

    power = one.log_evidence / math.log(10)
    _line(found=plain({"name": one.name, "power": power, "p": bare_p(one.p_value)}))


def _line(**what: Any) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


def wait() -> int:
    """Load what work needs, wait for a task, do it; an input that ends without one is no error."""
    for name in NEEDED:
        importlib.import_module(name)
    line = sys.stdin.readline()
    if not line.strip():
        return 0
    task = json.loads(line)
    return run(task["kind"], Path(task["study"]), Path(task["folder"]))


if __name__ == "__main__":
    sys.exit(wait())
