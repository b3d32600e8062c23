"""The one interface to sdypy-EMA: models to it and from it, and its poles for comparison."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import EstimationError, InputError
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from identification.arrangement import signs
from identification.model import ModalModel
from identification.pairing import pair
from identification.scaling import modal_constants, mode_shapes

_FREQUENCY = 1e-3
_DAMPING = 0.05
_BESIDE = 0.01


def frfs_to_sdypy(frfs: FrfSet, *, order: int = 60) -> Any:
    """Return an sdypy-EMA ``Model`` that holds FRFs as they were measured, every line of them.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs; signs of directions are not applied.
    order : int
        Highest polynomial order it will use, in pairs of poles [-].

    Returns
    -------
    sdypy.EMA.Model
        A new model.
    """
    other = _empty(frfs, order=order)
    other.frf, other.freq = np.array(frfs.values), np.array(frfs.frequency)
    other.omega = 2 * np.pi * other.freq
    return other


def to_sdypy(model: ModalModel) -> Any:
    """Return a modal model as an sdypy-EMA ``Model`` with poles, constants and reconstructed FRFs filled in.

    Its ``A`` are receptance residues [m/(N s)], its ``LR`` and ``UR`` the residual terms; signs of the
    directions are not applied, as its FRFs are the data as measured. Where the shapes are scaled ``phi``
    holds them.

    Parameters
    ----------
    model : ModalModel
        The model to hand over.

    Returns
    -------
    sdypy.EMA.Model
        A new model.
    """
    other = frfs_to_sdypy(model.frfs, order=max(1, len(model)))
    sign = signs(model.frfs)
    other.all_poles, other.n_bands, other.len_band = [np.array(model.poles)], 1, len(other.freq)
    other.pole_freq = [np.array(model.modal.frequency)]
    other.pole_xi = [np.array(model.modal.damping)]
    other.pole_ind = np.column_stack([np.zeros(len(model), dtype=int), np.arange(len(model))])
    other.nat_freq, other.nat_xi = np.array(model.modal.frequency), np.array(model.modal.damping)
    other.A = sign[:, None] * model.constants / (2j * model.poles.imag)
    other.LR, other.UR = (sign * model.lower).astype(complex), (sign * model.upper).astype(complex)
    other.H = np.array(model.synthesise(other.freq).values)
    if model.modal.scaled:
        other.phi = np.array(model.modal.shapes)
    return other


def from_sdypy(model: Any, frfs: FrfSet) -> ModalData:
    """Return the modes an sdypy-EMA ``Model`` has selected as plain modal data.

    Parameters
    ----------
    model : sdypy.EMA.Model
        A model whose poles were selected and whose constants were computed.
    frfs : FrfSet
        The FRFs it was made of, for the degrees of freedom.

    Returns
    -------
    ModalData
        Its modes, rising in frequency; standard deviations unknown. Shapes are made of its residues and
        mass-normalised by our own scaling where there is a drive point: its ``phi`` are residues over the root
        of a residue.

    Raises
    ------
    InputError
        If poles or constants are missing, or the FRFs do not match.
    """
    if not hasattr(model, "nat_freq") or not hasattr(model, "A"):
        raise InputError(
            "the sdypy-EMA model holds no selected poles with constants; call get_constants first"
        )
    if len(model.A) != len(frfs.values):
        raise InputError(
            f"the sdypy-EMA model has {len(model.A)} constants per mode and {len(frfs.values)} FRFs were given; "
            "give the FRFs it was made of"
        )
    order = np.argsort(model.nat_freq)
    frequency = np.asarray(model.nat_freq, dtype=float)[order]
    damping = np.asarray(model.nat_xi, dtype=float)[order]
    poles = 2 * np.pi * frequency * (-damping + 1j * np.sqrt(1 - damping**2))
    constants = modal_constants(np.asarray(model.A, dtype=complex)[:, order], poles) * signs(frfs)[:, None]
    equal = 1e-6 * np.abs(constants).max(axis=0, keepdims=True) * np.ones(constants.shape)
    shapes = mode_shapes(frfs, constants, equal, poles=poles)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan),
        damping=damping,
        dofs=shapes.dofs,
        shapes=shapes.shapes,
        scaled=shapes.scaled,
        geometry=frfs.geometry,
    )


def second_opinion(frfs: FrfSet, *, band: tuple[float, float], order: int = 60) -> pd.DataFrame:
    """Return the poles sdypy-EMA's LSCF finds stable at the end of its chart.

    A pole of the highest order counts if the order below has one within 0.1 % in frequency and 5 % in
    damping. Its LSCF loses modes on bands far from zero, so it is given everything from 1 % of the upper
    limit on, and what lies outside the band is left out afterwards.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    band : tuple of float
        Lowest and highest frequency [Hz].
    order : int
        Highest polynomial order of its chart; less where the lines carry less [-].

    Returns
    -------
    DataFrame
        One row per pole: frequency [Hz], damping [%]. ``attrs["warnings"]`` is a tuple of what is known to
        make the answer unreliable, by :func:`opinion_warnings`.

    Raises
    ------
    EstimationError
        If its linear algebra fails, or order or lines are too few for two orders of its chart.
    """
    lower = _lower(frfs, band)
    data = frfs.band(min(max(float(frfs.frequency[0]), frfs.df), max(band[0], frfs.df)), band[1])
    pairs = min(order // 2, _most_pairs(data))
    if pairs < 2:
        raise EstimationError(
            f"{frfs.source}: sdypy-EMA finds no stable poles with an order of {order} on {len(data.frequency)} lines; "
            "it needs an order of 4 and 7 lines from 0 Hz on: record longer, so that the lines are closer"
        )
    model = _empty(data, order=pairs, lower=lower)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model.get_poles(method="lscf", show_progress=False)
    except np.linalg.LinAlgError as error:
        raise EstimationError(f"{frfs.source}: sdypy-EMA could not solve for poles ({error})") from error
    stable = _stable(np.asarray(model.all_poles[-1]), np.asarray(model.all_poles[-2])) + data.decay
    stable = stable[np.argsort(np.abs(stable))]
    frequency = np.abs(stable) / (2 * np.pi)
    keep = (frequency >= band[0]) & (frequency <= band[1])
    damping = -100 * stable.real / np.abs(stable)
    table = pd.DataFrame({"frequency [Hz]": frequency[keep], "damping [%]": damping[keep]})
    table = table.set_index(pd.RangeIndex(1, len(table) + 1, name="pole"))
    fewer = (
        f"sdypy-EMA is run up to order {2 * pairs}, not {order}: {len(data.frequency)} lines allow no more",
    )
    table.attrs["warnings"] = (*opinion_warnings(frfs, band), *(fewer if pairs < order // 2 else ()))
    return table


def beside(modal: ModalData, opinion: pd.DataFrame) -> pd.DataFrame:
    """Return modes and the poles of a second opinion side by side.

    Each pole stands beside the mode nearest to it within 1 %; what has no counterpart has a row of its own.

    Parameters
    ----------
    modal : ModalData
        Our modes.
    opinion : DataFrame
        As from :func:`second_opinion`.

    Returns
    -------
    DataFrame
        Frequencies [Hz] and damping ratios [%] of both, rising in frequency.
    """
    ours = pd.DataFrame({"frequency [Hz]": modal.frequency})
    ours["damping [%]"] = np.nan if modal.damping is None else 100 * modal.damping
    theirs = opinion.rename(columns=lambda name: f"sdypy-EMA {name}").reset_index(drop=True)
    hertz = opinion["frequency [Hz]"].to_numpy()
    found = pair(modal.frequency, hertz, max_factor=1.0 + _BESIDE, spread=_BESIDE) if len(hertz) else ()
    partners = {p.test: p.model for p in found if abs(p.error) < _BESIDE}
    left = ours.assign(partner=[partners.get(i, -1 - i) for i in range(len(ours))])
    right = theirs.assign(partner=range(len(theirs)))
    both = left.merge(right, on="partner", how="outer").drop(columns="partner")
    order = both["frequency [Hz]"].fillna(both["sdypy-EMA frequency [Hz]"]).argsort()
    return both.iloc[order].reset_index(drop=True)


def opinion_warnings(frfs: FrfSet, band: tuple[float, float]) -> tuple[str, ...]:
    """State what is known to make sdypy-EMA's LSCF unreliable on a band.

    Measured on structures with known modes: it loses modes if its lower limit lies above a fifth of the upper
    one, or at 0 Hz, and a window's decay is removed only afterwards.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs it is given.
    band : tuple of float
        Lowest and highest frequency [Hz].
    """
    lower, upper = _lower(frfs, band), min(band[1], float(frfs.frequency[-1]))
    stated = []
    if lower > 0.2 * upper:
        stated.append(
            f"the FRFs begin at {lower:g} Hz, more than a fifth of {upper:g} Hz: with such FRFs sdypy-EMA loses and "
            "shifts modes; give it FRFs from lower frequencies"
        )
    if lower <= 0:
        stated.append("with the line at 0 Hz sdypy-EMA loses modes; start above 0 Hz")
    return tuple(stated)


def _most_pairs(frfs: FrfSet) -> int:
    """Return up to how many pairs of poles its LSCF can go.

    It takes impulse responses of 2 (lines - 1) samples, of lines from 0 Hz to the last but one, at twice as many delays
    to either side as there are pairs.
    """
    lines = round(float(frfs.frequency[-1] / frfs.df))
    return (2 * (lines - 1) - 1) // 4


def _lower(frfs: FrfSet, band: tuple[float, float]) -> float:
    """Return the lower limit handed on: 1 % of the upper one, if the lines reach down to it [Hz]."""
    wanted = min(max(band[0], frfs.df), max(0.01 * band[1], frfs.df))
    return max(wanted, float(frfs.frequency[0]))


def _empty(frfs: FrfSet, *, order: int, lower: float | None = None) -> Any:
    """Return an sdypy-EMA model that holds the FRFs; it leaves out the last line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from sdypy import EMA

        return EMA.Model(
            frf=np.array(frfs.values),
            freq=np.array(frfs.frequency),
            lower=float(frfs.frequency[0]) if lower is None else lower,
            upper=float(frfs.frequency[-1]),
            pol_order_high=order,
            frf_form=frfs.form,
        )


def _stable(last: ComplexArray, before: ComplexArray) -> ComplexArray:
    """Return the poles of the highest order that stand where one of the order below stands."""
    poles = last[(last.imag > 0) & (last.real < 0)]
    distance_f: FloatArray = np.abs(np.abs(poles)[:, None] / np.abs(before)[None, :] - 1.0)
    damping = -before.real / np.maximum(np.abs(before), np.finfo(float).tiny)
    own = -poles.real / np.abs(poles)
    distance_d = np.abs(own[:, None] - damping[None, :]) / own[:, None]
    return np.asarray(poles[((distance_f < _FREQUENCY) & (distance_d < _DAMPING)).any(axis=1)])
