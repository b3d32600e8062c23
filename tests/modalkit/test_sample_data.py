"""The sample tests are what their README says: the published frequencies, small, and made anew alike."""

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition import read_modes
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.identification import read

SAMPLES = Path(__file__).resolve().parents[2] / "sample_data"
NAMES = ("beam_dry", "beam_wet", "plate_dry", "plate_wet", "tape_taped")
ALL = (*NAMES, "tape_bare", "beam_joint")
PUBLISHED = {
    "beam_dry": [24.47, 153.96, 429.15],
    "beam_wet": [19.17, 119.80, 337.86],
    "plate_dry": [
        16.76,
        70.69,
        104.91,
        229.96,
        296.64,
        425.51,
        446.90,
        574.19,
        591.14,
        731.06,
        843.22,
        951.13,
    ],
    "plate_wet": [7.27, 39.61, 48.60, 132.58, 146.44, 262.12, 268.27, 310.61, 367.30, 446.70, 531.26, 539.65],
    "tape_taped": [24.3, 67.2, 130.3, 217.1, 323.8, 453.2],
}
DAMPING = [0.0130, 0.0082, 0.0056, 0.0048, 0.0041, 0.0056]


@pytest.fixture(scope="module")
def maker() -> Iterator[ModuleType]:
    sys.path.insert(0, str(SAMPLES))
    spec = importlib.util.spec_from_file_location("sample_data_make", SAMPLES / "make.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["sample_data_make"] = module
    spec.loader.exec_module(module)
    yield module
    sys.path.remove(str(SAMPLES))


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_the_identified_frequencies_are_the_published_ones(name: str) -> None:
    study = read_study(SAMPLES / name / "study.toml")
    session = open_study(study, with_baseline=False)
    assert session.case.measured.frequency == pytest.approx(PUBLISHED[name], rel=5e-4)


@pytest.mark.parametrize("name", NAMES)
def test_the_modes_beside_a_test_are_the_published_ones(name: str) -> None:
    modes = read_modes(SAMPLES / name / "modes.csv")
    assert modes.frequency.tolist() == PUBLISHED[name]
    assert np.all(modes.frequency_sigma >= 0.005)
    if name == "tape_taped":
        assert modes.damping is not None
        assert modes.damping.tolist() == DAMPING
    else:
        assert modes.damping is None or np.isnan(modes.damping).all()
    assert modes.shapes is None
    session = open_study(read_study(SAMPLES / name / "published.toml"))
    assert session.processed is None
    assert not session.case.measured.has_shapes


@pytest.mark.parametrize("name", ["beam_wet", "plate_wet"])
def test_the_wet_studies_know_the_dry_test_and_nothing_of_the_water(name: str) -> None:
    for file in ("study.toml", "published.toml"):
        study = read_study(SAMPLES / name / file)
        assert study.baseline is not None
        assert study.environment.model_dump(exclude_none=True) == {}


def test_the_files_are_small() -> None:
    sizes = [path.stat().st_size for path in SAMPLES.rglob("*.uff")]
    assert len(sizes) == len(ALL)
    assert max(sizes) < 0.8e6
    assert sum(p.stat().st_size for p in SAMPLES.rglob("*") if "__pycache__" not in p.parts) < 6e6


def test_beams_carry_their_hits_and_plates_their_coherence() -> None:
    beam = read(SAMPLES / "beam_dry" / "beam_dry.uff")
    assert len(beam.hits) == 5 * 15
    assert beam.frfs.decay == pytest.approx(8.0)
    plate = read(SAMPLES / "plate_dry" / "plate_dry.uff")
    assert plate.frfs.values.shape[0] == 25
    assert plate.frfs.coherence is not None
    assert plate.frfs.decay == pytest.approx(4.0)


@pytest.mark.long
def test_a_sample_is_made_anew_alike(maker: ModuleType, tmp_path: Path) -> None:
    test_setup = maker.rigs()[0]
    made = read(maker.make(test_setup, tmp_path)).frfs
    kept = read(SAMPLES / test_setup.name / f"{test_setup.name}.uff").frfs
    # another linear-algebra library may round differently, and a converter step with it
    assert np.abs(made.values - kept.values).max() < 1e-3 * np.abs(kept.values).max()
    maker.write_modes(test_setup.name, tmp_path)
    modes = (tmp_path / test_setup.name / "modes.csv").read_text(encoding="utf-8")
    assert modes == (SAMPLES / test_setup.name / "modes.csv").read_text(encoding="utf-8")


def test_the_joint_test_is_made_anew_alike(maker: ModuleType, tmp_path: Path) -> None:
    made = read(maker.make_joint(tmp_path)).frfs
    kept = read(SAMPLES / "beam_joint" / "beam_joint.uff").frfs
    assert np.abs(made.values - kept.values).max() < 1e-3 * np.abs(kept.values).max()


@pytest.mark.long
def test_frequencies_follow_the_hits_in_the_joint_test_and_in_no_other() -> None:
    found = open_study(read_study(SAMPLES / "beam_joint" / "study.toml")).case.measured
    assert found.slope is not None
    assert found.slope_sigma is not None
    assert found.level == pytest.approx(
        60 * np.exp(1.5 * 0.5**2), rel=0.2
    )  # log-normal: sum F^3 over sum F^2
    # the filter before the converter lowers peaks of a few samples: the level is that of the record
    assert found.slope == pytest.approx(np.full(3, -8e-5), rel=0.08)
    assert np.all(np.abs(found.slope) > 15 * found.slope_sigma)
    even = open_study(read_study(SAMPLES / "beam_dry" / "study.toml")).case.measured
    assert even.slope is not None
    assert even.slope_sigma is not None
    assert np.sum((even.slope / even.slope_sigma) ** 2) < 16  # chi-squared of 3: one in a thousand
    averaged = open_study(
        read_study(SAMPLES / "tape_taped" / "study.toml"), with_baseline=False
    ).case.measured
    assert averaged.slope is None


@pytest.mark.long
def test_a_tape_test_is_made_anew_alike(maker: ModuleType, tmp_path: Path) -> None:
    test_setup = maker.RIGS[1]
    made = read(maker.make_tape(test_setup, tmp_path)).frfs
    kept = read(SAMPLES / test_setup.name / f"{test_setup.name}.uff").frfs
    assert np.abs(made.values - kept.values).max() < 1e-3 * np.abs(kept.values).max()
    maker.write_modes(test_setup.name, tmp_path)
    modes = (tmp_path / test_setup.name / "modes.csv").read_text(encoding="utf-8")
    assert modes == (SAMPLES / test_setup.name / "modes.csv").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def taped() -> Session:
    study = read_study(SAMPLES / "tape_taped" / "study.toml")
    return open_study(study, with_baseline=False)


@pytest.mark.long
def test_the_identified_damping_is_the_published_one(taped: Session) -> None:
    assert taped.case.measured.damping == pytest.approx(DAMPING, rel=0.01)


def test_the_taped_beam_is_hit_at_node_4_and_seen_at_eleven_points(taped: Session) -> None:
    assert taped.processed is not None
    frfs = taped.processed.frfs
    assert [r.node for r in frfs.responses] == list(range(1, 12))
    assert {r.node for r in frfs.references} == {4}
    assert frfs.geometry.at((4,))[0, 0] == pytest.approx(0.3)
    assert frfs.coherence is not None
    assert frfs.df < 0.5 * 2 * DAMPING[0] * 24.3  # half of the width of the first resonance


def test_the_bare_beam_is_damped_little(maker: ModuleType) -> None:
    study = read_study(SAMPLES / "tape_bare" / "study.toml")
    found = open_study(study).case.measured
    assert len(found.frequency) == 6
    assert (found.damping < 0.5 * np.array(DAMPING)).all()
    # free-free Euler-Bernoulli beam of the steel and the section of the structure behind
    roots = np.array([4.730041, 7.853205, 10.995608, 14.137165, 17.278760, 20.420352])
    steel = roots**2 / (2 * np.pi) * np.sqrt(0.968 * 210e9 / 7860.0) * 0.0046 / np.sqrt(12)
    assert np.sqrt(np.mean((found.frequency / steel - 1) ** 2)) < 0.005


def test_the_level_of_the_tape_tests_is_0_74_of_the_truth(taped: Session) -> None:
    # every mode of a uniform free beam has phi^2 = 4/m at its end, and phi(end)^2 = A(end, hit)^2 / A(hit, hit)
    end, drive = taped.case.measured.constants[[0, 3]]
    mass = 7860.0 * 0.0315 * 0.0046
    assert (end**2 / drive * mass) == pytest.approx(4 * 0.74, rel=0.03)


def test_the_shapes_are_as_complex_as_the_tape_makes_them(maker: ModuleType, taped: Session) -> None:
    from tape import damped_modes

    assert taped.identified is not None
    found = taped.identified.constants
    poles = damped_modes(taped=True)
    truth = (poles.shapes * poles.shapes[3])[:, 2:8] * 2j
    clear = np.abs(truth) > 0.3 * np.abs(truth).max(axis=0)
    turned = np.degrees(np.angle(found * np.conj(truth)))
    turned = (turned + 90) % 180 - 90
    assert np.abs(turned[clear]).max() < 0.5
    spread = np.degrees(np.angle(truth * np.exp(-1j * np.angle(np.sum(truth**2, axis=0)) / 2)))
    assert np.abs((spread + 90) % 180 - 90)[clear].max() > 1.0


@pytest.mark.long
def test_the_structure_behind_is_near_the_published_frequencies_before_its_poles_are_moved(
    maker: ModuleType,
) -> None:
    for test_setup in maker.rigs():
        truth = maker.structure_behind(test_setup).frequency[: len(PUBLISHED[test_setup.name])]
        error = truth / np.array(PUBLISHED[test_setup.name]) - 1
        assert np.sqrt(np.mean(error**2)) < (0.04 if test_setup.wet else 0.01)
