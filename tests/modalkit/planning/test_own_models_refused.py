"""What cannot be planned on one's own model is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from own_model_cases import PLATE, POINTS, bench, study

from acquisition.errors import StudyError
from modalkit.planning.own import bench_of
from modalkit.study.read import read_study

REFUSED = [
    ({"test": ""}, "the points to be hit are not stated; give .test. points"),
    ({"test": "points = [0.1, 0.2]"}, "0.1 is a place along a beam; write a node and its direction"),
    ({"test": 'points = ["2+X", "9+X"]'}, "node 9 is not one of the model's, which reach from 1 to 6"),
    ({"test": 'points = ["2+X", "3+Y"]'}, "3.Y: the model cannot move in that direction"),
    ({"test": 'points = ["2+X", [9.0, 0.0, 0.0, "x"]]'}, "off the imported structure"),
    (
        {"test": f'{POINTS}\nshape_sigma = "4 %"'},
        "shape_sigma is for modes only. Leave it out: for a planned test",
    ),
    ({"test": 'points = ["here"]'}, "'here' is not a point; write a place along a beam"),
    ({"test": "points = [[0.1]]"}, "is not a point; write a place along a beam"),
]


@pytest.mark.parametrize(("words", "message"), REFUSED)
def test_what_cannot_be_planned_is_refused_in_one_line(
    tmp_path: Path, words: dict[str, str], message: str
) -> None:
    with pytest.raises(StudyError, match=message) as error:
        bench(tmp_path, **words)
    assert "\n" not in str(error.value)


def test_points_at_supports_are_refused(tmp_path: Path) -> None:
    """Two nodes that supports hold: nothing moves where the test would hit."""
    path = study(tmp_path, test='points = ["7+X", "8+X"]')
    with (tmp_path / "nodes.csv").open("a") as table:
        table.write("7, 0, 0, 0, 1, ,\n8, 0, 0.1, 0, 1, ,\n")
    with pytest.raises(
        StudyError,
        match="0 of the model's modes move any point, but a forecast needs two; check whether the points",
    ):
        bench_of(read_study(path))


def test_a_band_without_modes_is_refused(tmp_path: Path) -> None:
    path = study(tmp_path)
    path.write_text(path.read_text().replace("band = [1.0, 290.0]", "band = [1.0, 50.0]"))
    with pytest.raises(StudyError, match="holds 1 of the model's modes that the points show"):
        bench_of(read_study(path))


def test_a_place_on_a_plate_is_no_place_along_a_beam(tmp_path: Path) -> None:
    path = tmp_path / "beam.toml"
    text = PLATE.replace('type = "plate"', 'type = "beam"').replace("elements = [8, 4]", "")
    path.write_text(text.format(test="points = [[0.2, 0.05]]"))
    with pytest.raises(StudyError, match="is not a place along a beam"):
        bench_of(read_study(path))
    path.write_text(PLATE.format(test="points = [[0.2, 0.05]]\nsensor = 0.3"))
    with pytest.raises(StudyError, match=r"\[test\] points and sensor: 0.3 is a place along a beam"):
        bench_of(read_study(path))
    path.write_text(PLATE.format(test='points = ["3+Z"]'))
    with pytest.raises(StudyError, match="node 3: a plate has no node numbers; write"):
        bench_of(read_study(path))
