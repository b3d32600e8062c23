"""The report of an identification, or of modes that exist already."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.display import counted
from acquisition.quantities import hertz, percent
from identification import ModalModel, mpc
from modalkit.output.documents import without_hits
from modalkit.report.document import Document, Section
from modalkit.report.html import Cell, Column, Raw, bullets, definitions, element, joined, table
from modalkit.report.page import page
from modalkit.report.provenance import Basis, provenance
from modalkit.report.sections import the_warnings
from modalkit.report.tested import sections_of_test, shapes_section
from modalkit.workflow.case import Session
from modalkit.workflow.existing import Modes
from modalkit.workflow.identification import Processed


def identification_report(
    processed: Processed | None,
    modes: ModalModel | Modes,
    basis: Basis,
    *,
    named: tuple[Sequence[float], Sequence[float]] = ((), ()),
    session: Session | None = None,
    warnings: Sequence[str] = (),
    title: str = "",
) -> str:
    """Return the report of an identification as the text of an HTML file.

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
    return page(
        Document(
            title or "Identification",
            "modes",
            joined(element("h1", title or "Identification"), modes_answer(processed, modes)),
            [
                Section("Modes", [modes_table(modes)]),
                Section("Left out", [_left_out(processed, modes)]),
                *sections_of_test(processed, identified, modes.modal, named),
                shapes_section(modes.modal, session),
                Section("Warnings", [the_warnings(list(warnings))]),
                Section("What this rests on", [provenance(basis)]),
            ],
        )
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


def modes_table(modes: ModalModel | Modes) -> Raw:
    """Return one row per mode with its standard deviations."""
    modal = modes.modal
    assert modal.damping is not None
    assert modal.damping_sigma is not None
    purity = None if modal.shapes is None else mpc(modal.shapes)
    columns = [
        Column("mode", lambda v: f"{v:.0f}"),
        Column("frequency [Hz]", lambda v: f"{v:.4f}"),
        Column("sigma [Hz]", lambda v: f"{v:.2g}"),
        Column("damping [%]", lambda v: f"{v:.4f}"),
        Column("sigma [%]", lambda v: f"{v:.2g}"),
        Column("MPC", lambda v: f"{v:.3f}"),
    ]
    rows: list[list[Cell | Raw]] = [
        [
            r + 1,
            float(modal.frequency[r]),
            float(modal.frequency_sigma[r]),
            100 * float(modal.damping[r]),
            100 * float(modal.damping_sigma[r]),
            None if purity is None else float(purity[r]),
        ]
        for r in range(len(modal))
    ]
    return table(
        "Frequencies and damping ratios with one standard deviation; MPC is 1 for a real mode.", columns, rows
    )


def _left_out(processed: Processed | None, modes: ModalModel | Modes) -> Raw:
    """Return the points that were left out, with the reason."""
    hits = () if processed is None else processed.hits
    return bullets([*without_hits(hits), *(modes.points_rejected if isinstance(modes, ModalModel) else ())])
