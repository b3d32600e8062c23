"""Decks: what is read, kept and refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import IO

import numpy as np
import pytest
from deck_cases import Bricks, bar, by_ccx, frequencies, needs_ccx, written

from acquisition.errors import StudyError
from updating.models.imported.decks import cache as deck_cache
from updating.models.imported.decks import deck_matrices, program, read_deck_model
from updating.models.imported.decks.cards import read_cards
from updating.models.imported.of_deck import imported as made_of


@needs_ccx
def test_what_was_made_is_kept_and_the_deck_stays(
    bricks: Bricks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A second reading runs nothing; a changed included file, or a damaged file of the cache, runs again."""
    monkeypatch.setenv(deck_cache.VARIABLE, str(tmp_path / "kept"))
    lines = bar(bricks)
    cut = next(i for i, line in enumerate(lines) if line.startswith("*MATERIAL"))
    written(tmp_path, lines[cut : cut + 5], "steel.inp")
    path = written(tmp_path, [*lines[:cut], "*INCLUDE, INPUT=steel.inp", *lines[cut + 5 :]])
    before = path.read_bytes()
    ran = []
    own = program.run
    monkeypatch.setattr(program, "run", lambda *stated: (ran.append(1), own(*stated))[1])
    first = made_of(read_deck_model(path))
    assert len(ran) == 3
    again = made_of(read_deck_model(path))
    assert len(ran) == 3
    assert abs(first.stiffness - again.stiffness).max() == 0
    assert path.read_bytes() == before
    text = (tmp_path / "steel.inp").read_text()
    (tmp_path / "steel.inp").write_text(text.replace("210000.", "200000."))
    softer = read_deck_model(path).base
    assert len(ran) == 4
    assert softer.stiffness.max() < first.stiffness.max()
    for file in (tmp_path / "kept").glob("*.npz"):
        file.write_bytes(file.read_bytes()[:100])
    read_deck_model(path).base  # noqa: B018
    assert len(ran) == 5


def test_the_folder_of_what_is_kept_stays_small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(deck_cache.VARIABLE, str(tmp_path))
    monkeypatch.setattr(deck_cache, "MOST", 25e3)
    for i in range(5):
        deck_cache.kept(f"{i}", lambda: {"a": np.zeros(1000)})
    assert len(list(tmp_path.glob("*.npz"))) == 3
    assert not list(tmp_path.glob("*.part"))
    monkeypatch.setenv(deck_cache.VARIABLE, "")
    assert deck_cache.cache_folder() is None


def test_supports_of_steps_stay_and_nothing_else_of_them(tmp_path: Path) -> None:
    lines = ["*NODE", "1, 0, 0, 0", "*STEP", "*FREQUENCY", "5", "*BOUNDARY, OP=NEW", "1, 1, 3"]
    lines += ["*BOUNDARY, BASE MOTION=1", "1, 1", "*NODE FILE", "U", "*END STEP"]
    assert [card.head for card in read_cards(written(tmp_path, lines))] == ["*NODE", "*BOUNDARY"]


def in_files(folder: Path, lines: list[str]) -> Path:
    """Write a deck whose every card has its last lines, or all of them, in files of their own."""
    heads = [i for i, line in enumerate(lines) if line.startswith("*")]
    written_out = []
    for number, (start, end) in enumerate(zip(heads, [*heads[1:], len(lines)], strict=True)):
        kept = start + 1 + (number % 2 if end - start > 2 else 0)
        written_out += lines[start:kept]
        if kept < end:
            written(folder, lines[kept : end - 1] or lines[kept:end], f"{number}.txt")
            written_out += [
                f"*INCLUDE, INPUT={number}.txt",
                *(lines[end - 1 : end] if end - kept > 1 else []),
            ]
    return written(folder, written_out, "files.inp")


@needs_ccx
def test_a_file_may_hold_data_of_the_card_before_it(bricks: Bricks, tmp_path: Path) -> None:
    """CalculiX puts the text of the file in the place of its *INCLUDE: the same supports, rows and frequencies."""
    lines = bar(bricks)
    whole, files = read_deck_model(written(tmp_path, lines)), read_deck_model(in_files(tmp_path, lines))
    assert [(one.head, one.lines) for one in files.cards] == [(one.head, one.lines) for one in whole.cards]
    assert files.nodes.held == whole.nodes.held
    assert files.nodes.sets == whole.nodes.sets
    found = frequencies(made_of(files, divided=False), 6)
    assert found == pytest.approx(by_ccx(tmp_path, files.path.read_text().splitlines(), 6), rel=1e-6)


def test_what_cannot_be_kept_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk, say: what was made is there all the same."""

    def full(file: IO[bytes], **_: object) -> None:
        file.write(b"half")
        raise OSError("no space left on device")

    monkeypatch.setenv(deck_cache.VARIABLE, str(tmp_path))
    monkeypatch.setattr(np, "savez", full)
    assert deck_cache.kept("a", lambda: {"a": np.ones(3)})["a"].tolist() == [1, 1, 1]
    assert list(tmp_path.iterdir()) == []


@needs_ccx
def test_arrays_of_another_version_are_not_read(
    bricks: Bricks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(deck_cache.VARIABLE, str(tmp_path / "kept"))
    path = written(tmp_path, bar(bricks))
    read_deck_model(path).base  # noqa: B018
    monkeypatch.setattr(program, "ARRAYS", "arrays of another kind")
    read_deck_model(path).base  # noqa: B018
    assert len(list((tmp_path / "kept").glob("*.npz"))) == 2


REFUSED: dict[str, tuple[Callable[[list[str]], list[str]], list[tuple[str, str]], str]] = {
    "no such set": (list, [("rib", "RIB")], r"'rib': no element set or material RIB in .*; element sets: ROOT, TIP;"),
    "overlap": (list, [("a", "ROOT"), ("b", "STEEL")], r"'b' and 'a' share element 1 \(20 in all\)"),
    "no material": (
        lambda deck: [line.replace("TIP, MATERIAL=STEEL", "TIP, MATERIAL=STELE") for line in deck], [],
        r"no \*MATERIAL STELE",
    ),
    "no section": (lambda deck: [x for x in deck if "SECTION" not in x], [], "no section gives an element"),
    "layers": (
        lambda deck: [x.replace("SOLID SECTION, ELSET=TIP, MATERIAL=STEEL", "SHELL SECTION, ELSET=TIP, COMPOSITE")
                      for x in deck], [], "several layers",
    ),
    "unknown elements": (
        lambda deck: [*deck, "*ELEMENT, TYPE=U1, ELSET=X", "999, 1, 2"], [], "type U1 are not supported"
    ),
    "flat": (lambda deck: ["*PART, NAME=A", *deck], [], r"\*PART is not supported"),
    "no such node": (
        lambda deck: [*deck, "*ELEMENT, TYPE=C3D4, ELSET=X", "999, 1, 2, 3, 77777"], [],
        r"part\.inp: element 999 has node 77777, which is in no \*NODE card",
    ),
    "broken element": (
        lambda deck: [*deck, "*ELEMENT, TYPE=C3D8, ELSET=X", "999, 1, 2"], [], "3 words are not elements of 8 nodes"
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_refused_before_anything_runs(case: str, bricks: Bricks, tmp_path: Path) -> None:
    change, regions, message = REFUSED[case]
    with pytest.raises(StudyError, match=message):
        read_deck_model(written(tmp_path, change(bar(bricks))), regions)


@needs_ccx
def test_a_deck_that_does_not_solve_says_what_ccx_says(bricks: Bricks, tmp_path: Path) -> None:
    lines = [line for line in bar(bricks) if line not in ("*DENSITY", "7.85e-9")]
    with pytest.raises(
        StudyError, match=r"part\.inp: ccx does not solve this deck: \*ERROR.*density"
    ) as caught:
        read_deck_model(written(tmp_path, lines)).base  # noqa: B018
    assert "\n" not in str(caught.value)


def test_without_ccx_the_error_says_how_to_get_it(
    bricks: Bricks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(StudyError, match=r"needs the program ccx, and there is none; .*calculix-ccx"):
        made_of(read_deck_model(written(tmp_path, bar(bricks))))


@needs_ccx
def test_numbers_that_are_not_there(bricks: Bricks, tmp_path: Path) -> None:
    model = read_deck_model(written(tmp_path, bar(bricks)), units="mm-t-s")
    for name, message in {
        "TIP.thickness": "it has no thickness to change",
        "FOOT.stiffness": r"no \*SPRING, ELSET=FOOT in .*; there are: none",
        "FACE.x": "no node set FACE; there are: ALL, CLAMP, END",
        "ALL.x": "the set contains every node",
        "RIB.thickness": "no element set RIB",
    }.items():
        with pytest.raises(StudyError, match=message):
            model.parameter(name)
    assert model.parameter("TIP.colour") is None
    other = written(tmp_path, bar(bricks, kind="C3D8"), "coarse.inp")
    with pytest.raises(StudyError, match=r"its matrices \(270 rows\) and those of .* \(900 rows\)"):
        deck_matrices(other, model)
