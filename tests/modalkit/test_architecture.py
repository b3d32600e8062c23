"""The house: rooms import to their left only, and nothing prints or plots where it must not."""

from __future__ import annotations

import ast
import io
import re
import subprocess
import sys
import tokenize
from pathlib import Path

import grimp
import numpy as np
import pytest
from scipy import sparse
from scipy.sparse import csgraph

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("acquisition", "identification", "updating", "modalkit")


def sources(*folders: str) -> list[Path]:
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def imported(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module)
    return names


@pytest.mark.long
def test_the_contracts_of_the_import_linter_are_kept() -> None:
    command = [str(Path(sys.executable).parent / "lint-imports"), "--no-cache"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_no_module_needs_itself_through_others_even_for_types() -> None:
    """The contract on circles leaves aside what types alone need; modules that know each other by type are one."""
    graph = grimp.build_graph(*ROOMS, exclude_type_checking_imports=False, cache_dir=None)
    modules = sorted(graph.modules)
    number = {name: i for i, name in enumerate(modules)}
    pairs = [
        (i, number[to]) for name, i in number.items() for to in graph.find_modules_directly_imported_by(name)
    ]
    rows, columns = np.array(pairs).T
    links = sparse.coo_array((np.ones(len(pairs)), (rows, columns)), shape=(len(modules), len(modules)))
    _, circle = csgraph.connected_components(links, directed=True, connection="strong")
    shared = np.flatnonzero(np.bincount(circle) > 1)
    assert not len(shared), [[m for m, c in zip(modules, circle, strict=True) if c == one] for one in shared]


@pytest.mark.parametrize("room", ROOMS[:3])
def test_no_room_imports_to_its_right(room: str) -> None:
    right = ROOMS[ROOMS.index(room) + 1 :]
    for path in sources(room):
        wrong = {name for name in imported(path) if name.split(".")[0] in right}
        assert not wrong, f"{path.relative_to(ROOT)} imports {wrong}"


NOT_OBJECTS = {"acquisition/lazy.py", "acquisition/display.py"}
"""What reads or writes the names of modules and of classes."""


def reached_around(tree: ast.Module) -> set[str]:
    """Return by what an object is written to behind the back of its class, but at its birth."""
    births = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef) and function.name == "__post_init__"
        for node in ast.walk(function)
    }
    names = {n.attr for n in ast.walk(tree) if isinstance(n, ast.Attribute) and id(n) not in births}
    return names & {"__dict__", "__setattr__"}


@pytest.mark.parametrize("room", ROOMS)
def test_objects_are_complete_at_birth(room: str) -> None:
    for path in sources(room):
        if path.relative_to(ROOT).as_posix() not in NOT_OBJECTS:
            assert not reached_around(ast.parse(path.read_text(encoding="utf-8"))), path


EVERY_MODULE = """
import importlib, sys
from pathlib import Path
for package in sys.argv[1:]:
    found = importlib.import_module(package)
    folder = Path(found.__path__[0])
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        name = ".".join((package, *parts)).removesuffix(".__init__")
        importlib.import_module(name)
        if "updating" in sys.modules:
            sys.exit(name)
"""


@pytest.mark.long
def test_whoever_keeps_secrets_loads_nothing_of_the_candidates() -> None:
    packages = ["modalkit.simulator", "modalkit.blind"]
    words = [sys.executable, "-c", EVERY_MODULE, *packages]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.long
def test_nothing_is_plotted_below_the_face() -> None:
    for path in sources(*ROOMS[:3]):
        assert not {n for n in imported(path) if n.split(".")[0] == "matplotlib"}, path


@pytest.mark.long
def test_pyplot_and_its_global_state_are_not_used() -> None:
    for path in sources(*ROOMS):
        assert "matplotlib.pyplot" not in imported(path), path


PRIVATE = {
    *(
        "said",
        "says",
        "told",
        "tell",
        "tells",
        "heard",
        "hears",
        "look",
        "looks",
        "looking",
        "climb",
        "climbs",
    ),
    *(
        "seat",
        "seats",
        "knob",
        "knobs",
        "whiten",
        "weighed",
        "secret",
        "posed",
        "shortfall",
        "thinned",
        "thinning",
    ),
    *("leftover", "overrule", "remark", "remarks", "handling", "grams"),
}
"""Words of which docs/develop/words.md says what the field calls them."""


@pytest.mark.parametrize("room", ROOMS)
def test_names_are_words_of_the_field(room: str) -> None:
    for path in sources(room):
        if path.parent.name == "schemas":  # fields of documents keep the names that programs read them by
            continue
        names = {
            token.string
            for token in tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline)
            if token.type == tokenize.NAME
        }
        parts = {name: {part.lower() for part in re.findall(r"[A-Z]?[a-z]+", name)} for name in names}
        assert not {name for name in names if parts[name] & PRIVATE}, path


WRITTEN = {
    "told": "stated, given, separated",
    "tells": "shows, determines",
    "said": "stated",
    "says": "states",
    "heard": "recorded",
    "hears": "records",
    "looked": "sought, examined, observed",
    "knows": "has, includes",
    "speaks": "names, supports",
    "climb": "maximisation",
    "climbs": "maximisations",
    "climbed": "maximised",
    "knob": "parameter",
    "knobs": "parameters",
    "seat": "location",
    "whiten": "normal equations",
    "posed": "diagnosis problem",
    "shortfall": "theory error",
    "thinned": "selected",
    "thinning": "line selection",
    "leftover": "residual peak",
    "overrule": "manual selection",
    "remarks": "notes, warnings",
    "weighed": "compared, weighted",
    "secret": "hidden effect",
    "grams": "normal equations",
    "drown": "is below the noise",
    "handling": "processing options",
    "is no number": "is not a number",
    "are no numbers": "are not numbers",
    "no one test": "several tests",
    "tell apart": "separate",
    "told apart": "separated",
    "tells apart": "separates",
    "taken as a doubt": "treated as model uncertainty",
    "may as well be it": "is as likely",
    "ought to know": "should know",
}
"""Words and phrases that docstrings, comments and messages do without, each with the plain one."""

LITERAL = {
    "weighed": ("weighed mass", "specimen is weighed"),
    "secret": ("Keep it secret",),
    "grams": ("mass [kg] in grams",),
}
"""Phrases in which a word is meant literally."""


def written(path: Path) -> list[tuple[int, str]]:
    """Return docstrings, comments and texts of more than one word, with their lines; code in quotes is left out."""
    found = []
    for token in tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline):
        if token.type in (tokenize.STRING, tokenize.COMMENT) and len(token.string.split()) > 1:
            found.append((token.start[0], re.sub(r"``[^`]*``|`[^`]*`|\s+", " ", token.string)))
    return found


def unplain(text: str) -> set[str]:
    """Return the words and phrases of the list that are in a text."""
    words = f" {' '.join(re.findall(r'[a-z]+', text.lower()))} "
    found = {word for word in WRITTEN if f" {word} " in words}
    return {word for word in found if not any(phrase in text for phrase in LITERAL.get(word, ()))}


@pytest.mark.parametrize("room", ROOMS)
def test_docstrings_comments_and_messages_are_plain_english(room: str) -> None:
    found = {
        f"{path.relative_to(ROOT)}:{line}": {word: WRITTEN[word] for word in words}
        for path in sources(room)
        for line, text in written(path)
        if (words := unplain(text))
    }
    assert not found


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('"""Tell what the noise says."""', {"says"}),
        ('f"{path}: {word!r} is no number"', {"is no number"}),
        ('"effects that no test\n tells apart"', {"tells", "tells apart"}),
        ('"a number, as the file states it"', set()),
    ],
)
def test_a_sentence_that_has_to_be_read_twice_is_found(text: str, words: set[str]) -> None:
    assert unplain(text) == words
