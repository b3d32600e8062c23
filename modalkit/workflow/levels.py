"""Tests whose frequencies follow the force of the hits: a warning, and where averages smear modes, one common level."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from acquisition import EstimationError, FrfSet, HammerTest, HitVerdict, Windows
from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.quantities import hertz
from modalkit.workflow.frf_checks import NAMED

if TYPE_CHECKING:
    from identification import Growth, LevelDependence, ModalModel

Data = FrfSet | Sequence[HammerTest]
Select = Callable[[Sequence[float]], "ModalModel"]
Tests = Sequence[tuple[HammerTest, Sequence[HitVerdict]]]

ROUNDS = 2
"""How often hits are brought to one level: the first time by the modes of stretched averages, which lack those that
are faint, then by their own. Where levels moved modes by three half-widths, a third time moved none by a hundredth."""


def with_levels(
    select: Select, tests: Tests, of: Callable[[Data], Select], *, windows: Windows | None
) -> ModalModel:
    """Return the modes of a test, with the levels found from its hits; of one level where they smear.

    How frequencies follow the level is examined where they differ from FRF to FRF, which a mode that follows the level
    cannot but do, or where constants follow it. Modes whose constants do are products of others, and dropped.

    Parameters
    ----------
    select : function
        Returns the modes of the test without those that lie at frequencies [Hz].
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    of : function
        Returns such a function for other FRFs of the same test, or for other hits of which all are used.
    windows : Windows, optional
        As when the FRFs were estimated.
    """
    from identification import growth, level_dependence

    model = select(())
    screened = growth(model, tests, windows=windows) if tests else None
    if screened is None:
        return _with_coincidences(model)
    if model.carried is None and not screened.products.any():
        return model
    found = level_dependence(model, tests, windows=windows)
    assert found is not None  # as growth
    return _examined(Examined(select, model, found), tests, of, windows)


@dataclass(frozen=True, eq=False)
class Examined:
    """Modes, how they follow the level, and the function that selects some of them."""

    select: Select
    model: ModalModel
    found: LevelDependence

    def without(self, dropped: BoolArray) -> Examined:
        """Return the same without some of the modes, (n_modes,)."""
        if not dropped.any():
            return self
        select = _dropping(self.select, self.model.modal.frequency[dropped])
        model = select(())
        return replace(self, select=select, model=model, found=self.found.modes(_nearest(model, self.model)))


@dataclass(frozen=True, eq=False)
class Products:
    """Peaks that are products of modes: where they are and how far the level moves them [Hz], and what they are."""

    frequency: FloatArray
    reach: FloatArray
    names: tuple[str, ...]

    def among(self, model: ModalModel) -> FloatArray:
        """Return the frequencies of those modes of a model that are these peaks, (n,) [Hz]."""
        own = model.modal.frequency
        return np.asarray(own[(np.abs(own[:, None] - self.frequency) <= self.reach).any(axis=1)])


def _dropping(select: Select, dropped: FloatArray) -> Select:
    """Return a selection that always leaves out the modes at these frequencies [Hz]."""
    always = dropped.tolist()
    return lambda more: select([*always, *more])


def _nearest(model: ModalModel, other: ModalModel) -> IntArray:
    """Return the mode of another model that is nearest to each mode, (n_modes,)."""
    return np.asarray(np.abs(model.poles[:, None] - other.poles).argmin(axis=1))


def _examined(
    state: Examined, tests: Tests, of: Callable[[Data], Select], windows: Windows | None
) -> ModalModel:
    """Return the modes of one level that are not products of others, with notes on both."""
    from identification import follows_level, growth, is_smeared, with_line_doubt

    grown = growth(state.model, tests, state.found, windows=windows)
    assert grown is not None
    dropped = _of_others(grown)
    products = _products(state, dropped, grown)
    state = state.without(dropped)
    notes: tuple[str, ...] = ()
    if follows_level(state.found).any():
        smeared = is_smeared(state.model, state.found)
        if smeared:
            state, more = _further(state, _at_one_level(state, tests, of, windows, products), tests, windows)
            products = replace(products, names=(*products.names, *more))
            state = replace(state, model=with_line_doubt(state.model, state.found))
        state = replace(state, model=replace(state.model, levels=state.found))
        notes = (*notes, _notes(state.model, state.found, smeared))
    notes = (*_on_products(state, products), *notes)
    return replace(state.model, warnings=(*state.model.warnings, *notes)) if notes else state.model


def _further(
    known: Examined, even: Examined, tests: Tests, windows: Windows | None
) -> tuple[Examined, tuple[str, ...]]:
    """Return modes of one level without products that only show there, and the names of these.

    Modes that are known, as their constants do not grow at the poles of each hit, stay. How the poles of a faint
    product follow the level may not be determined: constants are taken at poles that follow it and at poles that do
    not, and the growth with the smaller standard deviation stands. Modes that show only when products are left out are
    examined in their turn.
    """
    from identification import growth

    names: tuple[str, ...] = ()
    reach = _reach(known, np.ones(len(known.model), np.bool_))
    while True:
        still, followed = (growth(even.model, tests, found, windows=windows) for found in (None, even.found))
        assert still is not None
        assert followed is not None
        grown = followed.surer(still)
        apart = np.abs(even.model.modal.frequency[:, None] - known.model.modal.frequency)
        which = _of_others(grown) & (apart > reach).all(axis=1)
        names = (*names, *_products(even, which, grown).names)
        rest = even.without(which)
        if not _newcomers(rest, even, _reach(even, ~which)):
            return rest, names
        even = rest


def _of_others(grown: Growth) -> BoolArray:
    """Return which modes are products of others, (n_modes,): none where the constants of all grow."""
    return np.asarray(grown.products & ~grown.products.all())


def _newcomers(now: Examined, before: Examined, reach: FloatArray) -> bool:
    """Return whether there are modes that were not there before: peaks that others, since left out, had covered."""
    apart = np.abs(now.model.modal.frequency[:, None] - before.model.modal.frequency)
    return bool((apart > reach).all(axis=1).any())


def _at_one_level(
    state: Examined, tests: Tests, of: Callable[[Data], Select], windows: Windows | None, products: Products
) -> Examined:
    """Return the modes of hits brought to one level, and how they follow it; those there are if none are found so."""
    from identification import at_one_level, level_dependence, stretched_averages

    stretched = stretched_averages(state.model, tests, windows=windows)

    def followed(model: ModalModel) -> LevelDependence:
        slope = stretched.slopes_at(model.modal.frequency)
        answer = level_dependence(model, tests, windows=windows, slope=slope)
        assert answer is not None
        return answer

    def selected(data: Data) -> tuple[Select, ModalModel]:
        select = of(data)
        select = _dropping(select, products.among(select(())))
        return select, select(())

    try:
        select, even = selected(stretched.frfs)
        for _ in range(ROUNDS):
            select, even = selected(at_one_level(even, tests, followed(even), windows=windows))
    except EstimationError:
        return state
    return Examined(select, even, followed(even))


def _products(state: Examined, which: BoolArray, grown: Growth) -> Products:
    """Return the modes that are products of the others, with the sums that they lie at."""
    from identification import combination

    own, reach, names = state.model.modal.frequency, _reach(state, ~which), []
    for i in np.flatnonzero(which):
        of = combination(float(own[i]), own[~which], reach[~which])
        names.append(f"{hertz(own[i])} ({f'{of}, ' if of else ''}force to the power {grown.power[i]:.2g})")
    return Products(own[which], reach[which], tuple(names))


def _reach(state: Examined, modes: BoolArray) -> FloatArray:
    """Return how far a peak may lie from where it is at the mean level, by what moves the modes, (n_modes,) [Hz]."""
    slope = np.abs(np.nan_to_num(state.found.slope)).max(where=modes, initial=0.0)
    moved = slope * (state.found.strongest - state.found.weakest)
    return np.asarray(moved * state.model.modal.frequency + np.abs(state.model.poles.real) / (2 * np.pi))


def _on_products(state: Examined, products: Products) -> tuple[str, ...]:
    """Return notes on peaks whose constants grow with the force."""
    if not products.names:
        return ()
    return (
        f"peaks that are products of modes are left out: {', '.join(products.names)}. Their modal constants grow with "
        f"the force of the hits, from {state.found.weakest:.3g} to {state.found.strongest:.3g} N; those of modes do "
        "not. A joint that slips or closes causes such peaks; softer hits reduce them",
    )


def _with_coincidences(model: ModalModel) -> ModalModel:
    """Return a model that lists which modes may be products of others, where no hits decide."""
    from identification import coincidences

    found = coincidences(model)
    if not found:
        return model
    named = [f"{hertz(model.modal.frequency[i])} ({of})" for i, of in found.items()]
    rest = f" and {len(named) - NAMED} more" if len(named) > NAMED else ""
    warning = (
        f"{len(found)} of {len(model)} modes lie at sums or differences of stronger modes: {', '.join(named[:NAMED])}"
        f"{rest}. They may be products of a joint that slips or closes. To find out, hit softly and hard and give the "
        "raw hits: the constants of products grow with the force"
    )
    return replace(model, warnings=(*model.warnings, warning))


def _notes(model: ModalModel, found: LevelDependence, smeared: bool) -> str:
    """Return notes on modes that follow the level."""
    from identification import follows_level

    change = 100 * found.slope * (found.strongest - found.weakest)
    named = ", ".join(
        f"{hertz(model.modal.frequency[i])} by {change[i]:+.2g} %"
        for i in np.flatnonzero(follows_level(found))
    )
    what = (
        f"all hits are scaled to one level of {found.level:.3g} N, with the level dependence of each mode"
        if smeared
        else "one mode at two levels may look like two: treat close modes with different shapes with care"
    )
    return (
        f"frequencies follow the force of the hits, from {found.weakest:.3g} to {found.strongest:.3g} N: {named}. The "
        f"usual cause is a joint that slips or closes; {what}. Hit all points equally hard"
    )
