"""Modes as data sets 55."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from acquisition.arrays import ComplexArray
from acquisition.modal_data import ModalData


def mode_sets(modal: ModalData) -> Iterator[bytes]:
    """Yield one data set 55 for each mode: complex modes, eigenvalue as (real, imaginary) in rad/s."""
    assert modal.damping is not None
    zeta = np.nan_to_num(modal.damping, nan=0.0)
    omega = 2 * np.pi * modal.frequency
    poles = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)
    nodes, shapes = _by_node(modal)
    for mode, pole in enumerate(poles):
        hertz = modal.frequency[mode]
        lines = [f"mode {mode + 1}: {hertz:.12g} Hz, damping ratio {zeta[mode]:.12g}", *["NONE"] * 4]
        modal_a = 2j * pole.imag if modal.scaled else 0.0
        lines.append("".join(f"{v:10d}" for v in (1, 3, 2, 8, 5, 3)))
        lines.append("".join(f"{v:10d}" for v in (2, 6, 1, mode + 1)))
        lines.append(_row([pole, complex(modal_a), -complex(modal_a) * pole]))
        for node, vector in zip(nodes, shapes[:, :, mode], strict=True):
            lines += [f"{node:10d}", _row(vector)]
        body = "".join(f"{line:<80s}\n" for line in lines)
        yield f"    -1\n    55\n{body}    -1\n".encode("ascii", "replace")


def _by_node(modal: ModalData) -> tuple[list[int], ComplexArray]:
    """Return the nodes and the translations of each, shape (n_nodes, 3, n_modes)."""
    nodes = list(dict.fromkeys(dof.node for dof in modal.dofs))
    table = np.zeros((len(nodes), 3, len(modal)), dtype=np.complex128)
    if modal.shapes is not None:
        for row, dof in enumerate(modal.dofs):
            if 0 <= dof.axis < 3:
                table[nodes.index(dof.node), dof.axis] = dof.sign * modal.shapes[row]
    return nodes, table


def _row(values: ComplexArray | list[complex]) -> str:
    return "".join(f"{part:13.5e}" for value in values for part in (value.real, value.imag))
