"""Results in a notebook: the drawings of the report in a frame; loading this needs nothing of a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from pathlib import Path
from typing import Any

from acquisition import InputError, ModalData
from identification import ModalModel
from modalkit.output.words import answer
from modalkit.report.diagnosis import answer_sections
from modalkit.report.document import Document, Section
from modalkit.report.html import Raw, element, joined
from modalkit.report.identification import modes_answer
from modalkit.report.modes import modes_table
from modalkit.report.page import page
from modalkit.report.place import write_report
from modalkit.report.sections import the_summary
from modalkit.report.tested import damping_section, sections_of_test, shapes_section
from modalkit.report.updating import update_answer, update_sections
from modalkit.workflow.case import Session
from modalkit.workflow.existing import Modes
from modalkit.workflow.processed import Processed
from updating import Diagnosis
from updating.update import Update

HEIGHT = 720
"""Height of the frame; what is longer scrolls in it [px]."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A page that a notebook shows.

    Parameters
    ----------
    document : Document
        What it shows.
    """

    document: Document

    @property
    def page(self) -> str:
        """The text of an HTML file that needs nothing else."""
        return page(self.document)

    @property
    def title(self) -> str:
        """What it shows."""
        return self.document.title

    def _repr_html_(self) -> str:
        """Return the page in a frame that can ask for nothing and changes nothing around it."""
        return (
            f'<iframe srcdoc="{escape(self.page, quote=True)}" title="{escape(self.title, quote=True)}" '
            f'sandbox="allow-scripts allow-downloads" style="width:100%;height:{HEIGHT}px;border:0"></iframe>'
        )

    def __repr__(self) -> str:
        """Return what it is, for a terminal."""
        return f"Drawn: {self.title}; a notebook shows it, save(path) writes it"

    def save(self, path: Path | str) -> None:
        """Write the page to a file that opens in any browser, or to one for Word where it ends in .docx.

        Raises
        ------
        InputError
            If it cannot be written, or something else than a report stands there.
        """
        write_report(Path(path), self.document)


def show(result: Any, *sessions: Session) -> Drawn:
    """Return the drawings of a result.

    Parameters
    ----------
    result : Diagnosis, Update, ModalModel, Modes, ModalData or Processed
        What to draw.
    *sessions : Session
        The studies it rests on.

    Raises
    ------
    InputError
        If there are none of such a thing.
    """
    title, head, sections = _parts(result, sessions)
    whole = joined(element("h1", title), head)
    return Drawn(Document(title, type(result).__name__, whole, sections))


def animate(modes: Any, session: Session | None = None) -> Drawn:
    """Return mode shapes in motion, with the model of a study beside them.

    Parameters
    ----------
    modes : ModalModel, Modes, ModalData or Session
        The modes, or a study that has some.
    session : Session, optional
        The study.

    Raises
    ------
    InputError
        If there are no shapes.
    """
    if isinstance(modes, Session):
        from modalkit.report.tested import modal_of

        modal, session = modal_of(modes), modes
    else:
        modal = modes if isinstance(modes, ModalData) else modes.modal
    section = shapes_section(modal, session)
    if not section.shown:
        raise InputError("these modes have no shapes to move; identify them from FRFs at several points")
    title = "Mode shapes" if session is None else session.case.title
    return Drawn(Document(title, "shapes", element("h1", title), [section]))


Parts = tuple[str, Raw, Sequence[Section]]


@singledispatch
def _parts(result: Any, sessions: Sequence[Session]) -> Parts:
    raise InputError(f"there are no drawings of a {type(result).__name__}")


@_parts.register
def _of_diagnosis(result: Diagnosis, sessions: Sequence[Session]) -> Parts:
    head = joined(element("p", answer(result), class_="answer"), the_summary(result))
    return result.title or "Diagnosis", head, answer_sections(result, sessions)


@_parts.register
def _of_update(result: Update, sessions: Sequence[Session]) -> Parts:
    title = ", ".join(dict.fromkeys(str(name) for name in result.pairs["study"]))
    return title, update_answer(result), update_sections(result)


@_parts.register
def _of_model(result: ModalModel, sessions: Sequence[Session]) -> Parts:
    modes = Section("Modes", [modes_table(result.modal)])
    sections = [modes, damping_section(result.modal), *sections_of_test(None, result, result.modal)]
    return "Modes", modes_answer(None, result), sections


@_parts.register
def _of_modes(result: Modes, sessions: Sequence[Session]) -> Parts:
    modes = Section("Modes", [modes_table(result.modal)])
    return (
        result.title or "Modes",
        modes_answer(None, result),
        [modes, damping_section(result.modal), *sections_of_test(None, None, result.modal)],
    )


@_parts.register
def _of_modal(result: ModalData, sessions: Sequence[Session]) -> Parts:
    return _of_modes(Modes(result), sessions)


@_parts.register
def _of_processed(result: Processed, sessions: Sequence[Session]) -> Parts:
    return result.content.title or "Test", Raw(""), sections_of_test(result, None, None)
