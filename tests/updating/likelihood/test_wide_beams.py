"""What a plate of a beam's outline moves beyond it, as doubts of the measured shapes."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, blank, case_of, exactly

from updating import Predictor
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.wide_beams import WideBeams
from updating.thresholds import BEYOND_PLATE

WIDE = replace(BEAM, length=0.5, width=0.05, thickness=0.004, clamped=(), masses=(), regions=())
PLACES = np.linspace(0.05, 0.47, 9)


def setting_of(clamped: tuple[str, ...] = ()) -> Setting:
    nominal = Predictor(replace(WIDE, clamped=clamped), blank(PLACES, top=900.0, sensor=8))
    truth = nominal.predict(count=4)
    return pose(case_of(exactly(nominal, truth), nominal.spec))[0].setting


def columns(setting: Setting, gain: float = 1.0) -> np.ndarray:
    constants = setting.nominal.constants
    return (
        WideBeams(setting)
        .columns(setting.nominal, np.full_like(constants, gain))
        .reshape(*constants.shape, 3)
    )


def test_constants_change_at_both_ends_alike() -> None:
    """At a drive point, seen and hit are one place."""
    _, seen, hit = np.moveaxis(columns(setting_of()), 2, 0)
    assert seen[8] == pytest.approx(hit[8])
    assert np.abs(seen).max() > 0.01 * np.abs(setting_of().nominal.constants).max()


def test_a_clamp_that_holds_the_section_straight_moves_shapes_as_a_shorter_beam_does() -> None:
    """By nu^2 b sqrt((1 - nu) / 6), of the lowest mode, further than two widths from the clamp."""
    setting = setting_of(("x0",))
    poisson = WIDE.material.poisson
    shorter = poisson**2 * WIDE.width * np.sqrt((1 - poisson) / 6)
    spec = replace(WIDE, clamped=("x0",))
    less = Predictor(
        replace(spec, length=WIDE.length - shorter), blank(PLACES - shorter, top=900.0, sensor=8)
    )
    moved = np.abs(less.predict(count=1).constants) - np.abs(setting.nominal.constants[:, :1])
    mean = (columns(setting)[:, 0, 0] * np.sign(setting.nominal.constants[:, 0])).ravel()
    assert mean[2:] == pytest.approx(moved[2:].ravel(), abs=0.1 * np.abs(moved).max())


def test_a_shape_turned_round_and_a_gain_are_followed() -> None:
    setting = setting_of()
    now, level = setting.nominal, np.ones_like(setting.nominal.constants)
    plain = WideBeams(setting).columns(now, level)
    other = replace(now, constants=-now.constants, seen=-now.seen)
    assert WideBeams(setting).columns(other, level) == pytest.approx(-plain)
    assert columns(setting, gain=0.7) == pytest.approx(0.7 * columns(setting))
    louder = replace(now, gain=3.0 * now.gain, constants=3.0 * now.constants)
    assert WideBeams(setting).columns(louder, level / 3.0) == pytest.approx(plain)
    assert WideBeams(setting).variance(louder, level / 3.0) == pytest.approx(
        WideBeams(setting).variance(now, level)
    )


def test_the_rest_is_a_share_of_what_the_plate_moves_beyond() -> None:
    setting = setting_of()
    level = np.ones_like(setting.nominal.constants)
    found = WideBeams(setting).variance(setting.nominal, level)
    assert found == pytest.approx(BEYOND_PLATE**2 * np.sum(columns(setting) ** 2, axis=2))


def test_a_beam_without_poissons_ratio_has_none() -> None:
    setting = setting_of(("x0",))
    level = np.ones_like(setting.nominal.constants)
    straight = replace(WIDE, material=replace(WIDE.material, poisson=0.0))
    without = replace(setting, predictor=Predictor(straight, setting.measured))
    assert WideBeams(setting).present
    assert not WideBeams(without).present
    assert WideBeams(without).columns(setting.nominal, level).shape == (level.size, 0)
    assert not WideBeams(without).variance(without.nominal, level).any()
