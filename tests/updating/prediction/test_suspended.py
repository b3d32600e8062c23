"""Modes of a free structure on its cords are not modes that it lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, blank, case_of, exactly

from updating import LIBRARY, Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.effects.base import total_mass
from updating.prediction.suspended import _independent

FREE = replace(BEAM, clamped=())
ALONG = np.linspace(0, FREE.length, 9)
LOOK = Predictor(FREE, blank(ALONG))
HUNG = {"x": 0.25, "mass": 0.05 * total_mass(FREE), "frequency": 300.0, "damping": 0.02}


def with_bounce(test: Measured, points: int = len(ALONG), noise: float = 0.0) -> Measured:
    """The test with a bounce and a pitch on cords below its modes, seen at some of its points."""
    rng, sensor = np.random.default_rng(5), ALONG[-1]
    middle = FREE.length / 2
    bounce = np.ones(len(ALONG))
    pitch = (ALONG - middle) * (sensor - middle) * 12 / FREE.length**2
    low = np.stack([bounce, pitch], axis=1) / total_mass(FREE)
    low = low * (1 + noise * rng.standard_normal(low.shape))
    n = len(test.frequency)
    whole = replace(
        test,
        frequency=np.append([11.0, 17.0], test.frequency),
        frequency_sigma=np.append([0.01, 0.01], test.frequency_sigma),
        damping=np.append([0.05, 0.05], test.damping),
        damping_sigma=np.append([0.002, 0.002], test.damping_sigma),
        constants=np.hstack([low, test.constants]),
        constants_sigma=np.hstack([0.01 * np.abs(low).max() * np.ones_like(low), test.constants_sigma]),
    )
    few = np.arange(len(ALONG)) >= len(ALONG) - points
    assert len(whole.frequency) == n + 2
    return replace(
        whole,
        seen=whole.seen[few],
        hit=whole.hit[few],
        constants=whole.constants[few],
        constants_sigma=whole.constants_sigma[few],
    )


def taken_out(warnings: list[str]) -> int:
    return sum("on its suspension" in warning for warning in warnings)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_bounce_and_pitch_are_none_that_something_hangs_on(noise: float) -> None:
    problem, warnings = pose(case_of(with_bounce(exactly(LOOK, LOOK.predict(count=5)), noise=noise), FREE))
    assert problem.measured.unpaired is None
    assert taken_out(warnings) == 2
    assert "every measured mode is paired" in str(problem.applies(LIBRARY["absorber"]))


def test_the_mode_of_what_hangs_on_it_stays() -> None:
    hung = exactly(LOOK, LOOK.predict(LIBRARY["absorber"].state(LOOK, HUNG), count=6))
    problem, warnings = pose(case_of(with_bounce(hung), FREE))
    assert taken_out(warnings) == 2
    assert problem.measured.unpaired is not None
    assert len(problem.measured.unpaired.frequency) == 1
    assert problem.measured.unpaired.frequency[0] > 100


def test_a_clamped_structure_has_none() -> None:
    look = Predictor(BEAM, blank(ALONG[1:]))
    hung = exactly(look, look.predict(LIBRARY["absorber"].state(look, {**HUNG, "frequency": 15.0}), count=6))
    problem, warnings = pose(case_of(hung))
    assert taken_out(warnings) == 0
    assert problem.measured.unpaired is not None


def test_rigid_body_modes_of_equal_shape_at_the_points_count_once() -> None:
    """Of six motions of a body, sensors along one axis tell three, or two; rounding of the rest explains anything."""
    rng = np.random.default_rng(1)
    bounce, pitch = np.ones(9), np.linspace(-1, 1, 9)
    nothing = 1e-13 * rng.standard_normal((9, 4))
    motions = np.column_stack([bounce, pitch, nothing])
    assert _independent(motions).shape == (9, 2)
    bending = pitch**2 - np.mean(pitch**2)
    explained = _independent(motions).T @ bending
    assert explained @ explained < 0.05 * bending @ bending


def test_no_more_modes_are_taken_out_than_the_body_has_motions() -> None:
    test = with_bounce(exactly(LOOK, LOOK.predict(count=5)))
    third = replace(
        test,
        frequency=np.append(20.0, test.frequency),
        frequency_sigma=np.append(0.01, test.frequency_sigma),
        damping=np.append(0.05, test.damping),
        damping_sigma=np.append(0.002, test.damping_sigma),
        constants=np.hstack([test.constants[:, :1], test.constants]),
        constants_sigma=np.hstack([test.constants_sigma[:, :1], test.constants_sigma]),
    )
    problem, warnings = pose(case_of(third, FREE))
    assert taken_out(warnings) == 2
    assert problem.measured.unpaired is not None
    assert problem.measured.unpaired.frequency.tolist() == [20.0]
