"""The best explanation of a diagnosis put back into its model, for the figures that show what it leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from acquisition.arrays import FloatArray
from updating import Case, Diagnosis, Predictor
from updating.diagnosis.answer.ranked import ParameterEstimate
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.fit import highest
from updating.diagnosis.search.points import Point, evaluate
from updating.effects import Variant, in_a_set
from updating.models.state import State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True, eq=False)
class Fitted:
    """A problem and its best explanation.

    Parameters
    ----------
    problem : Problem
        Test and model.
    candidate : Candidate, optional
        The explanation; None where there is none, or one that is not in the library.
    point : Point, optional
        It at its most probable parameters and tolerances.
    """

    problem: SpecimenProblem
    candidate: Candidate | None = None
    point: Point | None = None

    @property
    def left_over(self) -> FloatArray | None:
        """Residual after the explanation and the most probable tolerances, None where nothing explains [-]."""
        return None if self.point is None else self.point.left_over

    def model(self) -> tuple[Predictor, State] | None:
        """Return the model with explanation and tolerances in it, and the state that it was brought into."""
        if self.candidate is None or self.point is None:
            return None
        problem, stage = self.problem, self.candidate.stage(self.problem.predictor)
        state = self.candidate.assemble(stage, self.candidate.split(stage, self.point.coordinates.tolist()))
        shift = self.point.marginal.shift[: len(problem.names)]
        whole = state.plus(problem.doubted.departure(shift, stage))
        return stage.for_test(stage.measured, (*stage.additions, lambda _: whole)), whole


def fitted(diagnosis: Diagnosis, case: Case, *, alone: bool = True) -> Fitted:
    """Return the most probable explanation of a diagnosis in the model of a case.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case
        What was diagnosed, or one of several.
    alone : bool
        Whether it was the only one: then parameters are brought to their best, else left as the diagnosis has them.
    """
    problem, _ = pose(case)
    leader = diagnosis.ranking[0] if diagnosis.ranking and diagnosis.verdict != "none" else None
    if leader is None or any(name not in diagnosis.known for name in leader.effects):
        return Fitted(problem)
    found: list[tuple[Candidate, Point]] = []
    for fuller in (False, True)[: 1 + (problem.predictor.spec.fuller is not None)]:
        given = _stated(leader.parameters, case.title)
        whole = in_a_set(leader.effects, diagnosis.known)
        applying = [effect for effect in whole if problem.applies(effect) is None]
        stated = dict(zip((effect.key for effect in whole), leader.forms, strict=False))
        forms = tuple(
            Variant(stated[effect.key]) if effect.key in stated else _form(effect.key, given)
            for effect in applying
        )
        candidate = Candidate(tuple(applying), fuller, forms)
        start = _start(problem, candidate, given)
        point = highest(problem, candidate, start, rounds=6) if alone else evaluate(problem, candidate, start)
        found.append((candidate, point))
    candidate, point = max(found, key=lambda one: one[1].marginal.log_likelihood)
    return Fitted(problem, candidate, point) if point.possible else Fitted(problem)


def _stated(parameters: Mapping[str, ParameterEstimate], title: str) -> dict[str, ParameterEstimate]:
    """Return the estimates by effect.parameter: of one of several specimens, its own where it has some."""
    own = f" ({title})"
    common = {n: e for n, e in parameters.items() if " (" not in n}
    return {**common, **{n.removesuffix(own): e for n, e in parameters.items() if n.endswith(own)}}


def _form(name: str, given: Mapping[str, ParameterEstimate]) -> Variant:
    """Return what the form of an effect fixes: what has no interval."""
    own = {n.removeprefix(f"{name}."): e for n, e in given.items() if n.startswith(f"{name}.")}
    return Variant({n: e.value for n, e in own.items() if e.low95 is None})


def _start(
    problem: SpecimenProblem, candidate: Candidate, given: Mapping[str, ParameterEstimate]
) -> FloatArray:
    names = {name for name, _ in problem.parameters(candidate)}
    values = {n: float(e.value) for n, e in given.items() if n in names}  # type: ignore[arg-type]
    return candidate.coordinates(problem.predictor, values)
