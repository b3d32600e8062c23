"""The specimen hung up free: no clamp, and nothing that a clamp does."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from updating.diagnosis.next_test.base import Maker, Rival, Site, Trial
from updating.diagnosis.next_test.repeat import Repeat
from updating.effects.base import Effect
from updating.problem.specimen import SpecimenProblem


class FreeFree(Repeat):
    """The specimen hung up free, as many modes as before, with the same sensor."""

    family = "free-free"
    cost = 7
    measure = "take the specimen out of its clamp, hang it up free, and test it"

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem without clamps."""
        problem = site.problem
        free = problem.predictor.of(replace(problem.predictor.spec, clamped=()))
        return replace(problem, predictor=free, theory_error=None)

    def keeps(self, effect: Effect) -> bool:
        """Leave out what the clamp does."""
        return "unclamped" not in effect.undone_by


class Unclamped(Maker):
    """A free-free test, where there is a clamp and nothing else was put into the model."""

    def trials(self, site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
        """Give it."""
        predictor = site.problem.predictor
        if predictor.spec.clamped and not predictor.additions:
            yield FreeFree()
