"""A correlation as the plain record of its JSON file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

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
}


def correlation_document(correlation: Correlation, warnings: Sequence[str] = ()) -> dict[str, Any]:
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


def _rows(table: pd.DataFrame) -> list[dict[str, Any]]:
    return [{str(k): v for k, v in row.items()} for row in table.rename(columns=NAMES).to_dict("records")]
