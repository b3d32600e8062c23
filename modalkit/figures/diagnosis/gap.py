"""How large the gap is mode by mode, before and after, on a page of its own."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from acquisition.display import counted
from modalkit.figures.dumbbell import dumbbells
from modalkit.figures.style import MARGIN, WIDTH, caption, caption_height, new_figure, place
from modalkit.output.words import METRICS
from modalkit.views.mode_errors import ModeErrors
from updating import Diagnosis

ROW, INDENT = 0.3, 1.25
"""Height of a row and width of its name [in]."""


def gap_figure(diagnosis: Diagnosis, errors: ModeErrors, *, title: str = "") -> Figure:
    """Draw the error of every mode as it was and as the best explanation leaves it.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    errors : ModeErrors
        Errors of one specimen.
    title : str
        Which specimen, where there are several.

    Returns
    -------
    Figure
    """
    statement, note = _title(diagnosis, errors, of_several=bool(title)), title
    top = caption_height(statement, note) + 0.45
    tall = max(1.3, ROW * len(errors.frequency) + 0.3)
    figure = new_figure(top + tall + 0.65)
    caption(figure, statement, note)
    panel = place(figure, MARGIN + INDENT, top, WIDTH - 2 * MARGIN - INDENT - 0.1, tall, name="gap")
    dumbbells(
        panel,
        errors.frequency,
        errors.before,
        errors.after,
        floor=errors.floor,
        doubt=errors.doubt,
        signed=errors.signed,
        label=errors.label,
        indent=INDENT,
    )
    return figure


def _title(diagnosis: Diagnosis, errors: ModeErrors, *, of_several: bool) -> str:
    name = "all data" if errors.channel == "combined" else METRICS[errors.channel]
    modes = counted(len(errors.frequency), "mode")
    if diagnosis.verdict == "none":
        return f"{_capital(name)}, {modes}: {_outside(errors)}"
    if errors.after is None:
        return f"{_capital(name)} shows the gap most clearly ({modes})"
    shrink = diagnosis.shrink
    if errors.channel != shrink.metric or of_several:
        return f"{_capital(name)} of {modes}, before and after"
    left = "with the best-fitting (rejected) explanation" if diagnosis.verdict == "unknown" else "after"
    before, after = shrink.size(shrink.before), shrink.size(shrink.after)
    return f"{_capital(name)} of {modes}: {before} r.m.s. before, {after} {left}"


def _outside(errors: ModeErrors) -> str:
    """State how many modes lie outside the band of noise and tolerances that is drawn."""
    band = errors.doubt if errors.doubt is not None else errors.floor
    if band is None:
        return "all within tolerances and noise"
    what = "noise and tolerances" if errors.doubt is not None else "noise"
    count = int(np.sum(np.abs(errors.before) > band))
    return f"{count or 'none'} outside the band of {what} (2σ)"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
