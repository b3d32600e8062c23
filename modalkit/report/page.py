"""A report as the text of one HTML file that needs no other file and no network."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from modalkit.figures.save import png
from modalkit.report.document import Document, Moving, Part, Section, Standing
from modalkit.report.html import Raw, element, joined
from modalkit.report.scripts import scripts
from modalkit.views.chart import Chart
from modalkit.views.static import shared

BEGIN = '<!doctype html>\n<html lang="en">\n<head><meta name="generator" content="modalkit">'
"""How every report begins."""

NOTHING = Raw("")

TURN = "Drag to turn, or use the arrow keys; plus and minus zoom."
"""How a structure in space is turned."""


def page(document: Document) -> str:
    """Return a report as the text of an HTML file.

    Parameters
    ----------
    document : Document
        What is reported.
    """
    parts = list(document.parts())
    in_space = [part for part in parts if isinstance(part, Moving | Standing)]
    data: dict[str, Any] = {
        "charts": [part.data() for part in parts if isinstance(part, Chart)],
        "space": {part.name: {"kind": _kind(part), "page": part.page} for part in in_space},
    }
    own, policy = scripts(data, space=bool(in_space))
    style = "".join(sheet.read_text(encoding="utf-8") for sheet in (_style(), shared()["chart.css"]))
    body = joined(element("header", document.head), _contents(document), *map(_section, document.shown))
    return "\n".join(
        (
            BEGIN,
            '<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{escape(policy, quote=True)}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            '<meta name="color-scheme" content="light dark">',
            f"<title>{escape(f'{document.title}: {document.kind}')}</title>",
            f"<style>\n{style}</style></head>",
            f"<body><main>\n{body.markup}\n</main>\n{own}</body></html>\n",
        )
    )


def _style() -> Traversable:
    return files("modalkit.report").joinpath("static", "style.css")


def _kind(part: Moving | Standing) -> str:
    return "moving" if isinstance(part, Moving) else "standing"


def _contents(document: Document) -> Raw:
    """Return links to the sections, and the text where no script runs."""
    links = [element("li", element("a", s.title, href=f"#{_anchor(s)}")) for s in document.shown]
    quiet = element(
        "noscript", element("p", "The figures need scripts, which are switched off here; the tables do not.")
    )
    return joined(element("nav", element("ul", *links), aria_label="Contents"), quiet)


def _anchor(section: Section) -> str:
    return "-".join("".join(c if c.isalnum() else " " for c in section.title.lower()).split())


def _section(section: Section) -> Raw:
    return element("section", element("h2", section.title), *map(_part, section.shown), id=_anchor(section))


def _part(part: Part) -> Raw:
    if isinstance(part, Raw):
        return part
    if isinstance(part, Chart):
        return _figure(part.name, part.title, part.text, "plot")
    return _figure(part.name, part.title, part.text, "space", _on_paper(part))


def _figure(name: str, title: str, text: str, kind: str, paper: Raw = NOTHING) -> Raw:
    turn = element("span", TURN, class_="screen") if kind == "space" else NOTHING
    head = element("figcaption", element("strong", title), element("span", text), turn, id=f"{name}-title")
    place = element("div", class_=kind)
    return element("figure", head, place, paper, id=name, role="group", aria_labelledby=f"{name}-title")


def _on_paper(part: Moving | Standing) -> Raw:
    """Return the picture of a structure in space that print shows in its place."""
    picture = b64encode(png(part.still())).decode()
    return element("img", class_="paper", alt=part.title, src=f"data:image/png;base64,{picture}")
