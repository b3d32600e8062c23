"""Modes side by side as the documents of their JSON files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from identification import Correlation as Comparison
from modalkit.output.schemas.correlation import ComparisonDocument, CorrelationDocument
from updating.correlation.correlate import Correlation

NAMES = {
    "test mode": "test_mode",
    "model mode": "model_mode",
    "test [Hz]": "test_hz",
    "model [Hz]": "model_hz",
    "error [%]": "error_percent",
    "sigma [%]": "sigma_percent",
    "MAC": "mac",
    "frequency [Hz]": "frequency_hz",
    "FRAC": "frac",
    "response direction": "response_direction",
    "force direction": "force_direction",
}


def correlation_document(correlation: Correlation, warnings: Sequence[str] = ()) -> CorrelationDocument:
    """Return a correlation as ``modalkit.correlation/1``.

    Parameters
    ----------
    correlation : Correlation
        The result; rows of its ``mac`` are measured modes, columns those of the model.
    warnings : sequence of str
        What else the user ought to know.
    """
    return {
        "schema": "modalkit.correlation/1",
        "frequency_rms_percent": correlation.rms_percent,
        "pairs": _rows(correlation.table),
        "mac": correlation.mac.to_numpy().tolist(),
        "unpaired_test": _rows(correlation.unpaired_test),
        "unpaired_model": _rows(correlation.unpaired_model),
        "frac": _rows(correlation.frac),
        "model_damping": None if correlation.frfs is None else correlation.frfs.damping,
        "warnings": list(dict.fromkeys([*correlation.warnings, *warnings])),
    }


def comparison_document(found: Comparison, warnings: Sequence[str] = ()) -> ComparisonDocument:
    """Return two tests compared as ``modalkit.comparison/1``; modes are counted from 1."""
    first, second = found.test.frequency, found.model.frequency
    return {
        "schema": "modalkit.comparison/1",
        "pairs": [
            {
                "first_mode": p.test + 1,
                "second_mode": p.model + 1,
                "first_hz": first[p.test],
                "second_hz": second[p.model],
                "difference_percent": 100 * p.error,
                "mac": p.mac,
            }
            for p in found.pairs
        ],
        "mac": found.mac.tolist(),
        "unpaired_first": [{"mode": i + 1, "frequency_hz": first[i]} for i in found.test_alone],
        "unpaired_second": [{"mode": i + 1, "frequency_hz": second[i]} for i in found.model_alone],
        "degrees_of_freedom": [str(dof) for dof in found.dofs],
        "warnings": [*found.notes, *warnings],
    }


def _rows(table: pd.DataFrame) -> Any:
    return [{str(k): v for k, v in row.items()} for row in table.rename(columns=NAMES).to_dict("records")]
