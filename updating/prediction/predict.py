"""What a model predicts for the points of a test, with its sensitivities."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.display import Displayed
from updating.environment import Environment
from updating.models.absorbers import padded, structural
from updating.models.build import build_structure
from updating.models.clamped import Clamped
from updating.models.complex_modes import ComplexModes, complex_modes
from updating.models.damped_modes import Damped
from updating.models.damping import (
    Matrices,
    layer_slowing,
)
from updating.models.imported.placing import SIDE
from updating.models.reduced import Reduced
from updating.models.reduction import reduce_structure
from updating.models.response import receptance
from updating.models.shear import sheared
from updating.models.spec import Spec, Theory
from updating.models.state import NOMINAL, State
from updating.models.whole import Whole
from updating.prediction.as_read import constants_change, gained_per_newton, level_of, made_real, turned
from updating.prediction.bodies import BodyChange, body_changes
from updating.prediction.dampers import Dampers, expects_damping
from updating.prediction.prediction import Prediction
from updating.prediction.sensitivities import Sensitivities
from updating.prediction.stretch import Stretch
from updating.prediction.window_left import with_window
from updating.test_data.chain import measurement_chain
from updating.test_data.measured import Measured

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Predictor(Displayed):
    """A specimen's model, observed from the points of a test.

    Parameters
    ----------
    spec : Spec
        The nominal model.
    measured : Measured
        The test whose points and FRFs are predicted.
    environment : Environment
        What the study states about the surroundings.
    additions : tuple of callables
        What is put into the model beforehand, each a function of the predictor that returns a State:
        accepted effects, the correction by a baseline test.
    basis : Reduced, optional
        A reduced basis that is there already; left out, one is made when it is asked for.
    """

    spec: Spec
    measured: Measured
    environment: Environment = field(default_factory=Environment)
    additions: tuple[Callable[[Predictor], State], ...] = ()
    basis: Reduced | None = None

    @cached_property
    def base(self) -> State:
        """What the additions put into the model, on this predictor's basis; each sees those before it."""
        if not self.additions:
            return NOMINAL
        before = self.for_test(self.measured, self.additions[:-1]) if len(self.additions) > 1 else self.bare
        return before.base.plus(self.additions[-1](before))

    @cached_property
    def bare(self) -> Predictor:
        """The same predictor on the same basis without any addition."""
        return self.for_test(self.measured, ()) if self.additions else self

    def for_test(
        self, measured: Measured, additions: tuple[Callable[[Predictor], State], ...] | None = None
    ) -> Predictor:
        """Return a predictor for another test or with other additions, on the same reduced basis."""
        kept = self.additions if additions is None else additions
        return replace(self, measured=measured, additions=kept, basis=self.reduced)

    def on(self, basis: Reduced) -> Predictor:
        """Return the predictor of the same test on another basis."""
        return replace(self, basis=basis)

    def of(self, spec: Spec) -> Predictor:
        """Return the predictor of another model for the same test, on a basis of its own."""
        return replace(self, spec=spec, basis=None)

    @cached_property
    def reduced(self) -> Reduced:
        """The nominal model on its reduced basis."""
        if self.basis is not None:
            return self.basis
        points, directions = self.measured.points, self.measured.directions
        if not len(points) and self.spec.outlined:
            points = np.zeros((1, self.spec.dim))
        modes = 30 if self.spec.kind == "beam" else 40
        return reduce_structure(build_structure(self.spec), points, directions, modes=modes)

    @cached_property
    def clamped(self) -> Predictor:
        """The same specimen on the columns that it needs while its clamps hold; itself where that saves little."""
        small = self.reduced if self.base.released else Clamped.of(self.reduced)
        return self if small is self.reduced else self.on(small)

    @cached_property
    def whole(self) -> Predictor:
        """The same specimen on all degrees of freedom, for states of its full matrices."""
        return self.on(Whole.of(self.reduced))

    def once(self, name: Hashable, build: Callable[[], T]) -> T:
        """Return what ``build`` gives, computed the first time this predictor is asked for ``name``."""
        if name not in self._kept:
            self._kept[name] = build()
        found: T = self._kept[name]
        return found

    @cached_property
    def _kept(self) -> dict[Hashable, Any]:
        return {}

    @property
    def expects_damping(self) -> bool:
        """Whether the model, a region, or a baseline test states the expected damping."""
        return self.expects(self.base)

    def under(self, theory: Theory) -> Predictor:
        """Return the predictor of the same specimen under another theory, kept for the next call.

        A thin plate that is to shear keeps its basis, see :mod:`updating.models.shear`; all others are built anew.
        """
        if theory == self.spec.theory:
            return self
        if theory not in self._others:
            spec = self.spec.with_theory(theory)
            thin = (self.spec.theory, theory) == ("kirchhoff", "mindlin")
            self._others[theory] = (
                replace(self, spec=spec, basis=sheared(self.reduced)) if thin else self.of(spec)
            )
        return self._others[theory]

    @cached_property
    def _others(self) -> dict[str, Predictor]:
        return {}

    def predict(
        self,
        state: State = NOMINAL,
        *,
        factors: Sequence[str] = (),
        count: int | None = None,
        at_least: int = 0,
    ) -> Prediction:
        """Predict the lowest elastic modes of a state.

        Parameters
        ----------
        state : State
            Departure from the nominal model, on top of ``base``.
        factors : sequence of str
            Factors to differentiate by, those of regions as ``web.E``.
        count : int, optional
            Number of modes; left out, those up to 1.6 times the highest measured frequency and three more.
        at_least : int
            Fewest modes where ``count`` is left out.
        """
        total = self.base.plus(state)
        if total.theory is not None and total.theory != self.spec.theory:
            other, bare = self.under(total.theory), replace(state, theory=None)
            return other.predict(bare, factors=factors, count=count, at_least=at_least)
        values, vectors = self.reduced.eigen(total)
        chosen = self._chosen(values, count, at_least)
        read = measurement_chain(self.measured, total)
        rows = self._rows(total, read.points)
        moving = structural(vectors, total.absorbers)
        damped_modes = self.dampers.coupled_modes(total, values, vectors, chosen)
        modes = self._modes_seen(moving, chosen, damped_modes, rows["w"])
        whole = {n: m[:, : len(modes)] @ modes for n, m in rows.items()}
        shapes = {n: np.real(m) for n, m in whole.items()}
        by, changes = self._by_factors(total, (values, moving), chosen, factors, rows, read.points)
        level = level_of(read, layer_slowing(total, values[chosen], vectors[:, chosen]))
        product = read.product(whole["w"], whole["w"])
        constants, phase = (
            (product, None) if damped_modes is None else made_real(product, self.measured.channel_group)
        )
        frequency, damping = self._read_poles(total, values, vectors, chosen, damped_modes)
        return Prediction(
            frequency=frequency,
            damping=damping,
            constants=level * constants,
            seen=shapes["w"][read.seen],
            hit=read.at_hit(shapes["w"], 1.0),
            seen_slopes=np.stack([shapes[n][read.seen] for n in self.doubted]),
            hit_slopes=np.stack([read.at_hit(shapes[n], 0.0) for n in self.doubted]),
            log_frequency_by=by.T,
            constants_by=level[:, :, None] * constants_change(shapes["w"], changes, read),
            vectors=np.real(modes),
            slope=total.slope + gained_per_newton(total, values[chosen], moving[:, chosen]),
            gain=level,
            phase=phase,
        )

    def _modes_seen(
        self, moving: FloatArray, chosen: IntArray, damped_modes: Damped | None, rows: FloatArray
    ) -> FloatArray | ComplexArray:
        """Return the shapes of the modes chosen on the basis, complex where dampers couple them, (r, n_modes)."""
        if damped_modes is None:
            return moving[:, chosen]
        elastic = moving[:, self.reduced.structure.rigid_modes :]
        return turned(elastic @ damped_modes.turn, moving[:, chosen], rows)

    def _read_poles(
        self,
        total: State,
        values: FloatArray,
        vectors: FloatArray,
        chosen: IntArray,
        damped_modes: Damped | None,
    ) -> tuple[FloatArray, FloatArray]:
        """Return natural frequencies [Hz] and damping ratios [-] as an identification reads them, (n_modes,) each."""
        square, own = values[chosen], vectors[:, chosen]
        shift = 1.0 + total.slope * (self.measured.level or 0.0)
        moved = shift * layer_slowing(total, square, own)
        moved = moved * self.dampers.slowed(total, values, vectors, chosen, damped_modes)
        return with_window(
            moved * np.sqrt(np.where(square > 0, square, np.nan)) / (2 * np.pi),
            self.dampers.ratios(total, square, own) if damped_modes is None else damped_modes.ratio,
            total.decay,
        )

    def _chosen(self, values: FloatArray, count: int | None, at_least: int) -> IntArray:
        """Return which modes of those with eigenvalues (n,) [rad^2/s^2] are predicted, the lowest elastic ones."""
        first = self.reduced.structure.rigid_modes
        if count is None:
            top = (2 * np.pi * 1.6 * self.measured.top) ** 2
            count = max(int(np.sum(values < top)) - first, len(self.measured.frequency) + 3, at_least)
        return np.arange(first, min(first + count, len(values)))

    def slowing(self, state: State, count: int) -> FloatArray:
        """Return the factors (count,) on the lowest frequencies of a state where dampers couple modes."""
        total, first = self.base.plus(state), self.reduced.structure.rigid_modes
        if not total.losses:
            return np.ones(count)
        values, vectors = self.reduced.eigen(total)
        chosen = np.arange(first, first + count)
        found = self.dampers.coupled_modes(total, values, vectors, chosen)
        return self.dampers.slowed(total, values, vectors, chosen, found)

    @cached_property
    def nominal_rows(self) -> dict[str, FloatArray]:
        """Displacement and slopes of the basis at the test points, each (n_points, r)."""
        points, directions = self.measured.points, self.measured.directions
        kept = self.reduced.kept
        key = "rows", points.tobytes(), None if directions is None else directions.tobytes()
        if key not in kept:
            kept[key] = self.reduced.rows(points, directions)
        rows: dict[str, FloatArray] = kept[key]
        return rows

    @cached_property
    def doubted(self) -> tuple[str, ...]:
        """Rows by which a point's place is in doubt: slopes, and the sides of joints at which some points lie."""
        sides = tuple(name for name in self.nominal_rows if name.startswith(SIDE))
        return ("wx", "wy", "wz")[: self.measured.points.shape[1]] + sides

    def _rows(self, state: State, places: FloatArray | None = None) -> dict[str, FloatArray]:
        """Return the rows of the basis at places, the test's points where none are given."""
        stretch = self.stretch.by(state.factors)
        elsewhere = places is not None and len(places) > len(self.measured.points)
        if (stretch == 1.0).all() and not elsewhere:
            return self.nominal_rows
        points = places if places is not None and elsewhere else self.measured.points
        rows = self.reduced.rows(self.stretch.undone(points, stretch), self._directions(len(points)))
        along = dict(zip(("wx", "wy"), stretch.tolist(), strict=False))
        there = {n: m / along.get(n, 1.0) for n, m in rows.items()}
        return {n: np.zeros_like(there["w"]) for n in self.doubted} | there

    def _directions(self, count: int) -> FloatArray | None:
        stated = self.measured.directions
        return None if stated is None else stated[np.minimum(np.arange(count), len(stated) - 1)]

    @cached_property
    def body_changes(self) -> dict[str, BodyChange]:
        """What masses and places of the stated bodies change, see :mod:`updating.prediction.bodies`."""
        return body_changes(self.reduced, self.spec)

    @cached_property
    def stretch(self) -> Stretch:
        """How the model stretches under the points of the test."""
        return Stretch(self.spec)

    def unstretched(self, values: Mapping[str, Any], state: State = NOMINAL) -> dict[str, Any]:
        """Return values of an effect with its places on the model before ``base`` and ``state`` stretched it."""
        return self.stretch.unstretched(values, self.base.plus(state).factors)

    def _by_factors(
        self,
        state: State,
        eigen: tuple[FloatArray, FloatArray],
        chosen: IntArray,
        names: Sequence[str],
        rows: dict[str, FloatArray],
        places: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return derivatives of ln f and of the shapes at places by the logarithms of factors."""
        if not names:
            return np.zeros((0, len(chosen))), np.zeros((0, len(places), len(chosen)))
        by, turns = self._sensitivities(tuple(names)).of(state, eigen, chosen)
        vectors = eigen[1]
        n = len(vectors)
        change = (rows["w"][:, :n] @ vectors) @ turns
        for axis, (name, slope) in enumerate(zip(self.stretch.names, ("wx", "wy"), strict=False)):
            if name in names:
                moved = self.stretch.growths[axis] - places[:, axis : axis + 1]
                change[names.index(name)] += (moved * rows[slope][:, :n]) @ vectors[:, chosen]
        return by, change

    def _sensitivities(self, names: tuple[str, ...]) -> Sensitivities:
        """Return the derivatives by some factors, kept for the next state."""
        return self.once(
            ("sensitivities", names),
            lambda: Sensitivities(self.reduced, self.spec, names, self.body_changes),
        )

    def expects(self, state: State) -> bool:
        """Whether model, regions or the state say what damping to expect."""
        return expects_damping(self.spec, state)

    @cached_property
    def dampers(self) -> Dampers:
        """What damps the modes of this specimen's states."""
        return Dampers(self.reduced, self.spec)

    def matrices(self, state: State = NOMINAL) -> Matrices:
        """Return K, M, C and D of a state on top of ``base``; modal ratios enter C through the state's own modes.

        Parameters
        ----------
        state : State
            Departure from the nominal model, under the predictor's own theory.
        """
        return self.dampers.matrices(self.base.plus(state))

    def complex_modes(self, state: State = NOMINAL) -> ComplexModes:
        """Return the damped modes of a state, exact for damping that is not proportional."""
        return complex_modes(self.matrices(state), rigid=self.reduced.structure.rigid_modes)

    def point_rows(self, state: State = NOMINAL, places: FloatArray | None = None) -> FloatArray:
        """Return the rows of the basis at the points of the test, absorbers behind it, shape (n_points, r).

        Where ``places`` (n_points, dim) [m] are more than these, at them.
        """
        total = self.base.plus(state)
        rows = self._rows(total, places)["w"][:, : self.reduced.ranks[total.released]]
        return padded(rows, total.absorbers) if total.absorbers else rows

    def point_slopes(self, state: State = NOMINAL) -> FloatArray:
        """Return the slopes of those rows along the in-plane axes, shape (dim, n_points, r)."""
        total = self.base.plus(state)
        rows, size = self._rows(total), self.reduced.ranks[total.released]
        names = [n for n in ("wx", "wy")[: self.measured.points.shape[1]] if n in rows]
        slopes = np.array([rows[n][:, :size] for n in names]).reshape(len(names), -1, size)
        return padded(slopes, total.absorbers) if total.absorbers else slopes

    def frf_rows(self, state: State = NOMINAL) -> tuple[FloatArray, FloatArray]:
        """Return the rows of the basis at the response and at the force of every FRF, each (n_frf, r)."""
        rows = self.point_rows(state)
        return rows[self.measured.seen], rows[self.measured.hit]

    def receptance(self, laplace: ComplexArray, state: State = NOMINAL) -> ComplexArray:
        """Return the model's receptances for the FRFs of the test, shape (n_frf, n_lines) [m/N].

        Parameters
        ----------
        laplace : (n_lines,) complex array
            Where in the Laplace plane, i omega + sigma [1/s].
        state : State
            Departure from the nominal model, on top of ``base``; its gain multiplies the FRFs, and its decay is
            that of a window beside what ``laplace`` holds.
        """
        total = self.base.plus(state)
        if total.theory is not None and total.theory != self.spec.theory:
            return self.under(total.theory).receptance(laplace, replace(state, theory=None))
        seen, hit = self.frf_rows(state)
        return np.asarray(total.gain * receptance(self.matrices(state), seen, hit, laplace + total.decay))
