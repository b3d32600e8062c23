"""Frames of bars with light, massless and rounded rows, against condensation of the exact matrices (Guyan)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import Frame, chain, frame, line
from hypothesis import given, settings
from hypothesis import strategies as st
from imported_cases import spec_of

from acquisition.errors import StudyError
from updating.models import build_structure
from updating.models.fields import Sparse
from updating.models.imported import read_imported
from updating.models.imported.rounding import decimal_rounding
from updating.models.imported_structure import ImportedStructure
from updating.models.reduction import reduce_structure
from updating.models.state import NOMINAL

TEE = line(5, [0, 0.6, 0]) + [[1.2 * i, 1.2 + 0.24 * i, 0.0] for i in range(1, 4)]
"""Two bars that meet in a T, eight nodes."""

JOINED = [*chain(5), (2, 5), (5, 6), (6, 7)]
SKEW = line(9, [0.03, 0.06, 0.09])

GUYAN = 2e-5
"""By how much the masses that stand in for none move a frequency [-]."""


def structure_of(given: Frame) -> ImportedStructure:
    found = build_structure(spec_of(given.imported()))
    assert isinstance(found, ImportedStructure)
    return found


def elastic(given: Frame, count: int = 5) -> np.ndarray:
    """Return elastic frequencies on the reduced basis, without test points, [Hz]."""
    structure = structure_of(given)
    reduced = reduce_structure(structure, np.zeros((0, 3)), np.zeros((0, 3)))
    first = structure.rigid_modes
    return np.asarray(np.sqrt(reduced.eigen(NOMINAL)[0][first : first + count]) / (2 * np.pi))


def test_entries_next_to_zero_leave_the_digits_of_all_others() -> None:
    """1e-310 times the power of ten that makes it a whole number is not a number."""
    numbers = np.array([1.2345, 6.7891, 2.3457, 9.8763, 1e-310])
    assert decimal_rounding(Sparse(np.diag(numbers))) == 0.5e-4


@pytest.mark.parametrize("aside", [0.0, 1e-4])
@pytest.mark.parametrize("inertia", [0.0, 1e-14, 1e-12, 1e-10])
def test_twist_without_or_next_to_no_inertia_leaves_low_modes_exact(inertia: float, aside: float) -> None:
    places = [[aside, 0.0, 0.0], *TEE[1:]]
    given = frame(places, JOINED, inertia=inertia)
    assert structure_of(given).rigid_modes == 6
    assert elastic(given) == pytest.approx(given.frequencies(11)[6:], rel=GUYAN)


@pytest.mark.parametrize("masses", range(1, 8))
def test_a_held_stick_of_few_masses_keeps_its_lowest_modes(masses: int) -> None:
    given = frame(line(masses + 1, [1.0, 0, 0]), chain(masses + 1), held=[0], motions=(2, 4))
    assert structure_of(given).rigid_modes == 0
    assert elastic(given, masses) == pytest.approx(given.frequencies(masses), rel=GUYAN)


def test_a_free_bar_without_rotary_inertia_has_five_rigid_modes() -> None:
    """Spinning about its axis has neither stiffness nor mass: no mode at all."""
    given = frame(SKEW, chain(9))
    assert structure_of(given).rigid_modes == 5
    assert elastic(given) == pytest.approx(given.frequencies(10)[5:], rel=GUYAN)


@pytest.mark.parametrize("digits", [10, 17])
def test_a_pinned_bar_that_may_spin_has_no_mode_of_that(digits: int) -> None:
    exact = frame(SKEW, chain(9), pinned=[0, 8])
    given = exact.rounded(digits)
    assert structure_of(given).rigid_modes == 0
    assert elastic(given) == pytest.approx(exact.frequencies(5), rel=GUYAN)


def test_ten_digits_of_a_stiff_offset_do_not_move_the_first_mode() -> None:
    exact = frame(TEE, JOINED, inertia=0.01, seed=3, stiffer={4: 1e5})
    given = exact.rounded(10)
    assert given.frequencies(7)[6] != pytest.approx(exact.frequencies(7)[6], rel=3e-5)
    assert structure_of(given).rigid_modes == 6
    assert elastic(given) == pytest.approx(exact.frequencies(11)[6:], rel=1e-8)


@pytest.mark.long
@settings(max_examples=15)
@given(
    seed=st.integers(0, 2**31),
    digits=st.integers(6, 16),
    held=st.sampled_from([(), (0,), (0, 7)]),
    inertia=st.sampled_from([0.0, 1e-12, 0.01]),
)
def test_digits_of_the_file_change_no_count_of_rigid_modes(
    seed: int, digits: int, held: tuple[int, ...], inertia: float
) -> None:
    exact = frame(TEE, JOINED, held=held, inertia=inertia, seed=seed)
    first = 0 if held else 6
    given = exact.rounded(digits)
    assert structure_of(given).rigid_modes == first
    # the digits of a free structure are corrected; what they make of a held one is its model
    expected = (given if held else exact).frequencies(first + 3)[first:]
    assert elastic(given, 3) == pytest.approx(expected, rel=max(GUYAN, 1e3 * 10.0**-digits))


@settings(max_examples=15)
@given(
    seed=st.integers(0, 2**31),
    held=st.sampled_from([(), (0,)]),
    inertia=st.sampled_from([0.0, 1e-12, 0.01]),
    powers=st.lists(st.integers(-3, 3), min_size=48, max_size=48),
)
def test_order_and_units_of_rows_do_not_matter(
    seed: int, held: tuple[int, ...], inertia: float, powers: list[int]
) -> None:
    """Rows in other units are known by no place: motions are counted from the matrices alone."""
    exact = frame(TEE, JOINED, held=held, inertia=inertia, seed=seed)
    rows, first = len(exact.rows), 0 if held else 6
    order = np.random.default_rng(seed).permutation(rows)
    given = exact.on(10.0 ** np.array(powers[:rows]), order)
    structure = structure_of(given)
    assert structure.rigid_modes == first
    found = np.sqrt(structure.eigen(first + 3)[0][first:]) / (2 * np.pi)
    assert found == pytest.approx(exact.frequencies(first + 3)[first:], rel=GUYAN)


def test_two_bodies_that_are_not_joined_are_named() -> None:
    with pytest.raises(StudyError, match="more than six motions have no stiffness"):
        _ = structure_of(frame(TEE, [bar for bar in JOINED if bar != (2, 5)], inertia=0.01)).rigid_modes


@pytest.mark.parametrize("digits", [6, 8, 10, 12])
def test_the_digits_of_a_matrix_are_known_from_its_entries(digits: int) -> None:
    exact = frame(TEE, JOINED, seed=1)
    assert exact.rounded(digits).imported().decimal == pytest.approx(0.5 * 10.0 ** (1 - digits))
    assert exact.imported().decimal == 0.0


def test_numbers_as_they_are_written_by_hand_are_exact() -> None:
    given = frame(line(5, [1.0, 0, 0]), chain(5), held=[0], motions=(2, 4)).imported()
    assert decimal_rounding(given.stiffness) == 0.0


def punched(path: Path, given: Frame, *, tail: str = "") -> Path:
    """Write stiffness and mass as Nastran punches them, in ten digits."""
    lines = []
    node, direction = np.divmod(given.rows, 6)
    for name, matrix in (("KAAX", given.stiffness), ("MAAX", given.mass)):
        lines.append(f"DMIG    {name:<8}       0       6       2       0                {len(matrix):8d}")
        for column in range(len(matrix)):
            lines.append(f"DMIG*   {name:<16}{node[column] + 1:16d}{direction[column] + 1:16d}")
            lines += [
                f"*       {node[row] + 1:16d}{direction[row] + 1:16d}{matrix[row, column]:16.9E}"
                for row in range(column + 1)
                if matrix[row, column]
            ]
    path.write_text("\n".join(lines) + "\n" + tail)
    return path


def test_a_rectangular_matrix_beside_the_mass_is_no_mass(tmp_path: Path) -> None:
    given = frame(TEE, JOINED, inertia=0.01, seed=5)
    nodes = tmp_path / "nodes.csv"
    nodes.write_text(
        "node,x,y,z\n" + "".join(f"{i + 1},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(TEE))
    )
    tail = (
        "DMIG    MUG1T          0       9       2       0                      12\n"
        f"DMIG*   MUG1T   {1:24d}{0:16d}\n*       {1:16d}{1:16d}{1.5:16.9E}\n"
    )
    path = punched(tmp_path / "m.pch", given, tail=tail)
    structure = build_structure(spec_of(read_imported(path, path, nodes)))
    found = np.sqrt(structure.eigen(9)[0][6:]) / (2 * np.pi)
    assert structure.rigid_modes == 6
    assert found == pytest.approx(given.frequencies(9)[6:], rel=GUYAN)
