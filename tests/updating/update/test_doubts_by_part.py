"""Tolerances and bounds of single parameters, in an update and in a diagnosis; wide ones beside sharp frequencies."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg, optimize, sparse

from acquisition import StudyError
from updating import Case, Measured, Tolerances
from updating.diagnosis.diagnose import diagnose, pose
from updating.diagnosis.search.evidence import explain
from updating.models import Region
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.named_factors import departure
from updating.problem.candidate import Candidate
from updating.problem.stated_doubts import check_doubts
from updating.tolerances import FREE
from updating.update import Update, update

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "models"))
from imported_cases import spec_of

STIFFNESS, MASS = 3e7, 2e4


def chain(stiffness: np.ndarray) -> np.ndarray:
    """Return the stiffness matrix of storeys over one another [N/m]."""
    above = np.append(stiffness[1:], 0.0)
    return np.diag(stiffness + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)


def frequencies(logs: np.ndarray, modes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and shapes of storeys of so many times the stiffness."""
    n = len(logs)
    values, vectors = linalg.eigh(chain(STIFFNESS * np.exp(logs)), MASS * np.eye(n))
    return np.sqrt(values[:modes]) / (2 * np.pi), vectors[:, :modes]


def storeys(
    logs: np.ndarray,
    modes: int,
    tolerances: Tolerances,
    *,
    sigma: float = 1e-4,
    shapes: float = 0.0,
    of: int | None = None,
) -> Case:
    """Return storeys measured at all floors, or their frequencies alone, beside a model of equal ones.

    The upper ones are regions, ``of`` of them where it says how many; the rest is in no region.
    """
    n = len(logs)
    f, moved = frequencies(logs, modes)
    size = shapes * np.sqrt(np.mean(moved**2, axis=0)) * np.ones_like(moved)
    moved, size = (moved, size) if shapes else (moved[:0], size[:0])
    rows, nothing = len(moved), np.full(modes, np.nan)
    points = np.stack([np.zeros(n), np.zeros(n), 3.0 * (np.arange(n) + 1)], axis=1)
    unit = np.eye(n)
    own = range(n - (n if of is None else of), n)
    parts = tuple(Sparse(sparse.csr_array(chain(STIFFNESS * unit[i]))) for i in own)
    table = NodeTable(np.arange(n) + 1, points, np.ones(n, dtype=int), np.arange(n))
    whole = Sparse(sparse.csr_array(chain(STIFFNESS * np.ones(n))))
    imported = Imported(whole, Sparse(sparse.csr_array(MASS * np.eye(n))), table, parts, ())
    spec = spec_of(imported, regions=tuple(Region(f"storey_{i + 1}", (0, 1), (0, 1)) for i in own))
    test = Measured(
        frequency=f, frequency_sigma=np.zeros(modes), damping=nothing, damping_sigma=nothing,
        points=points[:rows], nodes=tuple(range(1, rows + 1)), seen=np.arange(rows), hit=np.full(rows, -1),
        constants=moved, constants_sigma=size, absolute=False, repeated=False, repeatability=sigma,
        position_sigma=0.0, directions=np.tile([1.0, 0.0, 0.0], (rows, 1)),
    )  # fmt: skip
    return Case("storeys", spec, test, baseline=None, tolerances=tolerances)


def turned(case: Case, **options: object) -> Update:
    names = [f"{region.name}.E" for region in case.spec.regions]
    return update(case, parameters=names, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("spread", [0.1, 0.3])
def test_wide_tolerances_and_sharp_frequencies_converge_to_the_nearest_structure(
    seed: int, spread: float
) -> None:
    """Eighteen storeys, eight frequencies: those met with the least departure, as another optimiser finds it."""
    logs = spread * np.random.default_rng(seed).standard_normal(18)
    case = storeys(logs, 8, Tolerances({"E": 10.0}))
    result = turned(case)
    assert result.converged
    found = np.log([p.factor or np.nan for p in result.parameters])
    wanted = case.measured.frequency
    assert frequencies(found, 8)[0] == pytest.approx(wanted, rel=1e-6)
    other = optimize.minimize(
        lambda x: x @ x,
        found + 0.01 * np.random.default_rng(9).standard_normal(18),
        jac=lambda x: 2 * x,
        constraints={"type": "eq", "fun": lambda x: np.log(frequencies(x, 8)[0] / wanted)},
        method="SLSQP",
        options={"maxiter": 300, "ftol": 1e-12},
    )
    assert other.success
    assert found @ found == pytest.approx(other.fun, rel=1e-4)


@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_free_ends_where_exact_data_are(seed: int) -> None:
    """Eighteen storeys off by up to 40 %, with shapes: a tolerance pulls, without one they are found."""
    logs = np.random.default_rng(seed).uniform(-0.35, 0.35, 18)
    off = {}
    for name, stated in {
        "free": Tolerances({"E": FREE}, free=frozenset({"E"})),
        "pulled": Tolerances({"E": 0.1}),
    }.items():
        case = storeys(logs, 12, stated, sigma=1e-3, shapes=0.01)
        result = turned(case, data=("frequencies", "shapes"))
        assert result.converged
        off[name] = np.abs(np.log([p.factor or np.nan for p in result.parameters]) - logs).max()
    assert off["free"] < 1e-6
    assert off["pulled"] > 100 * off["free"]


def test_a_modulus_that_is_free_is_no_cause() -> None:
    """All storeys 40 % softer: within a tolerance of 1 % a gap, of a modulus that is free none."""
    logs = np.full(6, np.log(0.6))
    near = storeys(logs, 4, Tolerances({"E": 0.01}), sigma=1e-3)
    free = replace(near, tolerances=Tolerances({"E": FREE}, free=frozenset({"E"})))
    assert diagnose(near).significant
    assert not diagnose(free).significant


def test_bounds_and_tolerances_of_one_storey_are_its_own() -> None:
    rng = np.random.default_rng(3)
    logs = np.array([0.0, 0.5, 0.0, -0.4, 0.0, 0.0])
    stated = Tolerances({"E": 0.01}, parts={"storey_2.E": 0.5}, bounds={"storey_4.E": (0.5, 1.1)})
    result = turned(storeys(logs + 1e-3 * rng.standard_normal(6), 6, stated))
    found = np.log([p.factor or np.nan for p in result.parameters])
    assert found == pytest.approx(logs, abs=0.03)
    assert (result.parameters[3].low, result.parameters[3].high) == pytest.approx((0.5 * 210e9, 1.1 * 210e9))
    tight = replace(stated, bounds={"storey_4.E": (0.9, 1.1)})
    stopped = turned(storeys(logs, 6, tight, sigma=5e-3))
    assert stopped.parameters[3].at_bound
    assert any("storey_4.E ended at a bound" in warning for warning in stopped.warnings)


def test_a_parameter_that_the_tolerances_of_others_let_the_data_find_is_determined() -> None:
    """Six storeys and three frequencies: what is doubted by 30 % is known to a part of that, the rest as before."""
    stated = Tolerances({"E": 0.002}, parts={"storey_2.E": 0.3})
    logs = np.array([0.0, 0.2, 0.0, 0.0, 0.0, 0.0])
    result = turned(storeys(logs, 3, stated))
    sigma = [p.sigma / p.value for p in result.parameters]
    assert "storey_2.E" not in result.undetermined
    assert sigma[1] < 0.06
    assert set(result.undetermined) == {f"storey_{i}.E" for i in (1, 3, 4, 5, 6)}


def test_as_many_parameters_as_frequencies_that_no_tolerance_holds_test_nothing() -> None:
    logs = 0.1 * np.random.default_rng(1).standard_normal(6)
    wide = turned(storeys(logs, 6, Tolerances({"E": 10.0})))
    assert any("the fit is not tested" in warning for warning in wide.warnings)
    held = turned(storeys(logs, 6, Tolerances({"E": 0.001}), sigma=0.01))
    assert not any("the fit is not tested" in warning for warning in held.warnings)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ((1.1, 1.5), r"do not include (the start value, )?1\b"),
        ((-0.5, 1.5), r"do not include (the start value, )?1\b"),
    ],
)
def test_bounds_that_cannot_be(bounds: tuple[float, float], message: str) -> None:
    case = storeys(np.zeros(3), 3, Tolerances({"E": 0.1}, bounds={"storey_1.E": bounds}))
    with pytest.raises(StudyError, match=message):
        turned(case)
    with pytest.raises(StudyError, match=message):  # as a nuisance of a diagnosis as well
        check_doubts(case.tolerances, case.spec)


def test_doubts_of_what_there_is_not_are_refused() -> None:
    case = storeys(np.zeros(3), 3, Tolerances(parts={"story_1.E": 0.1}))
    with pytest.raises(StudyError, match=r"story_1\.E: unknown name; give E, density"):
        check_doubts(case.tolerances, case.spec)
    check_doubts(Tolerances(bounds={"storey_1.E": (0.5, 2)}), case.spec)
    check_doubts(Tolerances(bounds={"lumped_mass.mass": (0, 2)}), case.spec, ["lumped_mass.mass"])


def test_what_is_in_no_region_need_not_follow_the_modulus_of_the_whole() -> None:
    """Five storeys of eight are 3 % stiffer than modelled; the lower three are not, and nobody listed them."""
    logs = np.where(np.arange(8) < 3, 0.0, 0.03)
    fits = {}
    for name, tolerances in {
        "as wide as E": Tolerances({"E": 0.02}),
        "stated": Tolerances({"E": 0.02}, parts={"unassigned.E": 0.04}),
        "denied": Tolerances({"E": 0.02}, parts={"unassigned.E": 0.0}),
    }.items():
        case = storeys(logs, 8, tolerances, sigma=3e-4, shapes=0.01, of=5)
        check_doubts(case.tolerances, case.spec)
        problem, warnings = pose(case)
        assert not any("for updates" in warning for warning in warnings)
        assert problem.names == (("E",) if name == "denied" else ("E", "unassigned.E"))
        fits[name] = explain(problem, Candidate()).p_value
    assert fits["as wide as E"] > 0.1
    assert fits["stated"] > 0.1
    assert fits["denied"] < 1e-6


def test_a_diagnosis_doubts_regions_by_their_own_tolerances_and_bounds() -> None:
    stated = Tolerances({"E": 0.02}, parts={"storey_2.E": 0.1}, bounds={"storey_5.E": (0.5, 1.5)})
    problem, _ = pose(storeys(np.zeros(6), 6, stated, shapes=0.01))
    assert problem.names == ("E", "storey_2.E", "storey_5.E")
    assert problem.sigmas == pytest.approx([0.02, 0.1, np.log(3) / np.sqrt(12)])
    here = problem.predictor.predict(factors=problem.names)
    for k, name in enumerate(problem.names):
        low, high = (
            problem.predictor.predict(departure(problem.predictor.spec, {name: float(np.exp(step))}))
            for step in (-1e-4, 1e-4)
        )
        slopes = np.log(high.frequency / low.frequency) / 2e-4
        assert here.log_frequency_by[:, k] == pytest.approx(slopes, abs=1e-7)
        signs = [np.sign(np.sum(p.constants * here.constants, axis=0)) for p in (low, high)]
        slopes = (high.constants * signs[1] - low.constants * signs[0]) / 2e-4
        assert here.constants_by[:, :, k] == pytest.approx(slopes, abs=1e-6 * np.abs(slopes).max() + 1e-12)


@pytest.mark.long
def test_a_change_within_the_doubt_of_its_region_is_no_gap() -> None:
    logs = np.array([0.0, 0.12, 0.0, 0.0, 0.0])
    sharp = diagnose(storeys(logs, 5, Tolerances({"E": 0.001}), shapes=0.01))
    doubted = diagnose(storeys(logs, 5, Tolerances({"E": 0.001}, parts={"storey_2.E": 0.1}), shapes=0.01))
    assert sharp.significant
    assert not doubted.significant


def test_a_region_of_matrices_has_no_thickness_to_doubt() -> None:
    case = storeys(np.zeros(3), 3, Tolerances(parts={"storey_1.thickness": 0.1}))
    with pytest.raises(
        StudyError, match=r"storey_1\.thickness: unknown name; give E, density of a region \(storey_1"
    ):
        check_doubts(case.tolerances, case.spec)
