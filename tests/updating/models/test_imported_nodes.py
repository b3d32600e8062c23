"""Node tables, decks and ``.dof`` files: where the rows of imported matrices sit."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from acquisition.errors import StudyError
from updating.models.imported import read_deck_table, read_table
from updating.models.imported.calculix import read_dofs
from updating.models.imported.deck import read_deck
from updating.models.imported.nodes import read_places

TABLE = "node, x, y, z, direction, row\n1, 0, 0, 0, 3,\n2, 0.1, 0, 0, 3, {0}\n2, 0.1, 0, 0, 5, {1}\n"


@pytest.mark.parametrize("rows", [(0, 1), (1, 2)])
def test_rows_are_counted_from_one_or_from_a_zero_that_is_there(
    tmp_path: Path, rows: tuple[int, int]
) -> None:
    (tmp_path / "nodes.csv").write_text(TABLE.format(*rows))
    table = read_table(tmp_path / "nodes.csv", 2)
    assert table.row.tolist() == [-1, 0, 1]
    assert table.direction.tolist() == [3, 3, 5]
    assert table.places[2].tolist() == [0.1, 0.0, 0.0]


WRONG_TABLES = [
    ("node,x,y,z,direction,row,3,\n1,0,0,0,3,1\n2,1,0,0,3,2\n", "line end lost"),
    ("node,x,y,z,row\n1,0,0,0,1\n", "no column direction"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,3\n", r"row 3 \(counted from 1\) lies beyond the 2 rows"),
    ("node,x,y,z,direction,row\n1,0,0,0,7,1\n", "direction 7"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1\n2,1,0,0,3,1\n", "belongs to two"),
    ("node,x,y,z,direction,row\n1,0,zero,0,3,1\n", "zero"),
    ("node,x,y,z,direction,row\n1,0,,0,3,1\n", "missing or not finite"),
    ("node,x,y,z,direction,row\n1,0,0,0,,1\n", "line 2: node or direction"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,-1\n", "leave it empty"),
    ("node,x,y,z,direction,row\n", "no line gives a row"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,\n", "no line gives a row"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1.5\n", r"row 1\.5 is not a whole number"),
    ("node,x,y,z,direction,row\n1,0,0,0,3.5,1\n", r"direction 3\.5 is not a whole number"),
    ("node,x,y,z,direction,row\n1.5,0,0,0,3,1\n", r"node 1\.5 is not a whole number"),
    ("node,x,y,z,direction,row\n1,0,0,0,1,1\n1,0.2,0,0,3,2\n", "node 1 stands at two places"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1,7\n2,0,0,0,3,2,7\n", "more values than the header has names"),
    ("node;x;y;z;direction;row\n1;0;0;0;3;1\n", "separated by commas"),
    ("node,x,y,z,direction,row,setz\n1,0,0,0,3,1,tip\n", "column 'setz' is not one of node, x"),
    ("node,x,y,z,direction,row,X\n1,0,0,0,3,1,0\n", "column 'x' .* is given twice"),
    (f"node,x,y,z,direction,row\n{2**53 + 2},0,0,0,3,1\n", "is not a whole number"),
    ("", "not a CSV table"),
]


@pytest.mark.parametrize(("text", "message"), WRONG_TABLES)
def test_a_wrong_node_table_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "nodes.csv").write_text(text)
    with pytest.raises(StudyError, match=message):
        read_table(tmp_path / "nodes.csv", 2)


PLACES = [
    ("node,x,y,z,sts\n1,0,0,0,tip\n", "column 'sts' is not one of"),
    (f"node,x,y,z\n{2**53 + 2},0,0,0\n", "not a number"),
    ("node,x,y,z\n1.5,0,0,0\n", "not a number"),
]


@pytest.mark.parametrize(("text", "message"), PLACES)
def test_wrong_places_of_nodes_are_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "nodes.csv").write_text(text)
    with pytest.raises(StudyError, match=message):
        read_places(tmp_path / "nodes.csv")


def test_an_unnamed_column_without_content_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "nodes.csv").write_text("node,x,y,z,sets,\n1,0,0,0,tip,\n2,1,0,0,,\n")
    found = read_places(tmp_path / "nodes.csv")
    assert list(found.nodes) == [1, 2]
    assert found.sets["tip"].tolist() == [1]


DECK = """** a plate
*HEADING
nonsense
*NODE, NSET=LOWER
1, 0.0, 0.0, 0.0
 2, 1.0D-1, 0.0
*INCLUDE, INPUT=more.inp
*NSET, NSET=Held
LOWER
*BOUNDARY
held, 1, 2
3, 3
"""


def deck(folder: Path, text: str = DECK) -> Path:
    (folder / "job.inp").write_text(text)
    (folder / "more.inp").write_text("*NODE\n3, 0.2, 0.1, 0.05\n*NSET, NSET=ODD, GENERATE\n1, 3, 2\n")
    (folder / "job.dof").write_text("1.3\n2.3\n2.3\n3.1\n3.2\n9.1\n")
    return folder / "job.inp"


def test_a_deck_and_its_dof_file_make_a_node_table(tmp_path: Path) -> None:
    path = deck(tmp_path)
    table = read_deck_table(path, tmp_path / "job.dof", 6)
    moving = table.row >= 0
    assert table.node[moving].tolist() == [1, 2, 2, 3, 3]  # node 9 is one of ccx's own making
    assert table.row[moving].tolist() == [0, 1, 2, 3, 4]
    held = set(zip(table.node[~moving].tolist(), table.direction[~moving].tolist(), strict=True))
    assert held == {(1, 1), (1, 2), (2, 1), (2, 2), (3, 3)}
    assert table.places[table.node == 3][0].tolist() == [0.2, 0.1, 0.05]
    assert table.places[table.node == 2][0].tolist() == [0.1, 0.0, 0.0]


WRONG_DECKS = [
    ("*ELEMENT\n1, 2, 3\n", "no \\*NODE card"),
    (DECK + "*NGEN, NSET=A\n", "line 13.*NGEN"),
    (DECK + "*TRANSFORM, NSET=A\n1, 0, 0, 0, 1, 0\n", "no \\*NSET A"),
    (DECK.replace("*NODE, NSET=LOWER", "*NODE, SYSTEM=C"), "is not supported"),
    (DECK + "nobody, 1\n", "no \\*NSET nobody"),
    (DECK.replace("1, 0.0, 0.0, 0.0", "1, here"), "is not a node line"),
    (DECK.replace("*INCLUDE, INPUT=more.inp", "*INCLUDE, INPUT=less.inp"), "cannot be read"),
    (DECK.replace(" 2, 1.0D-1, 0.0\n", ""), "node 2 is in no"),
]


@pytest.mark.parametrize(("text", "message"), WRONG_DECKS)
def test_a_deck_that_cannot_be_followed_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = deck(tmp_path, text)
    with pytest.raises(StudyError, match=message):
        read_deck_table(path, tmp_path / "job.dof", 6)


def test_supports_along_turned_axes_hold_no_row(tmp_path: Path) -> None:
    """The rows of a node under *TRANSFORM are along x, y, z still; only where all three are held is it at rest."""
    turned = (
        DECK + "*NSET, NSET=TURN\n2, 3\n*TRANSFORM, NSET=TURN\n0, 1, 0, 0, 0, 1\n*BOUNDARY\n2, 1\n3, 1, 3\n"
    )
    path = deck(tmp_path, turned.replace("held, 1, 2", "1, 1, 2"))
    table = read_deck_table(path, tmp_path / "job.dof", 6)
    held = set(zip(table.node[table.row < 0].tolist(), table.direction[table.row < 0].tolist(), strict=True))
    assert held == {(1, 1), (1, 2), (3, 1), (3, 2), (3, 3)}


def test_a_dof_file_of_another_run(tmp_path: Path) -> None:
    path = deck(tmp_path)
    with pytest.raises(StudyError, match="6 degrees of freedom where the matrices have 5"):
        read_deck_table(path, tmp_path / "job.dof", 5)
    (tmp_path / "bad.dof").write_text("1;3\n")
    with pytest.raises(StudyError, match=r"not a list of node.direction"):
        read_dofs(tmp_path / "bad.dof")
    with pytest.raises(StudyError, match=r"beside the .sti"):
        read_dofs(tmp_path / "none.dof")


NODES = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n"

SLIPS = [
    (NODES + "*BOUNDARY\n1,-2000000000,3\n", "first and last direction, 1 to 6"),
    (NODES + "*BOUNDARY\n1, 3, 1\n", "before its first"),
    (NODES + "*BOUNDARY\n1, \u00b2, 3\n", "first and last direction, 1 to 6"),
    (NODES + "*BOUNDARY\n7, 1, 3\n", "node 7 is in no"),
    (NODES + "*NSET, NSET=A, GENERATE\n1, 3, 0\n", "contains no node"),
    (NODES + "*NSET, NSET=A, GEMERATE\n1, 3\n", "is GENERATE meant"),
    (NODES + "*BOUNDRY\n1, 1, 3\n", "is \\*BOUNDARY meant"),
    (NODES + "*BOU", "is \\*BOUNDARY meant"),
    (NODES + "*DARY\n1, 1, 3\n", "\\*DARY is unknown; is \\*BOUNDARY meant"),
    (NODES + "*BOUNDARY,ROOT, 1, 3\n", "is not a card"),
    (NODES + "*NSE 2\n", "is not a card"),
    (NODES + "*BOUNDARY\n*STEP\n*FREQUENCY\n3\n", "BOUNDARY without a line before this"),
    (NODES + "*NSET, NSET=A\n3\n*END STEP\n", "END STEP without a \\*STEP before it"),
    (NODES + "*STEP\n*FREQUENCY\n3\n*END STEP\n1, 1, 3\n", "stands after \\*END STEP"),
    (NODES + "*BOY\n1, 1, 3\n", "is \\*BOUNDARY meant"),
    (NODES + "*NSET, NSET=A, GETE\n1, 3\n", "is GENERATE meant"),
    (NODES + "*NSET, NSET=A, GENOUNDARY\nA, 1, 3\n", "\\*NSET with GENOUNDARY is not supported"),
    (NODES + "*BOUNDARY" + " " * 90 + "x\n1, 1, 3\n", "is \\*BOUNDARY meant"),
    (NODES + "*\n", "is not a card"),
    (NODES + "*NSET, NSET=A\n*STEP\n", "\\*NSET without a line"),
    (NODES + "*BOUNDARY\n1, 1, 3, 0.1\n", "displacement other than zero"),
    (NODES + "2, 1.5, 0, 0\n", "node 2 was defined before at another place"),
    (NODES + "4, 1. 5, 0, 0\n", "is not a node line"),
    (NODES + "4, nan, 0, 0\n", "is not a node line"),
    (NODES + "*INCLUDE, INPUT=job.inp\n" * 8, "line 5: .*job.inp includes itself"),
]


@pytest.mark.parametrize(("text", "message"), SLIPS)
def test_slips_in_a_deck_are_named(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "job.inp").write_text(text)
    with pytest.raises(StudyError, match=message):
        read_deck(tmp_path / "job.inp")


def test_a_deck_costs_no_more_than_its_size(tmp_path: Path) -> None:
    ends = "*BOUNDARY\nA, 1, 3\n" * 200
    (tmp_path / "job.inp").write_text(NODES + "*NSET, NSET=A, GENERATE\n1, 999999999999\n" * 200 + ends)
    tracemalloc.start()
    held = read_deck(tmp_path / "job.inp").held
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()
    assert held == {(node, direction) for node in (1, 2, 3) for direction in (1, 2, 3)}


def test_files_that_include_each_other_twice_end(tmp_path: Path) -> None:
    for k in range(20):
        (tmp_path / f"{k}.inp").write_text(f"*INCLUDE, INPUT={k + 1}.inp\n" * 2)
    (tmp_path / "20.inp").write_text(NODES)
    with pytest.raises(StudyError, match="too many times"):
        read_deck(tmp_path / "0.inp")
