"""Every method finds a region that is grossly changed, or says nothing; evidence equals a brute-force integral."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from imported_cases import LENGTH, imported_beam, seen_from, spec_of
from scipy.special import logsumexp
from scipy.stats import norm
from updating_cases import BEAM as FINE
from updating_cases import PLATE, POINTS, ExactBeam, blank, case_of, observed, specimen, struck

from updating import Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.likelihood.gaussian import marginal
from updating.localisation import (
    METHODS,
    BestSubspace,
    Comac,
    ConstitutiveError,
    ForceResidual,
    Kind,
    Localiser,
    RegionEvidence,
    areas,
    boxes,
    compare_regions,
    regions_at,
)
from updating.localisation.changes import NODES, changes, columns
from updating.localisation.evidence import DOUBT, RegionPosterior
from updating.localisation.force_residual import region_parts
from updating.localisation.severity import Between, integrate, refine
from updating.localisation.shapes import dynamic, serep, shapes_of
from updating.models.state import NOMINAL, Loss, State
from updating.problem.specimen import SpecimenProblem

BEAM = FINE.with_elements(20)
SHARP = ((ConstitutiveError(), 2), (BestSubspace(), 1), (RegionEvidence(), 1))
"""The methods that are good for something, and among how many of the most suspect the region must be."""


@cache
def soft(zone: int, loss: float, *, as_designed: bool = False, shapes_only: bool = False) -> SpecimenProblem:
    """An exact Timoshenko beam that has lost stiffness in one of ten zones, tested at five points."""
    rng = np.random.default_rng(3)
    edges = (BEAM.length * zone / 10, BEAM.length * (zone + 1) / 10, loss)
    plain = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness, soft=edges)
    test = struck(plain if as_designed else specimen(rng, soft=edges), rng)
    if shapes_only:
        test = replace(test, hit=np.full(5, -1), seen=np.arange(5), absolute=False)
    return pose(case_of(test, BEAM))[0]


@cache
def altered(state: str) -> SpecimenProblem:
    """A beam from a finer mesh of the model, with mass or damping in its eighth zone."""
    predictor = Predictor(FINE.with_elements(60), blank(POINTS))
    if state == "mass":
        what = State(regional={(7, "density"): 1.5})
    else:
        whole = np.zeros((predictor.reduced.basis.shape[1],) * 2)
        part = region_parts(replace(soft(0, 0.1), predictor=predictor), "stiffness")[7]
        whole[: len(part), : len(part)] = part
        what = State(losses=(Loss(0.2 * whole, -1.0),))
    found = predictor.predict(what, count=5)
    test = observed(found.frequency, found.damping, found.constants, POINTS, np.random.default_rng(5))
    return pose(case_of(test, BEAM))[0]


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
@pytest.mark.parametrize("shapes_only", [False, True])
def test_scores_are_one_sound_number_per_region(method: Localiser, shapes_only: bool) -> None:
    problem = soft(3, 0.4, shapes_only=shapes_only)
    assert method.obstacle(problem) is None
    scores = method.scores(problem)
    assert scores.shape == (10,)
    assert np.isfinite(scores).all()
    assert (scores >= 0).all()
    assert scores.max() > 0


@pytest.mark.parametrize(("method", "among"), SHARP, ids=repr)
@pytest.mark.parametrize("zone", [1, 4, 6])
def test_a_zone_that_lost_half_its_stiffness_is_the_most_suspect(
    method: Localiser, among: int, zone: int
) -> None:
    scores = method.scores(soft(zone, 0.5, as_designed=True))
    assert np.sum(scores > scores[zone]) < among


@pytest.mark.long
@pytest.mark.parametrize("zone", range(10))
def test_evidence_and_subspace_find_a_tenth_under_tolerances(zone: int) -> None:
    problem = soft(zone, 0.12 if zone < 8 else 0.5)
    assert np.argmax(RegionEvidence().scores(problem)) == zone
    assert np.argmax(BestSubspace().scores(problem)) == zone


@pytest.mark.long
@pytest.mark.parametrize("kind", ["mass", "damping"])
def test_the_kind_of_change_and_its_size_are_found_too(kind: str) -> None:
    found = compare_regions(altered(kind))
    assert max(found.by_kind, key=lambda k: found.by_kind[k]) == kind
    assert np.argmax(found.regions) == 7
    expected = {"mass": 1.5, "damping": 0.2}[kind]
    assert np.exp(found.severity[found.kinds.index(kind), 7]) == pytest.approx(expected, rel=0.25)  # type: ignore[arg-type]
    assert np.argmax(BestSubspace().scores(altered(kind), kind=kind)) == 7  # type: ignore[arg-type]


def brute(problem: SpecimenProblem, kind: Kind, region: int) -> float:
    """Log evidence of a region's change, every severity predicted: steps halved until no more is gained."""
    state = changes(problem, kind)[region].state
    low, high = NODES[kind][0], NODES[kind][-1]

    def likely(severity: np.ndarray) -> np.ndarray:
        evaluations = [problem.compare(state(s), doubt=DOUBT) for s in severity.tolist()]
        return np.array([marginal(evaluation).log_likelihood for evaluation in evaluations])

    grid = np.r_[np.linspace(low, 0.0, 31)[:-1], np.linspace(0.0, high, 31)]
    values = likely(grid)
    for _ in range(9):
        ends = np.maximum(values[1:], values[:-1])
        steep = np.pad(np.abs(np.diff(values)) > 0.3, 1)
        coarse = (ends > values.max() - 14) & (steep[1:-1] | steep[:-2] | steep[2:])
        middle = ((grid[1:] + grid[:-1]) / 2)[coarse]
        order = np.argsort(np.r_[grid, middle])
        grid, values = np.r_[grid, middle][order], np.r_[values, likely(middle)][order]
    # the prior: half of it on either side of the model, both even
    density = 0.5 / np.where(grid[:-1] < 0, -low, high)
    top = values.max()
    share = np.exp(values - top)
    total = np.sum(density * np.diff(grid) * (share[1:] + share[:-1]) / 2)
    return float(top + np.log(total)) - marginal(problem.compare(NOMINAL)).log_likelihood


@pytest.mark.long
@pytest.mark.parametrize(("zone", "loss"), [(4, 0.1), (2, 0.5)])
@pytest.mark.parametrize("kind", ["stiffness", "mass"])
def test_evidence_is_the_integral_over_the_severity(zone: int, loss: float, kind: Kind) -> None:
    problem = soft(zone, loss)
    found = compare_regions(problem, (kind,))
    for region in (4, 2):
        assert found.log_evidence[0, region] == pytest.approx(brute(problem, kind, region), abs=0.1)


def test_likelihood_between_the_severities_predicted_is_that_of_a_prediction() -> None:
    problem = soft(4, 0.1)
    state = changes(problem, "stiffness")[4].state
    nodes = [*NODES["stiffness"].tolist(), 0.0]
    between = Between({s: problem.compare(state(s), doubt=DOUBT) for s in nodes})
    asked = np.array([-0.25, -0.1, -0.05, 0.05])
    exact = [marginal(problem.compare(state(s), doubt=DOUBT)).log_likelihood for s in asked.tolist()]
    assert between.log_likelihoods(asked) == pytest.approx(np.array(exact), abs=0.1)


@given(
    peaks=st.lists(
        st.tuples(st.integers(-29, 9).map(lambda i: i / 10 + 0.037), st.floats(1e-3, 1.0)),
        min_size=1,
        max_size=2,
    ),
)
def test_refined_steps_carry_the_integral_of_any_peaks(peaks: list[tuple[float, float]]) -> None:
    def likely(severity: np.ndarray) -> np.ndarray:
        parts = [norm.logpdf(severity, at, wide) for at, wide in peaks]
        return np.asarray(logsumexp(np.stack(parts), axis=0))

    # as in a region's evidence, a peak is found whose flanks reach to the next severity looked at
    first = np.unique(np.r_[np.linspace(-3.0, 0.0, 21), np.linspace(0, 1.1, 21), [at for at, _ in peaks]])
    _, score = integrate(*refine(likely, first))
    expected = np.sum([norm.cdf(1.1, at, wide) - norm.cdf(-3.0, at, wide) for at, wide in peaks])
    assert float(logsumexp(score)) == pytest.approx(float(np.log(expected)), abs=0.05)


def test_columns_are_the_sensitivities_of_the_model() -> None:
    problem = soft(3, 0.3)
    factor = problem.names.index("E")
    whole = problem.compare(NOMINAL).nuisance[:, factor] / problem.sigmas[factor]
    undamped = problem.compare(NOMINAL).channel != 1
    found = columns(problem, "stiffness").sum(axis=1)
    assert found[undamped] == pytest.approx(whole[undamped], abs=2e-3 * np.abs(whole).max())


def test_shapes_come_back_from_the_constants() -> None:
    beam = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness)
    frequency = beam.frequencies(5)
    shape = beam.shapes(frequency, POINTS)
    every = np.array([(a, b) for a in range(5) for b in (1, 4)])
    measured = observed(frequency, np.full(5, 0.01), shape * shape[-1], POINTS, np.random.default_rng(0))
    constants = shape[every[:, 0]] * shape[every[:, 1]]
    test = replace(
        measured,
        seen=every[:, 1],
        hit=every[:, 0],
        constants=3.0 * constants,
        constants_sigma=0.01 * np.abs(constants) + 1e-3,
    )
    shapes = shapes_of(pose(case_of(test, BEAM))[0])
    assert np.abs(shapes.measured) == pytest.approx(np.abs(shape), rel=1e-2, abs=1e-2 * np.abs(shape).max())


def test_expansions_keep_what_was_measured_and_add_what_the_model_knows() -> None:
    problem = soft(2, 0.02)
    shapes = shapes_of(problem)
    for whole in (serep(shapes), dynamic(shapes)):
        at = shapes.rows @ whole
        assert at == pytest.approx(shapes.measured, abs=0.03 * np.abs(shapes.measured).max())


def test_frequencies_alone_leave_nothing_to_the_shape_methods() -> None:
    test = soft(3, 0.4).measured
    alone = replace(
        test, seen=np.zeros(0, int), hit=np.zeros(0, int), constants=np.zeros((0, 5)), constants_sigma=np.zeros((0, 5))
    )  # fmt: skip
    problem = pose(case_of(alone, BEAM))[0]
    for method in (ForceResidual(), ConstitutiveError(), Comac()):
        assert "needs mode shapes" in (method.obstacle(problem) or "")
    scores = RegionEvidence().scores(problem)
    assert scores.sum() <= 1.0 + 1e-9  # rounding of exponentials over hundreds of samples
    assert scores[3] / scores.sum() > 1 / 10


@pytest.mark.long
def test_a_model_without_damping_is_not_suspected_of_it() -> None:
    from updating import Damping

    problem = pose(case_of(soft(3, 0.4).measured, replace(BEAM, damping=Damping())))[0]
    assert "needs damping" in (RegionEvidence().obstacle(problem, kind="damping") or "")
    assert compare_regions(problem).kinds == ("stiffness", "mass")


@pytest.mark.long
def test_without_a_gap_evidence_is_the_prior_by_area() -> None:
    rng = np.random.default_rng(8)
    found = compare_regions(pose(case_of(struck(specimen(rng), rng), BEAM))[0])
    assert found.log_evidence.max() < 3.0
    assert found.regions.max() < 0.6


@pytest.mark.long
def test_a_soft_spot_astride_two_regions_is_put_into_one_of_them() -> None:
    rng = np.random.default_rng(11)
    spot = (0.14, 0.16, 0.6)
    found = compare_regions(pose(case_of(struck(specimen(rng, soft=spot), rng), BEAM))[0])
    assert found.regions[3] + found.regions[4] > 0.9
    assert found.by_kind["stiffness"] > 0.9


@pytest.mark.long
def test_regions_of_imported_matrices_are_weighed_too() -> None:
    beam = imported_beam(20, parts=(5, 10, 15))
    points = np.zeros((5, 3))
    points[:, 0] = LENGTH * np.linspace(0.2, 1.0, 5)
    directions = np.tile([0.0, 0.0, 1.0], (5, 1))
    spec = spec_of(beam)
    seen = seen_from(points, directions, np.linspace(10.0, 300.0, 4))
    found = Predictor(spec, seen).predict(State(regional={(2, "E"): 0.7}), count=4)
    noise = np.random.default_rng(1).standard_normal((2, 5, 4))
    test = replace(
        seen,
        frequency=found.frequency * (1 + 5e-4 * noise[0, 0]),
        frequency_sigma=5e-4 * found.frequency,
        constants=found.constants * (1 + 0.01 * noise[1]),
        constants_sigma=0.01 * np.abs(found.constants) + 1e-4,
    )
    problem = pose(case_of(test, spec))[0]
    assert areas(problem).shape == (4,)
    assert np.argmax(compare_regions(problem).regions) == 2
    assert compare_regions(problem).kinds[0] == "stiffness"


def test_areas_and_places_of_a_plate() -> None:
    measured = replace(blank(np.array([[0.376, 0.2]])), constants=np.ones((1, 2)))
    problem = SpecimenProblem(
        predictor=Predictor(PLATE, measured),
        measured=measured,
        tolerances=case_of(measured).tolerances,
        order=np.arange(2),
    )
    assert areas(problem) == pytest.approx(np.full(15, 1 / 15))
    assert boxes(PLATE)[0, :2] == pytest.approx(np.array([[0, 0.0752], [0, 0.2 / 3]]))
    shares = regions_at(PLATE, np.array([[0.01, 0.01, 0.0], [0.376, 0.1, 0.0], [0.0752, 0.01, 0.0]]))
    assert np.argmax(shares[0]) == 0
    assert np.argmax(shares[1]) == 13
    assert shares[2].max() == pytest.approx(0.5)


@pytest.mark.long
def test_the_order_of_the_points_does_not_matter() -> None:
    problem = soft(5, 0.3)
    test = problem.measured
    turn = np.array([3, 1, 4, 0, 2])
    other: Measured = replace(
        test,
        points=test.points[turn],
        nodes=tuple(test.nodes[i] for i in turn),
        seen=np.full(5, int(np.argmax(turn == 4))),
        constants=test.constants[turn],
        constants_sigma=test.constants_sigma[turn],
    )
    turned = pose(case_of(other, BEAM))[0]
    for method in METHODS.values():
        assert method.scores(turned) == pytest.approx(method.scores(problem), rel=1e-3, abs=1e-6)


def test_a_region_without_an_area_has_no_probability():
    evidence = np.array([[3.0, 1.0]])
    posterior = RegionPosterior(("stiffness",), evidence, np.array([0.0, 1.0]), np.zeros((1, 2)))
    assert posterior.probability.tolist() == [[0.0, 1.0]]
