"""Known truth of real structures and the answers, as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from acquisition.quantities import estimate, number, quantity
from modalkit.output.schemas.diagnosis import SOMETHING_ELSE
from modalkit.papers.real.running import RealOutcome


def real_table(outcomes: Sequence[RealOutcome]) -> pd.DataFrame:
    """Return a table of cases: what is known and what was answered, the gap before and after, and how it is judged."""
    return pd.DataFrame([row_of(o) for o in outcomes])


def row_of(outcome: RealOutcome) -> dict[str, str]:
    """Return a case's row of the table."""
    case, document = outcome.case, outcome.document
    row = {"case": case.name, "data": case.kind, "truly known": case.known}
    if document is None or outcome.judgement is None:
        empty = dict.fromkeys(("size (95 %)", "gap [%]", "runner-up / tolerances / floor"), "")
        return row | {"said": outcome.missing or ""} | empty | {"judged": "skipped"}
    return row | {
        "said": verdict_text(document),
        "size (95 %)": sizes(outcome),
        "gap [%]": _gap(document),
        "runner-up / tolerances / floor": _rivals(document),
        "judged": f"{outcome.judgement.grade}: {outcome.judgement.reason}",
    }


def verdict_text(document: Mapping[str, Any]) -> str:
    """Return the verdict with the sets of effects it names, and whether their size is implausible."""
    cause = document["cause"]
    if cause["verdict"] in ("none", "unknown"):
        return str(cause["verdict"])
    names = "; ".join(" + ".join(s) for s in cause["sets"])
    first = _ranked(document)[0]
    doubt = "" if first.get("plausible", True) else " (size implausible)"
    return f"{cause['verdict']}: {names}{doubt}"


def sizes(outcome: RealOutcome) -> str:
    """Return the sizes of the true set where it is among those named, else of the first; known ones if any are."""
    document = outcome.document
    if document is None or document["cause"]["verdict"] in ("none", "unknown"):
        return ""
    rows = _ranked(document)
    named = [frozenset(s) for s in document["cause"]["sets"]]
    true = (
        r
        for r in rows
        if frozenset(r["effects"]) in outcome.case.accepted and frozenset(r["effects"]) in named
    )
    parameters = next(true, rows[0])["parameters"]
    known = {fact.parameter for fact in outcome.case.facts}
    chosen = {n: p for n, p in parameters.items() if n in known} or parameters
    stated = [_size(name, p) for name, p in chosen.items() if not isinstance(p["value"], list | str)]
    return "; ".join([*stated, *_places(outcome)])


def _places(outcome: RealOutcome) -> list[str]:
    """Return the places it points to, where one is known."""
    if outcome.answer is None or not outcome.case.places or not outcome.answer.locations:
        return []
    return ["at x = " + " or ".join(f"{1e3 * x:.0f}" for x, _ in outcome.answer.locations) + " mm"]


def _ranked(document: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    rows = [row for row in document["cause"]["ranking"] if row["effects"] != [SOMETHING_ELSE]]
    return sorted(rows, key=lambda row: -float(row["probability"]))


def _size(name: str, parameter: Mapping[str, Any]) -> str:
    what = name.split(".", 1)[1].replace("_", " ")
    value, unit, low, high = (parameter[key] for key in ("value", "unit", "low95", "high95"))
    known = low is not None and high is not None
    return f"{what} {estimate(value, unit, low, high) if known else quantity(value, unit)}"


def _gap(document: Mapping[str, Any]) -> str:
    """Return the error before, and after on data held out."""
    shrink = document["shrink"]
    held = shrink.get("held_out") or {}
    before = held.get("before_percent", shrink.get("before_percent"))
    after = held.get("after_percent")
    if before is None:
        return ""
    metric = "" if shrink["metric"] == "frequency" else f" ({shrink['metric']})"
    return f"{number(before)}{'' if after is None else ' -> ' + number(after)}{metric}"


def _rivals(document: Mapping[str, Any]) -> str:
    held = document["shrink"].get("held_out") or {}
    keys = ("runner_up_percent", "nuisance_only_percent", "noise_floor_percent")
    stated = [held.get(key) for key in keys]
    return (
        " / ".join("-" if v is None else number(v) for v in stated)
        if any(v is not None for v in stated)
        else ""
    )
