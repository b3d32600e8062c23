"""The site: pages are run before they are built, pages of reference made, equations set without a network."""

from __future__ import annotations

import re
import shutil
import time
from itertools import groupby
from pathlib import Path
from typing import Any

from commands import FRONT_DIFFERS, MADE, Outcome, front_figure_differs, pages, run_pages
from docutils import nodes
from latex2mathml.converter import convert
from made import inserted
from reference import MAKERS
from sphinx.application import Sphinx
from sphinx.util import logging

LOGGER = logging.getLogger(__name__)
LONG_LINE = 200
"""Lines longer than this are sentences, which wrap; the widest table of an output is narrower [characters]."""

SLOW = "*Slow, so not run by every build; `pytest --slow` checks it.*\n\n"


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect all of it."""
    app.add_config_value("run_pages", True, "")  # -D run_pages=0: to look at words only
    app.connect("builder-inited", run_all)
    app.connect("source-read", complete)
    app.connect("autodoc-process-docstring", plain_bars, priority=400)
    app.connect("build-finished", keep_notebooks)
    app.add_html_math_renderer("mathml", (inline_math, None), (display_math, None))
    return {"version": "1", "parallel_read_safe": False, "parallel_write_safe": True}


def run_all(app: Sphinx) -> None:
    """Run every page; one that prints something else than what stands there is a warning, and so an error."""
    if not int(app.config.run_pages):
        return
    begun = time.perf_counter()
    outcomes = run_pages(pages())
    for outcome in outcomes:
        if not outcome.agrees:
            LOGGER.warning(outcome.message())
    if front_figure_differs():
        LOGGER.warning(FRONT_DIFFERS)
    longest = sorted(outcomes, key=lambda o: -o.seconds)[:5]
    LOGGER.info(
        "ran %d blocks in %.0f s; longest: %s", len(outcomes), time.perf_counter() - begun, _list(longest)
    )


def _list(outcomes: list[Outcome]) -> str:
    return ", ".join(f"{o.page.name}:{o.block.line} {o.seconds:.0f} s" for o in outcomes)


def complete(app: Sphinx, docname: str, source: list[str]) -> None:
    """Put in what is made: reference, files that commands of a page wrote, a word on long commands."""
    text = inserted(source[0], MAKERS)
    text = re.sub(r"^<!-- insert: (.*) -->$", lambda m: _inserted(app, MADE / m[1]), text, flags=re.MULTILINE)
    text = re.sub(r"^<!-- hidden -->\n```\w+\n.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^<!-- (?:needs \w+, )?slow -->\n", lambda _: SLOW, text, flags=re.MULTILINE)
    text = re.sub(r"^<!-- (printed|shown|file: .*|needs .*) -->\n", "", text, flags=re.MULTILINE)
    source[0] = re.sub(r"^```console\n(.*?)^```$", _console, text, flags=re.MULTILINE | re.DOTALL)


def _inserted(app: Sphinx, path: Path) -> str:
    """Return a page that a command wrote, without what it says of files."""
    if not int(app.config.run_pages) and not path.exists():
        return "*Made where the build runs the pages.*"
    return re.sub(r"^figure: .*\n", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)


def _console(found: re.Match[str]) -> str:
    """Let paragraphs with long lines wrap; tables keep their lines."""
    fences = []
    for wraps, paragraphs in groupby(re.split(r"\n{2,}", found[1].rstrip("\n")), _is_long):
        fence = "```console\n" + "\n\n".join(paragraphs) + "\n```"
        fences.append(f":::{{container}} wrapped\n{fence}\n:::" if wraps else fence)
    return "\n\n".join(fences)


def _is_long(paragraph: str) -> bool:
    return max(len(line) for line in paragraph.splitlines()) > LONG_LINE


def plain_bars(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Let ``|a^H b|`` in a docstring be absolute values, not a substitution."""
    for number, line in enumerate(lines):
        parts = line.split("``")
        lines[number] = "``".join(p if k % 2 else p.replace("|", "\\|") for k, p in enumerate(parts))


def keep_notebooks(app: Sphinx, error: Exception | None) -> None:
    """Lay the executed notebooks beside the pages that were made of them."""
    if error is not None or app.builder.format != "html":
        return
    target = Path(app.outdir) / "notebooks"
    target.mkdir(exist_ok=True)
    for notebook in (Path(app.outdir).parent / "jupyter_execute").rglob("*.ipynb"):
        shutil.copy(notebook, target)


def inline_math(translator: Any, node: nodes.math) -> None:
    """Set an equation in a line as MathML, which browsers draw by themselves."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def display_math(translator: Any, node: nodes.math_block) -> None:
    """Set an equation on lines of its own."""
    translator.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode
