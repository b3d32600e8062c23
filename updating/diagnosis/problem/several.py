"""Several specimens diagnosed together: causes they share have one severity, all others one for each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.diagnosis.problem.recent import Recent
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import Lack, Obstacle
from updating.likelihood.comparison import Comparison, join
from updating.likelihood.outliers import with_outliers
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem
from updating.problem.theory_error import TheoryError
from updating.test_data.measured import Measured

Named = tuple[tuple[str, str], ...]
"""The names of places that a form fixes, as (parameter, name)."""


def _names(effect: Effect, form: Variant) -> Named:
    """Return the places that a form names: regions, node sets, joints."""
    return tuple((name, str(form.values[name])) for name in effect.named if name in form.values)


@dataclass(frozen=True, eq=False)
class Several:
    """The problems of several specimens, to be explained by one set of effects.

    It answers what a :class:`SpecimenProblem` answers; where one specimen has to stand for all, the first does.

    Parameters
    ----------
    specimens : tuple of Problem
        One per specimen.
    titles : tuple of str
        Their names.
    shared : frozenset of str
        Effects whose parameters have one value on all specimens; those of all others have one on each.
    recent : Recent
        The comparisons made last.
    """

    specimens: tuple[SpecimenProblem, ...]
    titles: tuple[str, ...]
    shared: frozenset[str] = field(default_factory=frozenset)
    recent: Recent = field(default_factory=Recent)

    @property
    def predictor(self) -> Predictor:
        """That of the first specimen."""
        return self.specimens[0].predictor

    @property
    def measured(self) -> Measured:
        """That of the first specimen."""
        return self.specimens[0].measured

    @property
    def nominal(self) -> Prediction:
        """That of the first specimen."""
        return self.specimens[0].nominal

    @property
    def theory_error(self) -> TheoryError | None:
        """That of the first specimen."""
        return self.specimens[0].theory_error

    @property
    def wide(self) -> bool:
        """Whether any specimen's tolerances are too wide for one linearisation."""
        return any(problem.wide for problem in self.specimens)

    def strain(self, shift: FloatArray) -> float:
        """Return the largest relative change that nuisances make of a property on any of the specimens [-]."""
        parts = np.split(shift, np.cumsum([problem.linearised for problem in self.specimens])[:-1])
        return max(problem.strain(part) for problem, part in zip(self.specimens, parts, strict=True))

    def applies(self, effect: Effect) -> Obstacle | None:
        """Return why an effect can be examined on none of the specimens, or None."""
        if effect.labels:
            what = "the point differs between tests; diagnose each specimen separately"
            return Obstacle(Lack.ONE_TEST, what)
        found = [problem.applies(effect) for problem in self.specimens]
        return None if None in found else found[0]

    def forms(self, effect: Effect) -> tuple[Variant, ...]:
        """Return the forms in which an effect may come: those of the first specimen, and at other names of others."""
        found: list[Variant] = []
        for i in self._where(effect):
            known = [_names(effect, form) for form in found]
            own = self.specimens[i].forms(effect)
            found += [form for form in own if not found or _names(effect, form) not in known]
        return tuple(
            form for form in found if "channel" not in form.values
        )  # a sensor of that specimen alone

    def _where(self, effect: Effect) -> list[int]:
        """Return the specimens an effect applies to."""
        return [i for i, problem in enumerate(self.specimens) if problem.applies(effect) is None]

    @cached_property
    def _kept(self) -> dict[tuple[str, Named], list[int]]:
        return {}

    def _acting(self, effect: Effect, form: Variant) -> list[int]:
        """Return the specimens on which a form of an effect acts: those that have the place it names, if any."""
        names = _names(effect, form)
        if (effect.name, names) not in self._kept:
            known = self._where(effect)
            if names:
                known = [
                    i
                    for i in known
                    if any(_names(effect, f) == names for f in self.specimens[i].forms(effect))
                ]
            self._kept[effect.name, names] = known
        return self._kept[effect.name, names]

    def _specimens_of(self, effect: Effect, form: Variant) -> list[int]:
        """Return the specimens on which an effect has parameters of its own: the first for a shared one."""
        return self._acting(effect, form)[: 1 if effect.name in self.shared else None]

    def _blocks(self, candidate: Candidate) -> list[tuple[Effect, Variant, int, list[tuple[str, Parameter]]]]:
        """Return effect, form, specimen and parameters of every block of coordinates, in their order."""
        blocks = []
        for effect, form in zip(candidate.effects, candidate.forms, strict=True):
            for i in self._specimens_of(effect, form):
                own = Candidate((effect,), candidate.fuller, (form,))
                stage = own.stage(self.specimens[i].predictor)
                blocks.append((effect, form, i, list(own.parameters(stage))))
        return blocks

    def _name(self, name: str, effect: Effect, i: int) -> str:
        return name if effect.name in self.shared else f"{name} ({self.titles[i]})"

    def parameters(self, candidate: Candidate) -> tuple[tuple[str, Parameter], ...]:
        """Return the parameters that are searched, as (effect.parameter, prior), by specimen where not shared."""
        return tuple(
            (self._name(name, effect, i), parameter)
            for effect, _, i, own in self._blocks(candidate)
            for name, parameter in own
        )

    def starts(self, candidate: Candidate) -> list[FloatArray]:
        """Return prior quantiles from which to search: the same start on all specimens."""
        parts = []
        for effect, form, i, _ in self._blocks(candidate):
            own = Candidate((effect,), candidate.fuller, (form,)).starts(self.specimens[i].predictor)
            parts.append((effect.key, own))
        names = list(dict.fromkeys(name for name, _ in parts))
        counts = {name: min(len(own) for n, own in parts if n == name) for name in names}
        found = []
        for choice in product(*(range(counts[name]) for name in names)):
            taken = dict(zip(names, choice, strict=True))
            found.append(np.concatenate([*(own[taken[name]] for name, own in parts), []]))
        return found

    def _split(self, candidate: Candidate, coordinates: FloatArray) -> list[dict[str, Values]]:
        """Return the values of every effect on each specimen; an effect that does not apply there is missing."""
        values: list[dict[str, Values]] = [{} for _ in self.specimens]
        start = 0
        for effect, form, i, own in self._blocks(candidate):
            end = start + len(own)
            single = Candidate((effect,), candidate.fuller, (form,))
            stage = single.stage(self.specimens[i].predictor)
            ((_, found),) = single.split(stage, coordinates[start:end].tolist())
            everywhere = self._acting(effect, form) if effect.name in self.shared else [i]
            for j in everywhere:
                values[j][effect.key] = found
            start = end
        return values

    def values(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, float]:
        """Return all values at prior quantiles, by effect.parameter."""
        split = self._split(candidate, coordinates)
        return {
            self._name(f"{effect.key}.{n}", effect, i): v
            for effect, form in zip(candidate.effects, candidate.forms, strict=True)
            for i in self._specimens_of(effect, form)
            for n, v in split[i][effect.key].items()
        }

    def derived(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, tuple[float, str]]:
        """Return derived quantities at prior quantiles, by effect.name."""
        split = self._split(candidate, coordinates)
        found = {}
        for effect, form in zip(candidate.effects, candidate.forms, strict=True):
            for i in self._specimens_of(effect, form):
                stage = candidate.stage(self.specimens[i].predictor)
                for n, v in effect.derived(stage, split[i][effect.key]).items():
                    found[self._name(f"{effect.key}.{n}", effect, i)] = v
        return found

    def place(self, candidate: Candidate, coordinates: FloatArray) -> tuple[State, ...]:
        """Return the state of each specimen at prior quantiles."""
        split = self._split(candidate, coordinates)
        return tuple(
            self._state(candidate, problem, own) for problem, own in zip(self.specimens, split, strict=True)
        )

    def parts(self, candidate: Candidate, coordinates: FloatArray) -> tuple[list[tuple[Effect, Values]], ...]:
        """Return the effects on each specimen with their values at prior quantiles."""
        return tuple(
            [(effect, own[effect.key]) for effect in candidate.effects if effect.key in own]
            for own in self._split(candidate, coordinates)
        )

    def _state(self, candidate: Candidate, problem: SpecimenProblem, own: Mapping[str, Values]) -> State:
        stage = candidate.stage(problem.predictor)
        parts = [(effect, own[effect.key]) for effect in candidate.effects if effect.key in own]
        return candidate.assemble(stage, parts)

    def at(
        self, candidate: Candidate, coordinates: FloatArray, shift: FloatArray | None = None
    ) -> Comparison:
        """Compare all data with a candidate at prior quantiles; see :meth:`Problem.at`."""
        parts: list[Comparison] = []
        start = 0
        for i, (problem, own) in enumerate(
            zip(self.specimens, self._split(candidate, coordinates), strict=True)
        ):
            end = start + problem.linearised
            part = self._compared(candidate, i, own, None if shift is None else shift[start:end])
            start = end
            parts.append(part)
        return with_outliers(join(parts), candidate.outliers)

    def _compared(
        self, candidate: Candidate, i: int, own: Mapping[str, Values], shift: FloatArray | None
    ) -> Comparison:
        """Compare one specimen's data, unless that was done just before with the same values."""
        problem, doubt = self.specimens[i], candidate.doubt_on(self.specimens[i].predictor)
        acting = tuple((e, tuple(own[e.key].items())) for e in candidate.effects if e.key in own)
        stage = candidate.stage(problem.predictor)
        key = (i, candidate.fuller, stage, acting, doubt, None if shift is None else shift.tobytes())

        def compared() -> Comparison:
            parts = [(effect, own[effect.key]) for effect, _ in acting]
            there = candidate.doubt_on(problem.predictor, parts)
            return problem.compare(candidate.assemble(stage, parts), shift, doubt=there)

        return self.recent.get(key, compared)

    def compare(self, state: State) -> Comparison:
        """Compare all data with one state of every specimen."""
        return join([problem.compare(state) for problem in self.specimens])

    def part(self, candidate: Candidate, i: int) -> tuple[Candidate, IntArray]:
        """Return the effects of a candidate that act on one specimen, and which of its coordinates are theirs."""
        start = 0
        columns: list[int] = []
        kept: list[tuple[Effect, Variant]] = []
        for effect, form, specimen_index, own in self._blocks(candidate):
            end = start + len(own)
            here = i in self._acting(effect, form) if effect.name in self.shared else specimen_index == i
            if here:
                columns += range(start, end)
                kept.append((effect, form))
            start = end
        part = Candidate(tuple(e for e, _ in kept), candidate.fuller, tuple(f for _, f in kept))
        return part, np.array(columns, dtype=np.int64)
