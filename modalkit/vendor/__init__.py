"""Libraries for the browser, served or inlined as they are: plotly's cartesian bundle, three.js; see LICENSES.txt."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable

PLOTLY = "plotly-cartesian.min.js"
THREE = ("three.module.min.js", "three.core.min.js")
"""The second is loaded by the first, from beside it."""


def vendored(name: str) -> Traversable:
    """Return a file of this folder."""
    return files(__name__).joinpath(name)
