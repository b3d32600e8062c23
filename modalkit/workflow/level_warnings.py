"""What to say where frequencies follow the force of the hits: a joint that softens, or closes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from acquisition import HammerTest, HitVerdict, Windows
from acquisition.quantities import hertz

if TYPE_CHECKING:
    from identification import ModalModel

SURE = 4.0
"""Slope over its standard deviation from which a mode follows the level. Doubled, weak joints go unnamed; halved, every
other test of thirty modes names one by chance [-]."""


def with_level_warning(
    model: ModalModel, tests: Sequence[tuple[HammerTest, Sequence[HitVerdict]]], *, windows: Windows | None
) -> ModalModel:
    """Return a model with a warning where the frequencies of its modes follow the level of the hits.

    It is examined where frequencies differ from FRF to FRF, which a mode that follows the level cannot but do.

    Parameters
    ----------
    model : ModalModel
        Identified from the FRFs of these hits.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    windows : Windows, optional
        As when the FRFs were estimated.
    """
    if model.carried is None or not tests:
        return model
    from identification import level_dependence

    found = level_dependence(model, tests, windows=windows)
    if found is None:
        return model
    sure = np.nan_to_num(np.abs(found.slope) / found.slope_sigma) > SURE
    if not sure.any():
        return model
    change = 100 * found.slope * (found.strongest - found.weakest)
    named = ", ".join(
        f"{hertz(model.modal.frequency[i])} by {change[i]:+.2g} %" for i in np.flatnonzero(sure)
    )
    statement = (
        f"frequencies follow the force of the hits, from {found.weakest:.3g} to {found.strongest:.3g} N: {named}. A "
        "joint that slips or closes does that, and one mode at two levels may pass for two; hit all points equally "
        "hard, and take modes that lie close together with unlike shapes with care"
    )
    return replace(model, warnings=(*model.warnings, statement))
