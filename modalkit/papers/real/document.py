"""The outcome of real structures as JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from modalkit.papers.real.judging import RULES, covers, estimates
from modalkit.papers.real.running import RealOutcome
from modalkit.papers.real.table import row_of

SCHEMA = "modalkit.real/1"
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
