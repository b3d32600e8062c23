"""The outcome of real structures as JSON, and as the tables of the documentation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from modalkit.papers.real.judging import RULES, covers, estimates
from modalkit.papers.real.running import RealOutcome
from modalkit.papers.real.table import row_of

SCHEMA = "modalkit.real/1"
BEGIN, END = "<!-- real: begin -->", "<!-- real: end -->"
_KEPT = ("significant", "p_value", "where", "cause", "shrink")


def real_document(outcomes: Sequence[RealOutcome]) -> dict[str, Any]:
    """Return the outcome as ``modalkit.real/1``."""
    return {
        "schema": SCHEMA,
        "rules": RULES.strip().splitlines(),
        "counts": counts(outcomes),
        "cases": [_document(o) for o in outcomes],
    }


def counts(outcomes: Sequence[RealOutcome]) -> dict[str, int]:
    """Return how many answers are right, partly right and wrong."""
    grades = [o.judgement.grade for o in outcomes if o.judgement is not None]
    return {grade: grades.count(grade) for grade in ("right", "partly", "wrong")}


def _document(outcome: RealOutcome) -> dict[str, Any]:
    case, document, answer, judgement = outcome.case, outcome.document, outcome.answer, outcome.judgement
    written: dict[str, Any] = {
        "name": case.name,
        "data": case.kind,
        "withheld": case.withheld,
        "known": case.known,
        "source": case.source,
        "accepted": [sorted(s) for s in case.accepted],
        "equivalent": [sorted(s) for s in (case.stands_in if case.removed else case.equivalent)],
        "why_equivalent": case.why,
        "without": list(case.removed),
        "missing": outcome.missing,
        "seconds": round(outcome.seconds, 2),
        "row": row_of(outcome),
    }
    if document is None or answer is None or judgement is None:
        return written
    facts = [
        {
            "parameter": fact.parameter,
            "known": [fact.low, fact.high],
            "said": [_finite(v) for v in (estimate.value, estimate.low, estimate.high)],
            "covered": covers(estimate, fact),
        }
        for fact, estimate in estimates(case, answer)
    ]
    slim = {key: document[key] for key in _KEPT if key in document}
    return written | {
        "grade": judgement.grade,
        "reason": judgement.reason,
        "facts": facts,
        "diagnosis": slim,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def real_markdown(document: Mapping[str, Any]) -> str:
    """Return the tables of the documentation from a document.

    Parameters
    ----------
    document : mapping
        ``modalkit.real/1``.

    Returns
    -------
    str
        Markdown: how many are right, the tables with the library whole and without the true effects, and what is
        withheld and known with its source.
    """
    whole = [c for c in document["cases"] if not c["without"]]
    left_out = [c for c in document["cases"] if c["without"]]
    parts = [
        *_stated("The library whole", whole),
        *_stated("The true effects taken out of the library", left_out),
    ]
    if whole:
        parts += ["### What is known, and from where", "", *_rows(_known(whole)), ""]
    return "\n".join(parts)


def _known(cases: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Return what is withheld and from where it is known, cases of which both are the same in one row."""
    names: dict[tuple[str, str], list[str]] = {}
    for case in cases:
        names.setdefault((case["withheld"], case["source"]), []).append(case["name"])
    return [{"case": "; ".join(n), "withheld": w, "known from": s} for (w, s), n in names.items()]


def _stated(heading: str, cases: Sequence[Mapping[str, Any]]) -> list[str]:
    if not cases:
        return []
    grades = [c.get("grade", "skipped") for c in cases]
    stated = [f"{grades.count(g)} {g}" for g in ("right", "partly", "wrong", "skipped") if g in grades]
    line = f"{len(cases)} cases: {', '.join(stated)}."
    return [f"### {heading}", "", line, "", *_rows([c["row"] for c in cases]), ""]


def _rows(rows: Sequence[Mapping[str, str]]) -> list[str]:
    names = list(rows[0])
    lines = [f"| {' | '.join(names)} |", f"|{' --- |' * len(names)}"]
    return lines + ["| " + " | ".join(row[name].replace("|", "\\|") for name in names) + " |" for row in rows]


def put_between_markers(page: str, table: str) -> str:
    """Return a page with what stands between its two markers replaced.

    Raises
    ------
    ValueError
        If it has no such markers.
    """
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"no {BEGIN} ... {END} in the page")
    return f"{head}{BEGIN}\n\n{table}\n{END}{tail}"
