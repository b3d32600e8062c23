"""A bracket of solids by its deck: from nothing to the updated model; what is refused. Skipped without ccx."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.long

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "deck"

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def bracket(example_of: Callable[[Path, str], ModuleType], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(example_of(EXAMPLES, "bracket").make(tmp_path_factory.mktemp("bracket")))


@needs_ccx
def test_the_milled_face_comes_back(bracket: Path, run: Run) -> None:
    """0.4 mm in the specimen, which has another mesh and other elements; steel that is right stays."""
    before = (bracket.parent / "bracket.inp").read_bytes()
    out = bracket.parent / "update.json"
    code, _, message = run("update", bracket, "--json", out)
    assert not code, message
    found = {p["name"]: p for p in json.loads(out.read_text())["parameters"]}
    assert found["WEBFACE.y"]["value"] == pytest.approx(-0.4e-3, abs=0.06e-3)
    assert abs(found["WEBFACE.y"]["value"] + 0.4e-3) < 3 * found["WEBFACE.y"]["sigma"]
    assert found["WEBFACE.y"]["unit"] == "m"
    assert found["STEEL.E"]["factor"] == pytest.approx(1.0, abs=0.01)
    pairs = json.loads(out.read_text())["pairs"]
    assert max(abs(p["after_hz"] / p["test_hz"] - 1) for p in pairs) < 0.003
    assert (bracket.parent / "bracket.inp").read_bytes() == before


@needs_ccx
@pytest.mark.slow
def test_the_web_is_where_the_gap_lies(bracket: Path, run: Run) -> None:
    out = bracket.parent / "diagnosis.json"
    code, _, message = run("diagnose", bracket, "--json", out)
    assert not code, message
    document = json.loads(out.read_text())
    assert document["significant"]
    assert "local_stiffness" in document["cause"]["ranking"][0]["effects"]
    assert max(document["where"]["zones"], key=lambda zone: zone["probability"])["name"] == "WEB"


REFUSED = {
    "set": ('[[model.region]]\nname = "rib"\n', "'rib': no element set or material rib"),
    "place": ('[[model.region]]\nname = "WEB"\nx = [0.0, 0.1]\n', "'WEB' takes no x on a deck"),
    "material": ("[model.material]\nE = 210e9\ndensity = 7850\n", "takes no material: the deck states it"),
    "parameter": (
        '[update]\nparameters = ["WEB.colour"]\n',
        "WEB.colour: a region has no 'colour' to update",
    ),
    "thickness": ('[update]\nparameters = ["WEB.thickness"]\n', "it has no thickness to change"),
    "frf": (
        '[update]\nmethod = "frf"\nparameters = ["WEBFACE.y"]\n',
        "WEBFACE.y is a number of a deck, which is updated",
    ),
    "node set": ('[update]\nparameters = ["EDGE.y"]\n', "no node set EDGE; there are: ALL, CLAMP, WEBFACE"),
}


@needs_ccx
@pytest.mark.parametrize("case", REFUSED)
def test_what_a_study_may_not_say_is_one_line(case: str, bracket: Path, run: Run) -> None:
    added, message = REFUSED[case]
    text = bracket.read_text()
    (bracket.parent / "wrong.toml").write_text(text[: text.index("[tolerances]")] + added)
    code, out, error = run("update", bracket.parent / "wrong.toml")
    assert (code, out) == (2, "")
    assert message in " ".join(error.split())


@needs_ccx
def test_a_deck_that_does_not_solve_and_a_ccx_that_is_missing(
    bracket: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    deck = (bracket.parent / "bracket.inp").read_text().replace("*DENSITY\n7.85e-9\n", "")
    (bracket.parent / "weightless.inp").write_text(deck)
    study = bracket.parent / "weightless.toml"
    study.write_text(bracket.read_text().replace("bracket.inp", "weightless.inp"))
    code, _, error = run("correlate", study)
    assert code == 2
    assert "weightless.inp: ccx does not solve this deck: *ERROR" in " ".join(error.split())
    monkeypatch.setenv("PATH", str(bracket.parent))
    code, _, error = run("correlate", study)
    assert code == 2
    assert "needs the program ccx, and there is none" in " ".join(error.split())


def test_examples_of_one_name_are_modules_of_their_own(example_of: Callable[[Path, str], ModuleType]) -> None:
    """Both folders have a bracket.py; which of the two was imported first is nothing to the other."""
    folders = (EXAMPLES.parent / "calculix", EXAMPLES, EXAMPLES.parent / "calculix")
    found = [example_of(folder, "bracket") for folder in folders]
    assert [Path(str(module.__file__)).parent for module in found] == list(folders)
    assert found[0] is found[2]
