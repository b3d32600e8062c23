"""Numbers that several modules of a diagnosis read stand in one module; the rules of a verdict in one record."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
from pathlib import Path

from updating import DecisionRules, thresholds

ROOT = Path(__file__).resolve().parents[2] / "updating"
ROOMS = ("problem", "likelihood", "diagnosis")
NO_THRESHOLDS = {
    "MIDDLE": "a quantile that stands in for what is fixed",
    "SHEAR_COEFFICIENT": "a constant of nature",
    "MANY_ELEMENTS": "the cost of a mesh",
    "UNIFORM": "the variance of a uniform prior",
    "NOT_YET": "a number of no node",
    "NO_MODE": "a number of no mode",
    "PER_LENGTH": "powers of a mass",
    "SETS": "rows of a printed table",
}
"""Numbers with a name in those rooms that limit nothing, and what they are instead."""


def named(tree: ast.Module) -> dict[str, ast.expr]:
    """Return the constants of a module."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
            found |= {name: node.value for name in names if name.isupper()}
    return found


def has_number(value: ast.expr) -> bool:
    return any(isinstance(n, ast.Constant) and isinstance(n.value, int | float) for n in ast.walk(value))


def test_no_number_that_limits_something_stands_elsewhere() -> None:
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            constants = named(ast.parse(path.read_text(encoding="utf-8")))
            own = {name for name, value in constants.items() if has_number(value)} - set(NO_THRESHOLDS)
            assert not own, (
                f"{path.relative_to(ROOT)}: {own}: a rule, a default of its function, or a threshold"
            )


def test_each_rule_says_its_meaning_and_its_unit_and_is_read() -> None:
    text = inspect.getdoc(DecisionRules) or ""
    source = "".join(
        p.read_text(encoding="utf-8")
        for p in [*sorted(ROOT.rglob("*.py")), *sorted((ROOT.parent / "modalkit").rglob("*.py"))]
    )
    for one in dataclasses.fields(DecisionRules):
        found = re.search(rf"^{one.name} : float\n((?:    .*\n)+)", text, flags=re.MULTILINE)
        assert found is not None, one.name
        assert re.search(r"\[(-|%|sigma)\]", found[1]), f"{one.name} has no unit"
        assert len(found[1]) > 50, f"{one.name} says too little"
        assert re.search(rf"(?i)rules\.{one.name}\b", source), f"{one.name} decides nothing"


def test_each_says_what_it_limits_and_is_used() -> None:
    source = Path(thresholds.__file__).read_text(encoding="utf-8")
    body = ast.parse(source).body
    everything = [
        p.read_text(encoding="utf-8") for p in sorted(ROOT.rglob("*.py")) if p.name != "thresholds.py"
    ]
    for node, after in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.Assign):
            (name,) = (n.id for n in node.targets if isinstance(n, ast.Name))
            assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant), name
            assert len(str(after.value.value)) > 30, f"{name} says too little"
            used = re.compile(rf"\b{name}\b")
            assert any(used.search(text) for text in everything), f"{name} limits nothing"
