"""Our own update of the taped beam by FRFs in two stages, for the tables and figures of paper B."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.papers.b.chain import Taped
from modalkit.papers.b.printed import DAMPERS, SECTION
from updating.frf_update import FrfUpdate, update_frfs
from updating.models.state import State
from updating.test_data.measured_frfs import measured_frfs


@dataclass(frozen=True, eq=False)
class Staged:
    """An update in two stages.

    Parameters
    ----------
    taped : Taped
        The test beside its model.
    result : FrfUpdate
        What the update hands back.
    section, both : State
        The model after the first stage, and after both.
    parameters : mapping of str to tuple of float
        Estimated value, updated value and standard deviation by name [SI].
    courses : mapping of str to (n,) array
        The way of every parameter over the iterations of its stage, the estimated value first [SI].
    repeats : mapping of str to tuple of int
        Iterations after which its stage was taken up again.
    """

    taped: Taped
    result: FrfUpdate
    section: State
    both: State
    parameters: Mapping[str, tuple[float, float, float]]
    courses: Mapping[str, FloatArray]
    repeats: Mapping[str, tuple[int, ...]]


def staged_update(taped: Taped) -> Staged:
    """Update areas and inertias first, then alpha and beta, by the FRFs of the test (paper B, Eqs. 7-13)."""
    stages = [[entry[0] for entry in rows.values()] for rows in (SECTION, DAMPERS)]
    identified = taped.session.identified
    assert identified is not None
    frfs = measured_frfs(identified, taped.session.case.measured)
    result = update_frfs(taped.session.case, frfs, stages=stages)
    courses, repeats, values = {}, {}, {}
    for p in result.parameters:
        unit = 1.0 if p.factor is None else p.value / p.factor
        rows, again = _rows(result.stages, [p.name in names for names in stages].index(True), len(stages))
        courses[p.name] = unit * result.history[p.name].to_numpy()[rows]
        repeats[p.name] = again
        values[p.name] = (float(courses[p.name][0]), p.value, p.sigma)
    return Staged(
        taped, result, State(regional=result.state.regional), result.state, values, courses, repeats
    )


def _rows(steps: tuple[int, ...], stage: int, count: int) -> tuple[list[int], tuple[int, ...]]:
    """Return the rows of the history at which a stage moved, and where among them it was taken up again.

    Parameters
    ----------
    steps : tuple of int
        Iterations of every step; the stages follow each other in turn.
    stage, count : int
        Which stage, of how many.
    """
    ends = np.cumsum([0, *steps]).tolist()
    rows, again = [0], []
    for i in range(stage, len(steps), count):
        if len(rows) > 1:
            again.append(len(rows) - 1)
        rows += range(ends[i] + 1, ends[i + 1] + 1)
    return rows, tuple(again)
