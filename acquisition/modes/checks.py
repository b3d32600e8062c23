"""Whether the modes of a file are those of something that vibrates, each of them once."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.modal_data import ModalData

HIGHEST = 1e12
"""Above the frequency of anything that vibrates as a whole [Hz]."""

LARGEST = 1e50
"""Components of shapes whose powers are still numbers [-]."""


def checked(modal: ModalData, path: Path, *, percent: str = "the column damping_percent") -> ModalData:
    """Return the modes of a file, if each has a frequency and what it has besides can be.

    Parameters
    ----------
    modal : ModalData
        The modes.
    path : Path
        The file, for messages.
    percent : str
        How a file of this kind states that damping is in per cent, for messages.

    Raises
    ------
    InputError
        If a frequency, standard deviation, damping ratio or shape cannot be, or a mode is given twice.
    """
    check_frequencies(modal.frequency, path)
    _sigmas(modal, path)
    _ratios(modal, path, percent)
    _shapes(modal, path)
    _once(modal, path)
    return modal


def check_frequencies(frequency: FloatArray, path: Path) -> None:
    """See that every mode has a frequency [Hz] that something can have.

    Raises
    ------
    InputError
        If one has not.
    """
    if not np.all((frequency > 0) & (frequency < HIGHEST)):
        raise InputError(
            f"{path}: a frequency is missing, not positive or beyond {HIGHEST:g} Hz; give every mode its own in Hz"
        )


def _sigmas(modal: ModalData, path: Path) -> None:
    frequency, sigma = modal.frequency, modal.frequency_sigma
    wrong = np.flatnonzero((sigma < 0) | (sigma >= frequency))
    if len(wrong):
        raise InputError(
            f"{path}: sigma {sigma[wrong[0]]:g} Hz of the mode at {frequency[wrong[0]]:g} Hz is negative or larger "
            "than the frequency; give its standard deviation in Hz, or leave it empty"
        )


def _ratios(modal: ModalData, path: Path, percent: str) -> None:
    damping = np.zeros(0) if modal.damping is None else modal.damping
    wrong = np.flatnonzero((damping < 0) | (damping >= 1))
    if len(wrong):
        worst = float(damping[wrong[0]])
        advice = "give it a value, or leave it empty" if worst < 0 else f"if it is in %, write {percent}"
        raise InputError(
            f"{path}: damping ratio {worst:g} of mode {wrong[0] + 1}: it must be between 0 and 1; {advice}"
        )


def _shapes(modal: ModalData, path: Path) -> None:
    largest = 0.0 if modal.shapes is None else float(np.abs(modal.shapes).max(initial=0.0))
    if largest > LARGEST:
        raise InputError(f"{path}: a shape reaches {largest:g}; scale it to numbers below {LARGEST:g}")
    sigma = modal.shape_sigma
    if sigma is not None and np.any(sigma < 0):
        raise InputError(
            f"{path}: a standard deviation of a shape is below zero; give it a value, or leave it empty"
        )


def _once(modal: ModalData, path: Path) -> None:
    """Check that no mode is given twice; without damping and shapes two of one frequency may be two."""
    columns = [
        *([] if modal.damping is None else [modal.damping]),
        *([] if modal.shapes is None else modal.shapes),
    ]
    first: dict[tuple[complex, ...], int] = {}
    for number, mode in enumerate(zip(modal.frequency, *columns, strict=True), start=1):
        if columns and np.isfinite(mode).all() and first.setdefault(mode, number) != number:
            raise InputError(f"{path}: modes {first[mode]} and {number} are the same mode; leave one out")
