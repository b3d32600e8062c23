"""The report of a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from modalkit.figures.diagnosis.localisation import localisation_figure
from modalkit.output.location import localisation_title
from modalkit.output.words import answer
from modalkit.report.document import Document, Part, Section, Standing
from modalkit.report.html import element, joined
from modalkit.report.provenance import Basis, cover, provenance
from modalkit.report.sections import (
    not_examined,
    the_causes,
    the_gap,
    the_next_test,
    the_place,
    the_remainder,
    the_shrinkage,
    the_summary,
    the_warnings,
)
from modalkit.report.tested import sections_of_all
from modalkit.views.charts.causes import causes_chart, closing_chart
from modalkit.views.charts.frfs import overlaid_chart
from modalkit.views.charts.gap import after_words, gap_chart
from modalkit.views.charts.place import place_chart
from modalkit.views.mode_errors import mode_errors
from modalkit.views.shapes import Changed
from modalkit.views.structure import structure_page
from modalkit.workflow.case import Session
from modalkit.workflow.diagnosis import warnings_of
from modalkit.workflow.fitted import Fitted, fitted
from modalkit.workflow.overlaid import overlaid
from updating import Case, Diagnosis


def diagnosis_report(
    diagnosis: Diagnosis, sessions: Sequence[Session], *, when: datetime, command: str = ""
) -> Document:
    """Return the report of a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    sessions : sequence of Session
        What was diagnosed, in the order of the diagnosis.
    when : datetime
        Date of the report.
    command : str
        What repeats it.
    """
    basis = Basis(when, command, [session.study for session in sessions])
    bests = best_of(diagnosis, sessions)
    tests = sections_of_all(sessions, [explained_models(diagnosis, best) for best in bests])
    return Document(
        diagnosis.title or "Diagnosis",
        "diagnosis",
        joined(
            element("h1", diagnosis.title or "Diagnosis"),
            cover("Diagnosis of the gap between test and model", basis),
            element("p", answer(diagnosis), class_="answer"),
            the_summary(diagnosis),
        ),
        [
            *answer_sections(diagnosis, sessions, bests),
            *tests,
            Section("What was not examined", [not_examined(diagnosis)]),
            Section("Warnings", [the_warnings([*diagnosis.warnings, *warnings_of(sessions)])]),
            Section("What this rests on", [provenance(basis)]),
        ],
    )


def best_of(diagnosis: Diagnosis, sessions: Sequence[Session]) -> list[Fitted]:
    """Return the most probable explanation in the model of each study."""
    alone = len(sessions) == 1
    return [fitted(diagnosis, session.case, alone=alone) for session in sessions]


def explained_models(diagnosis: Diagnosis, best: Fitted) -> list[Changed]:
    """Return the model with the most probable explanation in it, as it is drawn beside the shapes; none without."""
    found = best.model()
    if found is None:
        return []
    return [Changed(f"with {' + '.join(diagnosis.ranking[0].effects)}", found[0])]


def answer_sections(
    diagnosis: Diagnosis, sessions: Sequence[Session], bests: Sequence[Fitted] | None = None
) -> list[Section]:
    """Return how large, where, what, what is left, how far, what next, FRFs before and after.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    sessions : sequence of Session
        What was diagnosed; without, only what the diagnosis itself holds is drawn.
    bests : sequence of Fitted, optional
        As of :func:`best_of`, where they are there already.
    """
    gaps, frfs = _by_session(diagnosis, sessions, best_of(diagnosis, sessions) if bests is None else bests)
    if not sessions:
        gaps = [gap_chart(mode_errors(diagnosis))]
    where = [_where(diagnosis, sessions[0].case)] if sessions else []
    return [
        Section("How large the gap is", [*gaps, the_gap(diagnosis)]),
        Section("Where it sits", [*where, the_place(diagnosis)]),
        Section("What causes it", [causes_chart(diagnosis), the_causes(diagnosis)]),
        Section("What is left", [the_remainder(diagnosis)]),
        Section("How far it closes", [closing_chart(diagnosis), the_shrinkage(diagnosis)]),
        Section("What to measure next", [the_next_test(diagnosis)]),
        Section("FRFs before and after", frfs),
    ]


def _by_session(
    diagnosis: Diagnosis, sessions: Sequence[Session], bests: Sequence[Fitted]
) -> tuple[list[Part], list[Part]]:
    """Return the gaps and the FRFs of each specimen."""
    alone = len(sessions) == 1
    gaps: list[Part] = []
    frfs: list[Part] = []
    for i, (session, best) in enumerate(zip(sessions, bests, strict=True), start=1):
        mark = "" if i == 1 else f"-{i}"
        if not alone:
            gaps.append(element("h3", session.case.title))
        errors = mode_errors(diagnosis, session.case, best=best)
        gaps.append(gap_chart(errors, f"gap{mark}", after=after_words(diagnosis)))
        if session.identified is not None:
            both = overlaid(session.identified.frfs, best)
            frfs.append(overlaid_chart(both, f"frfs{mark}", tests=len(sessions)))
    return gaps, frfs


def _where(diagnosis: Diagnosis, case: Case) -> Part | None:
    """Return the structure: a plan of beams and plates, in space what is the user's own."""
    found = structure_page(diagnosis, case)
    if found is None:
        return place_chart(diagnosis, case)
    text = (
        "Regions by the probability that the cause sits there, blue for 1; black: test points with the directions "
        "measured; orange: places found."
    )
    return Standing(
        "place",
        localisation_title(diagnosis),
        text,
        found,
        still=lambda: localisation_figure(diagnosis, case),
    )
