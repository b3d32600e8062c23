"""Matrices that name nodes and directions, as Abaqus and Nastran write them: against the matrices they were made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from imported_cases import LENGTH, beam_matrices, beam_table, clamp, spec_of
from labelled_cases import ELEMENTS, abaqus, places, punched
from scipy import linalg

from acquisition.errors import StudyError
from updating.models import build_structure
from updating.models.imported import read_imported
from updating.models.imported.labelled import read_labelled


def exact(clamped: bool) -> np.ndarray:
    matrices = beam_matrices(ELEMENTS)
    k, m = ((clamp(x) if clamped else x).toarray() for x in matrices)
    return np.asarray(linalg.eigvalsh(k, m))


def test_a_clamped_beam_of_abaqus(tmp_path: Path) -> None:
    k, m = beam_matrices(ELEMENTS)
    imported = read_imported(
        abaqus(tmp_path / "job_STIF2.mtx", k, held=(0, 1)), abaqus(tmp_path / "job_MASS2.mtx", m),
        places(tmp_path / "nodes.csv"),
    )  # fmt: skip
    found = build_structure(spec_of(imported)).eigen(6)[0]
    assert found == pytest.approx(exact(clamped=True)[:6], rel=1e-9)
    assert imported.nodes.sets["tip"].tolist() == [70]
    held = imported.nodes.node[imported.nodes.row < 0]
    assert held.tolist() == [10, 10]
    expected = beam_table(ELEMENTS, clamped=True)
    for row in range(12):
        at = imported.nodes.places[imported.nodes.row == row][0]
        assert at == pytest.approx(expected.places[expected.row == row][0])


def test_nodes_of_abaqus_are_those_of_its_deck(tmp_path: Path) -> None:
    k, m = beam_matrices(ELEMENTS)
    cards = [f"{10 * (i + 1)}, {LENGTH * i / ELEMENTS!r}, 0., 0." for i in range(ELEMENTS + 1)]
    (tmp_path / "job.inp").write_text("\n".join(["*NODE", *cards, "*NSET, NSET=END", "70,"]) + "\n")
    imported = read_imported(
        abaqus(tmp_path / "job_STIF2.mtx", k, held=(0, 1)), abaqus(tmp_path / "job_MASS2.mtx", m),
        tmp_path / "job.inp",
    )  # fmt: skip
    assert build_structure(spec_of(imported)).eigen(3)[0] == pytest.approx(exact(clamped=True)[:3], rel=1e-9)
    assert imported.nodes.sets["END"].tolist() == [70]


def test_a_free_beam_of_nastran_with_its_parts(tmp_path: Path) -> None:
    """Both matrices in one file, nine digits; a modal coordinate without a place does not disturb."""
    k, m = beam_matrices(ELEMENTS)
    first, second = beam_matrices(ELEMENTS, 0, 3), beam_matrices(ELEMENTS, 3)
    whole = punched(tmp_path / "se.pch", KAAX=k, MAAX=m)
    parts = [punched(tmp_path / f"{i}.pch", KAAX=a, MAAX=b) for i, (a, b) in enumerate((first, second))]
    imported = read_imported(
        whole, whole, places(tmp_path / "nodes.csv"), stiffness_parts=parts, mass_parts=parts
    )
    structure = build_structure(spec_of(imported))
    assert structure.rigid_modes == 2
    assert structure.eigen(7)[0][2:] == pytest.approx(exact(clamped=False)[2:7], rel=1e-6)
    summed = imported.stiffness_parts[0] + imported.stiffness_parts[1]
    assert abs(summed - imported.stiffness).max() < 1e-7 * abs(imported.stiffness).max()


def test_numbers_that_touch_and_short_exponents_are_read(tmp_path: Path) -> None:
    path = tmp_path / "se.pch"
    path.write_text(
        "DMIG    KAAX           0       6       2       0                       2\n"
        "DMIG*   KAAX                           2               1                \n"
        "*                      2               1 1.866666647D+07\n"
        "*                      2               2-1.866666647D+07\n"
        "*                      2               3-9.27123642-4\n"
    )
    found = read_labelled(path, "stiffness")
    assert found.value.tolist() == [1.866666647e7, -1.866666647e7, -9.27123642e-4]
    assert found.row.tolist() == [[2, 1], [2, 2], [2, 3]]
    assert found.column.tolist() == [[2, 1]] * 3


REFUSED = {
    "no mass": (
        lambda t: t.replace("MAAX", "BAAX"),
        "name begins with M is needed as mass; the file has KAAX, BAAX",
    ),
    "complex": (lambda t: t.replace("       6       2", "       6       4"), "form 6 and type 4; .* real"),
    "rectangular": (lambda t: t.replace("       6       2", "       2       2"), "form 2 and type 2"),
    "a word": (lambda t: t.replace("D+0", "X+0"), "is not a number; punch"),
    "a shifted field": (lambda t: t.replace("*       ", "*   ", 3), "node and direction are|is not a number"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_punched_wrongly_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    change, message = REFUSED[case]
    k, m = beam_matrices(ELEMENTS)
    path = punched(tmp_path / "se.pch", KAAX=k, MAAX=m)
    path.write_text(change(path.read_text()))
    with pytest.raises(StudyError, match=message) as caught:
        read_imported(path, path, places(tmp_path / "nodes.csv"))
    assert "\n" not in str(caught.value)


def test_nodes_of_another_model_are_refused(tmp_path: Path) -> None:
    k, m = beam_matrices(ELEMENTS)
    path = punched(tmp_path / "se.pch", KAAX=k, MAAX=m)
    (tmp_path / "nodes.csv").write_text("node, x, y, z\n1, 0, 0, 0\n")
    with pytest.raises(StudyError, match="has none of the nodes"):
        read_imported(path, path, tmp_path / "nodes.csv")
    with pytest.raises(StudyError, match=r"missing\.pch: no such file"):
        read_imported(tmp_path / "missing.pch", path, tmp_path / "nodes.csv")


LOST = {
    "an entry twice": (lambda lines: [*lines[:4], lines[4], *lines[4:]], "is given twice"),
    "the first column": (lambda lines: [*lines[:3], *lines[4:]], "without a column before it"),
    "the first column run into its header": (
        lambda lines: [*lines[:3], "DMIG                 10               3 1.0D+06", *lines[5:]],
        "line 4: neither the header of a matrix",
    ),
    "another name": (
        lambda lines: [x.replace("DMIG*   KAAX", "DMIG*   KAA1") for x in lines],
        "has no header",
    ),
    "a number too long": (
        lambda lines: [x.replace("0D+0", "000000D+0") for x in lines],
        "more than three fields",
    ),
}


@pytest.mark.parametrize("case", LOST)
def test_a_punch_that_would_lose_entries_is_refused(case: str, tmp_path: Path) -> None:
    change, message = LOST[case]
    k, m = beam_matrices(ELEMENTS)
    path = punched(tmp_path / "se.pch", KAAX=k, MAAX=m)
    path.write_text("\n".join(change(path.read_text().split("\n"))))
    with pytest.raises(StudyError, match=message):
        read_labelled(path, "stiffness")


def test_a_support_between_two_degrees_of_freedom_is_refused(tmp_path: Path) -> None:
    """Its number, 1e36, beside nothing on the diagonal is beyond any ratio."""
    k, m = beam_matrices(ELEMENTS)
    stiffness, mass = abaqus(tmp_path / "k.mtx", k, held=(0, 1)), abaqus(tmp_path / "m.mtx", m)
    stiffness.write_text(stiffness.read_text().replace("10,3, 10,3, 1.0", "10,3, 100,3, 1.0"))
    with pytest.raises(StudyError, match=r"not symmetric: .* 1e\+36"):
        read_imported(stiffness, mass, places(tmp_path / "nodes.csv"))
