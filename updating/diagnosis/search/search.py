"""Which candidates are compared: singles first, then pairs that may be better, then one cause more where none fits.

That a single effect fits ends the search, unless it is a sketch that leaves more of itself in doubt than the noise
does: such a one may fit anything, and a second cause be plain in what is left. Beside it a second is sought.

An effect may come in several forms (which point, which sign); each is compared by itself, with its share of the
effect's prior, and their evidence is added up.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain, finish, single_cause
from updating.diagnosis.search.fewer import with_parts
from updating.diagnosis.search.larger import one_more
from updating.diagnosis.search.odd import with_odd_data
from updating.diagnosis.search.prior import count_sets, log_prior
from updating.diagnosis.search.sets import pairs_of
from updating.diagnosis.search.theory import with_theory_named
from updating.effects import Effect, Lack, Obstacle, Variant
from updating.likelihood.outliers import Outlier
from updating.problem.candidate import Candidate
from updating.problem.theory_shows import theory_shows
from updating.steps import SILENT, SingleCause, Steps
from updating.thresholds import (
    COUNT_PRIOR,
    DOUBT_BEYOND_NOISE,
    DOUBTED_FIT,
    FINISHING_ROUNDS,
    FORM_SHARE,
    HELD_NEAR_END,
    HELD_SHARE,
    LEAST_PLACE,
    NEGLIGIBLE_PROBABILITY,
    PROBABLE_BEHIND,
    REJECTED_FIT,
    WELL_FITTED,
    WITHIN_REACH,
)

BENEATH = "its effect on a plate is computed, and added to every set of causes where it exceeds the noise"
"""Why a plate's theory is not examined as a cause."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """An explanation with its share of the probability and how well it fits.

    Parameters
    ----------
    explanation : Explanation
        What was compared.
    probability : float
        Its share [-].
    p_value : float
        How well it fits [-].
    as_stated : float
        How well it fits with no data taken to be worse than stated [-].
    extreme : tuple of str
        Parameters that the data push to an end of their range that is no natural one.
    regions : mapping of str to float
        How its probability is shared among the regions that its forms name; a form that names two gives each half [-].
    without : float
        Log evidence of no effect at all with the same data set aside; of none where none are [-].
    log_score : float
        Logarithm of its evidence times its prior; of what explains no more than data set aside do, none [-].
    forms : tuple of (Explanation, float)
        The same effects in the forms that hold a place's worth of its probability, with their shares of it, the best
        first [-].
    """

    explanation: Explanation
    probability: float
    p_value: float
    as_stated: float
    extreme: tuple[str, ...] = ()
    regions: Mapping[str, float] = field(default_factory=dict)
    without: float = -np.inf
    log_score: float = -np.inf
    forms: tuple[tuple[Explanation, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.explanation.names


@dataclass(frozen=True)
class Searched:
    """How many of the sets of so many causes were searched: those that score tests found the most promising.

    Parameters
    ----------
    causes : int
        Causes in a set.
    sets, possible : int
        How many were searched, and how many there are.
    """

    causes: int
    sets: int
    possible: int


@dataclass(frozen=True, eq=False)
class Search:
    """All that was compared.

    Parameters
    ----------
    nothing : Explanation
        The nominal model with its tolerances.
    compared : tuple of Compared
        All sets of effects, most probable first; the empty set is among them.
    not_examined : dict
        Effects left out, and why.
    both : bool
        Whether every set was compared on the model's theory and on the fuller one.
    examined, repeated : int
        How many effects the sets are made of, and how many of them a set may have twice.
    set_aside : tuple of Compared
        No effect with the data set aside that sets of effects set aside, most probable first: data that are worse than
        stated are an explanation, too.
    """

    nothing: Explanation
    compared: tuple[Compared, ...]
    not_examined: dict[str, Obstacle]
    both: bool = False
    examined: int = 0
    repeated: int = 0
    set_aside: tuple[Compared, ...] = ()

    @property
    def searched(self) -> tuple[Searched, ...]:
        """How many sets of one cause, of two and so on were searched, up to the largest that any was."""
        counts = Counter(len(row.names) for row in self.compared if row.names)
        return tuple(
            Searched(causes, counts[causes], count_sets(causes, self.examined, self.repeated))
            for causes in range(1, 1 + max(counts, default=0))
        )

    @property
    def empty(self) -> Compared:
        """The empty set, with all its outliers."""
        return next(row for row in self.compared if not row.names)


def examine(problem: DiagnosisProblem, library: Sequence[Effect]) -> tuple[list[Effect], dict[str, Obstacle]]:
    """Sort a library into what can be examined on this specimen and what cannot, with the reason."""
    obstacles = {effect.name: problem.applies(effect) for effect in library}
    for effect in library:
        if effect.fuller and obstacles[effect.name] is None and _beneath(problem):
            obstacles[effect.name] = Obstacle(Lack.MODEL, BENEATH)
    possible = [effect for effect in library if obstacles[effect.name] is None]
    return possible, {name: why for name, why in obstacles.items() if why is not None}


def search(problem: DiagnosisProblem, library: Sequence[Effect], steps: Steps = SILENT) -> Search:
    """Evaluate no effect, every single effect, and sets of more where those of fewer do not explain the data.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    library : sequence of Effect
        Effects to consider.
    steps : Steps
        Where stages are announced.
    """
    steps.begin("comparing single causes")
    effects, obstacles = examine(problem, library)
    nothing = explain(problem, Candidate())
    both = _on_both(problem, effects, nothing)
    if both and _beneath(problem):
        nothing = _either(nothing, explain(problem, Candidate(fuller=True)))
    found = _with_odd(
        problem, [], [nothing, *_singles(problem, effects, nothing, steps, both=both)], steps, "single causes"
    )
    far = not _explained(problem, found, well=True)
    if far or _by_its_doubt(problem, found):
        steps.begin("comparing pairs of causes")
        pairs = pairs_of(problem, _as_stated(found), steps, far=far)
        found = _with_odd(problem, found, pairs, steps, "pairs of causes")
    for causes in range(3, len(COUNT_PRIOR)):
        if not _explained(problem, found):
            steps.begin(f"comparing sets of {causes} causes")
            larger = one_more(problem, _as_stated(found), causes, steps)
            found = _with_odd(problem, found, larger, steps, f"sets of {causes} causes")
    found = _finished(problem, with_parts(problem, found))
    if both and not _beneath(problem) and len(problem.specimens) == 1:
        found = _finished(problem, with_theory_named(problem, found, effects))
    repeated = sum(effect.repeats_on(problem.predictor) for effect in effects)
    compared, set_aside = _merged(problem, found)
    return Search(nothing, compared, obstacles, both, len(effects), repeated, set_aside)


def _with_odd(
    problem: DiagnosisProblem,
    found: list[Explanation],
    drafts: list[Explanation],
    steps: Steps,
    what: str,
) -> list[Explanation]:
    """Add drafts, as the data are stated and with outliers, and finish what is within reach."""
    steps.begin(f"integrating the probable {what}")
    together = _finished(problem, found + drafts)
    new = together[len(found) :]
    return _finished(problem, together + with_odd_data(problem, new)) if new else together


def _as_stated(found: list[Explanation]) -> list[Explanation]:
    """Return what takes no data to be worse than stated: only that shows whether more causes are needed."""
    return [one for one in found if not one.candidate.outliers]


def _explained(problem: DiagnosisProblem, found: list[Explanation], *, well: bool = False) -> bool:
    """Return whether any of the probable explanations fits beyond doubt, and at a plausible size.

    Where it has to fit well, its fit is no rarer than one in ten.
    """
    least = WELL_FITTED if well else DOUBTED_FIT
    rows = _compare(_as_stated(found))
    top = max(row.probability for row in rows)
    near = [row for row in rows if row.probability > top * np.exp(-PROBABLE_BEHIND)]
    return any(row.p_value >= least and not _extreme(problem, row.explanation) for row in near)


def _by_its_doubt(problem: DiagnosisProblem, found: list[Explanation]) -> bool:
    """Return whether the most probable explanation is a sketch that may fit by what it leaves in doubt of itself.

    It may where that doubt is far larger than the noise of the frequencies.
    """
    top = max(_compare(found), key=lambda row: row.probability).explanation
    for one, now in zip(problem.specimens, top.best.comparison.predictions, strict=True):
        test, doubt = one.measured, top.best.marginal.share * top.candidate.doubt_on(one.predictor).fidelity
        noise = np.hypot(test.frequency_sigma / test.frequency, test.repeatability)
        if np.any(doubt * np.abs(np.log(now.frequency / one.nominal.frequency)) > DOUBT_BEYOND_NOISE * noise):
            return True
    return False


def _finished(problem: DiagnosisProblem, found: list[Explanation]) -> list[Explanation]:
    """Evaluate by predictions what Laplace approximations left within reach of the best; the rest stays as drafted."""
    finished = list(found)
    for evaluation in range(FINISHING_ROUNDS):
        rows = _compare(finished)
        bar = max(row.probability for row in rows) * np.exp(-WITHIN_REACH)
        left = [i for i, row in enumerate(rows) if row.explanation.laplace_only and row.probability > bar]
        if not left:
            break
        left.sort(key=lambda i: -rows[i].probability)
        for i in left if evaluation else left[:1]:  # the best first: it may put the others out of reach
            finished[i] = finish(problem, finished[i])
    return finished


def _merged(
    problem: DiagnosisProblem, found: Sequence[Explanation]
) -> tuple[tuple[Compared, ...], tuple[Compared, ...]]:
    """Add up the forms of each set of effects; the most probable form stands for them.

    A set that sets data aside is compared with no effect that sets the same aside. Where it is not the more probable it
    explains nothing, and has no share; the data that are worse than stated have it.
    """
    forms: dict[tuple[str, ...], list[Compared]] = {}
    for row in _compare(found):
        forms.setdefault(tuple(sorted(row.names)), []).append(row)
    merged = []
    without: dict[tuple[bool, tuple[Outlier, ...]], Explanation] = {}
    for own in forms.values():
        top = max(own, key=lambda row: row.probability)
        total = float(logsumexp([row.explanation.log_evidence for row in own]))
        fits = max(row.p_value for row in own if row.probability >= FORM_SHARE * top.probability)
        candidate, least = top.explanation.candidate, -np.inf
        if candidate.outliers and top.names:
            bare = Candidate(fuller=candidate.fuller, outliers=candidate.outliers)
            key = bare.fuller, bare.outliers
            if key not in without:
                without[key] = explain(problem, bare, laplace_only=True)
            least = without[key].log_evidence
        explains = total > least or not top.names
        probability = sum(row.probability for row in own) if explains else 0.0
        extreme = _extreme(problem, top.explanation) if probability > NEGLIGIBLE_PROBABILITY else ()
        merged.append(
            Compared(
                explanation=replace(top.explanation, log_evidence=total),
                probability=probability,
                p_value=fits,
                as_stated=max(row.as_stated for row in own),
                extreme=extreme,
                regions=_by_region(own, total),
                without=least,
                log_score=total + log_prior(len(top.names), _examined(found)) if explains else -np.inf,
                forms=_by_form(own, sum(row.probability for row in own)),
            )
        )
    return _shared(merged, _aside(found, list(without.values())))


def _aside(found: Sequence[Explanation], without: list[Explanation]) -> list[Compared]:
    """Return no effect with data set aside, with its share beside all that was found.

    An odd shape, channel or damping ratio is a slip of a test in which nothing is hidden. A frequency that belongs
    elsewhere is a gap by itself: as likely, beforehand, as any one cause.
    """
    examined, level = _examined(found), logsumexp(_scores(found))
    known = {e.candidate.outliers for e in found if not e.names}
    rows = []
    for one in without:
        if one.candidate.outliers in known:
            continue
        gap = any(outlier.of_frequency for outlier in one.candidate.outliers)
        score = one.log_evidence + log_prior(int(gap), examined)
        share = float(np.exp(score - level))
        rows.append(
            Compared(explanation=one, probability=share, p_value=one.p_value, as_stated=0.0, log_score=score)
        )
    return rows


def _shared(rows: list[Compared], aside: list[Compared]) -> tuple[tuple[Compared, ...], tuple[Compared, ...]]:
    """Return rows of two kinds, each the most probable first, with shares that add up to one."""
    total = sum(row.probability for row in (*rows, *aside))
    first, second = (
        tuple(sorted((replace(row, probability=row.probability / total) for row in part), key=_improbable))
        for part in (rows, aside)
    )
    return first, second


def _improbable(row: Compared) -> float:
    return -row.probability


def _by_form(own: list[Compared], total: float) -> tuple[tuple[Explanation, float], ...]:
    """Return the forms of one set that hold enough of its probability to be named, with their shares of it [-]."""
    shares = [(row.explanation, row.probability / total) for row in own if total > 0]
    probable = [(one, share) for one, share in shares if share >= LEAST_PLACE]
    return tuple(sorted(probable, key=lambda form: -form[1]))


def _by_region(own: list[Compared], total: float) -> dict[str, float]:
    """Return how the evidence of one set's forms is shared among the regions that they name [-]."""
    shares: dict[str, float] = {}
    for row in own:
        named = [str(f.values["region"]) for f in row.explanation.candidate.forms if "region" in f.values]
        for name in named:
            share = float(np.exp(row.explanation.log_evidence - total)) if np.isfinite(total) else 0.0
            shares[name] = shares.get(name, 0.0) + share / len(named)
    return shares if sum(shares.values()) > 0 else {}


def _extreme(problem: DiagnosisProblem, explanation: Explanation) -> tuple[str, ...]:
    """Return the parameters whose best value and most of whose posterior lie at an end that is a judgement."""
    found = []
    for i, (name, parameter) in enumerate(problem.parameters(explanation.candidate)):
        best = float(explanation.best.coordinates[i])
        away = np.abs(explanation.samples[:, i] - round(best))
        if parameter.extreme(best) and explanation.weights[away > HELD_NEAR_END].sum() < 1 - HELD_SHARE:
            found.append(name)
    return tuple(found)


def _examined(found: Sequence[Explanation]) -> int:
    return len({name for e in found for name in e.names})


def _scores(found: Sequence[Explanation]) -> FloatArray:
    """Return the logarithm of evidence and prior of each [-]."""
    examined = _examined(found)
    return np.array([e.log_evidence + log_prior(len(e.names), examined) for e in found])


def _compare(found: Sequence[Explanation]) -> list[Compared]:
    score = _scores(found)
    probability = np.exp(score - logsumexp(score))
    stated = [0.0 if e.candidate.outliers else e.p_value for e in found]
    return [
        Compared(explanation=e, probability=float(p), p_value=e.p_value, as_stated=s)
        for e, p, s in zip(found, probability, stated, strict=True)
    ]


def _beneath(problem: DiagnosisProblem) -> bool:
    """Return whether theory is no cause to be named but what every set, the empty one too, stands on: of plates.

    What a thin plate lacks is computed mode by mode; no modeller assumes that the specimen has no shear.
    """
    return all(one.predictor.spec.kind == "plate" for one in problem.specimens)


def _on_both(problem: DiagnosisProblem, effects: list[Effect], nothing: Explanation) -> bool:
    """Return whether every set must be compared on the fuller theory as well.

    It must where that theory moves frequencies or shapes by more than a part of the noise, unless, where theory is a
    cause like others, it alone explains the data: then nothing else is needed beside it.
    """
    if not any(theory_shows(one) for one in problem.specimens):
        return False
    if _beneath(problem):
        return True
    fuller = next((effect for effect in effects if effect.fuller), None)
    return fuller is not None and explain(problem, Candidate((fuller,))).p_value < REJECTED_FIT


def _singles(
    problem: DiagnosisProblem, effects: list[Effect], nothing: Explanation, steps: Steps, *, both: bool
) -> list[Explanation]:
    """Evaluate every form of every effect, the simple ones first: what they reach is the bar for the others."""
    forms = [(effect, form) for effect in effects for form in problem.forms(effect)]
    sizes = [len(problem.parameters(Candidate((effect,), chosen=(form,)))) for effect, form in forms]
    order = np.argsort(sizes, kind="stable")
    bar, found = nothing.best.marginal.log_likelihood, []
    steps.found(SingleCause("", 0.0, nothing.p_value))
    for effect, form in steps.each([forms[i] for i in order], [float(1 + sizes[i]) ** 2 for i in order]):
        found.append(_single(problem, effect, form, bar, both=both))
        bar = max(bar, found[-1].best.marginal.log_likelihood)
        steps.found(single_cause(effect.name, found, nothing))
    return found


def _single(
    problem: DiagnosisProblem, effect: Effect, form: Variant, bar: float, *, both: bool
) -> Explanation:
    """Evaluate one form of an effect, where the theory falls short on either theory."""
    plain = explain(problem, Candidate((effect,), chosen=(form,)), laplace_only=True, bar=bar)
    if not both or effect.fuller:
        return plain
    fuller = Candidate((effect,), fuller=True, chosen=(form,))
    return _either(plain, explain(problem, fuller, starts=plain.tops, laplace_only=True, bar=bar))


def _either(plain: Explanation, fuller: Explanation) -> Explanation:
    """Return the better of one set on two theories, with half the evidence of each."""
    total = float(np.logaddexp(plain.log_evidence, fuller.log_evidence) - np.log(2))
    chosen = max(plain, fuller, key=lambda e: e.log_evidence)
    return replace(chosen, log_evidence=total, other=total - chosen.log_evidence)
