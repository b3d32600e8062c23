"""The tables of a batch: one row per study, and one row per mode, factor and cause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from modalkit.batch.run import BatchResult, Part

FIRST = 5
"""Frequencies in the main table."""

TEXT, NUMBER, COUNT, FLAG = "string", "float64", "Int64", "boolean"
STUDIES = {
    "study": TEXT, "title": TEXT, "verdict": TEXT, "effects": TEXT, "probability": NUMBER, "candidates": COUNT,
    "channel": TEXT, "significant": FLAG, "p_value": NUMBER, "parameter": TEXT, "value": NUMBER, "unit": TEXT,
    "low95": NUMBER, "high95": NUMBER, "at_bound": FLAG, "metric": TEXT, "gap_before_percent": NUMBER,
    "gap_after_percent": NUMBER, "closed_percent": NUMBER, "update_before_percent": NUMBER,
    "update_after_percent": NUMBER, "update_converged": FLAG, "update_failure": TEXT, "modes": COUNT,
    **{f"f{n}_hz": NUMBER for n in range(1, FIRST + 1)}, "warnings": COUNT,
}  # fmt: skip
MODES = {
    "study": TEXT, "mode": COUNT, "frequency_hz": NUMBER, "frequency_sigma_hz": NUMBER, "damping_ratio": NUMBER,
    "damping_sigma": NUMBER,
}  # fmt: skip
FACTORS = {
    "study": TEXT, "name": TEXT, "value": NUMBER, "unit": TEXT, "factor": NUMBER, "sigma": NUMBER, "low": NUMBER,
    "high": NUMBER, "at_bound": FLAG,
}  # fmt: skip
CAUSES = {
    "study": TEXT, "rank": COUNT, "effects": TEXT, "probability": NUMBER, "named": FLAG, "plausible": FLAG,
    "parameter": TEXT, "value": NUMBER, "unit": TEXT, "low95": NUMBER, "high95": NUMBER, "at_bound": FLAG,
}  # fmt: skip
SKIPPED = {"study": TEXT, "message": TEXT}
COLUMNS = {"": STUDIES, "modes": MODES, "factors": FACTORS, "causes": CAUSES, "skipped": SKIPPED}
"""The tables by name, with the types of their columns."""


def tables(result: BatchResult) -> dict[str, pd.DataFrame]:
    """Return the tables of a batch.

    Parameters
    ----------
    result : BatchResult
        What came out of the studies.

    Returns
    -------
    dict
        ``""`` is the main table, one row per study; ``modes``, ``factors`` and ``causes`` have a row per mode,
        updated parameter, and parameter of an explanation; ``skipped`` the studies that failed. The columns and
        their types are always the same; units stand in their names, or beside them in ``unit``.
    """
    parts = result.worked
    return {
        "": _frame([_study(part) for part in parts], STUDIES),
        "modes": _frame([row for part in parts for row in _modes(part)], MODES),
        "factors": _frame([row for part in parts for row in _factors(part)], FACTORS),
        "causes": _frame([row for part in parts for row in _causes(part)], CAUSES),
        "skipped": _frame([{"study": p.name, "message": p.failure} for p in result.skipped], SKIPPED),
    }


def _frame(rows: Sequence[Mapping[str, Any]], columns: Mapping[str, str]) -> pd.DataFrame:
    return pd.DataFrame(
        {
            name: pd.Series([row.get(name) for row in rows], dtype="object").astype(
                pd.api.types.pandas_dtype(kind)
            )
            for name, kind in columns.items()
        }
    )


def _record(part: Part) -> dict[str, Any]:
    assert part.record is not None
    return part.record


def _study(part: Part) -> dict[str, Any]:
    record = _record(part)
    modes, update, diagnosis = record["modes"], record["update"], record["diagnosis"]
    row: dict[str, Any] = {
        "study": part.name,
        "title": record["title"],
        "modes": len(modes),
        "warnings": len(record["warnings"]),
        "update_failure": record["update_failure"],
        **{f"f{n}_hz": mode["frequency_hz"] for n, mode in enumerate(modes[:FIRST], start=1)},
    }
    if update is not None:
        rms = update["rms_percent"]
        row |= {
            "update_before_percent": rms["before"],
            "update_after_percent": rms["after"],
            "update_converged": update["converged"],
        }
    return row if diagnosis is None else row | _answer(diagnosis)


def _answer(diagnosis: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer in one row: the verdict, the most probable explanation and its first parameter."""
    cause, shrink = diagnosis["cause"], diagnosis["shrink"]
    closed = shrink["closed_percent"]
    answer = {
        "verdict": cause["verdict"],
        "significant": diagnosis["significant"],
        "p_value": diagnosis["p_value"],
        "channel": diagnosis["where"]["channel"],
        "candidates": len(cause["sets"]),
        "metric": shrink["metric"],
        "gap_before_percent": shrink["before_percent"],
        "gap_after_percent": shrink["after_percent"],
        "closed_percent": None if closed is None else closed["value"],
    }
    if cause["verdict"] not in ("named", "class") or not cause["ranking"]:
        return answer
    best = max(cause["ranking"], key=lambda row: row["probability"])
    parameters = _parameters(best)
    first = parameters[0] if parameters else {}
    return answer | {"effects": " + ".join(best["effects"]), "probability": best["probability"]} | first


def _parameters(row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the parameters of an explanation that are numbers."""
    return [
        {"parameter": name, **{key: p[key] for key in ("value", "unit", "low95", "high95", "at_bound")}}
        for name, p in row["parameters"].items()
        if not isinstance(p["value"], list)
    ]


def _modes(part: Part) -> list[dict[str, Any]]:
    return [{"study": part.name, "mode": n, **mode} for n, mode in enumerate(_record(part)["modes"], start=1)]


def _factors(part: Part) -> list[dict[str, Any]]:
    update = _record(part)["update"]
    return [] if update is None else [{"study": part.name, **p} for p in update["parameters"]]


def _causes(part: Part) -> list[dict[str, Any]]:
    diagnosis = _record(part)["diagnosis"]
    if diagnosis is None:
        return []
    cause = diagnosis["cause"]
    rows = []
    for rank, row in enumerate(cause["ranking"], start=1):
        stated = {
            "study": part.name,
            "rank": rank,
            "effects": " + ".join(row["effects"]),
            "probability": row["probability"],
            "named": row["effects"] in cause["sets"],
            "plausible": row["plausible"],
        }
        rows += [stated | parameter for parameter in _parameters(row) or [{}]]
    return rows
