"""Figures as SVG inside a page."""

from __future__ import annotations

import re
from io import BytesIO
from xml.etree import ElementTree as Tree

from matplotlib import rc_context
from matplotlib.figure import Figure

REFERENCE = re.compile(r"url\(#([^)]+)\)")
FALLBACK = re.compile(r"'DejaVu Sans'[^;]*")
FAMILY = "'DejaVu Sans', Verdana, sans-serif"
"""Letters stay letters, so that they can be searched and read aloud; Verdana has the widths of DejaVu Sans."""


def inline_svg(figure: Figure, name: str, title: str) -> str:
    """Return a figure as an ``<svg>`` element that stands in a page among others.

    Parameters
    ----------
    figure : Figure
        The figure.
    name : str
        Put before all its identifiers, so that those of several figures differ.
    title : str
        What it shows, for those who cannot see it.
    """
    buffer = BytesIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "modalkit", "path.simplify_threshold": 0.3}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    root = Tree.fromstring(buffer.getvalue())
    for element in root.iter():
        element.tag = _local(element.tag)
        element.attrib = {_local(key): value for key, value in element.attrib.items()}
        _rename(element, name)
    for child in list(root):
        if child.tag == "metadata":
            root.remove(child)
    _drop_styles(root)
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    root.attrib |= {"role": "img", "aria-labelledby": f"{name}-title"}
    head = Tree.Element("title", {"id": f"{name}-title"})
    head.text = title
    root.insert(0, head)
    return Tree.tostring(root, encoding="unicode", short_empty_elements=True)


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def _drop_styles(root: Tree.Element) -> None:
    """Take out the style sheet, which would hold for the whole page; the page's own has its one rule."""
    for parent in list(root.iter("defs")):
        for child in list(parent):
            if child.tag == "style":
                parent.remove(child)


def _rename(element: Tree.Element, name: str) -> None:
    for key, value in element.attrib.items():
        if key == "id":
            element.set(key, f"{name}-{value}")
        elif key == "href" and value.startswith("#"):
            element.set(key, f"#{name}-{value[1:]}")
        elif "url(#" in value:
            element.set(key, REFERENCE.sub(rf"url(#{name}-\1)", value))
        elif key == "style" and "font" in value:
            element.set(key, FALLBACK.sub(FAMILY, value))
