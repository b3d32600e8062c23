"""An update as the document of its JSON file, whose keys are a contract."""

from __future__ import annotations

from typing import Any

import numpy as np

from modalkit.output.schemas.update import ByFrfs, DeterminabilityEntry, UpdateDocument
from updating.frf_update import FrfUpdate
from updating.update import Update


def to_json(update: Update) -> UpdateDocument:
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
                "initial": _number(p.initial),
                "interval": None if p.interval is None else [_number(end) for end in p.interval],
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
                "shape_sigma": _number(row.get("shape_sigma")),
            }
            for row in update.pairs.to_dict("records")
        ],
        "undetermined": list(update.undetermined),
        "held": list(update.held),
        "iterations": update.iterations,
        "converged": update.converged,
        "correlations": [[_number(c) for c in row] for row in update.correlations],
        "exact": update.exact,
        "rms_percent": {"before": update.rms_percent("before"), "after": update.rms_percent("after")},
        "statistics": {
            "data": update.data,
            "chi2": _number(update.chi2),
            "dof": update.dof,
            "reduced_chi2": _number(update.reduced_chi2),
            "inflation": _number(update.inflation),
            "weights": update.weights,
            "quantity": update.quantity,
            "draws": update.draws,
        },
        "determinability": _determinability(update),
        "frf": _by_frfs(update),
        "warnings": list(update.warnings),
    }


def _by_frfs(update: Update) -> ByFrfs | None:
    """Return what only an update by FRFs has; None for another."""
    if not isinstance(update, FrfUpdate):
        return None
    frac: list[dict[str, float | None]] = [
        {str(name): int(v) if name in ("response", "force") else _number(v) for name, v in row.items()}
        for row in update.frac.to_dict("records")
    ]
    return {
        "frac": frac,
        "damping": [
            {
                "test_damping": _number(row["test_damping"]),
                "before_damping": _number(row["before_damping"]),
                "after_damping": _number(row["after_damping"]),
            }
            for row in update.pairs.to_dict("records")
        ],
        "iterations_by_stage": list(update.stages),
        "lines_hz": [list(lines) for lines in update.lines],
        "discrepancy": list(update.discrepancy),
    }


def _determinability(update: Update) -> DeterminabilityEntry | None:
    stated = update.determinability
    if stated is None:
        return None
    return {
        "singular_values": [_number(v) for v in stated.singular_values],
        "alone": [_number(v) for v in stated.alone],
        "couplings": [
            {
                "parameters": list(c.parameters),
                "determined": list(c.determined),
                "sigma": [_number(v) for v in c.sigma],
            }
            for c in stated.couplings
        ],
        "subset": list(stated.subset),
        "explained": [_number(v) for v in stated.explained],
    }


def _number(value: Any) -> float | None:
    if value is None or not np.isfinite(value):
        return None
    return float(value)
