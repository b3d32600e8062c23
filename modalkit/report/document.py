"""A report before it is written: sections of markup, charts and structures in space."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from matplotlib.figure import Figure

from modalkit.report.html import Raw
from modalkit.views.chart import Chart


@dataclass(frozen=True, eq=False)
class InSpace:
    """What is drawn in three dimensions.

    Parameters
    ----------
    name : str
        Of its element.
    title, text : str
        What it shows.
    page : dict
        As of :func:`modalkit.views.shapes.shapes_page`, or :func:`modalkit.views.structure.structure_page`.
    still : callable
        What draws it for paper.
    """

    name: str
    title: str
    text: str
    page: dict[str, Any]
    still: Callable[[], Figure]


class Moving(InSpace):
    """Shapes, animated."""


class Standing(InSpace):
    """A structure, coloured by the probability of its regions."""


Part = Raw | Chart | Moving | Standing


@dataclass(frozen=True, eq=False)
class Section:
    """A section with its heading; one without parts is left out."""

    title: str
    parts: Sequence[Part | None] = ()

    @property
    def shown(self) -> list[Part]:
        """The parts that have something in them."""
        return [p for p in self.parts if p is not None and not (isinstance(p, Raw) and not p.markup)]


@dataclass(frozen=True, eq=False)
class Document:
    """A whole report.

    Parameters
    ----------
    title, kind : str
        What it is about, and what is reported of it.
    head : Raw
        The answer, before everything else.
    sections : sequence of Section
        The rest, in its order.
    """

    title: str
    kind: str
    head: Raw
    sections: Sequence[Section] = field(default_factory=tuple)

    @property
    def shown(self) -> list[Section]:
        """The sections that have something in them."""
        return [section for section in self.sections if section.shown]

    def parts(self) -> Iterator[Part]:
        """Yield all parts in their order."""
        for section in self.shown:
            yield from section.shown
