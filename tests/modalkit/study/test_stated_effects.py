"""Accepted effects that speak of points, in a study and on the command line."""

from pathlib import Path

import pytest

from acquisition.errors import InputError, StudyError
from modalkit.study.named_effects import effects_text, parse_effect
from modalkit.study.read import read_study
from modalkit.study.stated_effects import accepted_values, was_before

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"


def test_points_are_node_numbers() -> None:
    assert accepted_values({"name": "polarity", "points": [3]}) == ("polarity", {"points": (3,)})
    stated = {"name": "position_error", "point": 3, "dx": 0.01}
    assert accepted_values(stated) == ("position_error", {"point": 3, "dx": 0.01})


@pytest.mark.parametrize(
    "entry",
    [
        {"name": "polarity", "points": "3"},
        {"name": "polarity", "points": [3, 3]},
        {"name": "polarity", "points": []},
        {"name": "polarity", "points": [True]},
        {"name": "position_error", "point": [3], "dx": 0.01},
        {"name": "position_error", "point": 3.5, "dx": 0.01},
        {"name": "E", "factor": "large"},
        {"name": "E", "factor": float("nan")},
        {"name": "gremlin"},
        {"factor": 1.0},
    ],
)
def test_nonsense_is_refused(entry: dict[str, object]) -> None:
    with pytest.raises(StudyError):
        accepted_values(entry)


def test_the_command_line_takes_them_too() -> None:
    name, values = parse_effect("polarity:points=3/4")
    assert (name, values) == ("polarity", {"points": (3, 4)})
    assert effects_text([(name, values)]) == "polarity:points=3/4"
    assert parse_effect("position_error:point=3,dx=0.01")[1] == {"point": 3, "dx": 0.01}


def test_the_command_line_takes_units() -> None:
    assert parse_effect("lumped_mass:mass=20g,x=100mm")[1] == {"mass": 0.02, "x": 0.1}
    assert parse_effect("E:factor=88%")[1] == {"factor": 0.88}
    assert parse_effect("clamp_rotation:stiffness=4 kN m/rad per m", "plate")[1] == {"stiffness": 4000.0}
    with pytest.raises(InputError, match="mass: '20 mm' is not a quantity in kg"):
        parse_effect("lumped_mass:mass=20 mm,x=0.1")


@pytest.mark.parametrize(
    "text",
    ["polarity:points=a/b", "polarity:points=", "position_error:point=3/4,dx=0", "E:factor=1,factor=2"],
)
def test_nonsense_on_the_command_line_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        parse_effect(text)


def test_a_study_says_where_the_nonsense_stands(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    text = (SAMPLES / "beam_dry" / "study.toml").read_text()
    path.write_text(text + '\n[[model.effect]]\nname = "polarity"\npoints = "3"\n')
    with pytest.raises(StudyError, match=r"study.toml: \[\[model.effect\]\] polarity: points"):
        read_study(path).accepted()


def test_several_of_one_name_stand_where_there_may_be_several(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    text = (SAMPLES / "beam_dry" / "study.toml").read_text()
    body = '\n[[model.effect]]\nname = "lumped_mass"\nmass = "5 g"\nx = {x}\n'
    path.write_text(text + body.format(x=0.1) + body.format(x=0.2))
    assert read_study(path).accepted() == tuple(("lumped_mass", {"mass": 0.005, "x": x}) for x in (0.1, 0.2))
    modulus = '\n[[model.effect]]\nname = "E"\nfactor = 0.9\n'
    path.write_text(text + modulus + modulus)
    with pytest.raises(StudyError, match=r"study.toml: \[\[model.effect\]\] E is given twice"):
        read_study(path).accepted()


def test_an_accepted_effect_says_whether_the_baseline_had_it() -> None:
    """Nothing stated: what a structure has it had before, what one measurement did wrong it did alone."""
    assert was_before({"name": "lumped_mass", "mass": 0.02})
    assert not was_before({"name": "lumped_mass", "mass": 0.02, "before": False})
    assert not was_before({"name": "polarity", "points": [3]})
    assert was_before({"name": "polarity", "points": [3], "before": True})
    assert accepted_values({"name": "E", "factor": 1.1, "before": False}) == ("E", {"factor": 1.1})
    with pytest.raises(StudyError, match="before = 1"):
        was_before({"name": "E", "factor": 1.1, "before": 1})


def test_a_study_knows_which_effects_came_after_its_baseline(tmp_path: Path) -> None:
    text = (SAMPLES / "beam_dry" / "study.toml").read_text(encoding="utf-8")
    for stated in ("before = true", "before = false", ""):
        text += f'\n[[model.effect]]\nname = "lumped_mass"\nmass = 0.02\nx = 0.2\n{stated}\n'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    study = read_study(tmp_path / "study.toml")
    assert study.since_baseline() == (1,)
    assert study.baseline_stated() == (0, 1)
    assert [values for _, values in study.accepted()] == [{"mass": 0.02, "x": 0.2}] * 3
