"""Measured FRFs under those of the unchanged model and of the model with the best explanation in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import FrfSet
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.form import FORMS
from identification import frac
from modalkit.figures.diagnosis.fitted import Fitted
from modalkit.figures.overlay import chosen_frfs
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    ORANGE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    tidy,
)
from modalkit.figures.test.frf import NAMES
from updating.correlation.frfs import CorrelatedFrfs, correlate_frfs
from updating.models.state import State
from updating.prediction.matching import pair_modes
from updating.prediction.predict import Predictor
from updating.test_data.measured import UNKNOWN_LEVEL

TALL, SHORT, BLOCK = 2.2, 0.7, 4.15
"""Heights of magnitude, phase, and all that belongs to one FRF [in]."""

BEYOND = 1.15
"""FRFs are drawn up to so many times the highest mode compared [-]."""


LINES = 4096
"""Most lines on which a model is solved for the drawing."""


@dataclass(frozen=True, eq=False)
class Overlaid:
    """Measured FRFs and a model's before and after.

    Parameters
    ----------
    before : CorrelatedFrfs
        With the unchanged model, a baseline's correction included.
    after : CorrelatedFrfs, optional
        With the best explanation in it.
    every : int
        So many lines apart, of those measured.
    levelled : bool
        Whether the models were scaled to the level of the test, which is not known.
    """

    before: CorrelatedFrfs
    after: CorrelatedFrfs | None
    every: int = 1
    levelled: bool = False


def overlaid(frfs: FrfSet, best: Fitted) -> Overlaid:
    """Compute the model's FRFs before and after.

    Parameters
    ----------
    frfs : FrfSet
        Those the test was identified from.
    best : Fitted
        The best explanation.

    Raises
    ------
    StudyError
        If none of the FRFs is between points of the test.
    """
    top = BEYOND * float(best.problem.measured.frequency.max())
    part = selected_lines(frfs.band(0.0, top) if frfs.frequency[0] < top < frfs.frequency[-1] else frfs)
    found, before = best.model(), best.problem.predictor
    after = None if found is None else _after(part, best, *found)
    both = Overlaid(_beside(part, best, before), after, round(part.df / frfs.df))
    test = best.problem.measured
    if test.absolute and test.calibration <= UNKNOWN_LEVEL:
        return both
    levelled = None if both.after is None else _levelled(both.after)
    return replace(both, before=_levelled(both.before), after=levelled, levelled=True)


def _levelled(both: CorrelatedFrfs) -> CorrelatedFrfs:
    """Return a model's FRFs times the median ratio of the measured ones to them."""
    size, own = np.abs(both.measured.values), np.abs(both.model.values)
    known = (size > 0) & (own > 0)
    factor = float(np.exp(np.median(np.log(size[known] / own[known])))) if known.any() else 1.0
    return replace(both, model=replace(both.model, values=factor * both.model.values))


def selected_lines(frfs: FrfSet) -> FrfSet:
    """Return FRFs on every n-th line, where they have more than :data:`LINES`."""
    every = -(-len(frfs.frequency) // LINES)
    if every == 1:
        return frfs
    return replace(
        frfs,
        frequency=frfs.frequency[::every],
        values=frfs.values[:, ::every],
        coherence=None,
        variance=None,
        scatter=None,
    )


def _beside(frfs: FrfSet, best: Fitted, predictor: Predictor) -> CorrelatedFrfs:
    prediction = predictor.predict(at_least=best.problem.reach)
    measured = best.problem.measured
    return correlate_frfs(frfs, measured, predictor, prediction, pair_modes(measured, prediction))


def _after(frfs: FrfSet, best: Fitted, predictor: Predictor, state: State) -> CorrelatedFrfs:
    """Return the model's FRFs as the measurement has them: at its level, with reversed or exchanged points, delayed."""
    both = at_level(frfs, 1.0 + state.slope * (best.problem.measured.level or 0.0), best, predictor)
    nodes = best.problem.measured.nodes
    values = both.model.values[_exchanged(both.measured, nodes, state)]
    for (role, point), gain in state.point_gains.items():
        dofs = both.measured.responses if role == "seen" else both.measured.references
        concerned = np.array([dof.node == nodes[point] for dof in dofs])
        values = np.where(concerned[:, None], gain * values, values)
    values = values * np.exp(-2j * np.pi * both.measured.frequency * state.delay)
    return replace(both, model=replace(both.model, values=values), frac=frac(both.measured.values, values))


def at_level(frfs: FrfSet, shift: float, best: Fitted, predictor: Predictor) -> CorrelatedFrfs:
    """Return a model's FRFs where all its frequencies are shifted, as by joints that soften with the level of the hits.

    A model whose stiffness is s^2 times another's, with the same damping ratios, answers at s p as that one at p:
    H(s p) = s^(n-2) H(p) for receptances (n = 0), mobilities (1) and accelerances (2).

    Parameters
    ----------
    frfs : FrfSet
        The measured ones.
    shift : float
        s, the factor of all frequencies [-].
    best : Fitted
        Test and model.
    predictor : Predictor
        The model, of whose matrices the shift is no part.
    """
    if shift == 1.0:
        return _beside(frfs, best, predictor)
    there = replace(frfs, frequency=frfs.frequency / shift, decay=frfs.decay / shift)
    both = _beside(there, best, predictor)
    values = shift ** (FORMS.index(frfs.form) - 2) * both.model.values
    measured = replace(both.measured, frequency=both.measured.frequency * shift, decay=frfs.decay)
    model = replace(both.model, frequency=measured.frequency, decay=frfs.decay, values=values)
    return replace(both, measured=measured, model=model, frac=frac(measured.values, values))


def _exchanged(frfs: FrfSet, nodes: tuple[int, ...], state: State) -> IntArray:
    """Return, for each FRF, the row that was really measured under its name."""
    ends = [(r.node, f.node) for r, f in zip(frfs.responses, frfs.references, strict=True)]
    rows = {pair: i for i, pair in enumerate(ends)}
    for role, a, b in state.exchanged:
        other = {nodes[a]: nodes[b], nodes[b]: nodes[a]}
        ends = [(other.get(s, s), h) if role == "seen" else (s, other.get(h, h)) for s, h in ends]
    return np.array([rows.get(pair, i) for i, pair in enumerate(ends)], dtype=np.int64)


def overlaid_figure(both: Overlaid, *, count: int = 4) -> Figure:
    """Draw magnitude and phase of some FRFs: measured, the unchanged model, and with the explanation.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    count : int
        How many at the most.

    Returns
    -------
    Figure
    """
    shown = both.before if both.after is None else both.after
    chosen = chosen_frfs(shown, count)
    columns = min(2, len(chosen))
    title, note = _words(both, len(chosen))
    top = caption_height(title, note) + 0.45
    figure = new_figure(top + math.ceil(len(chosen) / columns) * BLOCK - 0.2)
    caption(figure, title, note)
    width = (WIDTH - 2 * MARGIN - 0.75 * columns - 0.2 * (columns - 1)) / columns
    for i, (row, why) in enumerate(chosen.items()):
        left = MARGIN + 0.75 + (i % columns) * (width + 0.95)
        _block(figure, both, row, why, left=left, top=top + (i // columns) * BLOCK, width=width)
    return figure


def _words(both: Overlaid, shown: int) -> tuple[str, str]:
    before, form = both.before, NAMES[both.before.measured.form]
    count = f"{shown} of {len(before.frac)}" if shown < len(before.frac) else "all"
    lines = f" on every {both.every}th line" if both.every > 1 else ""
    note = f"{count} FRFs{lines}. Damping of the model: {before.damping}."
    if both.levelled:
        note += " The level of the test is not known; that of the models is drawn to fit it."
    if before.measured.decay:
        note += f" All with the exponential window of {before.measured.decay:g} 1/s."
    median = f"median FRAC {np.median(before.frac):.3f}"
    if both.after is None:
        return f"{form}: test and model, {median}", note
    return f"{form}: {median} before, {np.median(both.after.frac):.3f} after", note


def _block(
    figure: Figure, both: Overlaid, row: int, why: str, *, left: float, top: float, width: float
) -> None:
    """Draw the two panels of one FRF."""
    test, models = both.before.measured, _models(both)
    name = f"{test.responses[row]} / {test.references[row]}"
    heading(figure, left, top - 0.02, name + (f" ({why})" if why else ""))
    magnitude = place(figure, left, top + 0.3, width, TALL, name=f"magnitude {name}")
    phase = place(figure, left, top + 0.3 + TALL + 0.12, width, SHORT, name=f"phase {name}")
    tidy(magnitude, y=f"|H| [{test.unit}]")
    tidy(phase, x="frequency [Hz]", y="phase [°]")
    magnitude.set_yscale("log")
    _curve(magnitude, test, test.values[row], INK, "measured", width=1.0)
    angle = np.degrees(np.angle(test.values[row]))
    phase.plot(test.frequency, angle, ".", color=FAINT, markersize=2.0, rasterized=True)
    for label, stated, colour, dashed in models:
        correlation = f"{label}, FRAC {stated.frac[row]:.3f}"
        _curve(magnitude, stated.model, stated.model.values[row], colour, correlation, dashed=dashed)
        _phase(phase, stated.model.frequency, stated.model.values[row], colour, dashed=dashed)
    size = np.abs(
        np.concatenate([test.values[row], *(stated.model.values[row] for _, stated, _, _ in models)])
    )
    size = size[np.isfinite(size) & (size > 0)]
    if len(size):
        magnitude.set_ylim(float(np.percentile(size, 0.5)) / 2.5, float(size.max()) * 2)
    for panel in (magnitude, phase):
        panel.set_xlim(float(test.frequency[0]), float(test.frequency[-1]))
    phase.set_ylim(-190, 190)
    phase.set_yticks([-180, 0, 180])
    magnitude.tick_params(labelbottom=False)
    magnitude.legend(
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.0),
        ncols=3,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.3,
        handletextpad=0.4,
        columnspacing=1.0,
        borderpad=0.0,
        borderaxespad=0.1,
    )


def _models(both: Overlaid) -> list[tuple[str, CorrelatedFrfs, str, bool]]:
    found = [("before", both.before, ORANGE, True)]
    return found if both.after is None else [*found, ("after", both.after, BLUE, False)]


def _curve(
    axes: Axes,
    frfs: FrfSet,
    values: ComplexArray,
    colour: str,
    label: str,
    *,
    dashed: bool = False,
    width: float = 1.4,
) -> None:
    size = np.abs(values)
    style = (0, (4, 2)) if dashed else "solid"
    axes.plot(
        frfs.frequency,
        np.where(size > 0, size, np.nan),
        color=colour,
        linewidth=width,
        linestyle=style,
        label=label,
    )


def _phase(axes: Axes, frequency: FloatArray, values: ComplexArray, colour: str, *, dashed: bool) -> None:
    angle = np.degrees(np.angle(values))
    jump = np.append(np.abs(np.diff(angle)) > 180, False)
    style = (0, (4, 2)) if dashed else "solid"
    axes.plot(frequency, np.where(jump, np.nan, angle), color=colour, linewidth=1.3, linestyle=style)
