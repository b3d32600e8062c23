"""Decks as models: parts, parameters and errors, against CalculiX's own frequencies, closed forms and other decks."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import IO

import numpy as np
import pytest
from scipy import sparse

from acquisition import ModalData
from acquisition.errors import StudyError
from updating import Axes, Case, Material, Spec, Tolerances, build_structure, measured_from_modes
from updating.models import Region
from updating.models.base import Structure
from updating.models.decks import cache as deck_cache
from updating.models.decks import deck_matrices, parameter_matrices, program, read_deck_model
from updating.models.decks import imported as made_of
from updating.models.decks.cards import read_cards
from updating.models.decks.model import DeckModel
from updating.models.decks.states import deck_answers, deck_state
from updating.models.fields import Sparse
from updating.models.imported import Imported
from updating.models.reduction import reduce_structure
from updating.models.state import State
from updating.models.whole import Whole
from updating.update import update
from updating.update.parameters.basis import extended

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")

Bricks = Callable[..., list[str]]


@pytest.fixture(scope="module")
def bricks(example_of: Callable[[Path, str], ModuleType]) -> Bricks:
    made: Bricks = example_of(EXAMPLES / "deck", "bricks").brick_deck
    return made


@pytest.fixture(scope="module")
def shells(example_of: Callable[[Path, str], ModuleType]) -> ModuleType:
    return example_of(EXAMPLES / "calculix", "mesh")


def bar(bricks: Bricks, *more: str, length: float = 200.0, steps: int = 10, kind: str = "C3D20") -> list[str]:
    """Return a bar of 20 x 10 mm along x, in mm, t and s, one half ROOT and one TIP, held at x = 0."""
    lines = (np.linspace(0, length, steps + 1).tolist(), [0.0, 10.0, 20.0], [0.0, 5.0, 10.0])
    sets = {"CLAMP": lambda x, y, z: x == 0, "END": lambda x, y, z: x == length}
    deck = bricks(lines, lambda x, y, z: "ROOT" if x < length / 2 else "TIP", sets, kind)
    deck += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.", "*DENSITY", "7.85e-9"]
    deck += [f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL" for name in ("ROOT", "TIP")]
    return [*deck, *more, "*BOUNDARY", "CLAMP, 1, 3"]


def written(folder: Path, lines: list[str], name: str = "part.inp") -> Path:
    (folder / name).write_text("\n".join(lines) + "\n", encoding="latin-1")
    return folder / name


def frequencies(imported: Imported, count: int) -> np.ndarray:
    spec = Spec("matrices", 1, 1, 1, (), (), "imported", Material(1, 1), imported=imported)
    return np.sqrt(build_structure(spec).eigen(count)[0]) / (2 * np.pi)


def by_ccx(folder: Path, lines: list[str], count: int) -> list[float]:
    """Return the frequencies that CalculiX itself finds [Hz]."""
    written(folder, [*lines, "*STEP", "*FREQUENCY", str(count), "*END STEP"], "modes.inp")
    subprocess.run(["ccx", "modes"], cwd=folder, check=True, capture_output=True)
    rows = (folder / "modes.dat").read_text().split("P A R T I C", maxsplit=1)[0].splitlines()
    return [float(r.split()[3]) for r in rows if len(r.split()) == 5 and r.split()[0].isdigit()]


def largest_difference(one: Sparse, other: Sparse) -> float:
    """Return the largest difference of two matrices, relative to their diagonals [-]."""
    scale = sparse.diags_array(1 / np.sqrt(np.abs(one.diagonal())))
    return float(abs(scale @ (one - other) @ scale).max())


@pytest.mark.long
@needs_ccx
def test_a_solid_is_what_ccx_finds_and_what_a_bar_does(bricks: Bricks, tmp_path: Path) -> None:
    """To 1e-6 of CalculiX's seven digits; along the bar, c / 4 L and three times that, on the nose."""
    lines = bar(bricks)
    found = frequencies(made_of(read_deck_model(written(tmp_path, lines), units="mm-t-s")), 12)
    assert found == pytest.approx(by_ccx(tmp_path, lines, 12), rel=1e-6)
    along = np.sqrt(210e9 / 7850) / (4 * 0.2)
    assert np.abs(found / along - 1).min() < 1e-4


@pytest.mark.long
@needs_ccx
def test_a_slender_cantilever_bends_as_the_closed_form_says(bricks: Bricks, tmp_path: Path) -> None:
    """1 m by 20 x 10 mm: shear and rotary inertia take 1e-4 or less from the first mode each way."""
    found = frequencies(
        made_of(read_deck_model(written(tmp_path, bar(bricks, length=1000.0, steps=40)), units="mm-t-s")), 2
    )
    for value, height in zip(found, (0.010, 0.020), strict=True):
        bending = 1.8751040687**2 / (2 * np.pi) * np.sqrt(210e9 * height**2 / 12 / 7850)
        assert value == pytest.approx(bending, rel=1e-3)


@needs_ccx
def test_parts_are_the_whole_and_each_of_its_own_elements(bricks: Bricks, tmp_path: Path) -> None:
    """Also of a set that no section names, and where a later section takes elements from an earlier one."""
    more = ["*ELSET, ELSET=MIDDLE", *(f"{i}," for i in (17, 18, 19, 20, 21, 22, 23, 24))]
    more += ["*MATERIAL, NAME=ALU", "*ELASTIC", "70000., 0.3", "*DENSITY", "2.7e-9"]
    more += ["*SOLID SECTION, ELSET=MIDDLE, MATERIAL=ALU"]
    model = read_deck_model(written(tmp_path, bar(bricks, *more)), [("waist", "MIDDLE")], units="mm-t-s")
    assert [(r.name, len(r.elements), r.materials) for r in model.division.regions] == [
        ("waist", 8, ("ALU",)), ("ROOT", 16, ("STEEL",)), ("TIP", 16, ("STEEL",))
    ]  # fmt: skip
    imported = made_of(model)
    assert (imported.rest["stiffness"], imported.rest["mass"]) == (None, None)
    low, high = imported.box(0) or (np.zeros(3), np.zeros(3))
    assert (low[0], high[0]) == pytest.approx((0.08, 0.12))
    ones = np.zeros(imported.order)
    ones[imported.nodes.row[(imported.nodes.direction == 2) & (imported.nodes.row >= 0)]] = 1.0
    assert ones @ imported.mass_parts[0] @ ones == pytest.approx(0.04 * 0.02 * 0.01 * 2700)
    assert model.division.made_of("steel") == (1, 2)


def plate(shells: ModuleType, thickness: float, fold: bool) -> list[str]:
    """Return a strip of shells, 100 x 40 mm, flat or with its second half standing up."""

    def place(u: float, v: float) -> tuple[float, float, float]:
        x, y = 0.1 * u, 0.04 * v
        return (x, y, 0.0) if not fold or u <= 0.5 else (0.05, y, x - 0.05)

    def region(u: float, v: float) -> str:
        return "FOOT" if u < 0.5 else "WALL"

    steel = (210e9, 0.3, 7850.0)
    lines: list[str] = shells.shell_deck((8, 4), place, region, {"FOOT": steel, "WALL": steel}, 0.003)
    at = next(i for i, line in enumerate(lines) if line.startswith("*SHELL SECTION, ELSET=WALL"))
    lines[at + 1] = f"{thickness}"
    return lines


@needs_ccx
@pytest.mark.parametrize("fold", [False, True])
@pytest.mark.parametrize("factor", [0.7, 1.1])
def test_thickness_between_the_runs_is_that_of_a_run(
    shells: ModuleType, tmp_path: Path, fold: bool, factor: float
) -> None:
    """Five runs give the matrices of any other thickness: the powers -1 to 3 are all there are."""
    base = 0.003 if fold else 0.0031
    model = read_deck_model(written(tmp_path, plate(shells, base, fold)))
    parameter = model.parameter("WALL.thickness")
    assert parameter is not None
    assert (parameter.nominal, parameter.unit) == (base, "m")
    runs = [model.matrices({parameter: value}) for value in parameter.samples]
    shares = parameter.weights(factor)
    other = read_deck_model(written(tmp_path, plate(shells, base * factor, fold), "other.inp"))
    for kind in (0, 1):
        made = sum((s * run[kind] for s, run in zip(shares, runs, strict=True)), 0 * runs[0][kind])
        assert largest_difference(deck_matrices(other.path, model)[kind], made) < 1e-9
        assert (
            largest_difference(parameter_matrices(model, "WALL.thickness", base * factor)[kind], made) < 1e-9
        )


@needs_ccx
def test_shells_that_begin_to_differ_are_joined_otherwise(shells: ModuleType, tmp_path: Path) -> None:
    model = read_deck_model(written(tmp_path, plate(shells, 0.003, fold=False)))
    parameter = model.parameter("WALL.thickness")
    assert parameter is not None
    with pytest.raises(
        StudyError, match=r"WALL\.thickness = 0\.0018 m, ccx eliminates other .* by a thousandth"
    ):
        model.matrices({parameter: 0.6})


@needs_ccx
def test_springs_and_masses_are_linear_and_in_si(bricks: Bricks, tmp_path: Path) -> None:
    """A spring of 50 N/mm at a node of the end, a mass of 10 g: what they add stands at their rows."""
    more = ["*ELEMENT, TYPE=SPRING1, ELSET=FOOT", "900, 200", "*SPRING, ELSET=FOOT", "3", "50."]
    more += ["*ELEMENT, TYPE=MASS, ELSET=BOLT", "901, 200", "*MASS, ELSET=BOLT", "1e-5"]
    model = read_deck_model(written(tmp_path, bar(bricks, *more)), units="mm-t-s")
    spring, mass = model.parameter("FOOT.stiffness"), model.parameter("bolt.mass")
    assert spring is not None
    assert mass is not None
    assert (spring.nominal, mass.nominal) == pytest.approx((50e3, 0.01))
    stiffer, _ = model.change({spring: 3.0})
    assert abs(stiffer).max() == pytest.approx(2 * 50e3, rel=1e-4)
    assert abs(stiffer).sum() == pytest.approx(2 * 50e3, rel=1e-2)
    _, heavier = model.change({mass: 3.0})
    assert heavier.diagonal().sum() == pytest.approx(3 * 2 * 0.01, rel=1e-6)


@needs_ccx
def test_a_longer_bar_is_a_node_set_moved(bricks: Bricks, tmp_path: Path) -> None:
    """The end moved by 4 mm: along it c / 4 (L + s), and middle nodes follow, between runs as well as in one."""
    model = read_deck_model(written(tmp_path, bar(bricks)), units="mm-t-s")
    end = model.parameter("END.x")
    assert end is not None
    assert (end.low, end.high) == pytest.approx((-6e-3, 6e-3))
    stiffness, mass = model.matrices({end: 4e-3})
    moved = Imported(stiffness, mass, made_of(model, divided=False).nodes)
    along = np.sqrt(210e9 / 7850) / (4 * 0.204)
    assert np.abs(frequencies(moved, 12) / along - 1).min() < 1e-4
    runs = [model.matrices({end: value}) for value in end.samples]
    shares = end.weights(4e-3)
    made = sum((s * run[0] for s, run in zip(shares, runs, strict=True)), 0 * stiffness)
    assert largest_difference(stiffness, made) < 1e-4


def halves(
    bricks: Bricks, head: str, shift: float, moduli: Sequence[float], densities: Sequence[float]
) -> list[str]:
    """Return a bar of two materials, in mm, the nodes of a set on its top moved along z."""
    lines = (np.linspace(0, 200, 11).tolist(), [0.0, 10.0, 20.0], [0.0, 5.0, 10.0])
    sets = {
        "CLAMP": lambda x, y, z: x == 0,
        "TOP": lambda x, y, z: z == 10 and 70 < x < 130,
        "RIGHT": lambda x, y, z: z == 10 and x > 110,
    }
    deck = bricks(lines, lambda x, y, z: "ROOT" if x < 100 else "TIP", sets, "C3D8I")
    for i in range(1, next(i for i, line in enumerate(deck) if line.startswith("*ELEMENT"))):
        number, x, y, z = (float(word) for word in deck[i].split(","))
        if sets[head](x, y, z):
            deck[i] = f"{number:.0f}, {x}, {y}, {z + 1e3 * shift:.12g}"
    for name, modulus, density in zip(("ROOT", "TIP"), moduli, densities, strict=True):
        deck += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{modulus * 210000.0:.9g}, 0.3"]
        deck += ["*DENSITY", f"{density * 7.85e-9:.9g}", f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
    return [*deck, "*BOUNDARY", "CLAMP, 1, 3"]


def structure_of(model: DeckModel) -> Structure:
    """Return the structure of a deck with its regions."""
    regions = tuple(Region(r.name, (0.0, 0.2)) for r in model.division.regions)
    return build_structure(
        Spec("matrices", 1, 1, 1, (), (), "imported", Material(1, 1), regions, imported=made_of(model))
    )


BESIDE = {
    "all of the deck": ("TOP", (0.5, 0.5), (0.8, 0.8)),
    "the region it lies in": ("RIGHT", (1.0, 0.5), (1.0, 0.8)),
    "one of the two it reaches": ("TOP", (1.0, 0.5), (1.0, 0.8)),
    "both, each by itself": ("TOP", (1.5, 0.6), (0.9, 1.2)),
}


@needs_ccx
@pytest.mark.parametrize("case", BESIDE)
def test_a_move_of_nodes_has_modulus_and_density_of_what_it_changes(
    case: str, bricks: Bricks, tmp_path: Path
) -> None:
    """Against CalculiX's matrices and frequencies of a deck with moved nodes and other materials."""
    head, moduli, densities = BESIDE[case]
    model = read_deck_model(written(tmp_path, halves(bricks, head, 0.0, (1, 1), (1, 1))), units="mm-t-s")
    number = model.parameter(f"{head}.z")
    assert number is not None
    shift = number.samples[3]
    true = halves(bricks, head, shift, moduli, densities)
    wanted = deck_matrices(written(tmp_path, true, "true.inp"), model)
    small = reduce_structure(structure_of(model), np.array([[0.2, 0.01, 0.005]]), np.array([[0, 0, 1.0]]))
    factors = {"E": moduli, "density": densities}
    beside = State(regional={(i, name): f for name, each in factors.items() for i, f in enumerate(each)})
    for reduced in (small, Whole.of(small)):
        found = reduced.matrices(beside.plus(deck_state(reduced, {number: shift}, beside)))
        for full, own in zip(wanted, found, strict=True):
            assert largest_difference(Sparse(reduced.project(full)), Sparse(own)) < 1e-7
    values, _ = structure_of(model).eigen(4, stiffness=Sparse(found[0]), mass=Sparse(found[1]))
    assert np.sqrt(values) / (2 * np.pi) == pytest.approx(by_ccx(tmp_path, true, 4), rel=2e-6)


@needs_ccx
def test_half_the_modulus_and_a_move_of_nodes_come_back_together(bricks: Bricks, tmp_path: Path) -> None:
    """From frequencies that CalculiX finds: the slope by E holds what the move adds, too, else E is 1 % off."""
    model = read_deck_model(written(tmp_path, halves(bricks, "TOP", 0.0, (1, 1), (1, 1))), units="mm-t-s")
    number = model.parameter("TOP.z")
    assert number is not None
    true = 0.9 * number.high
    found = np.array(by_ccx(tmp_path, halves(bricks, "TOP", true, (0.5, 0.5), (1, 1)), 8))
    spec = replace(structure_of(model).spec, material=Material(210e9, 7850.0))
    test = measured_from_modes(ModalData(found, 1e-4 * found), Axes(), spec)
    result = update(Case("bar", spec, test, None, Tolerances({})), parameters=("E", "TOP.z"))
    values = {p.name: p for p in result.parameters}
    assert values["E"].factor == pytest.approx(0.5, rel=3e-3)
    assert values["TOP.z"].value == pytest.approx(true, rel=0.12)  # coarse bricks, a move of a quarter of one


@needs_ccx
def test_what_a_number_moves_on_a_free_deck_is_no_rigid_motion(bricks: Bricks, tmp_path: Path) -> None:
    """The answers are what the modes become: with them the reduced model finds the moved one's frequencies."""
    deck = halves(bricks, "RIGHT", 0.0, (1, 1), (1, 1))[:-2]
    model = read_deck_model(written(tmp_path, deck), units="mm-t-s")
    number = model.parameter("RIGHT.z")
    assert number is not None
    structure = structure_of(model)
    small = reduce_structure(structure, np.array([[0.2, 0.01, 0.005]]), np.array([[0, 0, 1.0]]), modes=8)
    answers = deck_answers(small, number)
    mass = structure.matrix("mass")
    rigid = structure.eigen(12)[1][:, :6]
    assert np.abs(rigid.T @ (mass @ answers)).max() < 1e-9
    shift = number.samples[-1]
    true = by_ccx(tmp_path, halves(bricks, "RIGHT", shift, (1, 1), (1, 1))[:-2], 12)[6:10]
    off = []
    for reduced in (small, extended(small, answers)):
        values, _ = reduced.eigen(deck_state(reduced, {number: shift}))
        off.append(np.abs(np.sqrt(values[6:10]) / (2 * np.pi) / true - 1).max())
    assert off[1] < 0.1 * off[0]


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
        lambda deck: [*deck, "*ELEMENT, TYPE=U1, ELSET=X", "999, 1, 2"], [], "type U1 are not followed"
    ),
    "flat": (lambda deck: ["*PART, NAME=A", *deck], [], r"\*PART is not followed"),
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
        "ALL.x": "the set holds every node",
        "RIB.thickness": "no element set RIB",
    }.items():
        with pytest.raises(StudyError, match=message):
            model.parameter(name)
    assert model.parameter("TIP.colour") is None
    other = written(tmp_path, bar(bricks, kind="C3D8"), "coarse.inp")
    with pytest.raises(StudyError, match=r"its matrices have 270 rows, those of .* 900,"):
        deck_matrices(other, model)
