"""How far the gap shrinks, on a page of its own: on the data fitted and on what was held out, beside its rivals."""

from __future__ import annotations

from matplotlib.figure import Figure

from modalkit.figures.diagnosis.held_out import draw_held_out
from modalkit.figures.style import MARGIN, WIDTH, caption, caption_height, new_figure, place
from modalkit.views.charts.causes import rivals
from updating import Diagnosis

ROOM, ROW = 4.2, 0.42
"""Width of the names and height of a row [in]."""


def shrink_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the gap of the unchanged model, of the tolerances alone, of the runner-up and of the answer.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.

    Returns
    -------
    Figure
    """
    title, note = _title(diagnosis), _note(diagnosis)
    top = caption_height(title, note) + 0.1
    tall = ROW * len(rivals(diagnosis)) + 0.35
    figure = new_figure(top + tall + 0.65)
    caption(figure, title, note)
    panel = place(figure, MARGIN + ROOM, top, WIDTH - 2 * MARGIN - ROOM - 0.5, tall, name="held out")
    draw_held_out(panel, diagnosis, room=ROOM - 0.1, fitted=True)
    return figure


def _title(diagnosis: Diagnosis) -> str:
    shrink = diagnosis.shrink
    if diagnosis.verdict == "none":
        return "Nothing to close"
    if diagnosis.verdict == "unknown":
        return "What the best-fitting explanation would close; it is rejected"
    if shrink.closed is None or not shrink.closed.determined:
        before, after = map(shrink.size, (shrink.held_before, shrink.held_after))
        return f"{before} becomes {after} on modes held out"
    return f"Closes {shrink.closed} of the reducible gap"


def _note(diagnosis: Diagnosis) -> str:
    shrink = diagnosis.shrink
    if diagnosis.verdict == "none":
        return ""
    if shrink.held_nuisance <= 1.25 * shrink.held_after:
        return (
            "The tolerances alone would close the gap in this kind of data as far: the cause is "
            "identified by the other data, not by this figure."
        )
    return "Each mode is predicted from all the others in turn."
