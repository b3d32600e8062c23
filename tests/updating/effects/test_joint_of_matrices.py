"""A joint of imported matrices that slips or closes the harder it is hit, beside the same frame built by hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from imported_cases import bolted_frame, frame_matrices, seen_from, spec_of
from scipy.linalg import eigh
from updating_cases import observed

from updating import LIBRARY, Case, Predictor, Tolerances, diagnose
from updating.models.state import State

EFFECT = LIBRARY["joint_nonlinearity"]
LEVEL, COUNT = 50.0, 8


@pytest.fixture(scope="module")
def frame() -> Iterator[ModuleType]:
    with bolted_frame() as module:
        yield module


@pytest.fixture(scope="module")
def predictor(frame: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Predictor:
    """The frame with the names of its joints' sides, hit at its points with hits of different levels."""
    spec = spec_of(frame_matrices(frame, tmp_path_factory.mktemp("frame")))
    points = np.array([place for place, _ in frame.POINTS.values()])
    directions = np.eye(3)[[axis - 1 for _, axis in frame.POINTS.values()]]
    test = seen_from(points, directions, hertz(frame, {}))
    slopes = {"slope": np.zeros(COUNT), "slope_sigma": np.full(COUNT, 1e-6), "level": LEVEL}
    bare = Predictor(spec, replace(test, **slopes))
    constants = bare.predict(count=COUNT).constants  # by which the measured modes are known
    return bare.for_test(
        replace(bare.measured, constants=constants, constants_sigma=0.01 * np.abs(constants))
    )


def hertz(frame: ModuleType, turning: dict[str, float]) -> np.ndarray:
    """Solve the frame, some of whose joints turn with so many times their stiffness [Hz]."""
    built = frame.frame(turning)[0]
    pair = (built.matrix(kind).toarray() for kind in ("stiffness", "mass"))
    return np.sqrt(eigh(*pair, eigvals_only=True, subset_by_index=(0, COUNT - 1))) / (2 * np.pi)


def _highest(frame: ModuleType) -> float:
    """Return the square of the highest frequency of the frame, to which all others are rounded [Hz^2]."""
    built = frame.frame({})[0]
    pair = (built.matrix(kind).toarray() for kind in ("stiffness", "mass"))
    return float(eigh(*pair, eigvals_only=True)[-1]) / (2 * np.pi) ** 2


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_joint_that_turns_is_the_frame_built_at_each_level(
    frame: ModuleType, predictor: Predictor, sign: int
) -> None:
    """Its compliance, of the modelled one, is 1 + x, x in proportion to the force, or to its inverse."""
    slope = sign * 2e-5
    state = EFFECT.state(predictor, {"slope": slope, "joint": 1.0, "at": "joint_2"})
    change = state.stiffness[0]
    unit = predictor.reduced.project(
        next(j for j in predictor.spec.imported.joints if j.name == "joint_2").springs[1]
    )  # type: ignore[union-attr]
    more = 1 / (1 + np.sum(change * unit) / np.sum(unit * unit)) - 1
    found = predictor.predict(state, count=COUNT)
    assert found.frequency == pytest.approx(hertz(frame, {"joint_2": 1 / (1 + more)}), rel=1e-6)
    step = 0.01
    around = [hertz(frame, {"joint_2": 1 / (1 + more * (1 + s * step) ** -sign)}) for s in (-1, 1)]
    expected = np.log(around[1] / around[0]) / (2 * step * LEVEL)
    rounding = np.finfo(float).eps * _highest(frame) / around[0][0] ** 2 / (2 * step * LEVEL)
    assert rounding < 1e-2 * abs(slope)
    assert found.slope == pytest.approx(expected, rel=1e-3, abs=rounding)
    assert np.mean(found.slope) == pytest.approx(
        slope, rel=0.2
    )  # of a joint as modelled: it is softer at the level


def test_what_else_follows_the_force_is_no_strain_energy_of_the_joint(predictor: Predictor) -> None:
    values = {"slope": -2e-5, "joint": 1.0, "at": "joint_2"}
    alone = EFFECT.state(predictor, values)
    beside = EFFECT.state(predictor.for_test(predictor.measured, (lambda _: State(slope=-1e-4),)), values)
    assert beside.stiffness[0] == pytest.approx(alone.stiffness[0], rel=1e-9)


def test_forms_name_every_joint_in_turning_and_shifting(predictor: Predictor) -> None:
    forms = EFFECT.variants(predictor)
    named = {(form.values["at"], form.values["joint"]) for form in forms if "at" in form.values}
    assert named == {(f"joint_{i}", kind) for i in range(1, 5) for kind in (1.0, 2.0)}
    assert sum(form.weight for form in forms) == pytest.approx(1.0)


@pytest.mark.long
def test_a_diagnosis_names_the_joint_that_slips(predictor: Predictor) -> None:
    rng = np.random.default_rng(3)
    state = EFFECT.state(predictor, {"slope": -1e-4, "joint": 1.0, "at": "joint_3"})
    truth = predictor.predict(state, count=COUNT)
    points = predictor.measured.points
    floor = 0.01 * np.sqrt(np.mean(truth.constants**2))  # half of the modes move across the plane of the hits
    seen = observed(truth.frequency, np.full(COUNT, 0.004), truth.constants, points, rng)
    test = replace(
        seen,
        constants=seen.constants + floor * rng.standard_normal(seen.constants.shape),
        constants_sigma=np.hypot(seen.constants_sigma, floor),
        directions=predictor.measured.directions,
        slope=truth.slope + 2e-6 * rng.standard_normal(COUNT),
        slope_sigma=np.full(COUNT, 2e-6),
        level=LEVEL,
    )
    library = [EFFECT, LIBRARY["joint"], LIBRARY["E"]]
    found = diagnose(
        Case("frame", predictor.spec, test, tolerances=Tolerances({"E": 0.01, "density": 0.003})),
        library=library,
    )
    assert found.sets == (("joint_nonlinearity",),)
    (row, *_) = found.ranking
    assert row.forms[0]["at"] == "joint_3"
    slope = row.parameters["joint_nonlinearity.slope"]
    assert slope.low95 is not None
    assert slope.high95 is not None
    assert slope.low95 < -1e-4 < slope.high95
    assert "joint_3, in turning" in EFFECT.sentence({**row.forms[0], "slope": -1e-4})
