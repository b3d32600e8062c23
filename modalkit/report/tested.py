"""What every report shows of a test: hits, FRFs with fit, poles, how alike the modes are, shapes in motion."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition import HitVerdict, ModalData
from acquisition.display import counted
from acquisition.errors import InputError, ModalkitError
from acquisition.quantities import hertz
from identification import ModalModel, pole_origins
from modalkit.figures.shapes.shapes import shapes_figure
from modalkit.report.document import Moving, Section
from modalkit.report.html import Cell, Column, Raw, folded, table
from modalkit.report.modes import modes_table
from modalkit.views.chart import Chart
from modalkit.views.charts.damping import ExpectedDamping, damping_chart, expected_damping
from modalkit.views.charts.matrix import matrix_chart
from modalkit.views.charts.poles import poles_chart
from modalkit.views.charts.test import (
    auto_mac_chart,
    cmif_chart,
    frfs_chart,
    hits_chart,
    mvmif_chart,
    thin_indicators,
)
from modalkit.views.shapes import Beside, Changed, shapes_page
from modalkit.workflow.case import Session, modes_in_band
from modalkit.workflow.processed import Processed
from modalkit.workflow.stated_places import with_places
from updating.correlation.correlate import correlate
from updating.nominal import predictor_of


def sections_of_all(sessions: Sequence[Session], changed: Sequence[Sequence[Changed]] = ()) -> list[Section]:
    """Return the sections of the tests of several studies, one after the other.

    Parameters
    ----------
    sessions : sequence of Session
        The studies.
    changed : sequence of sequence of Changed
        Of each study, its model as it became; left out, none is drawn beside the shapes but that of the study.
    """
    became = changed or [()] * len(sessions)
    return [
        section
        for i, (session, own) in enumerate(zip(sessions, became, strict=True), start=1)
        for section in session_sections(session, number=i, tests=len(sessions), changed=own)
    ]


def session_sections(
    session: Session, *, number: int = 1, tests: int = 1, changed: Sequence[Changed] = ()
) -> list[Section]:
    """Return the sections of a study's test, with the model beside the shapes, as it stands and as it became.

    Parameters
    ----------
    session : Session
        The study worked out.
    number : int
        Which of several it is, from 1; its charts bear it.
    tests : int
        How many there are; of several, headings name the study.
    changed : sequence of Changed
        The study's model as it became.
    """
    whose = f" of {session.case.title}" if tests > 1 else ""
    modal = modal_of(session)
    test = session.study.test
    return [
        Section(f"Modes of the test{whose}", [] if modal is None else [modes_table(modal)]),
        damping_section(modal, expected_of(session), number, whose),
        *sections_of_test(
            session.processed, session.identified, modal, (test.add, test.drop), number, whose, tests
        ),
        shapes_section(modal, session, number, whose, changed),
    ]


def sections_of_test(
    processed: Processed | None,
    identified: ModalModel | None,
    modal: ModalData | None,
    named: tuple[Sequence[float], Sequence[float]] = ((), ()),
    number: int = 1,
    whose: str = "",
    tests: int = 1,
) -> list[Section]:
    """Return hits, FRFs and modes of a test; what it does not have is left out.

    Parameters
    ----------
    processed, identified, modal : Processed, ModalModel, ModalData, optional
        The test as far as it was worked out.
    named : (sequence, sequence)
        Frequencies that the user added and dropped [Hz].
    number : int
        Put behind the names of the charts, from 2 on.
    whose : str
        Put behind the headings.
    tests : int
        How many share the file [-].
    """
    mark = "" if number == 1 else f"-{number}"
    sections = []
    if processed is not None and processed.hits:
        chart = hits_chart(processed.hits, f"hits{mark}")
        sections.append(Section(f"Hits{whose}", [chart, hits_table(processed.hits)]))
    if identified is not None:
        origins = pole_origins(identified, add=named[0], drop=named[1])
        fit = [
            frfs_chart(identified, f"frf{mark}", tests=tests),
            poles_chart(identified, origins, f"poles{mark}"),
        ]
        if (tables := thin_indicators(identified.frfs)) is not None:
            fit.append(cmif_chart(identified.frfs, tables[0], f"cmif{mark}"))
            fit.append(mvmif_chart(identified.frfs, tables[1], f"mvmif{mark}"))
        sections.append(Section(f"FRFs and poles{whose}", fit))
    if modal is not None:
        sections.append(
            Section(f"How alike the modes are{whose}", [auto_mac_chart(modal, f"auto-mac{mark}")])
        )
    return sections


def damping_section(
    modal: ModalData | None, expected: ExpectedDamping | None = None, number: int = 1, whose: str = ""
) -> Section:
    """Return the damping over frequency, beside what a model expects."""
    mark = "" if number == 1 else f"-{number}"
    chart = None if modal is None else damping_chart(modal, expected, f"damping{mark}")
    return Section(f"Damping{whose}", [chart])


def expected_of(session: Session) -> ExpectedDamping | None:
    """Return the damping that a study's model expects; None where it states none, or does not go with the test."""
    beside, _ = _beside(session)
    return None if beside is None else expected_damping(beside)


def hits_table(hits: Sequence[HitVerdict]) -> Raw:
    """Return the verdict on every hit with its reasons."""
    columns = [
        Column("point"),
        Column("hit", lambda v: f"{v:.0f}"),
        Column("verdict"),
        Column("why"),
        Column("peak [N]", lambda v: f"{v:.4g}"),
        Column("-20 dB at [Hz]".replace("-", "−"), lambda v: f"{v:.0f}"),
    ]
    rows: list[list[Cell | Raw]] = [
        [str(h.point), h.hit, "used" if h.used else "left out", "; ".join(h.reasons), h.peak, h.band20]
        for h in hits
    ]
    shown = table("Verdict on every hit.", columns, rows)
    return folded(f"All {len(hits)} verdicts", shown)


def modal_of(session: Session) -> ModalData | None:
    """Return the modes of a study's test, identified or read."""
    if session.identified is not None:
        return session.identified.modal
    if session.study.test.modes is None:
        return None
    try:
        return modes_in_band(session.study, session.study.test, "test")[0]
    except InputError:  # the file is not there any more, which the provenance states
        return None


def shapes_section(
    modal: ModalData | None,
    session: Session | None,
    number: int = 1,
    whose: str = "",
    changed: Sequence[Changed] = (),
) -> Section:
    """Return the shapes in motion, test beside unchanged model and as it became, and the MAC between them."""
    mark, title = "" if number == 1 else f"-{number}", f"Shapes in motion{whose}"
    if modal is None or modal.shapes is None:
        return Section(title)
    if session is not None:
        study = session.study
        modal, _ = with_places(modal, study.test, study.axes(study.test), study.spec())
    placed = modal
    beside, why = _beside(session)
    page = shapes_page(modal, beside, changed)
    if not page["modes"]:
        return Section(title)
    moving = Moving(
        f"shapes{mark}",
        _moving(modal, page["model"] is not None),
        _lines(page["placed"]),
        page | {"no_model": why},
        still=lambda: shapes_figure(placed),
    )
    return Section(title, [moving, None if beside is None else mac_chart(beside, f"mac{mark}")])


def _moving(modal: ModalData, both: bool) -> str:
    points = len({dof.node for dof in modal.dofs})
    beside = ", test beside model" if both else ""
    where = f"{counted(points, 'point')}, {counted(len(modal.dofs), 'direction')}"
    return f"{counted(len(modal), 'mode')} at {where}{beside}"


def _lines(placed: bool) -> str:
    return "Lines are those of the test; a surface is drawn only where lines enclose it." if placed else ""


def _beside(session: Session | None) -> tuple[Beside | None, str]:
    """Return the model beside the test, or why there is none."""
    if session is None:
        return None, ""
    try:
        return Beside(session, predictor_of(session.case), correlate(session.case)), ""
    except ModalkitError as error:
        return None, str(error)


def mac_chart(beside: Beside, name: str = "mac") -> Chart | None:
    """Return the MAC of every measured mode with every mode of the model; None without shapes."""
    matrix = beside.correlation.mac
    if matrix.empty:
        return None
    test = beside.session.case.measured.frequency
    model = beside.predictor.predict().frequency
    rows = [f"{i}: {hertz(test[i - 1])}" for i in map(int, matrix.index)]
    columns = [f"{i}: {hertz(model[i - 1])}" for i in map(int, matrix.columns)]
    pairs = beside.correlation.table
    least = pairs["MAC"].min()
    title = f"{counted(len(pairs), 'pair')} of test and model, the least alike with a MAC of {least:.2f}"
    text = "MAC of every measured mode with every mode of the unchanged model, in hundredths."
    return matrix_chart(name, title, text, matrix.to_numpy(float), rows, columns, axes=("test", "model"))
