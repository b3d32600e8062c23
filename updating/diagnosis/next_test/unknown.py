"""What to do where nothing explains the gap: look where the misfit is, and take away what may be at fault."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.answer.mechanism import Mechanism
from updating.diagnosis.answer.result import NextTest
from updating.diagnosis.next_test.base import Site
from updating.diagnosis.next_test.places import in_liquid
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.evidence import Explanation
from updating.problem.specimen import SpecimenProblem

AT_A_PLACE: Mapping[str, str] = {
    "stiffness": "look for a crack, a loose joint, a rib or a repair {where}, and touch the structure there; take off "
    "what holds it, and repeat the test",
    "mass": "look for a body, a layer or a filling {where}, take it off and repeat the test",
    "damping": "look for parts that rub or stick {where}, take it off and repeat the test",
    "measurement": "hit again, with another cable and sensor, {where}",
}
"""What settles a change of each channel at a place."""

EVERYWHERE: Mapping[str, str] = {
    "stiffness": "measure thickness and length of the specimen, and the modulus of its material",
    "mass": "weigh the specimen",
    "damping": "repeat the test on other supports, without window, at another temperature: this shows "
    "where the damping comes from",
    "measurement": "calibrate all channels with a known free mass, and repeat the test",
}
"""What settles a change of each channel all over."""


def settling(mechanism: Mechanism) -> str:
    """Return what to do to settle what a cause in no library is."""
    placed = mechanism.extent != "global" and bool(mechanism.locations)
    text = (AT_A_PLACE if placed else EVERYWHERE)[mechanism.channel]
    return text.format(where=mechanism.where)


def advise(
    site: Site, found: Search, mechanisms: Sequence[Mechanism] = (), *, fewest: int = 4
) -> tuple[NextTest, ...]:
    """Return what to do next where nothing explains the gap.

    Parameters
    ----------
    site : Site
        The specimen.
    found : Search
        What was compared.
    mechanisms : sequence of Mechanism
        What a cause in no library changes, the leading one first; the first tests are for these.
    fewest : int
        With fewer points more of them are asked for: shapes of a few points are alike.
    """
    problem = site.problem
    spec, test = problem.predictor.spec, problem.measured
    least_bad = next((row.explanation for row in found.compared if row.names), found.nothing)
    stated = list(dict.fromkeys(settling(one) for one in mechanisms[:2]))
    points = _points_that_miss(site, problem, least_bad)
    if points:
        stated.append(
            f"hit again, with care, point {', '.join(points)}, where the best explanation fits worst, "
            "and a point or two beside it"
        )
    if problem.baseline is None:
        stated.append(_another_state(problem))
    if not stated:
        stated.append("remount the specimen and repeat the test: this shows whether the gap is repeatable")
    if len(test.points) < fewest and spec.outlined:
        stated.append("measure at five points or more: the place where shapes deviate shows where to look")
    if spec.clamped and spec.outlined:
        stated.append("hang the specimen up free and test it: this shows whether the clamp causes the gap")
    where = f"{site.title}: " if site.title else ""
    return tuple(NextTest(where + text, (), float("nan"), whole=False) for text in stated)


def _another_state(problem: SpecimenProblem) -> str:
    """Return which state of the structure to test as a baseline; not every one can be stripped or dried."""
    if in_liquid(problem):
        return "test the same specimen in air, as a baseline"
    return (
        "test the same structure in another state, as a baseline: before the change in question, or without a part "
        "that can be taken off"
    )


def _points_that_miss(
    site: Site, problem: SpecimenProblem, explanation: Explanation, *, times: float = 1.7, most: int = 3
) -> list[str]:
    """Return the numbers of the points, ``most`` at most, at which the constants are off by ``times`` the r.m.s."""
    test = problem.measured
    if not test.has_shapes:
        return []
    if len(site.diagnosis_problem.specimens) > 1:
        return []
    comparison = explanation.best.comparison
    rows = comparison.scaled
    left = (explanation.best.left_over / np.sqrt(comparison.variance))[rows].reshape(test.constants.shape)
    if not np.isfinite(left).all():
        return []
    roving = test.hit if len(np.unique(test.hit)) >= len(np.unique(test.seen)) else test.seen
    places, group = np.unique(roving, return_inverse=True)
    each = _rms_by(left, group, len(places))
    bar = times * float(np.sqrt(np.mean(left**2)))
    worst = [i for i in np.argsort(-each)[:most].tolist() if each[i] > bar]
    return [str(test.nodes[places[i]]) for i in worst]


def _rms_by(values: FloatArray, group: np.ndarray, count: int) -> FloatArray:
    total = np.bincount(group, np.mean(values**2, axis=1), minlength=count)
    return np.asarray(np.sqrt(total / np.maximum(np.bincount(group, minlength=count), 1)))
