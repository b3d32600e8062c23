"""The report of a plan: which effects a test separates, from what severity on, and what to change."""

from __future__ import annotations

from datetime import datetime

from modalkit.output.schemas.plan import PlanDocument
from modalkit.planning import Forecast
from modalkit.planning.document import to_json
from modalkit.planning.note import brings, note, offered
from modalkit.planning.separability import SEEN, SURE
from modalkit.planning.trials import Check
from modalkit.report.document import Document, Section
from modalkit.report.html import Cell, Column, Raw, bullets, definitions, element, joined, table
from modalkit.report.provenance import Basis, cover, provenance
from modalkit.study.read import Study
from modalkit.views.charts.planning import separations_chart, thresholds_chart


def plan_report(
    study: Study, found: Forecast, *, when: datetime, command: str = "", checked: Check | None = None
) -> Document:
    """Return the report of a plan.

    Parameters
    ----------
    study : Study
        The study.
    found : Forecast
        What its test separates.
    when : datetime
        Date of the report.
    command : str
        What repeats it.
    checked : Check, optional
        Blind trials on that very rig.
    """
    document, basis = to_json(found), Basis(when, command, [study])
    return Document(
        study.name,
        "plan",
        joined(element("h1", study.name), cover("Plan of a test", basis), _answer(found)),
        [
            Section("What it separates", [separations_chart(found)]),
            Section("From what severity on", [thresholds_chart(found), thresholds_table(document)]),
            Section("What a change gains", [changes_table(found)]),
            Section(f"Blind trials on {found.bench.basis}", [_trials(checked)]),
            Section("What was assumed", [bullets(list(found.bench.assumptions))]),
            Section("What the forecast leaves out", [_left_out(found)]),
            Section("What this rests on", [provenance(basis)]),
        ],
    )


def _answer(found: Forecast) -> Raw:
    """Return the lines of the note."""
    lines = [line.partition(":") for line in note(found)]
    stated = {name.strip(): " ".join(text.split()) for name, _, text in lines}
    pairs = list(found.now.shown_pairs.values())
    separately = sum(value >= SEEN for value in pairs)
    share = (
        f"{100 * separately / max(len(pairs), 1):.0f} % of the pairs of effects that are seen are separated"
    )
    return joined(element("p", share, class_="answer"), definitions(stated, class_="letter"))


def thresholds_table(document: PlanDocument) -> Raw:
    """Return the severities in words."""
    columns = [
        Column(n) for n in ("effect", "seen from", "separated from", "surely from", "asked about", "nearest")
    ]
    columns += [Column("σ from it", lambda v: f"{v:.1f}"), Column("expected")]
    rows: list[list[Cell | Raw]] = [
        [
            one["name"],
            *(
                size or "never"
                for size in (one["seen_from"], one["separated_from"], one["sure_from"], one["asked"])
            ),
            one["nearest"],
            one["nearest_sigma"],
            one["outcome"],
        ]
        for one in document["now"]["effects"]
    ]
    caption = f"Seen: {SEEN:g} standard deviations beyond tolerances; surely: {SURE:g} from all others."
    return table(caption, columns, rows)


def changes_table(found: Forecast) -> Raw:
    """Return the changes, the most worth first."""
    columns = [
        Column("change"),
        Column("newly separates"),
        Column("severities become smaller by", lambda v: f"{v:.2f}"),
        Column("pairs separated", lambda v: f"{100 * v:.0f} %"),
    ]
    rows: list[list[Cell | Raw]] = [
        [
            one.change.measure,
            brings(one) or "nothing",
            one.factor,
            one.after.shown_share,
        ]
        for one in offered(found)
    ]
    idle = [one.change.measure for one in found.advice if one.worth <= 0]
    more = f" Without overall gain: {'; '.join(idle)}." if idle else ""
    return table(f"Changes of the test that were tried, best first.{more}", columns, rows)


def _trials(checked: Check | None) -> Raw:
    if checked is None:
        return Raw("")
    frame = checked.table
    columns = [Column(str(name)) for name in frame.columns]
    rows: list[list[Cell | Raw]] = [
        ["" if v is None else str(v) for v in row] for row in frame.to_numpy().tolist()
    ]
    return joined(
        bullets(list(checked.summary)),
        table("Each trial: what was forecast and what was answered.", columns, rows),
    )


def _left_out(found: Forecast) -> Raw:
    left = [
        *found.bench.left_out,
        *(f"{key}: {why}" for key, why in found.bench.not_forecast.items()),
        "pairs of effects",
    ]
    return bullets(left)
