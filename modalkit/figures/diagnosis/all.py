"""The figures of a diagnosis: what ``--figures`` writes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from modalkit.figures.charts import frf_figure, gap_figure, overlaid_figure, shrink_figure
from modalkit.figures.diagnosis.figure import diagnosis_figure
from modalkit.figures.diagnosis.localisation import localisation_figure
from modalkit.views.charts.gap import after_words
from modalkit.views.mode_errors import mode_errors
from modalkit.workflow.case import Session
from modalkit.workflow.fitted import Fitted, fitted
from modalkit.workflow.overlaid import overlaid
from updating import Diagnosis


@dataclass(frozen=True, eq=False)
class Drawing:
    """A figure with what stands under it.

    Parameters
    ----------
    figure : Figure
        The figure.
    caption : str
        What it shows, in words for those who cannot see it too.
    """

    figure: Figure
    caption: str


def drawings(diagnosis: Diagnosis, sessions: Sequence[Session]) -> dict[str, Drawing]:
    """Draw a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    sessions : sequence of Session
        What was diagnosed, in the order of the diagnosis.

    Returns
    -------
    dict of str to Drawing
        By file name: ``diagnosis``, ``gap``, ``localisation``, ``shrink``, and where there are FRFs ``frfs`` and
        ``frf``; those of further specimens have their number behind the name.
    """
    first = sessions[0]
    bests = [fitted(diagnosis, session.case, alone=len(sessions) == 1) for session in sessions]
    found = {
        "diagnosis": Drawing(
            diagnosis_figure(diagnosis, first.case, best=bests[0]), "The whole answer on one page."
        )
    }
    for i, (session, best) in enumerate(zip(sessions, bests, strict=True)):
        found |= {f"{n}{_number(i)}": d for n, d in _own(diagnosis, session, best, len(sessions) > 1).items()}
    found["localisation"] = Drawing(
        localisation_figure(diagnosis, first.case),
        "The structure with its zones, shaded by the probability that the cause sits there, its test points and "
        "sensors, the places found, and what every mode adds to the gap.",
    )
    found["shrink"] = Drawing(
        shrink_figure(diagnosis),
        "The gap of the unchanged model, of its tolerances alone, of the runner-up and of the answer, "
        "each mode predicted from all others (dots), and on the data that were fitted (ring). The shaded "
        "part is noise.",
    )
    return found


def _own(diagnosis: Diagnosis, session: Session, best: Fitted, several: bool) -> dict[str, Drawing]:
    """Return the figures of one specimen."""
    title = session.case.title
    name = f"{title}: " if several else ""
    errors = mode_errors(diagnosis, session.case, best=best)
    shown = (
        "Error of every mode of the unchanged model (rings)"
        if errors.after is None
        else "Error of every mode before (rings) and after the most probable explanation (dots)"
    )
    bands = "" if errors.floor is None else ", with the bands that noise, and noise with the tolerances, fill"
    found = {
        "gap": Drawing(
            gap_figure(errors, after=after_words(diagnosis), title=title if several else ""),
            f"{name}{shown}{bands}.",
        )
    }
    if session.identified is None:
        return found
    frfs = session.identified.frfs
    found["frfs"] = Drawing(
        overlaid_figure(overlaid(frfs, best)),
        f"{name}Measured FRFs, those of the unchanged model (before), and those of the model with the most "
        "probable explanation and tolerances in it (after).",
    )
    found["frf"] = Drawing(
        frf_figure(frfs, session.identified), f"{name}Measured FRFs and those of the identified modes."
    )
    return found


def _number(i: int) -> str:
    return "" if i == 0 else f"_{i + 1}"
