"""What an effect knows stands in the effect: no other module asks for one by its name, or for imported matrices."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from updating import LIBRARY
from updating.effects import Lack
from updating.models.base import FACTORS

ROOT = Path(__file__).resolve().parents[3]
OWN = ("updating/effects", "modalkit/blind", "modalkit/simulator", "modalkit/planning", "modalkit/papers")
"""Rooms of the effects themselves, and those that must not know the library: they have names of their own."""

KINDS = ("updating/models", "modalkit/study", "modalkit/app/form.py")
"""Rooms that build a model of some kind, and the form that asks for what it is built from."""

SPELLED = frozenset({"modalkit/study/tables.py", "modalkit/app/asked.py", "modalkit/app/model_page.py"})
KEYS = {(room, "exponential_window") for room in SPELLED}
"""Keys of a study that are spelled as an effect is."""

WHOSE = frozenset({"effect", "effects", "name", "names"})
"""Attributes that hold names of effects where a property of the model is spelled alike: ``knob.effect``."""


def sources() -> list[tuple[str, ast.Module]]:
    found = []
    for path in sorted([*(ROOT / "updating").rglob("*.py"), *(ROOT / "modalkit").rglob("*.py")]):
        name = path.relative_to(ROOT).as_posix()
        if not name.startswith(OWN):
            found.append((name, ast.parse(path.read_text(encoding="utf-8"))))
    return found


def literals(node: ast.AST) -> set[str]:
    return {n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and isinstance(n.value, str)}


def documented(tree: ast.Module) -> set[int]:
    return {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}


def by_name(tree: ast.Module, names: set[str]) -> set[str]:
    """Return the names that stand in a module as they are, docstrings left aside."""
    skipped = documented(tree)
    return {
        n.value
        for n in ast.walk(tree)
        if isinstance(n, ast.Constant)
        and isinstance(n.value, str)
        and n.value in names
        and id(n) not in skipped
    }


def asked(node: ast.AST) -> set[str]:
    """Return the attributes and the mapping of which a comparison or a look-up speaks."""
    whose = {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)}
    return whose | ({"LIBRARY", "effect"} & {n.id for n in ast.walk(node) if isinstance(n, ast.Name)})


def switches(tree: ast.Module, names: set[str]) -> list[str]:
    """Return comparisons of an effect's name, or look-ups in the library, by a literal."""
    found = []
    for node in ast.walk(tree):
        prefix = isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        prefix = prefix and node.func.attr in ("startswith", "endswith")  # type: ignore[attr-defined, union-attr]
        if isinstance(node, ast.Compare):
            stated = literals(node) & names and asked(node) & WHOSE
        elif prefix:
            heads = literals(node)
            stated = any(n.startswith(h) for h in heads for n in names if len(h) > 3) and asked(node) & WHOSE
        else:
            stated = (
                isinstance(node, ast.Subscript)
                and literals(node.slice) & names
                and "LIBRARY" in asked(node.value)
            )
        if stated:
            found.append(f"{node.lineno}: {ast.unparse(node)}")  # type: ignore[attr-defined]
    return found


@pytest.mark.long
def test_no_module_asks_for_an_effect_by_its_name() -> None:
    alone = set(LIBRARY) - set(FACTORS)
    for name, tree in sources():
        named = {n for n in by_name(tree, alone) if (name, n) not in KEYS}
        assert not named, f"{name} speaks of {named}: what it knows of them belongs into the effect"
        assert not switches(tree, set(LIBRARY)), f"{name}: {switches(tree, set(LIBRARY))}"


@pytest.mark.long
def test_no_module_asks_whether_a_model_is_imported_by_its_kind() -> None:
    for name, tree in sources():
        if not name.startswith(KINDS):
            assert not by_name(tree, {"matrices"}), f"{name}: ask the structure or its Spec what they can"


def test_such_questions_would_be_found() -> None:
    names = set(LIBRARY)
    for line in (
        'knob.effect == "length"', '"shear" in self.names', 'effect.name.startswith("fluid")',
        'effect.name in {"E", "length"}', 'LIBRARY["E"]',
    ):  # fmt: skip
        assert switches(ast.parse(line), names), line
    for line in ('state.factors["length"]', 'factor == "E"', 'path.name.startswith(".")'):
        assert not switches(ast.parse(line), names), line


def test_what_effects_say_of_each_other_is_of_effects() -> None:
    for effect in LIBRARY.values():
        assert {*effect.equivalent_to, *([effect.twin.name] if effect.twin else [])} <= set(LIBRARY)
        assert effect.words() == effect.words().strip() != ""


def test_kinds_of_obstacles_are_few() -> None:
    assert [lack.value for lack in Lack] == ["model", "data", "expectation", "one test"]
