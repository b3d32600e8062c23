"""Modes of data sets 55, in SI units and mass-normalised where they say how."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.modal_data import ModalData
from acquisition.uff.text_sets import read_with_pyuff
from acquisition.uff.units import Units

_HERTZ = re.compile(r"(?:FR\s*=\s*|\b)([\d.]+(?:[eE][-+]?\d+)?)\s*(?:Hz\b|:d=)")


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode: pole [rad/s], shape by node (n_nodes, 3), whether it is mass-normalised, what was odd."""

    pole: complex
    damped: bool
    nodes: tuple[int, ...]
    shape: ComplexArray
    scaled: bool
    note: str


def read_mode(body: bytes, units: Units) -> Mode:
    """Read one data set 55 of normal (2) or complex modes (3, 7).

    Raises
    ------
    InputError
        If it is something else, or cannot be read.
    """
    found = read_with_pyuff(55, body)
    kind = int(found["analysis_type"])
    if kind not in (2, 3, 7):
        raise InputError(f"data set 55 with analysis type {kind}; only modes (2, 3 and 7) are used")
    shape = np.stack([np.asarray(found[f"r{i}"], dtype=np.complex128) for i in (1, 2, 3)], axis=-1)
    nodes = tuple(int(n) for n in found["node_nums"])
    if len(nodes) != len(shape) or not np.isfinite(shape).all():
        raise InputError("data set 55: nodes and shape do not agree, or values are not finite")
    stated = _HERTZ.search(body[:400].decode("latin-1"))
    pole, note = _pole(found, kind, float(stated[1]) if stated else None)
    if abs(pole) == 0:
        raise InputError("data set 55: its frequency is zero")
    mass = _modal_mass(found, kind, pole)
    if mass == 0:
        return Mode(pole, pole.real != 0, nodes, shape, False, note)
    scale = np.sqrt(units.force / units.length / np.complex128(mass))
    return Mode(pole, pole.real != 0, nodes, shape * scale, True, note)


def _pole(found: dict[str, object], kind: int, stated: float | None) -> tuple[complex, str]:
    """Return the pole [rad/s]; complex modes come as (re, im) in rad/s or as (damping, frequency) in Hz."""
    if kind == 2:
        omega = 2 * np.pi * float(str(found["freq"]))
        zeta = float(str(found["modal_damp_vis"]))
        return complex(-zeta * omega, omega * np.sqrt(max(1 - zeta**2, 0.0))), ""
    value = complex(str(found["eig"]).strip())
    radian = complex(-abs(value.real), abs(value.imag))
    hertz = 2 * np.pi * radian
    for pole in (radian, hertz):
        ratio = 0.0 if stated is None or pole == 0 else 2 * np.pi * stated / abs(pole)
        if abs(ratio - 1) < 0.02:  # where only rounding is between them, the ID line has more digits
            return pole * (ratio if abs(ratio - 1) < 1e-5 else 1.0), ""
    if value.real > 0:
        return hertz, "its eigenvalue has a positive real part; taken for (damping, frequency) in Hz"
    return radian, "its eigenvalue is taken for (real, imaginary) in rad/s"


def _modal_mass(found: dict[str, object], kind: int, pole: complex) -> complex:
    """Return the modal mass in the file's units, 0 if not stated; modal A = 2 i omega_d m."""
    if kind == 2:
        return float(str(found["modal_m"]))
    return complex(str(found["modal_a"]).strip()) / (2j * pole.imag)


def join_modes(modes: Sequence[Mode], geometry: Geometry) -> ModalData:
    """Return modes as one record over all nodes that move, in the order of frequency."""
    ordered = sorted(modes, key=lambda mode: abs(mode.pole))
    nodes = list(dict.fromkeys(n for mode in ordered for n in mode.nodes))
    row = {node: i for i, node in enumerate(nodes)}
    table = np.zeros((len(nodes), 3, len(ordered)), dtype=np.complex128)
    for column, mode in enumerate(ordered):
        table[[row[n] for n in mode.nodes], :, column] = mode.shape
    moving = np.argwhere(np.any(table != 0, axis=-1))
    poles = np.array([mode.pole for mode in ordered])
    return ModalData(
        frequency=np.abs(poles) / (2 * np.pi),
        frequency_sigma=np.full(len(poles), np.nan),
        damping=np.array([-m.pole.real / abs(m.pole) if m.damped else np.nan for m in ordered]),
        dofs=tuple(Dof(nodes[n], int(axis) + 1) for n, axis in moving),
        shapes=table[moving[:, 0], moving[:, 1]] if len(moving) else None,
        scaled=all(mode.scaled for mode in ordered),
        geometry=geometry,
    )
