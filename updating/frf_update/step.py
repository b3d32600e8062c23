"""A stage gone through once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from updating.frf_update.solve import Solved
from updating.frf_update.stage import Stage
from updating.models.state import State
from updating.prediction.assignment import match
from updating.update.data.specimen import Specimen

UNTOLD_RATIO = 0.005
"""Damping ratio of modes of which the test states none [-]."""


@dataclass(frozen=True, eq=False)
class Step:
    """A stage gone through once.

    Parameters
    ----------
    number : int
        Which stage, from 0; their count for all of them together.
    stage : Stage
        The stage on the lines it compared last.
    solved : Solved
        Where it came to rest, with all iterations.
    own : State
        What its parameters make of the nominal model.
    state : State
        That, and what the other stages had settled.
    together : bool
        Whether this is the step of all stages at once.
    """

    number: int
    stage: Stage
    solved: Solved
    own: State
    state: State
    together: bool = False


def last_steps(steps: Sequence[Step]) -> list[Step]:
    """Return the last step of each stage, or the one of all stages together where there is one."""
    if steps[-1].together:
        return [steps[-1]]
    return [[s for s in steps if s.number == n][-1] for n in sorted({s.number for s in steps})]


def identified_ratios(specimen: Specimen) -> tuple[float, ...]:
    """Return the identified damping ratios in the order of the model's modes, their median where there is none.

    A stage that leaves damping alone compares FRFs with these in the model, as paper A does for its figures: a peak
    ten times too high for want of damping gives no information on mass and stiffness.
    """
    prediction = specimen.predictor.predict()
    partner = match(specimen.measured, prediction, specimen.order)
    known = np.isfinite(specimen.measured.damping)
    middle = float(np.median(specimen.measured.damping[known])) if known.any() else UNTOLD_RATIO
    ratios = np.full(len(prediction.frequency) + 1, middle)  # the last stands for all modes above
    ratios[partner[known]] = specimen.measured.damping[known]
    return tuple(ratios.tolist())
