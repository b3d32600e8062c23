"""The pages name what there is: every file, module and name of the rooms that stands on one exists."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from functools import reduce
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SITE = sorted(path for path in (ROOT / "docs").rglob("*.md") if "made" not in path.parts)
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *SITE]
ROOMS = "acquisition|identification|updating|modalkit"
SLASHED = re.compile(rf"(?<![\w/.-])(?:{ROOMS}|benchmarks|docs|examples|sample_data|tests)/[\w./-]*[\w/]")
DOTTED = re.compile(rf"(?<![\w/.\"-])(?:{ROOMS})(?:\.[A-Za-z_]\w*)+(?![\w/])")
LONGEST_HOW_TO = 450
"""Words beside code that a how-to has at most: a screen, and a table to look things up in."""
ELSEWHERE = frozenset({"modalkit.readers"})
"""What looks like a module and is the name of something else: a group of entry points."""


def exists(name: str) -> bool:
    """Tell whether a dotted name is that of a module, or of something in one."""
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        try:
            module = importlib.import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        try:
            reduce(getattr, parts[k:], module)
        except AttributeError:
            return False
        return True
    return False


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_file_and_module_that_a_page_names_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    files = {found for found in SLASHED.findall(text) if not (ROOT / found).exists()}
    dotted = {found for found in DOTTED.findall(text) if found not in ELSEWHERE and not found.endswith(".md")}
    names = {found for found in dotted if not exists(found)}
    assert not files
    assert not names


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_page_that_a_page_links_to_exists(page: Path) -> None:
    links = re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    ours = [link for link in links if not link.startswith("/made/")]
    assert not {link for link in ours if not (page.parent / link).exists()}


@pytest.mark.parametrize("page", SITE, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_says_on_top_for_whom_it_is(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    drawn = page.parent.name == "rooms" or page == ROOT / "docs" / "index.md" or "{include}" in text
    heading = re.search(r"^# .*\n+", text, flags=re.MULTILINE)
    assert drawn or (heading is not None and text[heading.end()] == "*")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_line_of_prose_begins_as_a_comment(page: Path) -> None:
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    assert not re.findall(r"^\s*%.*", text, flags=re.MULTILINE), "MyST leaves out what begins with %"


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "howto").glob("*.md")), ids=lambda page: page.stem)
def test_a_how_to_is_a_screen(page: Path) -> None:
    words = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL).split()
    assert len(words) <= LONGEST_HOW_TO


@pytest.mark.slow
def test_pages_print_what_stands_on_them_long_commands_too() -> None:
    script = ROOT / "docs" / "_ext" / "commands.py"
    done = subprocess.run([sys.executable, script, "--slow"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("room", ROOMS.split("|"))
def test_the_page_of_a_room_names_each_of_its_sub_rooms(room: str) -> None:
    page = (ROOT / "docs" / "develop" / "rooms" / f"{room}.md").read_text(encoding="utf-8")
    inside = {path.parent.name for path in (ROOT / room).glob("*/__init__.py")}
    assert not {name for name in inside if f"`{name}`" not in page}
    assert len(page.splitlines()) <= 60, "a page of a room is at most a screen"


def test_the_map_says_where_every_reason_against_a_hit_comes_from() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "acquisition" / "hits").rglob("*.py"))
    kinds = set(re.findall(r"Fault\(\s*\"([^\"]+)\"", code))
    page = re.sub(
        r"\s+", " ", (ROOT / "docs" / "develop" / "rooms" / "acquisition.md").read_text(encoding="utf-8")
    )
    assert len(kinds) > 8
    assert not {kind for kind in kinds if f"*{kind}*" not in page}
