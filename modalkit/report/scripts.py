"""The scripts of a report: modules as the app has them, each as text, begun by one short script."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from modalkit.output.whole import plain
from modalkit.vendor import THREE, vendored
from modalkit.views.static import shared

DRAWN = ("dom.js", "scales.js", "marks.js", "plot.js", "reading.js", "chart.js")
"""What charts need."""

SPACE = ("body.js", "orbit.js", "stage.js", "scene.js", "viewer.js", "structure.js")
"""What structures in space need besides; they stand on three.js, two thirds of a megabyte."""


def scripts(data: Mapping[str, Any], *, space: bool) -> tuple[str, str]:
    """Return the scripts of a page as markup, and the policy that lets these run and nothing else.

    Parameters
    ----------
    data : mapping
        What is drawn.
    space : bool
        Whether there is something in space.
    """
    names = [*DRAWN, *(SPACE if space else ())]
    texts = {name: shared()[name].read_text(encoding="utf-8") for name in names}
    texts |= {name: vendored(name).read_text(encoding="utf-8") for name in THREE if space}
    texts |= {"page.js": _own("page.js")}
    modules = "\n".join(
        f'<script type="text/plain" data-module="{n}">{_inside(t)}</script>' for n, t in texts.items()
    )
    begin = _own("begin.js")  # the only script that runs by itself: it turns the texts into modules
    markup = f"{_block(data)}\n{modules}\n<script>{begin}</script>"
    return markup, policy([begin])


def policy(inline: Iterable[str]) -> str:
    """Return the policy of a page: no request to anywhere, no script but these and the modules they make."""
    hashes = " ".join(f"'sha256-{_digest(text)}'" for text in inline)
    return (
        f"default-src 'none'; script-src {hashes} blob:; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


def _block(data: Mapping[str, Any]) -> str:
    """Return data that a script reads, in which no markup can begin."""
    text = json.dumps(plain(dict(data)), allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    safe = text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    return f'<script type="application/json" id="data">{safe}</script>'


@cache
def _own(name: str) -> str:
    return files("modalkit.report").joinpath("static", name).read_text(encoding="utf-8")


def _inside(text: str) -> str:
    """Return a script that can stand in a page: none of it ends the element it stands in."""
    if "</script" in text.lower() or "<!--" in text:
        raise ValueError("a script of the report holds the end of a script element")
    return text


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
