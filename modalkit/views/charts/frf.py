"""FRFs: magnitude, and beneath it on the same lines phase and coherence, for every figure and page alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition import FrfSet
from acquisition.arrays import AnyArray, FloatArray
from identification import ModalModel
from modalkit.views.chart import Axis, Chart, Series, Sheet

PARTS = {
    "measured": ("ink", {"width": 2.6}),
    "earlier": ("faint", {}),
    "fit": ("orange", {"width": 1.1}),
    "before": ("orange", {"width": 1.1, "dash": True}),
    "after": ("blue", {"width": 1.3}),
    "remainder": ("faint", {"width": 1.0}),
    "noise": ("muted", {"width": 1.0, "dash": True}),
}
"""How a curve is drawn by the part it plays. The measured one is broad: it shows on both sides of what lies over it."""

DECADES = 8.0
"""The axis reaches so far below the largest magnitude at the most: lower is noise of numbers [-]."""

NAMES = {"receptance": "Receptances", "mobility": "Mobilities", "accelerance": "Accelerances"}


@dataclass(frozen=True, eq=False)
class Curve:
    """One FRF.

    Parameters
    ----------
    part : str
        A key of ``PARTS``.
    name : str
        In the key.
    frequency : (n_lines,) array
        Lines [Hz].
    values : (n_lines,) array
        The FRF; real ones, as of noise, have no phase [unit of the chart].
    coherence : (n_lines,) array, optional
        Its coherence [-].
    """

    part: str
    name: str
    frequency: FloatArray
    values: AnyArray
    coherence: FloatArray | None = None


def frf_chart(
    name: str, title: str, text: str, unit: str, curves: Sequence[Curve], *, modes: Sequence[float] = ()
) -> Chart:
    """Return magnitude, phase and coherence of FRFs of one pair of points.

    Parameters
    ----------
    name, title, text : str
        Of the chart.
    unit : str
        Of the FRFs.
    curves : sequence of Curve
        The one whose lines are shown first.
    modes : sequence of float
        Frequencies that are marked [Hz].
    """
    turn = _turn([one.values for one in curves if np.iscomplexobj(one.values)])
    known = [one for one in curves if one.coherence is not None]
    series = [magnitude(one) for one in curves]
    series += [_beneath(one, phase(one.values, turn), 1) for one in curves if np.iscomplexobj(one.values)]
    series += [_beneath(one, one.coherence, 2, width=1.0) for one in known]
    ticks = tuple(v for v in (-180.0, 0.0, 180.0) if turn <= v <= turn + 360)
    below = [Axis("phase [°]", range=(turn - 10, turn + 370), ticks=ticks)]
    if known:
        below.append(Axis("γ² [-]", range=(0.0, 1.05), ticks=(0.0, 1.0)))
    lines = curves[0].frequency
    return Chart(
        name,
        title,
        text,
        Axis("frequency [Hz]", range=(float(lines[0]), float(lines[-1]))),
        Axis(f"|H| [{unit}]", log=True, range=_levels([one.values for one in curves])),
        series,
        below=below,
        more={"modes": [float(f) for f in modes]},
    )


def magnitude(curve: Curve, keep: AnyArray | None = None) -> Series:
    """Return the magnitude of an FRF; on lines that several share, which are not repeated, where ``keep`` has them."""
    colour, more = PARTS[curve.part]
    x, y = (curve.frequency, curve.values) if keep is None else (None, curve.values[keep])
    size = np.abs(y)
    return Series(curve.name, "line", x, np.where(size > 0, size, np.nan), colour, dict(more))


def _beneath(curve: Curve, values: FloatArray | None, panel: int, **own: float) -> Series:
    assert values is not None
    colour, drawn = PARTS[curve.part]
    more = {**drawn, **own, "panel": panel, "unnamed": True}
    return Series(curve.name, "line", curve.frequency, values, colour, more)


def phase(values: AnyArray, turn: float = -180.0) -> FloatArray:
    """Return phases in the 360 degrees above ``turn``, nan ahead of a jump, where no line is drawn [deg]."""
    angle = turn + np.mod(np.degrees(np.angle(values)) - turn, 360.0)
    jump = np.append(np.abs(np.diff(angle)) > 180, False)
    return np.asarray(np.where(jump, np.nan, angle))


def _turn(curves: Sequence[AnyArray]) -> float:
    """Return where the turn begins in which phases jump least: most lie about 0 and 180, some about 90 [deg]."""

    def jumps(turn: float) -> int:
        return sum(int(np.isnan(phase(values, turn)).sum()) for values in curves)

    return min((-180.0, -90.0, -270.0), key=jumps)


def _levels(curves: Sequence[AnyArray]) -> tuple[float, float]:
    """Return the ends of the axis, which cut off single lines that antiresonances drive towards zero."""
    size = np.abs(np.concatenate(curves))
    size = size[np.isfinite(size) & (size > 0)]
    if not len(size):
        return 0.1, 10.0
    top = float(size.max())
    return max(float(np.percentile(size, 0.5)) / 2.5, top / 10**DECADES), 3 * top


def frf_names(frfs: FrfSet) -> list[str]:
    """Return what each FRF is between: response / force."""
    return [f"{a} / {b}" for a, b in zip(frfs.responses, frfs.references, strict=True)]


def test_sheet(frfs: FrfSet, model: ModalModel | None = None, *, count: int = 4) -> Sheet:
    """Return some FRFs with their coherence, the fit over them and the modes marked.

    Parameters
    ----------
    frfs : FrfSet
        Measured FRFs.
    model : ModalModel, optional
        The fit; only its band is then shown.
    count : int
        Number of FRFs at the most: a drive point if there is one, the others spread over the set.
    """
    chosen, names = pick(frfs, count), frf_names(frfs)
    shown = frfs if model is None else _within(frfs, *model.band)
    whole = len(names)
    where = f"all {whole}" if len(chosen) == whole else f"{len(chosen)} of {whole}"
    where = "the one pair" if whole == 1 else f"{where} pairs"
    charts = []
    for row in chosen:
        coherence = None if shown.coherence is None else shown.coherence[row]
        curves = [Curve("measured", "measured", shown.frequency, shown.values[row], coherence)]
        curves += [] if model is None else _fit(model, frfs, row)
        modes = () if model is None else model.modal.frequency.tolist()
        charts.append(frf_chart(f"frf-{row}", names[row], "", frfs.unit, curves, modes=modes))
    fitted = "with the fit " if model else ""
    return Sheet(f"{NAMES[frfs.form]} {fitted}at {where} of points", _note(frfs, model), charts)


def pick(frfs: FrfSet, count: int) -> list[int]:
    """Choose rows: a drive point first, the others spread evenly over the set."""
    n = len(frfs.responses)
    spread = np.unique(np.linspace(0, n - 1, max(1, min(count, n))).round().astype(int)).tolist()
    pairs = zip(frfs.responses, frfs.references, strict=True)
    drive = [i for i, (r, f) in enumerate(pairs) if (r.node, r.axis) == (f.node, f.axis)]
    if drive and not set(drive) & set(spread):
        nearest = min(range(len(spread)), key=lambda k: abs(spread[k] - drive[0]))
        spread[nearest] = drive[0]
    return [int(i) for i in sorted(spread, key=lambda i: (i not in drive, i))]


def _within(frfs: FrfSet, low: float, high: float) -> FrfSet:
    """Return the lines of a band and a margin, all of them if the band holds too few."""
    inside = np.count_nonzero((frfs.frequency >= low) & (frfs.frequency <= high))
    edge = 0.03 * (high - low)
    return frfs.band(max(low - edge, 0.0), high + edge) if inside >= 2 else frfs


def _fit(model: ModalModel, frfs: FrfSet, row: int) -> list[Curve]:
    """Return the fit of one FRF; none where it was left out of the identification."""
    pair = (frfs.responses[row], frfs.references[row])
    pairs = list(zip(model.frfs.responses, model.frfs.references, strict=True))
    if pair not in pairs:
        return []
    fitted = model.synthesise().select([pairs.index(pair)]).to(frfs.form)
    return [Curve("fit", "fit", fitted.frequency, fitted.values[0])]


def _note(frfs: FrfSet, model: ModalModel | None) -> str:
    parts = [f"{frfs.frequency[0]:.4g}–{frfs.frequency[-1]:.4g} Hz in steps of {frfs.df:.3g} Hz"]
    if frfs.averages is not None:
        few, many = int(frfs.averages.min()), int(frfs.averages.max())
        parts.append(f"{few if few == many else f'{few} to {many}'} hits averaged")
    if frfs.decay:
        parts.append(f"exponential window of {frfs.decay:.3g} 1/s still in them")
    if model is not None:
        parts.append(f"{len(model)} modes between {model.band[0]:.4g} and {model.band[1]:.4g} Hz")
    return "  ·  ".join(parts)
