"""Figures: nothing written overlaps, texts are broken to their room, and files are whole."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from figure_text import assert_legible
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.figures import mac_figure, save_figures
from modalkit.figures.style import broken, grouped, shortened, text_width


def test_the_check_of_legibility_finds_what_it_is_for() -> None:
    figure = Figure(figsize=(4, 3))
    figure.text(0.3, 0.5, "one")
    assert_legible(figure)
    figure.text(0.33, 0.51, "another", rotation=90)
    with pytest.raises(AssertionError, match="overlaps"):
        assert_legible(figure)
    beyond = Figure(figsize=(4, 3))
    beyond.text(0.9, 0.5, "too far to the right")
    with pytest.raises(AssertionError, match="outside"):
        assert_legible(beyond)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=30), st.floats(0.5, 20))
def test_labels_do_not_overlap(places: list[float], spacing: float) -> None:
    places = sorted(places)
    groups = grouped(places, spacing)
    assert [i for group in groups for i in group] == list(range(len(places)))
    middles = [np.mean([places[i] for i in group]) for group in groups]
    assert all(b - a > 0 for a, b in pairwise(middles))


@given(st.text("abcdef ghij", min_size=1, max_size=80), st.floats(60, 400))
def test_text_is_broken_and_shortened_to_its_room(text: str, room: float) -> None:
    lines = broken(text, room, 11)
    assert " ".join(lines).split() == text.split()
    assert all(text_width(line, 11) <= room or " " not in line for line in lines)
    assert text_width(shortened(text, room, 11), 11) <= room


@pytest.mark.long
@given(st.floats(20, 400))
def test_a_number_and_its_unit_stay_on_one_line(room: float) -> None:
    text = "Mass of the sensor 12.5 g (11.9 to 13.1), density 998 kg/m^3 at 3 %, modes 3 5 7"
    ends = [line.rsplit(" ", 1)[-1] for line in broken(text, room, 11)]
    assert not {"12.5", "998", "3"} & set(ends[:-2])
    assert not any(line.startswith(("g ", "kg/m", "%")) for line in broken(text, room, 11))


def test_files_are_whole_and_nothing_else_is_left(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "figures"
    figure = mac_figure(np.eye(2), ["1", "2"], ["1", "2"])
    files = save_figures({"mac": figure, "again": figure}, folder)
    assert files == [folder / "mac.png", folder / "again.png"]
    assert sorted(p.name for p in folder.iterdir()) == ["again.png", "mac.png"]
    assert all(
        p.read_bytes().startswith(b"\x89PNG") and p.read_bytes().endswith(b"IEND\xaeB`\x82") for p in files
    )


def test_files_that_cannot_be_written(tmp_path: Path) -> None:
    figure = mac_figure(np.eye(2), ["1", "2"], ["1", "2"])
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(InputError, match="give another folder"):
        save_figures({"mac": figure}, blocked)
    with pytest.raises(InputError, match="plain file name"):
        save_figures({"../mac": figure}, tmp_path)
