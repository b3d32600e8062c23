"""What a baseline test has already determined: the tolerances, and how the model's shapes deviate.

The same specimen was tested before the effect was there. What tolerances did to that test they do to this one,
so only the difference of the sensitivities is left in doubt; and what the model's modal constants missed then
they miss now, in proportion to the level of the mode. Modes are carried over by their overlap, so that a mode
that mixes two of the baseline takes its share of each.

How much of it is missed still depends on what misses it. What a stiffness does to a shape stays where all of a mode
becomes heavier; what a mass does falls with its share of the modal mass, as the square of the frequency. A baseline
shows the sum of the two. Where both are as likely, each is half of the sum, give or take half of its r.m.s. over the
points: at a point where they cancel either may be there, too.

A baseline shows what the model misses of each mode, e_s = dK_ss / (2 K_ss), and not how that couples the modes. The
coupling is taken to be as large: of the relative size 2 e_st, with e_st^2 = (e_s^2 + e_t^2) / 2. A mode that an effect
mixes from those of the baseline, of which it has the shares p_s, takes up sqrt(p_s p_t) of it from each pair (the cross
term of the perturbation of second order). Summed over the pairs the variance of ln f is the sum of
2 p_s (1 - p_s) e_s^2. Both doubts grow with what the effect changes. A specimen on which nothing has changed has its
baseline's modes, known to the noise of the two tests.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.hit_scatter import HitScatter, hit_scatter, level_errors, own_variance
from updating.models.state import State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.test_data.chain import measurement_chain
from updating.test_data.measured import Measured
from updating.test_data.same_places import same_rows
from updating.thresholds import UNREACHED_MODE_DOUBT, UNSTATED_DAMPING_NOISE


@dataclass(frozen=True, eq=False)
class Missed:
    """What the present constants are held to miss.

    Parameters
    ----------
    constants : (n_frf, n_modes) array
        To be added to the prediction [1/kg].
    variance : (n_frf, n_modes) array
        Its variance [1/kg^2].
    known : (n_frf, n_modes, n_factors) array
        Sensitivities already known [1/kg].
    """

    constants: FloatArray
    variance: FloatArray
    known: FloatArray


@dataclass(frozen=True, eq=False)
class Before:
    """A baseline beside the model that was corrected by it.

    Parameters
    ----------
    predictor : Predictor
        The corrected model, observed from the points of the test; the correction is its last addition.
    measured : Measured
        The test.
    baseline : Measured
        The baseline's modes.
    order : (n_baseline,) int array
        Rank of each baseline mode's partner, for data without shapes.
    factors : sequence of str
        Factors with a tolerance.
    additions : sequence of callables
        Effects put into the model beforehand that were there in the baseline, too.
    """

    predictor: Predictor
    measured: Measured
    baseline: Measured
    order: IntArray
    factors: Sequence[str]
    additions: tuple[Callable[[Predictor], State], ...] = ()

    @cached_property
    def _corrected(self) -> Predictor:
        """The corrected model, observed from the points of the baseline."""
        return self.predictor.for_test(self.baseline, (*self.additions, self.predictor.additions[-1]))

    @cached_property
    def prediction(self) -> Prediction:
        """The corrected model's modes at the baseline's points, in the order of the baseline."""
        prediction = self._corrected.predict(factors=self.factors, at_least=int(self.order.max()) + 3)
        return prediction.select(match(self.baseline, prediction, self.order))

    @cached_property
    def scatter(self) -> HitScatter | None:
        """What the scatter of the baseline's hits is made of; None where they do not determine it."""
        return hit_scatter(self.baseline, self.prediction)

    @cached_property
    def _own(self) -> FloatArray:
        """Variance of each of the baseline's constants that no other shares, (n_frf, n_baseline) [1/kg^2]."""
        return own_variance(self.baseline, self.scatter)

    def level_errors(self, now: Prediction) -> FloatArray:
        """Return how far errors of the baseline's poles stretch what it determines of each present mode, (n_modes,)
        [-].
        """
        return np.asarray(np.sqrt(self.shares(now) @ level_errors(self.baseline, self.scatter) ** 2))

    @cached_property
    def _correction(self) -> FloatArray:
        """What the baseline corrected ln f of its modes by, shape (n_baseline,) [-]."""
        base = self.baseline
        plain = self.predictor.for_test(base, self.additions)
        prediction = plain.predict(at_least=int(self.order.max()) + 3)
        prediction = prediction.select(match(base, prediction, self.order))
        return np.asarray(np.log(base.frequency / prediction.frequency))

    @cached_property
    def _uneven(self) -> FloatArray:
        """That part of it which is no common factor, shape (n_baseline,) [-]."""
        return np.asarray(self._correction - np.median(self._correction))

    def common(self, now: Prediction) -> FloatArray:
        """Return how much of that common factor of ln f may be gone, since masses made it (1 sigma), (n_modes,) [-]."""
        gone = np.sum(self.shares(now) * (1 - self._least_carried(now)), axis=1)
        return np.asarray(gone / 2 * np.median(self._correction))

    def _variance(self, now: Prediction) -> FloatArray:
        """Return the variance of what the baseline's modes determine of ln f of the present ones, (n_modes,
        n_baseline) [-].

        It holds identification, re-mounting, and of that part of the correction which is no common factor what the
        change of the modes leaves in doubt.
        """
        base = self.baseline
        noise = (base.frequency_sigma / base.frequency) ** 2 + base.repeatability**2
        changed = (1 - self._least_carried(now)) ** 2 + self._coupling(now)
        return np.asarray(noise + changed * self._uneven**2)

    def _coupling(self, now: Prediction) -> FloatArray:
        """Return the doubt in how modes are coupled by what the model misses: variance over its square.

        Of each mode and each of the baseline's, (n_modes, n_baseline) [-].
        """
        return 2 * (1 - self.shares(now))

    def seen(self, now: Prediction) -> FloatArray:
        """Return how much of each present mode the baseline's modes make up together, (n_modes,) [-]."""
        return np.asarray(np.clip(self._overlap(now).sum(axis=1), 0.0, 1.0))

    def shares(self, now: Prediction) -> FloatArray:
        """Return how much each baseline mode has of what they make up of a present one, (n_modes, n_baseline) [-]."""
        overlap = self._overlap(now)
        return np.asarray(overlap / np.maximum(overlap.sum(axis=1, keepdims=True), 1e-12))

    def _overlap(self, now: Prediction) -> FloatArray:
        """Return the squares of the modal overlaps, (n_modes, n_baseline) [-]: by the baseline's own mass."""
        kept, found = self._last
        if kept is now:
            return found
        before = self.prediction.vectors
        n = min(len(now.vectors), len(before))
        mass = self._mass
        momenta = mass[:n, :n] @ before[:n]
        own = np.sum(now.vectors[:n] * (mass[:n, :n] @ now.vectors[:n]), axis=0)
        norm = np.outer(own, np.sum(before[:n] * momenta, axis=0))
        overlap = np.asarray((now.vectors[:n].T @ momenta) ** 2 / np.maximum(norm, 1e-300))
        self._remembered[:] = [(now, overlap)]
        return overlap

    @cached_property
    def _mass(self) -> FloatArray:
        """Mass of the corrected model on its basis, by which the baseline's modes are orthogonal [kg]."""
        return self._corrected.reduced.matrices(self._corrected.base)[1]

    @cached_property
    def _remembered(self) -> list[tuple[Prediction | None, FloatArray]]:
        """The overlap asked for last: every channel of a comparison asks for the same."""
        return [(None, np.zeros((0, 0)))]

    @property
    def _last(self) -> tuple[Prediction | None, FloatArray]:
        return self._remembered[0]

    def frequency(self, now: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return variance of and sensitivities already known in ln f of the present modes.

        Returns
        -------
        variance : (n_modes,) array [-]
        known : (n_modes, n_factors) array [-]
        """
        shares, seen = self.shares(now), self.seen(now)
        beyond = (1 - seen) * (np.var(self._uneven) + UNREACHED_MODE_DOUBT**2)
        known = seen[:, None] * (shares @ self.prediction.log_frequency_by)
        return np.sum(shares * self._variance(now), axis=1) + beyond, known

    def damping(self, now: Prediction) -> FloatArray:
        """Return the variance of what the baseline's modes determine of ln zeta of the present ones, (n_modes,) [-]."""
        base, stated = self.baseline, np.full(len(self.baseline.damping), np.nan)
        np.divide(base.damping_sigma, base.damping, out=stated, where=base.damping > 0)
        return np.asarray(self.shares(now) @ np.nan_to_num(stated, nan=UNSTATED_DAMPING_NOISE) ** 2)

    @cached_property
    def twins(self) -> dict[int, int]:
        """The row of the baseline that joins the same two points, by the row of the test."""
        here, there = self._rows
        return dict(zip(here.tolist(), there.tolist(), strict=True))

    @cached_property
    def _rows(self) -> tuple[IntArray, IntArray]:
        """Rows of the test and of the baseline with the same two points, in either order."""
        return same_rows(self.measured, self.baseline)

    def _read(self, state: State) -> tuple[IntArray, IntArray]:
        """Return rows of the test and of the baseline that really join the same two points, labels exchanged or not."""
        if not state.exchanged:
            return self._rows
        true = measurement_chain(self.measured, State(exchanged=state.exchanged))
        return same_rows(replace(self.measured, seen=true.seen, hit=true.hit), self.baseline)

    def shapes(self, now: Prediction, state: State) -> Missed:
        """Return the misses of the present constants according to the baseline.

        It is the structure that the model misses, so that the present measurement reads what is missed as it reads the
        rest: at the points where it really is, with its own signs and levels in place of the baseline's.

        Parameters
        ----------
        now : Prediction
            The present modes.
        state : State
            Of the present measurement, all that is put into the model included.
        """
        here, there = self._read(state)
        missed, variance = np.zeros_like(now.constants), np.zeros_like(now.constants)
        known = np.zeros_like(now.constants_by)
        if not (self.measured.absolute and self.baseline.absolute and len(here)):
            return Missed(missed, variance, known)
        read = measurement_chain(self.baseline, self._corrected.base).gain[there, None]
        gain = measurement_chain(self.measured, state).gain[here, None] / read
        predicted = self.prediction.constants[there]
        error = self.baseline.constants[there] - predicted
        # of a mode that was not predicted to be seen, its sensor on a node, what was missed is all there is
        whole = np.sum(self.baseline.constants[there] ** 2, axis=0)
        level = np.sqrt(
            (np.sum((now.constants[here] / gain) ** 2, axis=0)[:, None] + whole)
            / (np.sum(predicted**2, axis=0) + whole)
        )
        least, shares = self._least_carried(now), self.shares(now)
        weights = shares * level * (1 + least) / 2
        unseen = (1 - self.seen(now))[:, None] * shares
        missed[here] = gain * (error @ weights.T)
        coupled = (self._coupling(now) * shares + unseen) * level**2
        either = np.mean(error**2, axis=0) @ (weights * (1 - least) / (1 + least)).T ** 2
        variance[here] = gain**2 * (self._own[there] @ (weights**2).T + error**2 @ coupled.T + either)
        known[here] = gain[:, :, None] * np.einsum(
            "fkp,mk->fmp", self.prediction.constants_by[there], weights
        )
        return Missed(missed, variance, known)

    def _least_carried(self, now: Prediction) -> FloatArray:
        """Return what of a mode of the baseline is missed still if only masses missed it, (n_modes, n_baseline) [-].

        Where a mode has become lighter or stiffer it may be more; as much is in doubt.
        """
        ratio = (now.frequency[:, None] / self.prediction.frequency) ** 2
        return np.asarray(np.minimum(ratio, 1 / ratio))
