"""The slope of each mode of a clamp that gives way with the force, beside the rig's own body at two levels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import LOOK
from updating_cases import BEAM, POINTS, blank

from modalkit.simulator.bodies.beam.beam import Beam
from updating import LIBRARY, Predictor

EFFECT = LIBRARY["joint_nonlinearity"]
EI = 210e9 * BEAM.width * BEAM.thickness**3 / 12
LEVEL = 80.0
MODES = 5


def predictor_of_beam(clamped: tuple[str, ...]) -> Predictor:
    """The beam struck at a level, as many modes measured as are compared."""
    test = blank(POINTS)
    ones = np.ones(MODES)
    shapes = np.ones((len(test.seen), MODES))
    test = replace(
        test, frequency=np.geomspace(20, 1500, MODES), frequency_sigma=ones, damping=0.01 * ones,
        damping_sigma=0.001 * ones, constants=shapes, constants_sigma=shapes,
        slope=0 * ones, slope_sigma=1e-6 * ones, level=LEVEL,
    )  # fmt: skip
    return Predictor(replace(BEAM, clamped=clamped), test)


def body(clamped: tuple[str, ...]) -> Beam:
    """The rig's beam, of cubic Timoshenko elements."""
    return Beam(
        0.0, BEAM.length, BEAM.width, BEAM.thickness, 210e9, 7850.0, clamped=clamped, alpha=2.0, beta=1e-6
    )


def hertz(beam: Beam) -> np.ndarray:
    return np.asarray(beam.real_modes(MODES)[0][:MODES]) / (2 * np.pi)


@pytest.mark.parametrize("clamped", [("x0",), ("x0", "x1")])
@pytest.mark.parametrize("slope", [-3e-4, -1e-4, 1e-4])
@pytest.mark.parametrize(
    ("joint", "name", "power"), [(1.0, "clamp_rotation", 1), (2.0, "clamp_translation", 3)]
)
def test_a_clamp_that_gives_way_or_closes(
    clamped: tuple[str, ...], slope: float, joint: float, name: str, power: int
) -> None:
    """The rig's clamp at the level of the test and beside it: frequencies, and each mode's slope by differences."""
    predictor, bench = predictor_of_beam(clamped), body(clamped)
    probe = {1: 300, 3: 2e4}[power] * EI / BEAM.length**power
    rest = hertz(bench)
    share = float(np.mean(1 - hertz(replace(bench, **{name: probe})) / rest))

    def at(level: float) -> np.ndarray:
        growth = (level / LEVEL) ** np.sign(slope)
        return hertz(replace(bench, **{name: probe * share / (abs(slope) * LEVEL) * growth}))

    found = predictor.predict(EFFECT.state(predictor, {"slope": slope, "joint": joint}), count=MODES)
    assert found.frequency == pytest.approx(at(LEVEL), rel=6e-4)
    by_levels = np.log(at(1.001 * LEVEL) / at(0.999 * LEVEL)) / (0.002 * LEVEL)
    assert found.slope == pytest.approx(by_levels, rel=0.02)
    assert np.mean(found.slope) == pytest.approx(slope, rel=0.3)


def test_between_two_clamps_a_tension_grows_with_the_force() -> None:
    """The rig's tension in proportion to the force, the slope again the mean over the modes."""
    predictor, bench, slope = predictor_of_beam(("x0", "x1")), body(("x0", "x1")), 2e-4
    rest, probe = hertz(bench), 20.0
    share = float(np.mean(hertz(replace(bench, axial=probe)) / rest - 1))

    def at(level: float) -> np.ndarray:
        return hertz(replace(bench, axial=probe * slope * level / share))

    found = predictor.predict(EFFECT.state(predictor, {"slope": slope, "joint": 3.0}), count=MODES)
    assert found.frequency == pytest.approx(at(LEVEL), rel=6e-4)
    by_levels = np.log(at(1.001 * LEVEL) / at(0.999 * LEVEL)) / (0.002 * LEVEL)
    assert found.slope == pytest.approx(by_levels, rel=0.02)


def test_a_joint_that_nobody_knows_changes_all_modes_alike() -> None:
    for predictor in (predictor_of_beam(("x0",)), LOOK["matrices"]):
        found = predictor.predict(EFFECT.state(predictor, {"slope": 1e-4}), count=4)
        assert found.slope == pytest.approx(np.full(4, 1e-4))


def test_it_says_which_joint() -> None:
    assert "turns" in EFFECT.sentence({"slope": 1e-4, "joint": 1.0})
    assert EFFECT.sentence({"slope": 1e-4}) == EFFECT.summary
    assert EFFECT.derived(predictor_of_beam(("x0",)), {"slope": 1e-4, "joint": 2.0}) == {"joint": (2.0, "-")}


def test_only_joints_that_are_there_are_tried() -> None:
    joints = [
        {form.values["joint"] for form in EFFECT.variants(predictor_of_beam(c))}
        for c in ((), ("x0",), ("x0", "x1"))
    ]
    assert joints == [{0.0}, {0.0, 1.0, 2.0}, {0.0, 1.0, 2.0, 3.0}]
