"""The simulated rig: its points, hits, mounting, windows and surroundings are those of the study."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulate_cases import STEEL, STUDY, Run, pointed_at

from acquisition import read_uff
from modalkit.samples import sample_file
from modalkit.simulation.planned import spaced
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import prepare, simulate_test
from modalkit.study.named_effects import parse_effect
from modalkit.study.read import read_study
from modalkit.workflow.case import process
from modalkit.workflow.identification import read
from updating import Spec


@pytest.mark.long
def test_the_rig_is_that_of_the_study_s_own_hits() -> None:
    """The sample was made with these figures; window, rate and records are stated, the rest is heard."""
    made = simulate_test(read_study(STUDY), options=Options(hits=1))
    plan = made.test_setup.plan
    assert (plan.rate, plan.samples, plan.decay, plan.form) == (1280.0, 1024, 8.0, "accelerance")
    assert simulate_test(read_study(STUDY)).tests[0].points[0].count == 15
    assert plan.peak == pytest.approx(60.0, rel=0.1)
    assert plan.width == pytest.approx(1.2 / 500, rel=0.1)
    assert plan.force_noise == pytest.approx(2e-4 * 60, rel=0.25)
    motion = np.abs(read_uff(STUDY.parent / "beam_dry.uff").tests[0].points[2].motion).max()
    assert plan.response_floor == pytest.approx(3e-4 * motion, rel=0.5)
    assert made.test_setup.band == (5.0, 500.0)
    assert made.tests[0].decay == 8.0


@pytest.mark.long
def test_an_unknown_window_and_gain_are_in_the_data_and_not_stated(tmp_path: Path) -> None:
    study = read_study(STUDY)
    plain = simulate_test(study, seed=1, options=Options(hits=3))
    off = simulate_test(
        study,
        [parse_effect("exponential_window:decay=2.0"), parse_effect("calibration_gain:gain=1.2")],
        seed=1,
        options=Options(hits=3),
    )
    off.write(tmp_path / "off.uff")
    plain.write(tmp_path / "plain.uff")
    one, other = (read(tmp_path / n).identify(band=(5, 500)) for n in ("plain.uff", "off.uff"))
    assert other.frfs.decay == 8.0
    sigma = np.hypot(*(np.sqrt(m.pole_covariance[:, 1, 1]) * np.abs(m.poles) for m in (one, other)))
    assert (np.abs(other.poles.real - one.poles.real + 2.0) < 4.5 * sigma).all()
    assert sigma.max() < 0.1
    ratio = np.median(other.constants.real / one.constants.real, axis=0)
    assert ratio == pytest.approx(np.full(3, 1.2), rel=0.01)


def test_points_stand_off_the_clamps() -> None:
    beam = Spec(
        "beam",
        length=1.0,
        width=0.03,
        thickness=0.005,
        elements=(10,),
        clamped=("x0", "x1"),
        theory="euler-bernoulli",
        material=STEEL,
    )
    assert spaced(beam, 4)[:, 0] == pytest.approx([0.2, 0.4, 0.6, 0.8])
    plate = Spec(
        "plate",
        length=0.4,
        width=0.3,
        thickness=0.003,
        elements=(8, 6),
        clamped=("x0",),
        theory="kirchhoff",
        material=STEEL,
    )
    grid = spaced(plate, None)
    assert len(grid) == 20
    assert grid.min(axis=0) == pytest.approx([0.08, 0.0])
    assert grid.max(axis=0) == pytest.approx([0.4, 0.3])


@pytest.mark.long
def test_a_new_mounting_scatters_as_the_study_says() -> None:
    study = read_study(STUDY)
    quick = Options(hits=1, samples=256)
    plain = simulate_test(study, options=quick)
    ready = prepare(study, replace(quick, remount=True))
    again = [simulate_test(ready, seed=i) for i in range(12)]
    ratios = np.array([one.poles / plain.poles for one in again])
    assert np.abs(ratios.imag).max() < 1e-12
    spread = np.sqrt(np.mean((ratios.real - 1) ** 2))
    assert spread == pytest.approx(study.test.repeatability, rel=0.5)  # 36 draws: 12 % is one sigma
    gains = np.array([one.test_setup.plan.gain for one in again])
    assert np.sqrt(np.mean(np.log(gains) ** 2)) == pytest.approx(study.test.calibration, rel=0.8)


@pytest.mark.long
def test_a_mass_that_the_study_takes_out_is_on_the_model_before(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        STUDY.read_text().replace(
            'files = ["beam_dry.uff"]',
            f'files = ["{STUDY.parent / "beam_dry.uff"}"]\nsensor_masses = {{ "5+Z" = 0.0086 }}',
        )
    )
    known = simulate_test(read_study(path), options=Options(hits=1)).table()
    heavy = simulate_test(
        read_study(STUDY), [parse_effect("sensor_mass:mass=0.0086")], options=Options(hits=1)
    ).table()
    column = "frequency [Hz]"
    assert known[column].to_numpy() == pytest.approx(heavy[column].to_numpy(), rel=1e-9)
    made = simulate_test(read_study(path), options=Options(hits=6), seed=3)
    made.write(tmp_path / "made.uff")
    again = tmp_path / "again.toml"
    again.write_text(path.read_text().replace(str(STUDY.parent / "beam_dry.uff"), "made.uff"))
    back = process(read_study(again))[1].modal.frequency
    bare = simulate_test(read_study(STUDY), options=Options(hits=1)).table()[column].to_numpy()
    assert back == pytest.approx(bare, rel=2e-4)


@pytest.mark.long
def test_the_rig_of_averaged_frfs_has_their_lines_averages_and_noise(tmp_path: Path) -> None:
    stated = Options(hits=8, noise=2e-3)
    first = simulate_test(read_study(STUDY), seed=2, options=stated)
    first.write(tmp_path / "frfs.uff", as_frfs=True)
    plan = simulate_test(
        read_study(pointed_at(tmp_path / "frfs.uff", tmp_path)), options=Options(noise=None)
    ).test_setup.plan
    assert plan.hits == 8
    assert plan.rate == pytest.approx(1280.0, rel=2e-3)
    assert plan.samples == pytest.approx(1024, rel=2e-3)
    assert plan.decay == 8.0
    largest = [np.abs(point.motion).max(axis=-1).mean() for point in first.tests[0].points]
    peaks = np.mean([point.force.max(axis=-1).mean() for point in first.tests[0].points])
    assert plan.response_floor == pytest.approx(2e-3 * np.median(largest) * plan.peak / peaks, rel=0.4)


@pytest.mark.long
def test_a_beam_in_water_sounds_lower(tmp_path: Path) -> None:
    study = read_study(sample_file("beam_wet/study.toml"))
    effect = [parse_effect("fluid_added_mass:fluid_density=998")]
    dry, wet = (simulate_test(study, e, options=Options(hits=1)).table() for e in ([], effect))
    count = min(len(dry), len(wet))
    ratio = wet["frequency [Hz]"].to_numpy()[:count] / dry["frequency [Hz]"].to_numpy()[:count]
    assert (ratio < 0.8).all()


@pytest.mark.long
def test_a_window_applied_on_reading_is_not_one_of_the_records(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        STUDY.read_text()
        .replace("beam_dry.uff", str(STUDY.parent / "beam_dry.uff"))
        .replace("exponential_window = 8.0", "exponential_window = 8.0\nwindow = 3.0")
    )
    made = simulate_test(read_study(path), options=Options(hits=1))
    assert made.tests[0].decay == 8.0
    plain = simulate_test(read_study(STUDY), options=Options(hits=1)).test_setup.plan
    assert made.test_setup.plan.response_floor == pytest.approx(plain.response_floor, rel=0.2)


@pytest.mark.long
def test_accepted_effects_are_in_the_model_already(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        STUDY.read_text().replace("beam_dry.uff", str(STUDY.parent / "beam_dry.uff"))
        + '\n[[model.effect]]\nname = "sensor_mass"\nmass = 0.0086\n'
    )
    quick = Options(hits=1)
    accepted = simulate_test(read_study(path), [parse_effect("E:factor=0.96")], options=quick).table()
    both = [parse_effect("sensor_mass:mass=0.0086"), parse_effect("E:factor=0.96")]
    named = simulate_test(read_study(STUDY), both, options=quick).table()
    column = "frequency [Hz]"
    assert accepted[column].to_numpy() == pytest.approx(named[column].to_numpy(), rel=1e-9)
