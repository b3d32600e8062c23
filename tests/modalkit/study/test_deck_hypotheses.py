"""Hypotheses on numbers of a deck: thickness, springs, masses, places of nodes; against CalculiX with other numbers."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition import StudyError
from modalkit.planning.own.families import families_of
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating.effects import hypotheses_of
from updating.models import build_structure
from updating.nominal import predictor_of

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "calculix"

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")

TABLE = '[[hypothesis]]\nname = "it"\nparameter = "{}"\nrange = [{}, {}]\n'


@pytest.fixture(scope="module")
def shells(example_of: Callable[[Path, str], ModuleType]) -> ModuleType:
    return example_of(EXAMPLES, "mesh")


def plate(
    shells: ModuleType, thickness: float = 0.003003, spring: float = 2e4, mass: float = 0.05
) -> list[str]:
    """Return a plate of shells held along one edge, its outer half another set, spring and mass at its far corners."""
    lines: list[str] = shells.shell_deck(
        (8, 4),
        lambda u, v: (0.1 * u, 0.04 * v, 0.0),
        lambda u, v: "ROOT" if u < 0.5 else "TIP",
        dict.fromkeys(("ROOT", "TIP"), (210e9, 0.3, 7850.0)),
        0.003,
    )
    at = next(i for i, line in enumerate(lines) if line.startswith("*SHELL SECTION, ELSET=TIP"))
    lines[at + 1] = f"{thickness}"
    places = [line.split(",") for line in lines if line.count(",") == 3 and line[0].isdigit()]
    near, far = (
        next(n for n, *at in places if np.allclose([float(c) for c in at], [0.1, y, 0.0], atol=1e-9))
        for y in (0.0, 0.04)
    )
    more = ["*ELEMENT, TYPE=SPRING1, ELSET=SEAT", f"9000, {near}", "*SPRING, ELSET=SEAT", "3", f"{spring}"]
    more += ["*ELEMENT, TYPE=MASS, ELSET=BODY", f"9001, {far}", "*MASS, ELSET=BODY", f"{mass}"]
    held = lines.index("*BOUNDARY")
    return [*lines[:held], *more, *lines[held:]]


def studied(folder: Path, deck: list[str], *hypothesis: str) -> Path:
    (folder / "plate.inp").write_text("\n".join(deck) + "\n")
    (folder / "modes.csv").write_text("frequency, sigma\n200, 0.1\n900, 0.5\n1200, 0.5\n")
    text = '[test]\nmodes = "modes.csv"\n[model]\ntype = "calculix"\ndeck = "plate.inp"\n'
    path = folder / "study.toml"
    path.write_text(text + "".join(hypothesis))
    return path


@pytest.mark.long
@pytest.mark.parametrize(
    ("parameter", "low", "high", "value", "deck"),
    [
        ("TIP.thickness", 0.0022, 0.0032, 0.0026, {"thickness": 0.0026}),
        ("SEAT.stiffness", 1e4, 3e4, 1.2e4, {"spring": 1.2e4}),
        ("BODY.mass", 0.03, 0.08, 0.07, {"mass": 0.07}),
    ],
)
def test_a_number_of_the_deck_is_a_hypothesis(
    shells: ModuleType,
    tmp_path: Path,
    parameter: str,
    low: float,
    high: float,
    value: float,
    deck: dict[str, float],
) -> None:
    path = studied(tmp_path, plate(shells), TABLE.format(parameter, low, high))
    predictor = predictor_of(open_study(path).case)
    (effect,) = hypotheses_of(predictor.spec)
    (stated,) = effect.parameters(predictor)
    assert (stated.low, stated.high) == (low, high)
    found = predictor.predict(effect.state(predictor, {"value": value}), count=6).frequency
    other = tmp_path / "other"
    other.mkdir()
    changed = build_structure(read_study(studied(other, plate(shells, **deck))).spec())
    expected = np.sqrt(changed.eigen(6)[0]) / (2 * np.pi)
    before = predictor.predict(count=6).frequency
    assert np.abs(expected / before - 1).max() > 0.005
    assert found == pytest.approx(expected, rel=2e-4)
    (place,) = effect.locations(predictor, {"value": value})
    assert place[0] > 0.05  # all three sit in the outer half


def test_what_cannot_be_supposed_is_refused_in_one_line(shells: ModuleType, tmp_path: Path) -> None:
    for parameter, ends, message in (
        (
            "TIP.thickness",
            (0.0001, 0.003),
            r"'it': range = \[0.0001, 0.003\] m exceeds \[0.001802, 0.004805\] m",
        ),
        ("TOP.thickness", (0.002, 0.003), r"'it': TOP.thickness"),
        ("SEAT.thickness", (0.002, 0.003), r"'it': SEAT.thickness"),
        ("TIP.colour", (0.002, 0.003), r"'it': no parameter 'TIP.colour'; known: .*SET.thickness"),
    ):
        with pytest.raises(StudyError, match=message) as caught:
            read_study(studied(tmp_path, plate(shells), TABLE.format(parameter, *ends))).spec()
        assert "\n" not in str(caught.value)


def test_a_region_s_modulus_is_supposed_in_the_unit_of_an_update(
    shells: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two materials: no one modulus is the structure's, but each region has its own by its cards."""
    deck = plate(shells)
    at = next(i for i, line in enumerate(deck) if line.startswith("*ELASTIC"))
    deck[at + 1] = "70e9, 0.3"
    path = studied(tmp_path, deck, TABLE.format("ROOT.E", '"35 GPa"', '"70 GPa"'))
    (stated,) = read_study(path).spec().hypotheses
    assert (stated.low, stated.high, stated.nominal, stated.unit) == (35e9, 70e9, 70e9, "Pa")
    path = studied(tmp_path, deck, TABLE.format("E", 0.5, 1.0))
    (stated,) = read_study(path).spec().hypotheses
    assert (stated.low, stated.high, stated.nominal, stated.unit) == (0.5, 1.0, 1.0, "-")
    monkeypatch.setenv("PATH", "")  # what is refused is refused before CalculiX runs
    for ends, parameter, message in (
        ((0.5, 1.0), "ROOT.E", r"\[0.5, 1\] Pa is far from the model's value, ROOT.E = 7e\+10 Pa"),
        (('"1 mm"', '"2 mm"'), "ROOT.E", "not a quantity in Pa"),
        (
            ('"35 GPa"', '"70 GPa"'),
            "E",
            "E is a factor where no single card of the deck states it for all elements",
        ),
    ):
        with pytest.raises(StudyError, match=message):
            read_study(studied(tmp_path, deck, TABLE.format(parameter, *ends))).spec()


def test_a_forecast_asks_about_a_number_of_the_deck(shells: ModuleType, tmp_path: Path) -> None:
    """A shift of nodes stands at 0 and a spring at what the deck says; both are said in their unit."""
    deck = plate(shells)
    nodes = [
        line
        for line in deck
        if line.count(",") == 3 and line[0].isdigit() and line.split(",")[1].strip() == "0.1"
    ]
    held = deck.index("*BOUNDARY")
    sets = ["*NSET, NSET=EDGE", *[line.split(",")[0] for line in deck if line in nodes]]
    deck = [*deck[:held], *sets, *deck[held:]]
    edge = TABLE.format("EDGE.x", '"-2 mm"', '"0 mm"').replace('"it"', '"shorter"')
    seat = TABLE.format("SEAT.stiffness", 1e4, 2e4).replace('"it"', '"softer"')
    path = studied(tmp_path, deck, edge, seat)
    predictor = predictor_of(open_study(path).case)
    shorter, softer = (families_of(e, predictor, np.zeros((0, 3)))[0] for e in hypotheses_of(predictor.spec))
    assert shorter.values(0.0, 0.0) == {"value": 0.0}
    assert shorter.values(shorter.clear, 0.0) == {"value": pytest.approx(-0.002)}
    assert shorter.amount(5e-4) == "0.5 mm"
    assert softer.values(softer.clear, 0.0) == {"value": pytest.approx(1e4)}
    assert softer.amount(5e3) == "5000 N/m"
