"""FRFs that cannot be correct: copies of each other, and constants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition import FrfSet, InputError

NAMED = 6
"""Most FRFs named in a message; doubled, the line is longer."""

CONSTANT = 1e-9
"""Change of an FRF over the lines, relative to its size, that is rounding of a constant [-]."""


def identical(frfs: FrfSet) -> tuple[str, ...]:
    """Name FRFs at different degrees of freedom that are one and the same measurement, to the last digit.

    Two measurements differ at least by their noise. H_ij and H_ji may be equal by reciprocity, and are not named.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of a test.
    """
    seen: dict[bytes, list[int]] = {}
    for row, values in enumerate(np.asarray(frfs.values)):
        top = values[int(np.abs(values).argmax())]
        if top != 0:
            side = -1.0 if top.real < 0 or (top.real == 0 and top.imag < 0) else 1.0
            seen.setdefault((values * side + 0.0).tobytes(), []).append(row)
    groups = [rows for rows in seen.values() if len(rows) > 1 and _unlike(frfs, rows)]
    return tuple(
        f"the FRFs {listed(frfs, rows)} are identical to the last "
        "digit: one measurement was probably stored for several points; check them, and leave out the copies"
        for rows in groups
    )


def _unlike(frfs: FrfSet, rows: Sequence[int]) -> bool:
    """Return whether rows are not just H_ij and H_ji."""
    ends = {
        frozenset(((r.node, abs(r.direction)), (f.node, abs(f.direction))))
        for r, f in ((frfs.responses[i], frfs.references[i]) for i in rows)
    }
    return len(ends) > 1


def without_constant(frfs: FrfSet, warnings: list[str]) -> FrfSet:
    """Return the set without FRFs that are the same at every line: no structure responds so.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of a test.
    warnings : list of str
        What was left out is added to it.

    Raises
    ------
    InputError
        If no other FRF is there.
    """
    inner = np.asarray(frfs.values[:, 1:-1] if frfs.values.shape[1] > 3 else frfs.values)
    size = np.abs(inner).max(axis=1)
    flat = (np.abs(inner - inner[:, :1]).max(axis=1) <= CONSTANT * size) & (size > 0)
    if not flat.any():
        return frfs
    if flat.all():
        raise InputError(
            f"{frfs.source}: every FRF is the same at all frequencies ({abs(inner[0, 0]):.3g} {frfs.unit}), so "
            "there is no mode to identify; check whether the response channels hold the force"
        )
    names = listed(frfs, np.flatnonzero(flat).tolist())
    warnings.append(f"FRF {names} is the same at all frequencies and was left out; check its channel")
    return frfs.select(np.flatnonzero(~flat))


def listed(frfs: FrfSet, rows: Sequence[int]) -> str:
    """Return the names of some FRFs, response/reference, the first few of many."""
    names = [f"{frfs.responses[i]}/{frfs.references[i]}" for i in rows]
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
