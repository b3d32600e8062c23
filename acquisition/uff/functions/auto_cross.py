"""FRFs and coherences from auto- and cross-spectra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray, FloatArray
from acquisition.uff.functions.measurements import Measurement
from acquisition.uff.functions.quantities import MOTIONS
from acquisition.uff.functions.stored import Held
from acquisition.warned import Located

AUTO, CROSS = (2, 9), 3


def combine_spectra(records: Sequence[Measurement]) -> tuple[list[Measurement], list[str]]:
    """Return FRFs (type 4) and coherences (type 6) made of spectra, and what could not be combined.

    H1 = G_xf / G_ff and coherence |G_xf|^2 / (G_xx G_ff), where G_xf is the cross-spectrum of a response with
    the force at its reference, and G_ff, G_xx are auto-spectra on the same axis and of the same scaling
    (Bendat and Piersol, Random Data, 2010, sections 5.2 and 6.1).
    """
    autos = [r for r in records if r.function_type in AUTO and r.values is not None]
    crosses = [r for r in records if r.function_type == CROSS and r.values is not None]
    made: list[Measurement] = []
    warnings: list[str] = []
    forces = [a for a in autos if a.quantity == "force"]
    if autos and not crosses:
        warnings.append(
            f"{autos[0].place}: {len(autos)} auto-spectra and no cross-spectrum; they are not used"
        )
    for cross in crosses:
        if cross.quantity not in MOTIONS:
            finding = "a cross-spectrum that is not one of a motion with a force; left out"
            warnings.append(Located(cross.place, finding))
            continue
        peers = [c for c in crosses if c.reference == cross.reference]
        force = _matching([a for a in forces if a.response == cross.reference], cross, peers)
        if force is None:
            finding = (
                f"no single auto-spectrum of the force at {cross.reference} has its axis and "
                "scaling; no FRF can be made of it, export the auto-spectrum or the FRF"
            )
            warnings.append(Located(cross.place, finding))
            continue
        peers = [c for c in crosses if c.response == cross.response]
        same = [a for a in autos if a.response == cross.response and a.quantity == cross.quantity]
        made += _ratio(cross, force, _matching(same, cross, peers), warnings)
    return _causal(made, warnings), warnings


def _matching(
    autos: Sequence[Measurement], cross: Measurement, peers: Sequence[Measurement]
) -> Measurement | None:
    """Return the one auto-spectrum that goes with a cross-spectrum."""
    fit = [a for a in autos if a.axis == cross.axis and _same_scale(a, cross)]
    if len(fit) > 1:
        named = [a for a in fit if a.reference == cross.reference and a.response != a.reference]
        if len(named) == 1:
            return named[0]
        if len(fit) == len(peers):
            return fit[[id(p) for p in peers].index(id(cross))]
    return fit[0] if len(fit) == 1 else None


def _same_scale(auto: Measurement, cross: Measurement) -> bool:
    return auto.density is None or cross.density is None or auto.density == cross.density


def _ratio(
    cross: Measurement, force: Measurement, motion: Measurement | None, warnings: list[str]
) -> list[Measurement]:
    """Return the FRF and, where the auto-spectrum of the response is there, the coherence."""
    gxf = np.asarray(cross.read(), dtype=np.complex128)
    gff = _power(force)
    if not (gff > 0).any() or (gff < 0).any():
        warnings.append(f"{force.place}: an auto-spectrum that is not positive; no FRF can be made of it")
        return []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        frf = gxf / gff
    bad = np.flatnonzero(~np.isfinite(frf))
    if bad.size and (bad.size > 1 or bad[0] > 0 or cross.minimum != 0):
        warnings.append(f"{force.place}: the force is zero at {bad.size} lines; no FRF can be made of it")
        return []
    averages = cross.averages or force.averages
    made = [replace(cross, function_type=4, values=Held(frf), factor=1.0, averages=averages)]
    if motion is not None:
        coherence = _coherence(gxf, gff, _power(motion))
        if coherence is None:
            finding = "with its auto-spectra the coherence exceeds 1, so their scalings differ; left out"
            warnings.append(Located(cross.place, finding))
            return []
        coherence_set = replace(
            cross, function_type=6, quantity="other", values=Held(coherence), factor=1.0, averages=averages
        )
        made.append(coherence_set)
    return made


def _power(auto: Measurement) -> FloatArray:
    return np.asarray(auto.read().real, dtype=np.float64)


def _coherence(gxf: ComplexArray, gff: FloatArray, gxx: FloatArray) -> FloatArray | None:
    """Return the coherence, None if it is clearly above 1 somewhere."""
    product = gxx * gff
    coherence = np.abs(gxf) ** 2 / np.where(product > 0, product, np.inf)
    return None if coherence.max() > 1.01 else np.clip(coherence, 0.0, 1.0)


def _causal(made: list[Measurement], warnings: list[str]) -> list[Measurement]:
    """Turn the sign of the phase if the FRFs answer before they are hit: then F X* was stored, not X F*."""
    frfs = [m for m in made if m.function_type == 4 and m.minimum == 0 and m.points > 16]
    if not frfs:
        return made
    early, late = np.sum([_halves(m.read()) for m in frfs], axis=0)
    if late <= 2 * early:
        return made
    warnings.append(
        f"{frfs[0].place}: the cross-spectra are stored as force times conjugate response (their impulse "
        "responses begin before the hit); their conjugates are used"
    )
    return [
        replace(m, values=Held(np.conj(m.values.values)))
        if m.function_type == 4 and isinstance(m.values, Held)
        else m
        for m in made
    ]


def _halves(frf: AnyArray) -> tuple[float, float]:
    """Return the energy of the impulse response in its first and second half, without the edges."""
    response = np.fft.irfft(np.where(np.isfinite(frf), frf, 0)) ** 2
    response /= response.sum() or 1.0
    edge, middle = len(response) // 50, len(response) // 2
    return float(response[edge:middle].sum()), float(response[middle : len(response) - edge].sum())
