"""Which candidates are compared: singles first, then pairs that may be better, then one cause more where none fits.

That a single effect fits ends the search, unless it is a sketch that leaves more of itself in doubt than the noise
does: such a one may fit anything, and a second cause be plain in what is left. Beside it a second is sought.

An effect may come in several forms (which point, which sign); each is compared by itself, with its share of the
effect's prior, and their evidence is added up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Search, compare, extreme_parameters, merged
from updating.diagnosis.search.evidence import (
    Explanation,
    attempts,
    either,
    explain,
    finish,
    single_cause,
)
from updating.diagnosis.search.fewer import with_parts
from updating.diagnosis.search.larger import one_more
from updating.diagnosis.search.odd import with_odd_data
from updating.diagnosis.search.points import Point
from updating.diagnosis.search.sets import pairs_of
from updating.diagnosis.search.theory import with_theory_named
from updating.effects import Effect, Lack, Obstacle
from updating.problem.candidate import Candidate
from updating.problem.theory_shows import theory_shows
from updating.steps import SILENT, SingleCause, Steps
from updating.thresholds import (
    COUNT_PRIOR,
    DOUBT_BEYOND_NOISE,
    DOUBTED_FIT,
    FINISHING_ROUNDS,
    HOPELESS_FIT,
    PROBABLE_BEHIND,
    REJECTED_FIT,
    WELL_FITTED,
    WITHIN_REACH,
)

BENEATH = "its effect on a plate is computed, and added to every set of causes where it exceeds the noise"
"""Why a plate's theory is not examined as a cause."""


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
        nothing = either(nothing, explain(problem, Candidate(fuller=True)))
    singles = [nothing, *_singles(problem, effects, nothing, steps, both=both)]
    found = _with_odd(problem, [], singles, steps, "single causes", least=WELL_FITTED)
    far = not _explained(problem, found, well=True)
    if far or _by_its_doubt(problem, found):
        steps.begin("comparing pairs of causes")
        pairs = pairs_of(problem, _as_stated(found), steps, far=far)
        found = _with_odd(problem, found, pairs, steps, "pairs of causes", least=DOUBTED_FIT)
    for causes in range(3, len(COUNT_PRIOR)):
        if not _explained(problem, found):
            steps.begin(f"comparing sets of {causes} causes")
            larger = one_more(problem, _as_stated(found), causes, steps)
            what = f"sets of {causes} causes"
            found = _with_odd(problem, found, larger, steps, what, least=DOUBTED_FIT)
    found = _finished(problem, with_parts(problem, found))
    if both and not _beneath(problem) and len(problem.specimens) == 1:
        found = _finished(problem, with_theory_named(problem, found, effects))
    repeated = sum(effect.repeats_on(problem.predictor) for effect in effects)
    compared, set_aside = merged(problem, found, both=both)
    return Search(nothing, compared, obstacles, both, len(effects), repeated, set_aside)


def _with_odd(
    problem: DiagnosisProblem,
    found: list[Explanation],
    drafts: list[Explanation],
    steps: Steps,
    what: str,
    *,
    least: float,
) -> list[Explanation]:
    """Add drafts, as the data are stated and with outliers, and finish what is within reach and may end the search.

    It ends where something fits as well as ``least`` [-].
    """
    steps.begin(f"integrating the probable {what}")
    together = _finished(problem, found + drafts, least=least)
    new = together[len(found) :]
    return _finished(problem, together + with_odd_data(problem, new), least=least) if new else together


def _as_stated(found: list[Explanation]) -> list[Explanation]:
    """Return what takes no data to be worse than stated: only that shows whether more causes are needed."""
    return [one for one in found if not one.candidate.outliers]


def _explained(problem: DiagnosisProblem, found: list[Explanation], *, well: bool = False) -> bool:
    """Return whether any of the probable explanations fits beyond doubt, and at a plausible size.

    Where it has to fit well, its fit is no rarer than one in ten.
    """
    least = WELL_FITTED if well else DOUBTED_FIT
    rows = compare(_as_stated(found))
    top = max(row.probability for row in rows)
    near = [row for row in rows if row.probability > top * np.exp(-PROBABLE_BEHIND)]
    return any(row.p_value >= least and not extreme_parameters(problem, row.explanation) for row in near)


def _by_its_doubt(problem: DiagnosisProblem, found: list[Explanation]) -> bool:
    """Return whether the most probable explanation is a sketch that may fit by what it leaves in doubt of itself.

    It may where that doubt is far larger than the noise of the frequencies.
    """
    top = max(compare(found), key=lambda row: row.probability).explanation
    for one, now in zip(problem.specimens, top.best.comparison.predictions, strict=True):
        test, doubt = one.measured, top.best.marginal.share * top.candidate.doubt_on(one.predictor).fidelity
        noise = np.hypot(test.frequency_sigma / test.frequency, test.repeatability)
        if np.any(doubt * np.abs(np.log(now.frequency / one.nominal.frequency)) > DOUBT_BEYOND_NOISE * noise):
            return True
    return False


def _finished(
    problem: DiagnosisProblem, found: list[Explanation], *, least: float = HOPELESS_FIT
) -> list[Explanation]:
    """Evaluate by predictions what Laplace approximations left within reach of the best; the rest stays as drafted.

    So does all where nothing within reach fits as well as ``least`` [-]: no evidence decides between what is rejected.
    """
    finished = list(found)
    for evaluation in range(FINISHING_ROUNDS):
        rows = compare(finished)
        top = max(row.probability for row in rows)
        bar = top * np.exp(-WITHIN_REACH)
        near = [i for i, row in enumerate(rows) if row.probability > bar]
        left = [i for i in near if rows[i].explanation.lacks_samples(rows[i].probability / top)]
        if not left or all(rows[i].p_value < least for i in near):
            break
        left.sort(key=lambda i: -rows[i].probability)
        for i in left if evaluation else left[:1]:  # the best first: it may put the others out of reach
            finished[i] = finish(problem, finished[i], share=rows[i].probability / top)
    return finished


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
    """Evaluate every form of every effect: all a few steps uphill, the simple ones first, then to the top, best first.

    What one reaches is the bar for the others.
    """
    forms = [Candidate((effect,), chosen=(form,)) for effect in effects for form in problem.forms(effect)]
    forms.sort(key=lambda form: len(problem.parameters(form)))
    costs = [float(1 + len(problem.parameters(form))) ** 2 for form in forms]
    bar = nothing.best.marginal.log_likelihood
    found: dict[int, Explanation] = {}
    steps.found(SingleCause("", 0.0, nothing.p_value))
    work = steps.each([*forms, *forms], costs + costs)
    begun = []
    for form in islice(work, len(forms)):
        begun.append(attempts(problem, form, bar=bar))
        bar = max(bar, *(point.marginal.log_likelihood for point in begun[-1]))
    best_first = sorted(range(len(forms)), key=lambda i: -begun[i][0].marginal.log_likelihood)
    for i, _ in zip(best_first, work, strict=True):
        found[i] = _single(problem, forms[i], begun[i], bar, both=both)
        bar = max(bar, found[i].best.marginal.log_likelihood)
        steps.found(single_cause(forms[i].names[0], list(found.values()), nothing))
    return [found[i] for i in range(len(forms))]


def _single(
    problem: DiagnosisProblem, form: Candidate, begun: Sequence[Point], bar: float, *, both: bool
) -> Explanation:
    """Evaluate one form of an effect, where the theory falls short on either theory."""
    plain = explain(problem, form, begun=begun, laplace_only=True, bar=bar)
    if not both or form.effects[0].fuller:
        return plain
    fuller = replace(form, fuller=True)
    return either(plain, explain(problem, fuller, starts=plain.tops, laplace_only=True, bar=bar))
