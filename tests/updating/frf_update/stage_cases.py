"""One stage of an update by FRFs, for tests of what it computes: nothing is left of stages before it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from updating import Measured, Predictor, Spec
from updating.frf_update.columns import columns
from updating.frf_update.stage import Stage
from updating.models.state import NOMINAL
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.tolerances import Tolerances
from updating.update.parameters.named import build_parameter_set


def stage_of(spec: Spec, measured: Measured, frfs: MeasuredFrfs, names: Sequence[str]) -> Stage:
    """Return the stage that moves the named parameters of a model whose damping is known."""
    predictor, nowhere = Predictor(spec, measured), np.zeros(0)
    return Stage(
        predictor=predictor,
        frfs=frfs,
        ends=columns(frfs),
        parameter_set=build_parameter_set(list(names), predictor, Tolerances(), {}),
        earlier=NOMINAL,
        resonances=nowhere,
        widths=nowhere,
        warp=np.ones(len(frfs.laplace)),
        all_resonances=np.sort(measured.frequency),
    )


def slopes_and_differences(stage: Stage, theta: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the sensitivity of the FRFs to the only parameter, and what a central difference makes it [m/N]."""
    by = stage.slopes(theta, stage.evaluate(theta), measured=False)[0]
    below, above = (stage.evaluate(theta + side).receptance for side in (-step, step))
    return by, (above - below) / (2 * step)
