"""The joint dry update as a table, from the published frequencies alone."""

import pytest

from modalkit.papers.a.chain import sample_folder
from modalkit.papers.a.joint import joint_table
from modalkit.papers.render import PaperTable, render
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.update import update_studies


@pytest.fixture(scope="module")
def made() -> PaperTable:
    return joint_table()


@pytest.mark.long
@pytest.mark.parametrize(
    ("variant", "length", "sensor", "beam", "plate", "error"),
    [
        ("E of the plate alone", 18.2, 10.9, 1.0, 0.93, 0.52),
        ("E shared", 11.0, 2.0, 0.86, 0.86, 0.65),
        ("E of each", 16.0, 8.6, 0.96, 0.91, 0.48),
    ],
)
def test_every_variant(
    made: PaperTable, variant: str, length: float, sensor: float, beam: float, plate: float, error: float
) -> None:
    row = made.table.set_index("variant").loc[variant]
    assert row["length, ours"] == pytest.approx(length, abs=0.5)
    assert row["sensor, ours"] == pytest.approx(sensor, abs=0.5)
    assert row["E beam, ours"] == pytest.approx(beam, abs=0.005)
    assert row["E plate, ours"] == pytest.approx(plate, abs=0.005)
    assert row["r.m.s., ours"] == pytest.approx(error, abs=0.01)


def test_the_spread_is_said_to_be_the_result(made: PaperTable) -> None:
    text = render([made], "md")
    assert "Paper A, joint" in text
    assert "spread of the variants is the result" in text


@pytest.mark.long
def test_the_study_files_give_the_variant_with_e_shared() -> None:
    every = ("length", "sensor_mass", "E")
    sessions = [
        open_study(read_study(sample_folder() / name / "published.toml"))
        for name in ("beam_dry", "plate_dry")
    ]
    result = update_studies(sessions, every)
    found = {p.name: p.factor if p.name == "E" else p.value for p in result.parameters}
    assert found["length"] == pytest.approx(0.011, abs=0.0005)
    assert found["sensor_mass"] == pytest.approx(0.002, abs=0.0005)
    assert found["E"] == pytest.approx(0.86, abs=0.005)
    assert result.rms_percent() == pytest.approx(0.65, abs=0.01)
    assert len(result.pairs) == 15


@pytest.mark.long
def test_weights_that_leave_a_mode_out_go_with_relative_ones() -> None:
    sessions = [
        open_study(read_study(sample_folder() / name / "study.toml")) for name in ("beam_dry", "plate_dry")
    ]
    pairs = update_studies(sessions, ("length", "sensor_mass", "E")).pairs
    assert pairs["used"].sum() == 14
    assert not pairs.set_index("test_hz")["used"].iloc[3 + 7]
