"""Docstrings name types that exist, and parameters that their function or class has."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = ("acquisition", "identification", "updating", "modalkit")
SECTIONS = ("Parameters", "Returns", "Yields", "Raises")
Documented = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


@cache
def trees(room: str) -> dict[Path, ast.Module]:
    return {
        path.relative_to(ROOT): ast.parse(path.read_text(encoding="utf-8"))
        for path in (ROOT / room).rglob("*.py")
    }


@cache
def known() -> frozenset[str]:
    """Names of classes, types and constants that some module defines or imports."""
    names = {*dir(builtins), "DataFrame"}
    for room in ROOMS:
        for node in (node for tree in trees(room).values() for node in ast.walk(tree)):
            if isinstance(node, ast.ClassDef):
                names.add(node.name)
            elif isinstance(node, ast.Import | ast.ImportFrom):
                names |= {(one.asname or one.name).rpartition(".")[2] for one in node.names}
            elif isinstance(node, ast.Assign):
                names |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    return frozenset(names)


def sections(docstring: str) -> Iterator[tuple[str, str]]:
    """Yield the lines that head an entry, with the section that each is in."""
    section, lines = "", docstring.splitlines()
    for line, below in zip(lines, [*lines[1:], ""], strict=False):
        if re.fullmatch(r"-{3,}", below.strip()):
            section = line.strip()
        elif section in SECTIONS and line and not line.startswith((" ", "---")):
            yield section, line


def documented(room: str) -> Iterator[tuple[str, Documented, str, str]]:
    """Yield where, of what, in which section, and the line, of every entry of a room's docstrings."""
    for path, tree in trees(room).items():
        for node in ast.walk(tree):
            if isinstance(node, Documented):
                for section, line in sections(ast.get_docstring(node) or ""):
                    yield f"{path}:{node.lineno}", node, section, line


def types_of(section: str, line: str) -> list[str]:
    """Return the names of classes that an entry gives as a type; dotted ones are of other packages."""
    _, stated, given = line.partition(" : ")
    text = given if stated else "" if section == "Parameters" else line
    bare = re.sub(r"\"[^\"]*\"|'[^']*'|\([^)]*\)", "", text)
    return re.findall(r"(?<![\w.])[A-Z][A-Za-z0-9]*[a-z][A-Za-z0-9]*\b(?!\.)", bare)


@pytest.mark.long
@pytest.mark.parametrize("room", ROOMS)
def test_types_in_docstrings_exist(room: str) -> None:
    unknown = [
        f"{where}: {line}"
        for where, _, section, line in documented(room)
        if not set(types_of(section, line)) <= known()
    ]
    assert not unknown


def own_names(node: Documented) -> set[str] | None:
    """Return the names of a function's parameters or of a class's fields; None where a base class has further ones."""
    if isinstance(node, ast.ClassDef):
        made = [m for m in node.body if isinstance(m, ast.FunctionDef) and m.name == "__init__"]
        if made:
            return own_names(made[0])
        fields = {
            m.target.id for m in node.body if isinstance(m, ast.AnnAssign) and isinstance(m.target, ast.Name)
        }
        return None if node.bases else fields
    given = node.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return {one.arg for one in every if one is not None}


@pytest.mark.parametrize("room", ROOMS)
def test_parameters_in_docstrings_exist(room: str) -> None:
    wrong = []
    for where, node, section, line in documented(room):
        names = own_names(node)
        if section == "Parameters" and names is not None:
            stated = {name.strip(" *") for name in line.partition(" : ")[0].split(",")}
            wrong += [f"{where}: {name}" for name in sorted(stated - names)]
    assert not wrong
