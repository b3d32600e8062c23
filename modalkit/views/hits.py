"""The page of the hits: every verdict with its reason, the records of one, the FRFs that follow."""

from __future__ import annotations

from typing import Any

import numpy as np

from acquisition import FrfSet, HitVerdict, InputError, force_range
from acquisition.arrays import FloatArray
from acquisition.hits.checks import pulse_spectrum, upright
from acquisition.quantities import hertz, number
from acquisition.warned import in_order
from modalkit.output.documents import hit_document
from modalkit.study.read import Study
from modalkit.views.charts.frf import frf_names
from modalkit.views.curves import POINTS, check_frf, decibels, envelope, lines
from modalkit.workflow.judged_hits import Judged
from modalkit.workflow.processed import Processed

PULSE_EDGE = 0.1
"""A pulse lasts as long as the force is above this share of its peak [-]. Halved: noise of a weak hit counts to it."""

AROUND = (2, 4)
"""So many lengths of the pulse are drawn before and behind it, sample by sample [-]: ringing and what a tip does when
it leaves. Doubled: the pulse is half as wide in the picture."""


def hits_page(processed: Processed | None, study: Study) -> dict[str, Any]:
    """Return the verdicts and the list of FRFs; None stands for a test that has modes alone."""
    if processed is None:
        return {"hits": [], "force": None, "frfs": [], "first": 0, "unit": "", "warnings": []}
    named = {(p.upper(), n) for p, n in (*study.test.use, *study.test.leave)}
    force = force_range(processed.hits)
    return {
        "hits": [_verdict(v, decided=(str(v.point), v.hit) in named) for v in processed.hits],
        "force": None if force is None else str(force),
        "frfs": frf_names(processed.frfs),
        "first": first_frf(processed.frfs),
        "unit": processed.frfs.unit,
        "estimator": study.test.estimator,
        "warnings": [str(w) for w in in_order(processed.warnings)],
    }


def first_frf(frfs: FrfSet) -> int:
    """Return the FRF that is shown first: the largest at a drive point; of a test without any, the largest of all."""
    size = np.sqrt(np.mean(np.abs(frfs.values) ** 2, axis=1))
    driven = np.array([a.node == b.node for a, b in zip(frfs.responses, frfs.references, strict=True)])
    return int(np.argmax(np.where(driven, size, -1.0) if driven.any() else size))


def _verdict(verdict: HitVerdict, *, decided: bool) -> dict[str, Any]:
    """Return the verdict on a hit, with what was proposed: a hit with a fault is not to be used."""
    return {
        **hit_document(verdict),
        "proposed": not verdict.kind,
        "decided": decided,
        "peak": f"{number(verdict.peak)} N",
        "width": f"{number(1e3 * verdict.width)} ms",
        "band10": hertz(verdict.band10),
        "band20": hertz(verdict.band20),
    }


def record_page(processed: Processed, point: str, hit: int) -> dict[str, Any]:
    """Return force and responses of a hit, and the spectrum of its force with where it is 10 and 20 dB down.

    Raises
    ------
    InputError
        If there is no such hit.
    """
    judged, verdict, entry, row = _found(processed, point, hit)
    test = judged.test
    time = np.arange(test.samples) / test.rate
    wave = upright(np.asarray(test.points[entry].force[[row]], dtype=float))[0]
    frequency, size = pulse_spectrum(wave, test.rate)
    level = decibels(size / max(float(size[0]), 1e-300))
    shown = frequency <= min(3 * max(verdict.band20, 1.0), frequency[-1])
    x, y = envelope(frequency[shown], np.maximum(level[shown], -80.0))
    responses = [
        {"dof": str(dof), "time": t, "value": v}
        for dof, motion in zip(test.points[entry].responses, test.points[entry].motion[row], strict=True)
        for t, v in [envelope(time, motion)]
    ]
    return {
        "verdict": _verdict(verdict, decided=False),
        "force": force_trace(time, test.points[entry].force[row]),
        "responses": responses,
        "unit": {"receptance": "m", "mobility": "m/s", "accelerance": "m/s²"}[test.form],
        "spectrum": {"frequency": x, "level": y, "band10": verdict.band10, "band20": verdict.band20},
    }


def force_trace(time: FloatArray, force: FloatArray) -> dict[str, Any]:
    """Return a force with every sample about its pulse, and the times between which that is drawn first."""
    first, last = about_pulse(force)
    x, y = envelope(time, force, (first, last))
    return {"time": x, "value": y, "range": [float(time[first]), float(time[last - 1])]}


def about_pulse(force: FloatArray) -> tuple[int, int]:
    """Return the first sample about a pulse, and that behind the last; of several hits about all of them.

    No more than ``curves.POINTS`` samples: about the highest of what lasts longer.
    """
    size = np.abs(force)
    inside = np.flatnonzero(size >= PULSE_EDGE * size.max(initial=0.0))
    length = int(inside[-1] - inside[0]) + 1
    first, last = int(inside[0]) - AROUND[0] * length, int(inside[-1]) + 1 + AROUND[1] * length
    if last - first > POINTS:
        first = int(size.argmax()) - POINTS // 3
        last = first + POINTS
    return max(first, 0), min(last, len(force))


def _found(processed: Processed, point: str, hit: int) -> tuple[Judged, HitVerdict, int, int]:
    """Return the test, the verdict, the entry and the row of a hit."""
    for judged in processed.judged:
        verdicts = iter(judged.verdicts)
        for entry, hits in enumerate(judged.test.points):
            for row in range(hits.count):
                verdict = next(verdicts)
                if (str(verdict.point), verdict.hit) == (point, hit):
                    return judged, verdict, entry, row
    raise InputError(f"there is no hit {hit} at {point}")


def others_page(processed: Processed, index: int, *, most: int = 24) -> dict[str, Any]:
    """Return the magnitudes of the other FRFs of the same force, evenly chosen where there are more than ``most``.

    Raises
    ------
    InputError
        If there is no such FRF.
    """
    frfs = processed.frfs
    check_frf(frfs, index)
    same = [i for i, one in enumerate(frfs.references) if one == frfs.references[index] and i != index]
    if not same:  # a hammer that roves: those of the same response
        same = [i for i, one in enumerate(frfs.responses) if one == frfs.responses[index] and i != index]
    chosen = [same[int(k)] for k in np.linspace(0, len(same) - 1, min(most, len(same))).round()]
    names = frf_names(frfs)
    found = lines(frfs.frequency, **{names[i]: np.abs(frfs.values[i]) for i in chosen})
    return {
        "x": found["x"],
        "curves": [{"name": names[i], "magnitude": found[names[i]]} for i in chosen],
        "left_out": len(same) - len(chosen),
    }


def frf_page(processed: Processed, index: int) -> dict[str, Any]:
    """Return an FRF with its coherence.

    Raises
    ------
    InputError
        If there is no such FRF.
    """
    frfs = processed.frfs
    check_frf(frfs, index)
    coherence = None if frfs.coherence is None else frfs.coherence[index]
    force = force_range(processed.hits)
    return lines(
        frfs.frequency,
        magnitude=np.abs(frfs.values[index]),
        phase=np.degrees(np.angle(frfs.values[index])),
        coherence=coherence,
    ) | {
        "name": frf_names(frfs)[index],
        "unit": frfs.unit,
        "hits": None if frfs.averages is None else int(frfs.averages[index]),
        "band20": None if force is None else force.band20,
    }
