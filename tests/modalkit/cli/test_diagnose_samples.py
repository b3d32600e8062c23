"""Diagnoses of data by others, of the published numbers of the tape paper, and of its samples."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from modalkit.cli import app
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import Diagnosis, diagnose

pytestmark = pytest.mark.long

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
TAPE = (0.5, 0.8)
"""Segments 6 to 8 [m]; the paper's beam is 1 m long."""


@cache
def answer(path: Path) -> Diagnosis:
    return diagnose(open_study(read_study(path)).case)


def sample(name: str) -> Diagnosis:
    return answer(SAMPLES / name)


def test_shear_is_named_on_a_measured_beam_beside_a_point_of_another_gain(
    shared_data: Callable[[str], Path],
) -> None:
    """The constants of point 4 are 0.85 of the others' in each of the four modes, 0.80 to 0.75 beside 0.9 to 1.04."""
    found = answer(shared_data("frf/ModeLAB/study.toml"))
    assert len(found.gap.modes) >= 4
    assert (found.verdict, found.sets) == ("named", (("channel_gain", "shear"),))
    best, alone = found.ranking[0], next(row for row in found.ranking if row.effects == ("shear",))
    assert best.p_value > 0.05
    assert alone.p_value < 1e-3
    assert best.parameters["channel_gain.points"].value == (4,)
    assert best.parameters["channel_gain.gain"].value == pytest.approx(0.85, abs=0.03)
    shrink = found.shrink
    assert shrink.metric == "frequency"
    assert shrink.closed is not None
    assert shrink.closed.value > 95
    assert shrink.held_after < 0.05 * shrink.held_before
    assert shrink.held_after < 0.5 * shrink.held_nuisance  # shear alone closes as much


def test_published_damping_shows_a_patch_or_what_looks_alike() -> None:
    """Six frequencies and damping ratios leave the place wide open, and the kind of damping."""
    found = sample("tape_taped/published.toml")
    assert found.significant
    assert found.where.channel == "damping"
    assert set(found.effects) <= {"damping_patch", "uniform_damping", "fluid_damping"}
    patch = found.ranking[0]
    assert patch.effects == ("damping_patch",)
    assert patch.p_value > 0.05
    x = patch.parameters["damping_patch.x"]
    assert x.low95 is not None
    assert x.high95 is not None
    middle = np.mean(TAPE)
    assert x.low95 < middle < x.high95 or x.low95 < 1 - middle < x.high95
    assert found.shrink.metric == "damping"
    assert found.shrink.after < 14.4  # the paper's own, as a mean; this is r.m.s.


def test_the_sample_tells_on_which_side_the_tape_sits() -> None:
    found = sample("tape_taped/study.toml")
    assert (found.verdict, found.sets) == ("named", (("damping_patch",),))
    row = found.ranking[0]
    assert row.p_value > 0.05
    assert found.where.channel == "damping"
    assert [place[0] for place in found.where.locations] == pytest.approx([np.mean(TAPE)], abs=0.02)
    # what stands behind: loss factor 0.03, 3.5 % of mass and 9 % of stiffness on 0.3 m
    truth = {"extent": TAPE[1] - TAPE[0], "loss_factor": 0.03, "mass": 0.035, "stiffness": 0.09}
    for name, value in truth.items():
        estimate = row.parameters[f"damping_patch.{name}"]
        assert estimate.low95 is not None
        assert estimate.high95 is not None
        assert estimate.low95 < value < estimate.high95
    assert found.shrink.metric == "damping"
    assert found.shrink.after <= 9.0


def test_a_level_that_a_larger_section_would_explain_is_no_more_than_that() -> None:
    """Area and inertia a third too large, or FRFs a quarter too small: no FRF tells."""
    found = sample("tape_bare/study.toml")
    assert found.verdict == "class"
    assert set(found.sets) == {("calibration_gain",), ("section_scale",)}
    rows = {row.effects[0]: row for row in found.ranking[:2]}
    gain = rows["calibration_gain"].parameters["calibration_gain.gain"]
    scale = rows["section_scale"].parameters["section_scale.factor"]
    assert gain.low95 is not None
    assert gain.high95 is not None
    assert gain.low95 < 0.74 < gain.high95
    assert scale.value == pytest.approx(1 / 0.74, rel=0.05)
    assert ("calibration_gain",) in rows["section_scale"].equivalents


def test_a_body_between_the_starting_places_of_the_search_is_found(tmp_path: Path) -> None:
    """Far from the truth the likelihood rises slowly, however much is missing to what another effect has reached."""
    plan = tmp_path / "plan.toml"
    plan.write_text(
        'title = "cantilever"\n[test]\nband = [5.0, 900.0]\n[model]\ntype = "beam"\nlength = 0.45\nwidth = 0.025\n'
        'thickness = 0.006\nclamped = ["x0"]\n[model.material]\nE = 70e9\ndensity = 2700.0\n'
    )
    body = "lumped_mass:mass=0.02,x=0.3,bulk=1"
    words = ["simulate", str(plan), "--effect", body, "--seed", "3", "-o", str(tmp_path / "t.uff")]
    assert CliRunner().invoke(app, words).exit_code == 0
    study = tmp_path / "study.toml"
    study.write_text(plan.read_text().replace("[test]", '[test]\nfiles = ["t.uff"]'))
    found = answer(study)
    assert found.sets[0] == ("lumped_mass",)  # a short heavy place may be as good
    assert set(found.sets) <= {("lumped_mass",), ("local_mass",)}
    assert found.where.location is not None
    assert found.where.location[0] == pytest.approx(0.3, abs=0.005)
