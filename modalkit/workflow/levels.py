"""Tests whose frequencies follow the force of the hits: said, and where averages smear modes, brought to one level."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from acquisition import EstimationError, FrfSet, HammerTest, HitVerdict, Windows
from acquisition.quantities import hertz

if TYPE_CHECKING:
    from identification import LevelDependence, ModalModel

Tests = Sequence[tuple[HammerTest, Sequence[HitVerdict]]]

ROUNDS = 2
"""How often hits are brought to one level: the first time by the modes of stretched averages, which lack those that
are faint, then by their own. Where levels moved modes by three half-widths, a third time moved none by a hundredth."""


def with_levels(
    model: ModalModel,
    tests: Tests,
    identify: Callable[[FrfSet | Sequence[HammerTest]], ModalModel],
    *,
    windows: Windows | None,
) -> ModalModel:
    """Return a model that says how its modes follow the level of the hits, of one level where they smear.

    It is examined where frequencies differ from FRF to FRF, which a mode that follows the level cannot but do.

    Parameters
    ----------
    model : ModalModel
        Identified from the FRFs of these hits.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    identify : function
        Identifies the same from other FRFs, or other hits of which all are used.
    windows : Windows, optional
        As when the FRFs were estimated.
    """
    from identification import follows_level, is_smeared, level_dependence

    if model.carried is None or not tests:
        return model
    found = level_dependence(model, tests, windows=windows)
    if found is None or not follows_level(found).any():
        return model
    smeared = is_smeared(model, found)
    if smeared:
        model, found = _at_one_level(model, found, tests, identify, windows)
    statement = _statement(model, found, smeared)
    return replace(model, levels=found, warnings=(*model.warnings, statement))


def _at_one_level(
    model: ModalModel,
    found: LevelDependence,
    tests: Tests,
    identify: Callable[[FrfSet | Sequence[HammerTest]], ModalModel],
    windows: Windows | None,
) -> tuple[ModalModel, LevelDependence]:
    """Return the modes of hits brought to one level, and how they follow it; those there are if none are found so."""
    from identification import at_one_level, level_dependence, stretched_averages

    stretched = stretched_averages(model, tests, windows=windows)

    def followed(of: ModalModel) -> LevelDependence:
        slope = stretched.slopes_at(of.modal.frequency)
        answer = level_dependence(of, tests, windows=windows, slope=slope)
        assert answer is not None
        return answer

    try:
        even = identify(stretched.frfs)
        for _ in range(ROUNDS):
            even = identify(at_one_level(even, tests, followed(even), windows=windows))
    except EstimationError:
        return model, found
    return even, followed(even)


def _statement(model: ModalModel, found: LevelDependence, smeared: bool) -> str:
    """Return what is to be said of modes that follow the level."""
    from identification import follows_level

    change = 100 * found.slope * (found.strongest - found.weakest)
    named = ", ".join(
        f"{hertz(model.modal.frequency[i])} by {change[i]:+.2g} %"
        for i in np.flatnonzero(follows_level(found))
    )
    what = (
        f"hits are brought to one level of {found.level:.3g} N, by what each mode does at the level of each"
        if smeared
        else "one mode at two levels may pass for two: take modes that lie close together with unlike shapes with care"
    )
    return (
        f"frequencies follow the force of the hits, from {found.weakest:.3g} to {found.strongest:.3g} N: {named}. A "
        f"joint that slips or closes does that; {what}; hit all points equally hard"
    )
