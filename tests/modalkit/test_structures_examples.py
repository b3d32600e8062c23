"""The frame and the machine of `examples/matrices`: named, by the user's own names; and hypotheses that are refused."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from scipy import sparse
from scipy.io import mmwrite

from acquisition.errors import StudyError
from modalkit.output.documents import diagnosis_document
from modalkit.output.summary import answers
from modalkit.study.read import read_study
from modalkit.workflow.diagnosis import diagnose_studies

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "matrices"


def made(name: str, folder: Path) -> Path:
    """Return the study of an example."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(EXAMPLES))
    try:
        return Path(importlib.import_module(name).make(folder))
    finally:
        patch.undo()
        for module in ("frame", "machine", "bars", "hits"):
            sys.modules.pop(module, None)


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    yield made("frame", tmp_path_factory.mktemp("frame"))


@pytest.mark.slow
def test_a_loose_joint_is_named_by_the_hypothesis_of_it(frame: Path) -> None:
    found = diagnose_studies([frame])
    assert (found.verdict, found.sets) == ("named", (("joint 3 is loose",),))
    (amount,) = found.ranking[0].parameters.values()
    assert amount.value == pytest.approx(1.0, abs=0.02)
    assert "seen on two of ten frames" in answers(found)["Cause"]
    assert diagnosis_document(found)["cause"]["effects"] == ("joint 3 is loose",)
    place = found.where.location
    assert place is not None
    assert place == pytest.approx((0.0, 0.0, 0.75), abs=0.1)


@pytest.mark.slow
def test_a_soft_foot_is_named_by_its_name(tmp_path: Path) -> None:
    found = diagnose_studies([made("machine", tmp_path)])
    assert (found.verdict, found.sets) == ("named", (("local_stiffness",),))
    assert found.where.names == ("foot_rear_left",)
    assert found.ranking[0].parameters["local_stiffness.loss"].value == pytest.approx(0.33, abs=0.02)
    said = answers(found)
    assert "foot_rear_left is softer than modelled" in said["Cause"]
    assert "foot_rear_left" in said["Where"]
    zones = {zone.name: zone.probability for zone in found.where.zones}
    assert zones["foot_rear_left"] > 0.99


FIRST = '[[hypothesis]]\nname = "joint 1 is loose"\nstiffness = "joint_1_loose.mtx"'
REFUSED = [
    (FIRST.replace("joint_1_loose", "stiffness"), "is identical to the model's own, so the hypothesis changes nothing"),
    (FIRST.replace("joint_1_loose", "small"), "of order 12 and the model of order 228"),
    (FIRST.replace("joint 1 is loose", "lumped_mass"), "'lumped_mass' is the name of an effect"),
    (FIRST.replace("joint 1 is loose", "joint 2 is loose"), "'joint 2 is loose' is given twice"),
    (FIRST.replace("joint 1 is loose", "joint.1"), "contains '.'"),
    (FIRST.replace('stiffness = "joint_1_loose.mtx"', 'deck = "loose.inp"'), 'for .model. type = "calculix"'),
    (FIRST.replace('stiffness = "joint_1_loose.mtx"', 'parameter = "beam_1.E"'), "needs its range"),
    (FIRST.replace('stiffness = "joint_1_loose.mtx"', 'parameter = "web.E"\nrange = [1e9, 2e9]'), "known: E, dens"),
    (FIRST + '\nmass = "mass.mtx"', "mass = 'mass.mtx' is identical to the model's own"),
    (FIRST + "\nrange = [1.0, 0.0]", "ends before it begins"),
    (FIRST + "\nrange = [0.0, 3.0]", "at 3: stiffness matrix indefinite"),
    (FIRST + '\nparameter = "E"', "needs stiffness, mass or both; or deck; or parameter"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_hypotheses_that_cannot_be_are_refused_in_one_line(frame: Path, text: str, message: str) -> None:
    mmwrite(frame.parent / "small.mtx", sparse.eye_array(12))
    written = frame.read_text()
    assert FIRST in written
    other = frame.parent / "other.toml"
    other.write_text(written.replace(FIRST, text))
    with pytest.raises(StudyError, match=message) as error:
        read_study(other).spec()
    assert "\n" not in str(error.value)
    assert str(other) in str(error.value)


def test_a_parameter_is_supposed_in_its_unit(frame: Path) -> None:
    text = FIRST.replace(
        'stiffness = "joint_1_loose.mtx"', 'parameter = "beam_1.E"\nrange = ["100 GPa", "250 GPa"]'
    )
    other = frame.parent / "parameter.toml"
    other.write_text(frame.read_text().replace(FIRST, text))
    supposed = read_study(other).spec().hypotheses[0]
    assert (supposed.low, supposed.high, supposed.unit) == (100e9, 250e9, "Pa")
    assert (supposed.factor, supposed.region, supposed.nominal) == ("E", 4, 210e9)


def test_a_range_with_a_unit_is_refused_where_values_are_factors(frame: Path) -> None:
    text = FIRST.replace('stiffness = "joint_1_loose.mtx"', 'parameter = "E"\nrange = ["60 GPa", "80 GPa"]')
    other = frame.parent / "factors.toml"
    model, end = frame.read_text().replace(FIRST, text).split("[model.material]")
    other.write_text(model + end[end.index("[") :])
    with pytest.raises(StudyError, match=r"E is a factor where the study has no \[model.material\]"):
        read_study(other).spec()


def test_hypotheses_are_of_models_given_by_matrices(frame: Path) -> None:
    other = frame.parent / "beam.toml"
    other.write_text(
        '[test]\nfiles = ["hits.uff"]\n[model]\ntype = "beam"\nlength = 1.0\nwidth = 0.1\nthickness = 0.01\n'
        f"[model.material]\nE = 210e9\ndensity = 7850.0\n{FIRST}\n"
    )
    with pytest.raises(StudyError, match="is for models given by matrices or a deck, found"):
        read_study(other).spec()
