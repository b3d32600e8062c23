"""A diagnosis as one HTML page that needs no other file and no network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from html import escape
from importlib.resources import files

from modalkit.figures.words import answer
from modalkit.report.drawings import Drawing, drawings
from modalkit.report.html import Raw, element, joined
from modalkit.report.place import BEGIN
from modalkit.report.provenance import provenance
from modalkit.report.sections import (
    not_examined,
    the_causes,
    the_gap,
    the_next_test,
    the_place,
    the_shrinkage,
    the_summary,
    the_warnings,
)
from modalkit.report.svg import inline_svg
from modalkit.workflow.case import Session
from modalkit.workflow.diagnosis import warnings_of
from updating import Diagnosis


def diagnosis_report(
    diagnosis: Diagnosis,
    sessions: Sequence[Session],
    *,
    when: datetime,
    drawn: Mapping[str, Drawing] | None = None,
) -> str:
    """Return the report of a diagnosis as the text of an HTML file.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    sessions : sequence of Session
        What was diagnosed, in the order of the diagnosis.
    when : datetime
        Date of the report.
    drawn : mapping of str to Drawing, optional
        The figures of :func:`drawings`, where they are drawn already.
    """
    shown = dict(drawings(diagnosis, sessions) if drawn is None else drawn)
    body = joined(
        element(
            "header",
            element("h1", diagnosis.title or "Diagnosis"),
            element("p", answer(diagnosis), class_="answer"),
            the_summary(diagnosis),
        ),
        _section("How large the gap is", _figures(shown, "gap"), the_gap(diagnosis)),
        _section("Where it sits", _figures(shown, "localisation"), the_place(diagnosis)),
        _section("What causes it", the_causes(diagnosis)),
        _section("How far it closes", _figures(shown, "shrink"), the_shrinkage(diagnosis)),
        _frfs(shown),
        _section("What to measure next", the_next_test(diagnosis)),
        _section("What was not examined", not_examined(diagnosis)),
        _section("Warnings", the_warnings([*diagnosis.warnings, *warnings_of(sessions)])),
        _section("What this rests on", provenance(sessions, when)),
    )
    return _page(diagnosis.title or "Diagnosis", body)


def _page(title: str, body: Raw) -> str:
    style = files("modalkit.report").joinpath("style.css").read_text(encoding="utf-8")
    return "\n".join(
        (
            BEGIN,
            '<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(title)}: diagnosis</title>",
            f"<style>\n{style}</style></head>",
            f"<body><main>\n{body.markup}\n</main></body></html>\n",
        )
    )


def _section(title: str, *parts: Raw) -> Raw:
    return element("section", element("h2", title), *parts)


def _frfs(shown: Mapping[str, Drawing]) -> Raw:
    found = _figures(shown, "frfs")
    return _section("FRFs before and after", found) if found.markup else Raw("")


def _figures(shown: Mapping[str, Drawing], name: str) -> Raw:
    """Return a figure, and those of its kind of further specimens."""
    chosen = [n for n in shown if n == name or n.startswith(f"{name}_")]
    return joined(*(_figure(n, shown[n]) for n in chosen))


def _figure(name: str, drawing: Drawing) -> Raw:
    picture = Raw(inline_svg(drawing.figure, name, drawing.caption))
    return element("figure", picture, element("figcaption", drawing.caption))
