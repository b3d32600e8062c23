"""Shapes that err by more than was stated of them, or by nobody knows how much, beside a bridge of known parameters."""

from __future__ import annotations

import itertools
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg

from updating import Case, Measured, Tolerances
from updating.update import Update, update

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "models"))
from imported_cases import LENGTH, STIFF, Sparse, beam_matrices, clamp, imported_beam, spec_of

ELEMENTS, MODES, POINTS, TOLERANCE, SCATTER = 40, 7, 20, 0.1, 5e-4
EDGES = tuple(range(0, ELEMENTS + 1, 10))
NAMES = [f"part{i + 1}.E" for i in range(len(EDGES) - 1)]
NODES = np.linspace(3, ELEMENTS, POINTS).astype(int)


def truth(logs: np.ndarray, spring: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and shapes at the points by dense algebra, on a spring to the ground that no part is."""
    both = zip(itertools.pairwise(EDGES), logs, strict=True)
    stiffness = sum(np.exp(log) * beam_matrices(ELEMENTS, a, b)[0] for (a, b), log in both)
    k, m = (clamp(Sparse(matrix)).toarray() for matrix in (stiffness, beam_matrices(ELEMENTS)[1]))
    at = 2 * (2 * ELEMENTS // 3) - 2
    k[at, at] += spring * STIFF / LENGTH**3
    values, vectors = linalg.eigh(k, m)
    return np.sqrt(values[:MODES]) / (2 * np.pi), vectors[2 * NODES - 2, :MODES]


def measured(
    frequency: np.ndarray,
    shapes: np.ndarray,
    error: np.ndarray,
    *,
    stated: float | None,
    rng: np.random.Generator,
) -> Case:
    """Return the case of shapes with random errors (n_modes,) over their r.m.s., of which ``stated`` is stated."""
    size = np.sqrt(np.mean(shapes**2, axis=0))
    shapes = shapes + error * size * rng.standard_normal(shapes.shape)
    points = np.zeros((POINTS, 3))
    points[:, 0] = LENGTH * NODES / ELEMENTS
    nothing = np.full(MODES, np.nan)
    test = Measured(
        frequency=frequency * (1 + SCATTER * rng.standard_normal(MODES)), frequency_sigma=np.zeros(MODES),
        damping=nothing, damping_sigma=nothing, points=points, nodes=tuple(range(1, POINTS + 1)),
        seen=np.arange(POINTS), hit=np.full(POINTS, -1), constants=shapes,
        constants_sigma=(stated or 0.02) * size * np.ones_like(shapes), absolute=False, repeated=False,
        repeatability=SCATTER, position_sigma=0.0, directions=np.tile([0.0, 0.0, 1.0], (POINTS, 1)),
        guessed=stated is None,
    )  # fmt: skip
    spec = spec_of(imported_beam(ELEMENTS, parts=EDGES[1:-1]))
    return Case("bridge", spec, test, baseline=None, tolerances=Tolerances({"E": TOLERANCE}))


def both(case: Case) -> Update:
    return update(case, parameters=NAMES, data=("frequencies", "shapes"))


def drawn(seed: int) -> tuple[np.random.Generator, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng, TOLERANCE * rng.standard_normal(len(NAMES))


def off(result: Update) -> float:
    """Return the r.m.s. error of the frequencies, in their sigmas."""
    return result.rms_percent() / 100 / SCATTER


def pulls(result: Update, logs: np.ndarray) -> np.ndarray:
    found = np.array([np.log(p.factor or np.nan) for p in result.parameters])
    return (found - logs) / np.array([p.sigma / p.value for p in result.parameters])


@pytest.mark.parametrize("error", [0.005, 0.05, 0.3])
@pytest.mark.parametrize("stated", [None, 0.02])
def test_the_error_of_shapes_is_found(error: float, stated: float | None) -> None:
    rng, logs = drawn(1)
    result = both(measured(*truth(logs), np.full(MODES, error), stated=stated, rng=rng))
    found = result.pairs["shape_sigma"].to_numpy()
    expected = error if stated is None else max(error, stated)
    assert np.median(found) == pytest.approx(expected, rel=0.25)
    assert off(result) < 2
    assert np.abs(pulls(result, logs)).max() < 3.5


def test_one_bad_shape_does_not_spoil_the_others() -> None:
    rng, logs = drawn(2)
    error = np.full(MODES, 0.01)
    error[3] = 0.5
    result = both(measured(*truth(logs), error, stated=None, rng=rng))
    found = result.pairs["shape_sigma"].to_numpy()
    assert found[3] > 0.3
    assert np.delete(found, 3).max() < 0.025
    assert [p.factor for p in result.parameters] == pytest.approx(np.exp(logs), rel=0.02)
    assert any("that of test mode 4 as" in warning for warning in result.warnings)


def test_good_shapes_stated_as_they_are_stay_as_they_are() -> None:
    rng, logs = drawn(3)
    result = both(measured(*truth(logs), np.full(MODES, 0.02), stated=0.02, rng=rng))
    assert result.pairs["shape_sigma"].to_numpy() == pytest.approx(np.full(MODES, 0.02), rel=0.02)
    assert not any("error is taken as" in warning for warning in result.warnings)


@pytest.mark.long
@pytest.mark.parametrize("stated", [None, 0.02, 0.001])
def test_a_spring_that_the_model_lacks_makes_the_shapes_worse_and_not_the_frequencies(
    stated: float | None,
) -> None:
    rng, logs = drawn(4)
    case = measured(*truth(logs, spring=2.0), np.full(MODES, 0.02), stated=stated, rng=rng)
    without = update(case, parameters=NAMES, data=("frequencies",))
    result = both(case)
    # a misfit of 24.3 is exceeded by chance once in a thousand tests of seven frequencies
    assert MODES * off(result) ** 2 <= MODES * off(without) ** 2 + 24.4
    assert np.median(result.pairs["shape_sigma"]) > 0.03


@pytest.mark.long
def test_shapes_that_the_model_can_follow_only_against_the_frequencies_count_for_less() -> None:
    rng, logs = drawn(4)
    frequency, _ = truth(logs)
    _, shapes = truth(-logs)
    case = measured(frequency, shapes, np.full(MODES, 1e-4), stated=1e-4, rng=rng)
    result = both(case)
    assert MODES * off(result) ** 2 < 24.4 + 3
    assert any("do not contradict the frequencies" in warning for warning in result.warnings)


@pytest.mark.long
def test_errors_in_common_at_a_sensor_for_all_modes_leave_the_frequencies_alone() -> None:
    rng, logs = drawn(5)
    frequency, shapes = truth(logs)
    gains = np.exp(0.2 * rng.standard_normal((POINTS, 1)))
    result = both(measured(frequency, gains * shapes, np.full(MODES, 0.01), stated=0.01, rng=rng))
    assert off(result) < 2
    assert np.abs(pulls(result, logs)).max() < 3.5
