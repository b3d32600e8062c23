"""Modes side by side as the documents of their JSON files."""

from __future__ import annotations

from collections.abc import Sequence

from identification import Correlation as Comparison
from modalkit.output.fields import fill
from modalkit.output.schemas.correlation import ComparisonDocument, CorrelationDocument
from updating.correlation.correlate import Correlation


def correlation_document(correlation: Correlation, warnings: Sequence[str] = ()) -> CorrelationDocument:
    """Return a correlation as ``modalkit.correlation/1``.

    Parameters
    ----------
    correlation : Correlation
        The result; rows of its ``mac`` are measured modes, columns those of the model.
    warnings : sequence of str
        What else the user should know.
    """
    return fill(
        CorrelationDocument,
        correlation,
        mac=correlation.mac.to_numpy().tolist(),
        model_damping=None if correlation.frfs is None else correlation.frfs.damping,
        warnings=list(dict.fromkeys([*correlation.warnings, *warnings])),
    )


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
