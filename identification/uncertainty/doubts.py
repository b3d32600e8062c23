"""Doubts about modes that the data support: hum, leakage, a foreign FRF, references that disagree."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.reciprocity import reciprocity
from acquisition.quantities import hertz, percent
from acquisition.warned import Consequential
from identification.fit.equations.iteration import solved_step
from identification.fit.equations.refine import Fit

_AT_REST = 0.02  # part of a mode left at the end of a record that is worth a word
_NARROW = 0.1  # half-power bandwidth in lines under which a mode is rather a tone
_UNDAMPED = 1e-7
_SKIRT = 5.0  # half-widths about a mode in which such a pole rather mends the mode's fit
_MAINS = (50.0, 60.0)
_DRIFT = 0.3
_ALONE, _ENOUGH = 0.99, 4
_MANY_SIGMA = 3.0


def about(
    frfs: FrfSet,
    poles: ComplexArray,
    others: ComplexArray,
    constants: ComplexArray,
    sigma: FloatArray,
    scatter: FloatArray,
) -> tuple[str, ...]:
    """Return warnings on the modes found.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    poles : (n_modes,) complex array
        Poles of the modes [rad/s].
    others : (n,) complex array
        Other poles of the fit [rad/s].
    constants : (n_frf, n_modes) complex array
        Modal constants [1/kg].
    sigma : (n_frf, n_modes) array
        Their standard deviations [1/kg].
    scatter : (n_modes,) array
        Standard deviation of each circular frequency from FRF to FRF, beyond noise [rad/s].
    """
    return (
        *_tones(frfs, poles, others),
        *_ringing(frfs, poles),
        *_drifting(poles, scatter),
        *_in_one_frf(frfs, constants, sigma),
        *_not_reciprocal(frfs),
    )


def _numbers(modes: IntArray) -> str:
    return ", ".join(str(int(m) + 1) for m in modes)


def _tones(frfs: FrfSet, poles: ComplexArray, others: ComplexArray) -> tuple[str, ...]:
    """Name modes narrower than a tenth of a line, and tones that were taken for no mode."""
    width = -2.0 * (poles.real - frfs.decay) / (2 * np.pi)
    narrow = np.flatnonzero(width < _NARROW * frfs.df)
    stated = []
    pure = np.abs(others[-others.real < _UNDAMPED * np.abs(others)]) / (2 * np.pi)
    pure = pure[(pure > frfs.frequency[0]) & (pure < frfs.frequency[-1])]
    disagreement = np.abs(2 * np.pi * pure[:, None] - poles.imag[None, :]) / np.abs(poles.real)[None, :]
    pure = pure[(disagreement > _SKIRT).all(axis=1)]
    if len(pure):
        named = ", ".join(hertz(f) for f in pure)
        stated.append(f"a tone at {named} that does not decay{_hum(frfs, pure)} was not accepted as a mode")
    if not len(narrow):
        return tuple(stated)
    return (
        *stated,
        f"mode(s) {_numbers(narrow)} are narrower than a tenth of the line "
        f"spacing{_hum(frfs, np.abs(poles[narrow]) / (2 * np.pi))}: a tone, or leakage of records that end "
        "too early; if they are not modes, leave them out with drop",
    )


def _hum(frfs: FrfSet, tones: FloatArray) -> str:
    """Name the frequencies that are multiples of the mains."""
    off = 0.1 * min(1.0, frfs.df)
    near = [hertz(f) for f in tones if any(abs(f / m - round(f / m)) * m < off for m in _MAINS)]
    return f" ({', '.join(near)}: a multiple of the mains)" if near else ""


def _ringing(frfs: FrfSet, poles: ComplexArray) -> tuple[str, ...]:
    """Name modes that are not at rest when a record of 1/df ends, where the record is not known to the fit."""
    if frfs.record is not None or frfs.line_shape is not None:
        return ()
    left = np.exp(-(frfs.decay - poles.real) / frfs.df)
    which = np.flatnonzero(left > _AT_REST)
    if not len(which):
        return ()
    text = (
        f"mode(s) {_numbers(which)}: {100 * left.max():.0f} % of the response is left after {1 / frfs.df:.3g} s "
        "(1/df). If the records are that long, leakage biases their damping and level: record longer, or "
        "use an exponential window"
    )
    return (Consequential(text),)


def _drifting(poles: ComplexArray, scatter: FloatArray) -> tuple[str, ...]:
    """Name modes whose frequency is another in every FRF, by a third of the half-power half-width or so."""
    which = np.flatnonzero(scatter > _DRIFT * np.abs(poles.real))
    if not len(which):
        return ()
    worst = 100 * (scatter[which] / np.abs(poles[which])).max()
    return (
        f"the frequency of mode(s) {_numbers(which)} differs from FRF to FRF by {percent(worst)}: a roving sensor or "
        "hammer loads the structure, or the frequencies drift; damping is then too large and shapes are wrong",
    )


def _in_one_frf(frfs: FrfSet, constants: ComplexArray, sigma: FloatArray) -> tuple[str, ...]:
    """Name modes that one FRF alone shows, where there are several."""
    if len(constants) < _ENOUGH:
        return ()
    power = np.abs(constants) ** 2
    most = power.argmax(axis=0)
    modes = np.arange(constants.shape[1])
    alone = power[most, modes] > _ALONE * power.sum(axis=0)
    alone &= np.abs(constants[most, modes]) > _MANY_SIGMA * sigma[most, modes]
    stated = []
    for row in np.unique(most[alone]):
        which = np.flatnonzero(alone & (most == row))
        stated.append(
            f"mode(s) {_numbers(which)} appear in the FRF {frfs.responses[row]}/{frfs.references[row]} only; check "
            "whether it belongs to this test"
        )
    return tuple(stated)


def _not_reciprocal(frfs: FrfSet) -> tuple[str, ...]:
    """Hand on what the comparison of H_ij with H_ji finds."""
    table = reciprocity(frfs)
    return tuple(
        f"{row.iloc[0]} and {row.iloc[1]}: {row['message']}" for _, row in table.iterrows() if row["message"]
    )


def not_at_rest(fit: Fit, poles: ComplexArray) -> str:
    """Return what to say of a fit that did not come to rest: how far its next step goes, and what to do.

    Parameters
    ----------
    fit : Fit
        The fit.
    poles : (n_modes,) complex array
        Those of its poles that are modes [rad/s].
    """
    step = fit.equations.step
    move = solved_step(step.normal, step.gradient, 0.0)[1::2] / (2 * np.pi)
    own = np.abs(fit.poles[:, None] - poles).argmin(axis=0)
    worst = int(np.argmax(np.abs(move[own])))
    place = float(np.abs(poles[worst])) / (2 * np.pi)
    return (
        "the refinement of the poles did not converge: the next step would change frequencies by up to "
        f"{abs(move[own[worst]]):.2g} Hz (at {hertz(place)}), damping may change too, and standard deviations may be "
        "too small. The usual reason is more poles than the data support: narrow the band, lower the order, or drop "
        "poles that are not modes. Trust only numbers that then stay within their standard deviations"
    )
