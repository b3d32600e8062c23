"""The report of an identification, or of modes that exist already."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.display import counted
from acquisition.quantities import hertz, percent
from identification import ModalModel
from modalkit.output.documents import without_hits
from modalkit.report.document import Document, Section
from modalkit.report.html import Raw, bullets, definitions, element, joined
from modalkit.report.modes import modes_table
from modalkit.report.provenance import Basis, cover, provenance
from modalkit.report.sections import the_warnings
from modalkit.report.tested import damping_section, expected_of, sections_of_test, shapes_section
from modalkit.workflow.case import Session
from modalkit.workflow.existing import Modes
from modalkit.workflow.processed import Processed


def identification_report(
    processed: Processed | None,
    modes: ModalModel | Modes,
    basis: Basis,
    *,
    named: tuple[Sequence[float], Sequence[float]] = ((), ()),
    session: Session | None = None,
    warnings: Sequence[str] = (),
    title: str = "",
) -> Document:
    """Return the report of an identification.

    Parameters
    ----------
    processed : Processed, optional
        The FRFs and hits; None for modes that exist already.
    modes : ModalModel or Modes
        The modes.
    basis : Basis
        What it rests on.
    named : (sequence, sequence)
        Frequencies that the user added and dropped [Hz].
    session : Session, optional
        The study with its model, which is drawn beside the shapes.
    warnings : sequence of str
        What the user should know.
    title : str
        Of the test.
    """
    identified = modes if isinstance(modes, ModalModel) else None
    return Document(
        title or "Identification",
        "modes",
        joined(
            element("h1", title or "Identification"),
            cover("Modes of a test", basis),
            modes_answer(processed, modes),
        ),
        [
            Section("Modes", [modes_table(modes.modal)]),
            Section("Left out", [_left_out(processed, modes)]),
            damping_section(modes.modal, None if session is None else expected_of(session)),
            *sections_of_test(processed, identified, modes.modal, named),
            shapes_section(modes.modal, session),
            Section("Warnings", [the_warnings(list(warnings))]),
            Section("What this rests on", [provenance(basis)]),
        ],
    )


def modes_answer(processed: Processed | None, modes: ModalModel | Modes) -> Raw:
    """Return what was found, in a few lines."""
    modal = modes.modal
    span = f"{hertz(modal.frequency.min())} to {hertz(modal.frequency.max())}" if len(modal) else "none"
    stated = {"Modes": f"{counted(len(modal), 'mode')}, {span}"}
    if isinstance(modes, ModalModel):
        stated["Band"] = f"{modes.band[0]:g} to {modes.band[1]:g} Hz"
    if processed is not None and processed.hits:
        left = sum(not hit.used for hit in processed.hits)
        stated["Hits"] = (
            f"{len(processed.hits)}, {left} left out" if left else f"{len(processed.hits)}, all used"
        )
    stated["Shapes"] = _shapes(modes)
    relative = modal.frequency_sigma / modal.frequency if len(modal) else None
    if relative is not None and (relative > 0).any():
        stated["Known to"] = f"frequencies to {percent(100 * float(relative.max()))} or better (1σ)"
    return joined(
        element(
            "p", f"{counted(len(modal), 'mode')} of the test, with what is known of them.", class_="answer"
        ),
        definitions(stated, class_="letter"),
    )


def _shapes(modes: ModalModel | Modes) -> str:
    if modes.modal.shapes is None:
        return "none"
    scaled = "mass-normalised" if modes.modal.scaled else "not mass-normalised"
    return f"at {counted(len(modes.modal.dofs), 'degree')} of freedom, {scaled}"


def _left_out(processed: Processed | None, modes: ModalModel | Modes) -> Raw:
    """Return the points that were left out, with the reason."""
    hits = () if processed is None else processed.hits
    return bullets([*without_hits(hits), *(modes.points_rejected if isinstance(modes, ModalModel) else ())])
