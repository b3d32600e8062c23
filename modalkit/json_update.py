"""An update as the plain record of its JSON file, whose keys are a contract."""

from __future__ import annotations

from typing import Any

import numpy as np

from updating.update import Update


def to_json(update: Update) -> dict[str, Any]:
    """Return an update as ``modalkit.update/1``; what is not finite becomes None.

    Parameters
    ----------
    update : Update
        The result. ``value``, ``sigma``, ``low`` and ``high`` of a parameter are in its ``unit``; ``study`` is
        None for a parameter that several studies share.
    """
    return {
        "schema": "modalkit.update/1",
        "parameters": [
            {
                "name": p.name,
                "study": p.study,
                "value": _number(p.value),
                "unit": p.unit,
                "factor": _number(p.factor),
                "sigma": _number(p.sigma),
                "at_bound": p.at_bound,
                "low": _number(p.low),
                "high": _number(p.high),
            }
            for p in update.parameters
        ],
        "pairs": [
            {
                "study": str(row["study"]),
                "test_mode": int(row["test_mode"]),
                "model_mode": int(row["model_mode"]),
                "mac": _number(row["mac"]),
                "test_hz": _number(row["test_hz"]),
                "before_hz": _number(row["before_hz"]),
                "after_hz": _number(row["after_hz"]),
                "used": bool(row["used"]),
            }
            for row in update.pairs.to_dict("records")
        ],
        "undetermined": list(update.undetermined),
        "iterations": update.iterations,
        "converged": update.converged,
        "correlations": [[_number(c) for c in row] for row in update.correlations],
        "exact": update.exact,
        "rms_percent": {"before": update.rms_percent("before"), "after": update.rms_percent("after")},
        "warnings": list(update.warnings),
    }


def _number(value: Any) -> float | None:
    if value is None or not np.isfinite(value):
        return None
    return float(value)
