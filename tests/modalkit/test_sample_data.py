"""The sample tests are what their README says: the published frequencies, small, and made anew alike."""

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition import read_modes
from modalkit.process import open_study
from modalkit.reading import read
from modalkit.study import read_study

SAMPLES = Path(__file__).resolve().parents[2] / "sample_data"
NAMES = ("beam_dry", "beam_wet", "plate_dry", "plate_wet")
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
}


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


@pytest.mark.parametrize("name", NAMES)
def test_the_identified_frequencies_are_the_published_ones(name: str) -> None:
    study = read_study(SAMPLES / name / "study.toml")
    session = open_study(study.model_copy(update={"baseline": None}))
    assert session.case.measured.frequency == pytest.approx(PUBLISHED[name], rel=5e-4)


@pytest.mark.parametrize("name", NAMES)
def test_the_modes_beside_a_test_are_the_published_ones(name: str) -> None:
    modes = read_modes(SAMPLES / name / "modes.csv")
    assert modes.frequency.tolist() == PUBLISHED[name]
    assert np.all(modes.frequency_sigma >= 0.005)
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
    assert len(sizes) == 4
    assert max(sizes) < 1.5e6
    assert sum(p.stat().st_size for p in SAMPLES.rglob("*") if "__pycache__" not in p.parts) < 5e6


def test_beams_carry_their_hits_and_plates_their_coherence() -> None:
    beam = read(SAMPLES / "beam_dry" / "beam_dry.uff")
    assert len(beam.hits) == 5 * 15
    assert beam.frfs.decay == pytest.approx(8.0)
    plate = read(SAMPLES / "plate_dry" / "plate_dry.uff")
    assert plate.frfs.values.shape[0] == 25
    assert plate.frfs.coherence is not None
    assert plate.frfs.decay == pytest.approx(4.0)


def test_a_sample_is_made_anew_alike(maker: ModuleType, tmp_path: Path) -> None:
    rig = maker.rigs()[0]
    made = read(maker.make(rig, tmp_path)).frfs
    kept = read(SAMPLES / rig.name / f"{rig.name}.uff").frfs
    # another linear-algebra library may round differently, and a converter step with it
    assert np.abs(made.values - kept.values).max() < 1e-3 * np.abs(kept.values).max()
    maker.write_modes(rig.name, tmp_path)
    modes = (tmp_path / rig.name / "modes.csv").read_text(encoding="utf-8")
    assert modes == (SAMPLES / rig.name / "modes.csv").read_text(encoding="utf-8")


def test_the_structure_behind_is_near_the_published_frequencies_before_its_poles_are_moved(
    maker: ModuleType,
) -> None:
    for rig in maker.rigs():
        truth = maker.structure_behind(rig).frequency[: len(PUBLISHED[rig.name])]
        error = truth / np.array(PUBLISHED[rig.name]) - 1
        assert np.sqrt(np.mean(error**2)) < (0.04 if rig.wet else 0.01)
