"""Modes as the table that `acquisition.modes.read.read_modes` reads back."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.modal_data import ModalData


def modes_csv(modal: ModalData) -> str:
    """Return modes as comma-separated text: one row per mode, every number with all its digits.

    The columns are ``frequency`` [Hz], ``sigma`` [Hz], ``damping`` [-] and ``damping_sigma`` [-]; of every degree of
    freedom the shape's real part (``3+Z``), imaginary part (``3+Z imag``) and standard deviation (``3+Z sigma``),
    as far as there are any; and ``scaled``, 1 where the shapes are mass-normalised. Rows ``x``, ``y``, ``z`` bring the
    coordinates of the shapes' points [m], where all are known.

    Parameters
    ----------
    modal : ModalData
        The modes.
    """
    columns = dict(_columns(modal))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_written(values[mode]) for values in columns.values()] for mode in range(len(modal)))
    nodes = [dof.node for dof in modal.dofs]
    if modal.shapes is not None and all(node in modal.geometry for node in nodes):
        for name, places in zip("xyz", modal.geometry.at(nodes).T, strict=True):
            place = dict(zip(map(str, modal.dofs), places, strict=True))
            writer.writerow([name, *(_written(place.get(c, np.nan)) for c in list(columns)[1:])])
    return text.getvalue()


def _columns(modal: ModalData) -> Iterator[tuple[str, FloatArray]]:
    yield "frequency", modal.frequency
    for name, values in (
        ("sigma", modal.frequency_sigma),
        ("damping", modal.damping),
        ("damping_sigma", modal.damping_sigma),
    ):
        if values is not None and not np.isnan(values).all():
            yield name, values
    yield "scaled", np.full(len(modal), float(modal.scaled))
    if modal.shapes is None:
        return
    whole = bool(np.any(modal.shapes.imag))
    for row, dof in enumerate(modal.dofs):
        yield str(dof), modal.shapes[row].real
        if whole:
            yield f"{dof} imag", modal.shapes[row].imag
        if modal.shape_sigma is not None:
            yield f"{dof} sigma", modal.shape_sigma[row]


def _written(value: float) -> str:
    return "" if np.isnan(value) else f"{float(value)!r}"
