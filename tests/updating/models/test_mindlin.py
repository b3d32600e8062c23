"""Thick plates: exact solutions, published tables, CalculiX, and properties that hold for any plate."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from updating_cases import PLATE, STEEL, blank

from updating import Case, Predictor, Region, Spec, build_structure
from updating.effects import LIBRARY
from updating.models.state import State
from updating.nominal import predictor_of

THICK = replace(PLATE, theory="mindlin")
POINTS = np.array([(x, y) for x in np.linspace(0.05, 0.376, 5) for y in (0.0, 0.07, 0.2)])
ALL = ("x0", "x1", "y0", "y1")

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")


def frequencies(spec: Spec, count: int) -> np.ndarray:
    """Elastic frequencies of the full model [Hz]."""
    structure = build_structure(spec)
    values = structure.eigen(structure.rigid_modes + count)[0][structure.rigid_modes :]
    return np.sqrt(values) / (2 * np.pi)


def supported(spec: Spec, count: int) -> np.ndarray:
    """Frequencies of a plate hinged on all sides: clamps that hold no rotation [Hz]."""
    structure = build_structure(replace(spec, clamped=ALL))
    return np.sqrt(structure.eigen(count, released=frozenset({"rotation"}))[0]) / (2 * np.pi)


def exact_supported(spec: Spec, count: int, *, thin: bool = False) -> np.ndarray:
    """Waves sin(m pi x / a) sin(n pi y / b) of a hinged plate: deflection and turning are two unknowns of each [Hz]."""
    h, nu, rho = spec.thickness, STEEL.poisson, STEEL.density
    rigidity, shear = STEEL.E * h**3 / 12 / (1 - nu**2), 5 / 6 * STEEL.E / (2 * (1 + nu)) * h
    found = []
    for m in range(1, 12):
        for n in range(1, 12):
            k2 = (m * np.pi / spec.length) ** 2 + (n * np.pi / spec.width) ** 2
            if thin:
                found.append(k2 * np.sqrt(rigidity / (rho * h)))
                continue
            stiffness = np.array([[shear * k2, -shear * k2], [-shear * k2, rigidity * k2**2 + shear * k2]])
            mass = np.diag([rho * h, rho * h**3 / 12 * k2])
            found.append(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real.min()))
    return np.sort(found)[:count] / (2 * np.pi)


@pytest.mark.parametrize("thickness", [0.003, 0.01, 0.03])
def test_a_hinged_plate_has_the_frequencies_of_its_differential_equations(thickness: float) -> None:
    """Shear correction 5/6 and rotary inertia included: Mindlin (1951); h / b from 1/67 to 1/7."""
    spec = replace(THICK, thickness=thickness, elements=(16, 10))
    assert supported(spec, 6) == pytest.approx(exact_supported(spec, 6), rel=3e-4)


def test_it_converges_as_the_fourth_power_of_the_mesh() -> None:
    spec = replace(THICK, thickness=0.05)
    true = exact_supported(spec, 5)
    coarse, fine = (supported(replace(spec, elements=n), 5) / true - 1 for n in ((6, 4), (12, 8)))
    assert np.all(fine > -1e-9)
    assert np.all(fine < coarse / 10)
    assert np.all(fine < 5e-4)


def test_twist_dies_out_at_the_edges_of_a_stocky_plate_on_elements_no_wider_than_it_is_thick() -> None:
    """Within h / sqrt(10) of an edge; without narrow elements there it is 0.16 % off."""
    stocky = Spec(
        "plate",
        length=0.25,
        width=0.2,
        thickness=0.03,
        elements=(10, 8),
        clamped=(),
        theory="mindlin",
        material=STEEL,
    )
    finer = frequencies(replace(stocky, elements=(22, 18)), 8)
    assert frequencies(stocky, 8) == pytest.approx(finer, rel=2e-4)


@pytest.mark.parametrize("clamped", [("x0",), ALL, ()])
def test_thin_plates_do_not_lock(clamped: tuple[str, ...]) -> None:
    """h / b = 1/500: on a coarse mesh the frequencies are those of a thin plate but for what shear takes."""
    thin = replace(PLATE, thickness=PLATE.width / 500, clamped=clamped, elements=(8, 6))
    ratio = frequencies(replace(thin, theory="mindlin"), 6) / frequencies(thin, 6)
    assert np.all(ratio < 1 + 1e-9)
    assert np.all(ratio > 1 - 1.5e-3)


@pytest.mark.parametrize(
    ("clamped", "known"), [(("x0",), [0.348, 0.817, 2.036]), (ALL, [3.2954, 6.2858, 6.2858])]
)
def test_square_plates_are_the_published_ones(clamped: tuple[str, ...], known: list[float]) -> None:
    """h / a = 0.1, omega a^2 sqrt(rho h / D) / pi^2: Liew, Xiang and Kitipornchai, Comput. Struct. 49 (1993) 1-29."""
    plate = Spec(
        "plate",
        length=1.0,
        width=1.0,
        thickness=0.1,
        elements=(14, 14),
        clamped=clamped,
        theory="mindlin",
        material=STEEL,
    )
    unit = np.pi / 2 * np.sqrt(STEEL.E * 0.1**3 / 12 / (1 - 0.3**2) / (STEEL.density * 0.1))
    assert frequencies(plate, len(known)) / unit == pytest.approx(known, abs=0.0015)


@pytest.mark.parametrize("clamped", [(), ("x0",), ("x0", "y1"), ("x0", "x1")])
@pytest.mark.parametrize(("scale", "thickness"), [(0.3, 0.002), (4.0, 0.02)])
def test_size_and_direction_do_not_matter(scale: float, thickness: float, clamped: tuple[str, ...]) -> None:
    """A plate twice as large in all directions has half the frequencies; one turned by 90 degrees has the same."""
    spec = replace(THICK, thickness=thickness, clamped=clamped, elements=(6, 5), regions=())
    plain = frequencies(spec, 5)
    size = (scale * spec.length, scale * spec.width, scale * spec.thickness)
    larger = replace(spec, length=size[0], width=size[1], thickness=size[2], regions=())
    assert frequencies(larger, 5) * scale == pytest.approx(plain, rel=1e-5)
    turned = tuple({"x": "y", "y": "x"}[edge[0]] + edge[1] for edge in clamped)
    swapped = replace(spec, length=spec.width, width=spec.length, elements=(5, 6), clamped=turned, regions=())
    assert frequencies(swapped, 5) == pytest.approx(plain, rel=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("factor", ["E", "density", "thickness", "length", "width"])
def test_factors_are_other_plates(factor: str) -> None:
    """A factor on the model gives the frequencies of the plate that has it, but for the narrow edge elements."""
    thick = replace(THICK, thickness=0.01, elements=(12, 8), clamped=("x0",))
    predictor = Predictor(thick, blank(POINTS))
    material = STEEL
    if factor in ("E", "density"):
        other = replace(thick, material=replace(material, **{factor: 1.1 * getattr(material, factor)}))
    else:
        other = replace(thick, **{factor: 1.1 * getattr(thick, factor)})
    found = predictor.predict(State(factors={factor: 1.1}), count=6).frequency
    assert found == pytest.approx(frequencies(other, 6), rel=1e-3)


def test_regions_are_plates_of_their_own() -> None:
    """All regions at once are the whole plate; one of them alone moves less."""
    halves = (
        Region("a", (0.0, 0.188), (0.0, 0.2), E=190e9),
        Region("b", (0.188, 0.376), (0.0, 0.2), E=190e9),
    )
    spec = replace(THICK, elements=(8, 6))
    soft = frequencies(replace(spec, regions=halves), 4)
    whole = replace(spec, material=replace(STEEL, E=190e9))
    assert soft == pytest.approx(frequencies(whole, 4), rel=1e-9)
    one = frequencies(replace(spec, regions=halves[:1]), 4)
    assert np.all((soft < one) & (one < frequencies(spec, 4)))


EFFECTS = {
    "local_stiffness": {"x": 0.15, "y": 0.05, "extent": 0.04, "loss": 0.8},
    "damping_patch": {"x": 0.2, "y": 0.1, "extent": 0.1, "loss_factor": 0.1, "mass": 0.1, "stiffness": 0.1},
    "clamp_rotation": {"stiffness": 4e3},
    "clamp_translation": {"stiffness": 1e7},
    "orthotropy": {"ratio": 1.3},
    "axial_load": {"force": 300.0},
    "lumped_mass": {"mass": 0.05, "x": 0.3, "y": 0.1},
    "fluid_added_mass": {"fluid_density": 998.0},
    "length": {"extension": 0.01},
    "thickness": {"factor": 1.1},
}


@pytest.mark.long
def test_effects_do_to_a_thick_plate_what_they_do_to_a_thin_one() -> None:
    """At h / b = 1/63 shear takes half a per cent, so that shifts agree to some per cent of themselves.

    A thick plate has to resolve a soft place by its own elements.
    """
    found = []
    for theory in ("kirchhoff", "mindlin"):
        predictor = Predictor(replace(PLATE, theory=theory, elements=(32, 24)), blank(POINTS))
        plain = predictor.predict(count=6).frequency
        states = {
            n: LIBRARY[n].state(predictor, LIBRARY[n].settled(predictor, v)) for n, v in EFFECTS.items()
        }
        found.append({n: np.log(predictor.predict(s, count=6).frequency / plain) for n, s in states.items()})
    for name, shift in found[0].items():
        assert found[1][name] == pytest.approx(shift, abs=0.04 * np.abs(shift).max() + 1e-4), name


@pytest.mark.long
def test_the_full_model_has_the_soft_spot_of_the_reduced_one() -> None:
    predictor = Predictor(replace(THICK, elements=(16, 8)), blank(POINTS))
    values = EFFECTS["local_stiffness"]
    reduced = predictor.predict(LIBRARY["local_stiffness"].state(predictor, values), count=6).frequency
    whole = predictor.whole
    stiffness, mass = whole.reduced.matrices(LIBRARY["local_stiffness"].state(whole, values))
    full = predictor.reduced.structure.eigen(6, stiffness=stiffness, mass=mass)[0]
    assert reduced == pytest.approx(np.sqrt(full) / (2 * np.pi), rel=1e-3)


def shell_deck(folder: Path, spec: Spec, elements: tuple[int, int], count: int) -> Path:
    """Write a free plate of eight-node shells with reduced integration, narrow ones along its edges."""
    sides = []
    for size, n in zip((spec.length, spec.width), elements, strict=True):
        rows = np.array([0.4, 1.2]) * spec.thickness
        ends = np.concatenate([[0.0], rows, np.linspace(0, size, n + 1)[1:-1], size - rows[::-1], [size]])
        sides.append(np.insert(ends, np.arange(1, len(ends)), (ends[1:] + ends[:-1]) / 2))
    corners = [(i, j) for j in range(len(sides[1])) for i in range(len(sides[0])) if i % 2 == 0 or j % 2 == 0]
    number = {place: k for k, place in enumerate(corners, start=1)}
    nodes = [f"{k}, {sides[0][i]:.9g}, {sides[1][j]:.9g}, 0." for (i, j), k in number.items()]
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    first = [(i, j) for i, j in number if i % 2 == j % 2 == 0 and (i + 2, j + 2) in number]
    shells = [
        ", ".join(str(n) for n in (cell, *(number[i + a, j + b] for a, b in around)))
        for cell, (i, j) in enumerate(first, start=1)
    ]
    lines = ["*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=S8R, ELSET=PLATE", *shells]
    lines += [
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{STEEL.E}, {STEEL.poisson}",
        "*DENSITY",
        f"{STEEL.density}",
    ]
    lines += ["*SHELL SECTION, ELSET=PLATE, MATERIAL=STEEL", f"{spec.thickness}"]
    lines += ["*STEP", "*FREQUENCY", f"{count}", "*END STEP", ""]
    deck = folder / "plate.inp"
    deck.write_text("\n".join(lines))
    return deck


@needs_ccx
@pytest.mark.slow
def test_calculix_shells_agree(tmp_path: Path) -> None:
    """The plate of `sample_data/plate_dry`, free, of S8R shells, of which ccx makes bricks."""
    spec = replace(THICK, elements=(38, 20), clamped=())
    deck = shell_deck(tmp_path, spec, (60, 32), 16)
    subprocess.run(["ccx", deck.stem], cwd=tmp_path, check=True, capture_output=True, timeout=300)
    table = (tmp_path / "plate.dat").read_text().split("P A R T I C I P A T I O N")[0]
    rows = re.findall(r"^\s+\d+((?:\s+[-\d.E+]+){4})\s*$", table, flags=re.MULTILINE)
    shells = np.array([float(row.split()[2]) for row in rows])
    shells = shells[shells > 1.0][:10]
    own, thin = frequencies(spec, 10), frequencies(replace(spec, theory="kirchhoff"), 10)
    assert own == pytest.approx(shells, rel=7e-4)
    assert np.abs(np.log(own / shells)).mean() < 0.15 * np.abs(np.log(thin / shells)).mean()


@pytest.mark.long
@pytest.mark.parametrize("clamped", [("x0",), ()])
@pytest.mark.parametrize("thickness", [0.003175, 0.012])
def test_a_thin_model_with_what_shear_changes_is_the_thick_one(
    clamped: tuple[str, ...], thickness: float
) -> None:
    """Frequencies and shapes, on the basis of the thin plate, with a clamp that turns as well."""
    spec = replace(PLATE, clamped=clamped, thickness=thickness, elements=(20, 10))
    thin, thick = Predictor(spec, blank(POINTS)), Predictor(replace(spec, theory="mindlin"), blank(POINTS))
    states = [lambda p: State()] + [lambda p: LIBRARY["clamp_rotation"].state(p, {"stiffness": 4e3})] * bool(
        clamped
    )
    for state in states:
        plain, true = (p.predict(state(p), count=7) for p in (thin, thick))
        found = thin.under("mindlin").predict(state(thin), count=7)
        lacking, left = (np.log(p.frequency / true.frequency) for p in (plain, found))
        assert np.all(lacking > 0)
        assert np.abs(left) == pytest.approx(0, abs=0.03 * lacking.max())
        size = np.abs(true.constants).max(axis=0)
        wrong, still = (
            np.abs(np.abs(p.constants) - np.abs(true.constants)).max(axis=0) / size for p in (plain, found)
        )
        assert still.max() < 0.1 * wrong.max()
        assert not np.allclose(found.vectors, plain.vectors)


def test_a_study_that_accepts_shear_has_the_thick_model() -> None:
    thin = replace(PLATE, elements=(8, 6))
    case = Case("thick", thin, blank(POINTS), accepted=(("shear", {}),))
    found = predictor_of(case)
    assert found.spec.theory == "mindlin"
    assert found.predict(count=4).frequency == pytest.approx(
        frequencies(thin.with_theory("mindlin"), 4), rel=1e-4
    )


def test_a_very_thin_plate_has_no_elements_too_narrow_for_its_polynomials() -> None:
    """One of 1/500 of the length at the far end of the plate was a singular matrix."""
    thick = Spec(
        "plate",
        length=0.4102,
        width=0.1571,
        thickness=0.00116,
        elements=(16, 16),
        clamped=("x0",),
        theory="mindlin",
        material=STEEL,
    )
    thin = frequencies(replace(thick, theory="kirchhoff"), 3)
    np.testing.assert_allclose(frequencies(thick, 3), thin, rtol=3e-3)
