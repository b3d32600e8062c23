"""The complex mode indicator function: how many modes there are at a line, close ones included."""

from __future__ import annotations

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet


def cmif(frfs: FrfSet, *, band: tuple[float, float] | None = None, count: int = 4) -> pd.DataFrame:
    """Return the complex mode indicator functions: eigenvalues of H^H H at every line.

    Shih, Tsai, Allemang and Brown, Mech. Syst. Signal Process. 2 (1988) 367-377. H has a row for each response and a
    column for each reference; a peak of the first function is a mode, a peak of the second at the same line another
    one beside it. One reference, or one response, gives one function: the sum of |H|^2.

    Parameters
    ----------
    frfs : FrfSet
        FRFs between every response and every reference. Those of a response that lacks a reference are left out
        (or of a reference that lacks a response, if that costs fewer FRFs); an FRF that is there twice is averaged.
    band : tuple of float, optional
        Lines to evaluate [Hz].
    count : int
        How many functions at the most [-].

    Returns
    -------
    DataFrame
        Rows are lines [Hz], columns the functions 1, 2, ..., largest first [unit of the FRFs squared];
        ``attrs["left_out"]`` names the degrees of freedom left out.

    Raises
    ------
    InputError
        If no response has every reference, or the band holds no line.
    """
    chosen = frfs if band is None else frfs.band(*band)
    matrix, left_out = _matrix(chosen)
    values = np.linalg.svd(matrix, compute_uv=False)[:, :count] ** 2
    lines = pd.Index(chosen.frequency, name="frequency [Hz]")
    table = pd.DataFrame(values, lines, pd.RangeIndex(1, values.shape[1] + 1, name="CMIF"))
    table.attrs["left_out"] = left_out
    return table


def _matrix(frfs: FrfSet) -> tuple[ComplexArray, list[str]]:
    """Return the FRFs as (n_lines, n_responses, n_references), and the degrees of freedom that lack one."""
    places: dict[tuple[Dof, Dof], list[int]] = {}
    for i, (response, reference) in enumerate(zip(frfs.responses, frfs.references, strict=True)):
        places.setdefault((_positive(response), _positive(reference)), []).append(i)
    responses, references = (list(dict.fromkeys(pair[k] for pair in places)) for k in (0, 1))
    rows = [a for a in responses if all((a, b) in places for b in references)]
    columns = [b for b in references if all((a, b) in places for a in responses)]
    if len(rows) * len(references) >= len(columns) * len(responses):
        columns = references
    else:
        rows = responses
    if not rows or not columns:
        raise InputError(
            f"{frfs.source}: no response was measured with every reference; select FRFs that form a full matrix"
        )
    left_out = [str(d) for d in responses if d not in rows] + [str(d) for d in references if d not in columns]
    sign = np.array([a.sign * b.sign for a, b in zip(frfs.responses, frfs.references, strict=True)])
    values = frfs.values * sign[:, None]
    full = [[values[places[a, b]].mean(axis=0) for b in columns] for a in rows]
    return np.moveaxis(np.array(full, dtype=np.complex128), 2, 0), left_out


def _positive(dof: Dof) -> Dof:
    return Dof(dof.node, abs(dof.direction))
