"""A study's own model under its test: the problem that a diagnosis poses, on data as the nominal model gives them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.linalg

from acquisition.arrays import BoolArray, FloatArray, IntArray
from modalkit.blind.answer import Answer
from modalkit.planning.case import Case
from modalkit.planning.changes import Change, Gain
from modalkit.planning.curves import Curve, refined, solve_curve
from modalkit.planning.design import Design
from modalkit.planning.effects import NOT_FORECAST
from modalkit.planning.family import Family
from modalkit.planning.own.changes import own_changes
from modalkit.planning.own.families import families_of
from modalkit.planning.own.following import followed
from modalkit.planning.own.layout import Layout
from modalkit.planning.own.trials import REMOUNTED, Trial, drawn_chain
from modalkit.planning.separability import EQUAL
from modalkit.simulation.simulate import prepare
from modalkit.study.read import Study
from updating.effects import LIBRARY, Effect, hypotheses_of
from updating.likelihood.comparison import Comparison
from updating.models.state import NOMINAL
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

NO_SEVERITY = "the forecast has no severity scale for it on such a model"
"""Why an effect of the library, or one of a user's own, is left out."""


@dataclass(frozen=True, eq=False, kw_only=True)
class OwnBench:
    """A study's own model and its test.

    Parameters
    ----------
    study : Study
        The study.
    problem : SpecimenProblem
        Test and model; the data are the nominal model's own, at all stations, in one mode more than the test has.
    layout : Layout
        The stations.
    ranks : (n_modes + 1,) int array
        Ranks of the modes among the elastic ones; one less where the model has none above.
    design : Design
        The test as it is.
    band : (float, float)
        Band examined [Hz].
    hits : int
        Hits at each point [-].
    assumptions, left_out : tuples of str
        Where each figure comes from, and what is not known of.
    without : tuple of str
        Effects that the study rules out.
    """

    study: Study
    problem: SpecimenProblem
    layout: Layout
    ranks: IntArray
    design: Design
    band: tuple[float, float]
    hits: int
    assumptions: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    basis = "the study's own model"

    @cached_property
    def library(self) -> dict[str, Effect]:
        """The effects of the library and the study's hypotheses, by name."""
        spec = self.problem.predictor.spec
        return {**LIBRARY, **{effect.name: effect for effect in hypotheses_of(spec)}}

    @cached_property
    def not_forecast(self) -> Mapping[str, str]:
        """Effects that are not asked about, and why."""
        found: dict[str, str] = {}
        asked = {family.cause for family in self.families}
        for name, effect in self.library.items():
            obstacle = effect.why_not(self.problem.predictor)
            if obstacle is not None:
                found[name] = str(obstacle)
            elif name in self.without:
                found[name] = "the study rules it out"
            elif name not in asked:
                found[name] = NOT_FORECAST.get(name, NO_SEVERITY)
        return found

    @cached_property
    def families(self) -> tuple[Family, ...]:
        """Effects that apply to the model and that the data can show."""
        return tuple(family for effect in self._asked for family in self._of(effect))

    @property
    def _asked(self) -> Iterator[Effect]:
        shapes_only = {"calibration_gain", "channel_gain", "position_error"}
        for effect in self.library.values():
            idle = effect.name in self.without or (effect.name in shapes_only and not self.design.shapes)
            if not idle and effect.why_not(self.problem.predictor) is None:
                yield effect

    def _of(self, effect: Effect) -> list[Family]:
        points = self.problem.measured.points[list(self.layout.own)]
        return families_of(effect, self.problem.predictor, points)

    @cached_property
    def _nominal(self) -> Comparison:
        return self.problem.compare(NOMINAL)

    def change(self, family: Family, q: float, place: float) -> FloatArray:
        """Return what an effect of a severity [SI] at a place changes of the data, in one row [-].

        A state that has lost its stiffness changes nothing that could be detected.
        """
        zero = self._nominal.residual
        if not q:
            return np.zeros_like(zero)
        effect = self.library[family.cause]
        candidate = Candidate((effect,))
        stage = candidate.stage(self.problem.predictor)
        there = self.problem.compare(candidate.assemble(stage, [(effect, family.values(q, place))]))
        return np.nan_to_num(zero - there.residual, posinf=0.0, neginf=0.0)

    def solve(self, family: Family) -> Curve:
        """Return an effect at all its severities and places, with what its idealisation leaves in doubt."""
        doubt = Candidate((self.library[family.cause],)).doubt_on(self.problem.predictor)
        slack = np.where(self._nominal.of("damping"), doubt.damping, 0.0) if doubt.damping else None
        curve = solve_curve(family, self.change, fidelity=doubt.fidelity, slack=slack)
        return refined(curve, self.change, self._white, self.columns(self.design))

    @cached_property
    def _white(self) -> FloatArray:
        return self.whitener(self.design)

    def columns(self, design: Design) -> IntArray:
        """Return which entries of a row of data a test has."""
        return np.flatnonzero(self._have(self._nominal, design))

    def _have(self, found: Comparison, design: Design) -> BoolArray:
        hit = np.isin(self.layout.station[np.maximum(found.source, 0)], design.stations)
        inside = found.mode < design.modes
        damping = found.of("damping") & (design.damping_known or design.baseline)
        return np.asarray(
            inside & (found.of("frequency") | damping | (found.of("frf") & hit & design.shapes))
        )

    def whitener(self, design: Design) -> FloatArray:
        """Return W with ``W @ data`` of unit covariance, all doubts of the diagnosis counted in.

        A pair of tests has twice the noise, and neither tolerances nor doubts in level and damping.
        """
        found = self.problem_of(design).compare(NOMINAL)
        have = self._have(found, design)
        nuisance = found.nuisance[have]
        noise = found.variance[have] * (2.0 if design.baseline else 1.0)
        if design.baseline:
            nuisance = np.sqrt(2.0) * np.delete(nuisance, found.doubts, axis=1)
        lower = scipy.linalg.cholesky(np.diag(noise) + nuisance @ nuisance.T, lower=True)
        return np.asarray(scipy.linalg.solve_triangular(lower, np.eye(len(lower)), lower=True))

    def problem_of(self, design: Design) -> SpecimenProblem:
        """Return the problem with everything as doubtful as a design has it."""
        own, test = self.problem, self.problem.measured
        measured = replace(
            test,
            frequency_sigma=design.noise * test.frequency_sigma,
            damping_sigma=design.noise * test.damping_sigma,
            constants_sigma=design.noise * test.constants_sigma,
            calibration=design.calibration,
            repeatability=design.repeatability,
            position_sigma=design.position_sigma,
            absolute=design.absolute,
        )
        factors = dict(zip(own.names, design.tolerances, strict=True))
        damping = 0.0 if design.baseline else design.damping
        tolerances = replace(own.tolerances, factors={**own.tolerances.factors, **factors}, damping=damping)
        return replace(
            own, predictor=own.predictor.for_test(measured), measured=measured, tolerances=tolerances
        )

    def changes(self, design: Design, worth: Gain) -> Iterator[Change]:
        """Give all changes of the test that are worth a look."""
        higher = self.problem.measured.frequency[design.modes :]
        above = float(higher[0]) if len(higher) else None
        return own_changes(design, self.layout, self.problem.names, above, self.hits, worth)

    def follows(self, change: Change) -> bool:
        """Return whether a trial can follow a change: shapes without a hammer have no other places."""
        return change.design.stations == self.design.stations or not self.layout.blank.bare

    def right(self, case: Case) -> frozenset[str]:
        """Return the names that are right answers to a case."""
        return frozenset((case.family.cause, *(b for a, b in EQUAL if a == case.family.cause)))

    @cached_property
    def trial(self) -> Trial:
        """The test as it is, to be made on the study's model: it is hit as it was, or as is planned."""
        ready = prepare(self.study, REMOUNTED)
        return Trial(self.study, replace(ready, study=drawn_chain(self.study)), self.design, self.problem)

    def attempt(self, case: Case, change: Change | None, seed: list[int]) -> Answer:
        """Make a trial of the test as it is, or with a change followed."""
        trial = self.trial if change is None else followed(self.trial, self.layout, change.design)
        return trial.diagnosed(case, seed)
