"""Evidence against integration by brute force, marginals against the full covariance, honest p-values."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import logsumexp
from scipy.stats import multivariate_normal
from updating_cases import BEAM, DOUBTS, ExactBeam, blank, case_of, observed

from updating import LIBRARY, Case, Measured, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.notes import _on_samples
from updating.diagnosis.search.compared import Compared, Search
from updating.diagnosis.search.evidence import attempts, explain, finish
from updating.diagnosis.search.fit import maximise
from updating.diagnosis.search.goodness import p_value
from updating.diagnosis.search.points import Point, evaluate
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import gaussian, marginal, normal_equations
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import REPEATED_SCATTER_PRIOR, SHAPE_NOISE_SCALES

pytestmark = pytest.mark.long

COARSE = replace(BEAM, elements=(8,), theory="euler-bernoulli")
HIT = np.array([0.1, 0.25, 0.376])
MODULUS, GAIN = (
    LIBRARY[name].parameters(Predictor(COARSE, blank(HIT)))[0] for name in ("E", "calibration_gain")
)


def trial(*, E: float = 1.0, gain: float = 1.0, noise: float = 1.0, **changes: object) -> Measured:
    """Three modes of an exact beam at three points; noise widens every sigma."""
    rng = np.random.default_rng(8)
    beam = ExactBeam(0.376, 0.0305, 0.0047625, 210e9 * E, shear=False, rotary=False)
    frequency = beam.frequencies(3)
    shape = beam.shapes(frequency, HIT)
    omega = 2 * np.pi * frequency
    test = observed(frequency, 1 / omega + 5e-7 * omega, gain * shape * shape[-1], HIT, rng)
    wider = {n: noise * getattr(test, n) for n in ("frequency_sigma", "constants_sigma", "calibration")}
    return replace(test, **wider, repeatability=noise * test.repeatability, **changes)  # type: ignore[arg-type]


def diagnosis_problem(measured: Measured, doubts: dict[str, float] | None = None) -> SpecimenProblem:
    case = case_of(measured, COARSE)
    return pose(replace(case, tolerances=Tolerances(DOUBTS if doubts is None else doubts)))[0]


def brute(problem: SpecimenProblem, candidate: Candidate, count: int) -> float:
    """Integrate the likelihood over the unit cube of prior quantiles, by the midpoint rule."""
    k = len(candidate.starts(problem.predictor)[0])
    axes = np.meshgrid(*[(np.arange(count) + 0.5) / count] * k, indexing="ij")
    grid = np.stack([a.ravel() for a in axes], axis=1)
    values = [evaluate(problem, candidate, u).marginal.log_likelihood for u in grid]
    return float(logsumexp(values) - np.log(len(values)))


def candidate(*names: str) -> Candidate:
    return Candidate(tuple(LIBRARY[n] for n in names))


FINE = 500
"""Points along one parameter: against twice as many the sharpest peak's integral changes by 0.02."""


@pytest.mark.parametrize(
    ("names", "truth"),
    [
        ("E", {"E": 0.9}),
        ("thickness", {"E": 1.0}),
        ("clamp_rotation", {"E": 1.0}),  # a peak at the edge: the stiffest clamp fits best
        ("E", {"E": 0.95 * MODULUS.low}),  # beyond the edge
        ("E", {"E": 1.05 * MODULUS.high}),
        ("exponential_window", {"E": 1.0}),  # nearly invisible
        ("length", {"E": 0.97}),
        ("calibration_gain", {"gain": 1.6}),
    ],
)
def test_evidence_of_one_parameter(names: str, truth: dict[str, float]) -> None:
    problem = diagnosis_problem(trial(**truth))
    found = explain(problem, candidate(names))
    assert found.log_evidence == pytest.approx(brute(problem, candidate(names), FINE), abs=0.2)
    assert found.weights.sum() == pytest.approx(1.0)
    assert ((found.samples >= 0) & (found.samples <= 1)).all()


@pytest.mark.parametrize(
    ("names", "truth"),
    [
        (("E", "calibration_gain"), {"E": 0.8, "gain": 1.3}),
        (("sensor_mass",), {"E": 0.97}),
        (("E", "clamp_rotation"), {"E": 0.75}),
        (("E", "density"), {"E": 0.9}),  # a ridge: only the level tells them apart
        (("clamp_rotation", "calibration_gain"), {"gain": 1.04 * GAIN.high}),  # both at an edge
    ],
)
def test_evidence_of_two_parameters(names: tuple[str, ...], truth: dict[str, float]) -> None:
    problem = diagnosis_problem(trial(**truth, noise=12.0), {"E": 0.03})
    found = explain(problem, candidate(*names))
    assert found.log_evidence == pytest.approx(brute(problem, candidate(*names), 40), abs=0.2)


def test_a_parameter_that_nothing_sees_costs_nothing() -> None:
    """Frequencies alone do not see a common factor on stiffness and mass, nor the gain."""
    test = trial()
    blind = replace(test, seen=test.seen[:0], hit=test.hit[:0], constants=test.constants[:0])
    problem = diagnosis_problem(replace(blind, constants_sigma=blind.constants, absolute=False))
    plain = explain(problem, Candidate()).log_evidence
    found = explain(problem, candidate("section_scale"))
    assert found.log_evidence == pytest.approx(plain, abs=0.2)  # the error of some twenty samples
    mean = float(found.weights @ found.samples[:, 0])
    assert mean == pytest.approx(0.5, abs=0.05)
    assert np.sqrt(found.weights @ (found.samples[:, 0] - mean) ** 2) == pytest.approx(
        1 / np.sqrt(12), rel=0.1
    )


def test_the_posterior_is_where_the_truth_is_and_as_wide_as_the_likelihood() -> None:
    problem = diagnosis_problem(trial(E=0.9))
    found = explain(problem, candidate("E"))
    grid = (np.arange(FINE) + 0.5) / FINE
    score = np.array([evaluate(problem, candidate("E"), np.array([u])).marginal.log_likelihood for u in grid])
    weight = np.exp(score - logsumexp(score))
    mean = float(weight @ grid)
    assert found.weights @ found.samples[:, 0] == pytest.approx(mean, abs=2e-3)
    width = np.sqrt(weight @ (grid - mean) ** 2)
    assert np.sqrt(found.weights @ (found.samples[:, 0] - mean) ** 2) == pytest.approx(width, rel=0.15)
    peak = maximise(problem, candidate("E"), np.array([0.2]))
    assert peak.point.coordinates[0] == pytest.approx(grid[np.argmax(score)], abs=1e-3)
    assert peak.normal[0, 0] == pytest.approx(1 / width**2, rel=0.15)


def comparison(seed: int, n: int = 24, p: int = 5, *, residual: bool = False) -> Comparison:
    rng = np.random.default_rng(seed)
    nuisance = 0.02 * rng.standard_normal((n, p))
    variance = rng.uniform(0.3, 2.0, n) * 1e-4
    channel = np.repeat([0, 1, 2], n // 3)
    size = 0.03 * rng.standard_normal(n)
    if residual:
        scale = rng.choice(SHAPE_NOISE_SCALES, p=REPEATED_SCATTER_PRIOR)
        noise = np.sqrt(variance) * np.where(channel == 2, scale, 1.0) * rng.standard_normal(n)
        size = nuisance @ rng.standard_normal(p) + noise
    mode = np.tile(np.arange(n // 3), 3)
    prior, none = REPEATED_SCATTER_PRIOR, np.full(n, -1)
    return Comparison(
        residual=size,
        nuisance=nuisance,
        variance=variance,
        channel=channel,
        mode=mode,
        source=none,
        predictions=(),
        scale_prior=prior,
        doubts=np.arange(2),
        tolerances=np.arange(0),
    )


def full(data: Comparison, scale: float, keep: np.ndarray) -> np.ndarray:
    noise = np.where(data.channel == 2, scale**2, 1.0) * data.variance
    return np.asarray((np.diag(noise) + data.nuisance @ data.nuisance.T)[np.ix_(keep, keep)])


@settings(max_examples=25)
@given(seed=st.integers(0, 10**6), part=st.sampled_from(["all", "some", "no shapes"]))
def test_the_marginal_is_that_of_the_full_covariance(seed: int, part: str) -> None:
    data = comparison(seed)
    rng = np.random.default_rng(seed)
    keep = {
        "all": np.ones(24, bool),
        "some": rng.random(24) < 0.7,
        "no shapes": data.channel != 2,
    }[part]
    keep[0] = True
    scales, prior = (
        (SHAPE_NOISE_SCALES, REPEATED_SCATTER_PRIOR) if (data.channel[keep] == 2).any() else ((1.0,), (1.0,))
    )
    parts = [multivariate_normal.logpdf(data.residual[keep], cov=full(data, scale, keep)) for scale in scales]
    found = marginal(data, keep)
    assert found.log_likelihood == pytest.approx(logsumexp(parts, b=prior), rel=1e-9)
    top = scales[int(np.argmax(np.array(parts) + np.log(prior)))]
    inverse = np.linalg.inv(full(data, top, keep))
    assert found.scale == top
    assert found.chi2 == pytest.approx(data.residual[keep] @ inverse @ data.residual[keep], rel=1e-7)
    assert found.shift == pytest.approx(data.nuisance[keep].T @ inverse @ data.residual[keep], abs=1e-7)


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), scale=st.sampled_from(SHAPE_NOISE_SCALES))
def test_whitened_least_squares_is_that_of_the_full_covariance(seed: int, scale: float) -> None:
    data = comparison(seed)
    columns = np.random.default_rng(seed + 1).standard_normal((24, 3))
    inverse = np.linalg.inv(full(data, scale, np.ones(24, bool)))
    normal, load = normal_equations(data, columns, scale)
    np.testing.assert_allclose(normal, columns.T @ inverse @ columns, rtol=1e-7)
    np.testing.assert_allclose(load, columns.T @ inverse @ data.residual, rtol=1e-6, atol=1e-6)


def test_a_prediction_that_is_no_number_is_impossible() -> None:
    data = replace(comparison(1), residual=np.full(24, np.nan))
    assert marginal(data).log_likelihood == -np.inf
    assert p_value(Point(np.zeros(0), data, marginal(data))) == 0.0


def test_p_values_of_what_the_model_allows_are_not_too_small() -> None:
    found = []
    for seed in range(300):
        data = comparison(seed, residual=True)
        found.append(p_value(Point(np.zeros(0), data, marginal(data))))
    values = np.array(found)
    for level in (0.05, 0.01):
        allowed = level * 300 + 3 * np.sqrt(level * 300)
        assert (values < level).sum() <= allowed
    assert np.median(values) > 0.3


@pytest.mark.parametrize("channel", [0, 1])
def test_p_values_of_what_it_does_not_allow_are_small(channel: int) -> None:
    data = comparison(5, residual=True)
    wrong = data.residual + np.where((data.channel == channel) & (data.mode == 3), 0.5, 0.0)
    data = replace(data, residual=wrong)
    assert p_value(Point(np.zeros(0), data, marginal(data))) < 1e-6


def test_one_scale_is_one_gaussian() -> None:
    data = comparison(9)
    logpdf = multivariate_normal.logpdf(data.residual, cov=full(data, 4.0, np.ones(24, bool)))
    assert gaussian(data, [4.0]).log_likelihood[0, 0, 0] == pytest.approx(logpdf, rel=1e-9)


def test_a_pair_has_the_parameters_of_both() -> None:
    problem = diagnosis_problem(trial())
    both = candidate("E", "sensor_mass")
    prior = LIBRARY["E"].parameters(problem.predictor)[0]
    values = both.values(problem.predictor, [0.25, 0.75, 0.2, 0.5])
    assert list(values) == ["E.factor", "sensor_mass.mass", "sensor_mass.bulk", "sensor_mass.dx"]
    assert values["E.factor"] == pytest.approx(prior.low * (prior.high / prior.low) ** 0.25)
    state = both.state(problem.predictor, [0.25, 0.75, 0.2, 0.5])
    assert dict(state.factors) == {"E": values["E.factor"]}
    assert len(state.mass) == 1
    assert both.locations(problem.predictor, [0.25, 0.75, 0.2, 0.5]) == ((0.376, 0.0, 0.0),)
    assert Case("x", COARSE, trial()).accepted == ()


def test_what_is_improbable_has_fewer_samples_and_the_same_evidence() -> None:
    problem = diagnosis_problem(trial(E=0.8, gain=1.3, noise=12.0), {"E": 0.03})
    both = candidate("E", "calibration_gain")
    draft = explain(problem, both, laplace_only=True)
    whole, rough = finish(problem, draft), finish(problem, draft, share=1e-3)
    assert len(rough.samples) < 0.5 * len(whole.samples)
    assert rough.settled and whole.settled
    assert draft.lacks_samples(1e-3) and rough.lacks_samples(1.0)
    assert not rough.lacks_samples(1e-3) and not whole.lacks_samples(1.0)
    assert rough.log_evidence == pytest.approx(whole.log_evidence, abs=0.5)
    assert rough.log_evidence == pytest.approx(brute(problem, both, 40), abs=0.5)


def test_a_search_from_attempts_ends_where_one_from_the_starts_does() -> None:
    problem = diagnosis_problem(trial(E=0.9))
    for name in ("E", "clamp_rotation", "local_stiffness"):
        begun = attempts(problem, candidate(name))
        heights = [point.marginal.log_likelihood for point in begun]
        assert heights == sorted(heights, reverse=True)
        found = explain(problem, candidate(name), begun=begun, laplace_only=True)
        direct = explain(problem, candidate(name), laplace_only=True)
        assert found.best.marginal.log_likelihood == pytest.approx(
            direct.best.marginal.log_likelihood, abs=0.05
        )
        hopeless = explain(problem, candidate(name), begun=begun, laplace_only=True, bar=1e4)
        assert len(hopeless.peaks) == 1


def test_a_warning_states_that_samples_are_few_where_they_are_fewer_than_wanted() -> None:
    problem = diagnosis_problem(trial(E=0.9))
    nothing, found = explain(problem, Candidate()), explain(problem, candidate("E"))
    for effective, wanted, warned in ((30.0, 100.0, True), (30.0, 20.0, False), (0.0, 0.0, False)):
        one = replace(found, effective=effective, wanted=wanted)
        row = Compared(explanation=one, probability=0.02, p_value=1.0, as_stated=1.0)
        warnings = _on_samples(Search(nothing, (row,), {}))
        assert bool(warnings) == warned
        assert not warned or "30 effective samples; 100 are needed" in warnings[0]
