"""Tests that hold too little, or something else: the command says so and concludes no more than it can."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from updating import LIBRARY

pytestmark = pytest.mark.long

Run = Callable[..., tuple[int, str, str]]
SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
PLATE = (16.76, 70.69, 104.91, 229.96, 296.64, 425.51, 446.90, 574.19, 591.14, 731.06)
BEAM = (24.47, 153.96, 429.15)


@pytest.fixture
def answer(run: Run, tmp_path: Path) -> Callable[..., tuple[dict[str, Any], str]]:
    def call(specimen: str, table: str) -> tuple[dict[str, Any], str]:
        (tmp_path / "modes.csv").write_text(table)
        study = tmp_path / "study.toml"
        study.write_text((SAMPLES / specimen / "published.toml").read_text())
        code, text, _ = run("diagnose", study, "--json", tmp_path / "out.json")
        assert code == 0
        return json.loads((tmp_path / "out.json").read_text()), text

    return call


def table_of(frequencies: tuple[float, ...]) -> str:
    return "frequency,sigma\n" + "".join(f"{f},{0.001 * f:.5f}\n" for f in frequencies)


def test_one_mode_names_nothing(answer: Callable[..., tuple[dict[str, Any], str]]) -> None:
    found, text = answer("beam_dry", table_of(BEAM[:1]))
    assert found["cause"]["verdict"] == "class"
    assert len(found["cause"]["sets"]) > 3
    assert found["shrink"]["closed_percent"] is None
    assert found["shrink"]["held_out"]["after_percent"] is None
    assert "only 1 mode paired" in text
    assert "none can be held out" in text


def test_two_modes_of_a_beam_leave_a_class(answer: Callable[..., tuple[dict[str, Any], str]]) -> None:
    found, text = answer("beam_dry", table_of(BEAM[:2]))
    assert found["cause"]["verdict"] == "class"
    assert "only 2 modes paired" in text


def test_a_wild_outlier_is_pointed_at_and_nothing_is_named(
    answer: Callable[..., tuple[dict[str, Any], str]],
) -> None:
    wild = tuple(396.64 if f == 296.64 else f for f in PLATE)
    found, text = answer("plate_dry", table_of(wild))
    assert found["cause"]["verdict"] == "unknown"
    assert found["shrink"]["closed_percent"] is None or "best-fitting (rejected)" in text
    pointed = (
        "396.6 Hz deviates from the others",
        "test lacks modes of the model: 1 between 230.0 Hz and 396.6 Hz",
    )
    assert any(words in warning for words in pointed for warning in found["warnings"])


def test_the_wrong_structure_is_called_that(answer: Callable[..., tuple[dict[str, Any], str]]) -> None:
    found, _ = answer("beam_dry", table_of((5.0, 40.0, 110.0, 220.0)))
    assert found["cause"]["verdict"] == "unknown"
    assert any("probably different structures" in warning for warning in found["warnings"])


def test_modes_without_sigma_are_as_good_as_the_repeatability(
    answer: Callable[..., tuple[dict[str, Any], str]],
) -> None:
    found, _ = answer("beam_dry", "frequency\n" + "".join(f"{f}\n" for f in BEAM))
    assert found["cause"]["verdict"] == "class"
    assert any("have no sigma" in warning for warning in found["warnings"])
    assert found["gap"]["modes"][0]["sigma_percent"] == pytest.approx(0.3)


def test_no_mode_with_a_partner_is_one_line_and_exit_code_2(run: Run, tmp_path: Path) -> None:
    (tmp_path / "modes.csv").write_text(table_of((0.5, 1.0)))
    study = tmp_path / "study.toml"
    study.write_text((SAMPLES / "beam_dry" / "published.toml").read_text())
    code, out, err = run("diagnose", study)
    assert code == 2
    assert len(err.strip().splitlines()) == 1
    assert "Cause" not in out


def test_an_effect_left_out_of_the_library_must_be_in_it(run: Run) -> None:
    code, _, err = run("diagnose", SAMPLES / "beam_dry" / "published.toml", "--without", "E,gremlin")
    assert code == 2
    assert "--without gremlin" in err


KEPT = {"E", "density", "thickness", "sensor_mass"}
"""Enough to be wrongly named in the place of what is left out; the whole library takes half a minute."""


def test_what_is_left_out_of_the_library_is_not_named(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "d.json"
    study = SAMPLES / "plate_wet" / "published.toml"
    without = ["fluid_added_mass", *(name for name in LIBRARY if name not in KEPT)]
    code, _, _ = run("diagnose", study, "--without", ",".join(without), "--json", out)
    cause = json.loads(out.read_text())["cause"]
    assert code == 0
    assert cause["verdict"] == "unknown"
    assert not any("fluid_added_mass" in row["effects"] for row in cause["ranking"])


def test_shared_effects_need_somebody_to_share_them_with(run: Run) -> None:
    beam = SAMPLES / "beam_dry" / "published.toml"
    code, _, err = run("diagnose", beam, "--shared", "length")
    assert code == 2
    assert "one study only" in err
    code, _, err = run("diagnose", beam, beam)
    assert code == 2
    assert "given twice" in err
    code, _, err = run("diagnose", beam, SAMPLES / "plate_dry" / "published.toml", "--shared", "gremlin")
    assert code == 2
    assert "gremlin" in err


def test_a_beam_and_a_plate_share_length_and_sensor(run: Run, tmp_path: Path) -> None:
    """The joint fit of the published notes: some 18 mm of clamp and an accelerometer of some 10 g."""
    studies = [SAMPLES / name / "published.toml" for name in ("beam_dry", "plate_dry")]
    out = tmp_path / "both.json"
    code, text, _ = run("diagnose", *studies, "--shared", "length,sensor_mass", "--json", out)
    assert code == 0
    found = json.loads(out.read_text())
    assert found["cause"]["sets"] == [["length", "sensor_mass"]]
    parameters = found["cause"]["ranking"][0]["parameters"]
    assert parameters["length.extension"]["low95"] < 0.0182 < parameters["length.extension"]["high95"]
    assert parameters["sensor_mass.mass"]["low95"] < 0.0109 < parameters["sensor_mass.mass"]["high95"]
    assert len({mode["study"] for mode in found["gap"]["modes"]}) == 2
    assert "study" in text
