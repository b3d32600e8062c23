"""FRFs between responses and references as a matrix at every line, and functions of it that indicate modes."""

from __future__ import annotations

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet


def full_matrix(frfs: FrfSet) -> tuple[ComplexArray, list[str]]:
    """Return the FRFs as a matrix at every line, and the degrees of freedom left out of it.

    Those of a response that lacks a reference are left out, or of a reference that lacks a response, if that costs
    fewer FRFs. An FRF that is there twice is averaged; directions are made positive.

    Parameters
    ----------
    frfs : FrfSet
        FRFs between responses and references.

    Returns
    -------
    matrix : array, shape (n_lines, n_responses, n_references)
        The FRFs [unit of the FRFs].
    left_out : list of str
        Degrees of freedom that lack an FRF.

    Raises
    ------
    InputError
        If no response has every reference.
    """
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


def indicators(frfs: FrfSet, values: FloatArray, name: str, left_out: list[str]) -> pd.DataFrame:
    """Return mode indicator functions as a table: rows are lines [Hz], columns the functions 1, 2, ...

    Parameters
    ----------
    frfs : FrfSet
        FRFs that they are of.
    values : (n_lines, n_functions) array
        Their values.
    name : str
        What they are called.
    left_out : list of str
        Degrees of freedom left out, the table's ``attrs["left_out"]``.
    """
    lines = pd.Index(frfs.frequency, name="frequency [Hz]")
    table = pd.DataFrame(values, lines, pd.RangeIndex(1, values.shape[1] + 1, name=name))
    table.attrs["left_out"] = left_out
    return table
