"""What compares the blocks of a page with what they print: it has to see a change, and none where there is none."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def pages() -> ModuleType:
    """Return the module that knows the blocks of a page."""
    path = Path(__file__).resolve().parents[2] / "docs" / "_ext" / "blocks.py"
    spec = importlib.util.spec_from_file_location("pages_blocks", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("written", "printed", "alike"),
    [
        ("mode 1: 24.4701 Hz", "mode 1: 24.4702 Hz", True),
        ("mode 1: 24.4701 Hz", "mode 1: 24.4703 Hz", False),
        ("clamp_rotation  0.9622", "clamp_rotation  0.9701", True),
        ("clamp_rotation  0.9622", "clamp_rotation  0.9101", False),
        ("p = 5e-09", "p = 6e-09", True),
        ("p = 5e-09", "p = 5e-08", False),
        ("75 hits, 0 left out", "75 hits, 1 left out", False),
        ("a    24.47   b", "a 24.47 b", True),
        ("named: length", "named: density", False),
        ("beam_2 0.5", "beam_3 0.5", False),
        ("closes 100 % (97 to 100)", "closes 100 % (96 to 100)", False),
    ],
)
def test_a_line_is_the_same_up_to_another_processor_s_rounding(
    pages: ModuleType, written: str, printed: str, alike: bool
) -> None:
    assert pages.alike(written, printed) is alike


def test_dots_stand_for_any_lines(pages: ModuleType) -> None:
    printed = "a\nb\nc\nd\n"
    assert (
        pages.same("a\n...\n", printed)
        and pages.same("...\nd\n", printed)
        and pages.same("a\n...\nc\n...", printed)
    )
    assert not pages.same("a\nb\nc\n", printed)
    assert not pages.same("a\n...\nx\n...", printed)
    assert not pages.same("b\n...", printed)


def test_what_is_renewed_keeps_its_shape(pages: ModuleType) -> None:
    printed = "head 2\none 1.5\ntwo 2.5\n[[Table]]\nrow 7.5\nmore\n"
    assert (
        pages.renewed("head 1\n...\n[[Table]]\nrow 9.1\n...\n", printed)
        == "head 2\n...\n[[Table]]\nrow 7.5\n...\n"
    )
    assert pages.renewed("old\n", printed) == printed
    assert pages.renewed(printed, printed) == printed


def test_the_blocks_of_a_page(pages: ModuleType) -> None:
    text = """# A page
```sh
not run
```
<!-- file: a.toml -->
```toml
x = 1
```
<!-- slow -->
```console
$ modalkit one
1
$ modalkit two
```
<!-- printed -->
```text
3
```
"""
    toml, console, printed = pages.blocks(text)
    assert toml.file == "a.toml" and printed.mark == "printed"
    assert console.commands() == [("modalkit one", "1\n"), ("modalkit two", "")]
    assert not console.runs(slow=False) and console.runs(slow=True)
    assert (
        text[slice(*console.span)] == console.body and text.splitlines()[console.line - 1] == "$ modalkit one"
    )


@pytest.fixture(scope="module")
def site() -> Iterator[tuple[ModuleType, ModuleType]]:
    """Return the modules that make parts of pages, and that keep them there."""
    folder = str(ROOT / "docs" / "_ext")
    sys.path.insert(0, folder)
    try:
        yield importlib.import_module("made"), importlib.import_module("reference")
    finally:
        sys.path.remove(folder)


KEPT = [
    "api",
    "api_acquisition",
    "api_identification",
    "api_updating",
    "commands",
    "effects",
    "json",
    "study",
    "thresholds",
]


@pytest.mark.parametrize("name", KEPT)
def test_a_page_of_reference_holds_what_is_made_of_it(site: tuple[ModuleType, ModuleType], name: str) -> None:
    made, reference = site
    text = (ROOT / "docs" / "reference" / f"{name}.md").read_text(encoding="utf-8")
    assert made.renewed(text, reference.MAKERS) == text, "docs/_ext/commands.py --refresh PAGE renews it"
    assert "<!-- end made -->" in text and "| --- |" in text


def test_a_part_is_replaced_whether_it_is_kept_or_not(site: tuple[ModuleType, ModuleType]) -> None:
    made, _ = site
    makers = {"one": lambda: "1\n", "two": lambda: "2"}
    page = "a\n<!-- made: one -->\nold\n<!-- end made -->\nb\n<!-- made: two -->\nc\n"
    assert made.inserted(page, makers) == "a\n1\nb\n2\nc\n"
    kept = made.renewed(page, makers)
    assert kept == "a\n<!-- made: one -->\n\n1\n\n<!-- end made -->\nb\n<!-- made: two -->\nc\n"
    assert made.renewed(kept, makers) == kept
