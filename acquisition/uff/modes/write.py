"""Modes as data sets 55."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.modal_data import ModalData


def mode_sets(modal: ModalData) -> Iterator[bytes]:
    """Yield one data set 55 for each mode: complex modes, eigenvalue as (real, imaginary) in rad/s.

    The first ID line keeps all digits, ``mode 1: 10.25 Hz, damping ratio 0.0125``; the second the standard
    deviations, where there are any, ``sigma 0.001 Hz, damping sigma 0.0002``: a data set 55 has no other
    place for them. Standard deviations of a shape follow as a data set of their own, of unknown analysis type (0), so
    that no reader takes them for a mode; its first ID line states ``shape sigma of mode 1``.
    """
    assert modal.damping is not None
    assert modal.damping_sigma is not None
    zeta = np.nan_to_num(modal.damping, nan=0.0)
    omega = 2 * np.pi * modal.frequency
    poles = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)
    nodes, shapes = _by_node(modal, modal.shapes, signed=True)
    width = shapes.shape[1]
    for mode, pole in enumerate(poles):
        hertz = float(modal.frequency[mode])
        lines = [f"mode {mode + 1}: {hertz!r} Hz, damping ratio {float(zeta[mode])!r}"]
        lines += [
            _sigmas(float(modal.frequency_sigma[mode]), float(modal.damping_sigma[mode])),
            *["NONE"] * 3,
        ]
        modal_a = 2j * pole.imag if modal.scaled else 0.0
        lines.append("".join(f"{v:10d}" for v in (1, 3, 2 if width == 3 else 3, 8, 5, width)))
        lines.append("".join(f"{v:10d}" for v in (2, 6, 1, mode + 1)))
        lines += _rows([pole, complex(modal_a), -complex(modal_a) * pole])
        for node, vector in zip(nodes, shapes[:, :, mode], strict=True):
            lines += [f"{node:10d}", *_rows(vector)]
        yield _set(lines)
    if modal.shape_sigma is not None:
        yield from _sigma_sets(modal, modal.shape_sigma)


def _sigma_sets(modal: ModalData, sigma: FloatArray) -> Iterator[bytes]:
    """Yield the standard deviations of each shape, real, at the nodes of the shapes."""
    nodes, table = _by_node(modal, sigma, signed=False)
    width = table.shape[1]
    for mode in range(len(modal)):
        lines = [f"shape sigma of mode {mode + 1}: {float(modal.frequency[mode])!r} Hz", *["NONE"] * 4]
        lines.append("".join(f"{v:10d}" for v in (1, 0, 2 if width == 3 else 3, 8, 2, width)))
        lines.append("".join(f"{v:10d}" for v in (1, 1, mode + 1)))
        lines.append(f"{0.0:13.5e}")
        for node, vector in zip(nodes, table[:, :, mode].real.tolist(), strict=True):
            lines += [f"{node:10d}", "".join(f"{value:13.5e}" for value in vector)]
        yield _set(lines)


def _set(lines: list[str]) -> bytes:
    body = "".join(f"{line:<80s}\n" for line in lines)
    return f"    -1\n    55\n{body}    -1\n".encode("ascii", "replace")


def _sigmas(frequency: float, damping: float) -> str:
    stated_values = [f"sigma {frequency!r} Hz"] if np.isfinite(frequency) else []
    stated_values += [f"damping sigma {damping!r}"] if np.isfinite(damping) else []
    return ", ".join(stated_values) or "NONE"


def _by_node(
    modal: ModalData, values: ComplexArray | FloatArray | None, *, signed: bool
) -> tuple[list[int], ComplexArray]:
    """Return the nodes and what stands at each, shape (n_nodes, 3 or, with rotations, 6, n_modes)."""
    nodes = list(dict.fromkeys(dof.node for dof in modal.dofs))
    row = {node: i for i, node in enumerate(nodes)}
    width = 6 if any(dof.axis > 2 for dof in modal.dofs) else 3
    table = np.zeros((len(nodes), width, len(modal)), dtype=np.complex128)
    if values is not None:
        for number, dof in enumerate(modal.dofs):
            if dof.axis >= 0:
                table[row[dof.node], dof.axis] = (dof.sign if signed else 1) * values[number]
    return nodes, table


def _rows(values: ComplexArray | list[complex]) -> list[str]:
    """Return numbers as lines of six columns."""
    parts = [f"{part:13.5e}" for value in values for part in (value.real, value.imag)]
    return ["".join(parts[i : i + 6]) for i in range(0, len(parts), 6)]
