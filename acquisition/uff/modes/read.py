"""Modes of data sets 55 and 2414 as one record, in SI units and mass-normalised where they say how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.dof import Dof
from acquisition.geometry import Geometry
from acquisition.modal_data import ModalData
from acquisition.uff.modes.data_sets import ModeSet, SigmaSet


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode: its data set, its pole [rad/s], whether damping is stated, shape in SI, whether mass-normalised.

    ``hertz`` states whether its eigenvalue was taken for (damping, frequency) in Hz; ``scale`` (6,) is what the shape
    of the file was multiplied by; ``sigma`` (n, 6) its standard deviations, where they are given.
    """

    stated: ModeSet
    pole: complex
    hertz: bool
    damped: bool
    shape: ComplexArray
    scaled: bool
    scale: ComplexArray
    sigma: FloatArray | None = None


def solve_modes(
    sets: Sequence[ModeSet], sigmas: Mapping[int, Sequence[SigmaSet]] | None = None
) -> tuple[list[Mode], list[str]]:
    """Return modes with poles in rad/s, and what had to be assumed.

    Complex eigenvalues come as (real, imaginary) in rad/s or as (damping, frequency) in Hz. The frequency in the
    ID lines and the ratio of modal B to modal A, which is the eigenvalue in rad/s, tell; what they say of some
    modes of a file holds for all of them.
    """
    modes, notes = [], []
    for _, group in groupby(sorted(sets, key=lambda s: s.file), key=lambda s: s.file):
        members = list(group)
        hertz, note = _in_hertz([s for s in members if s.is_complex])
        notes += [note] if note else []
        solved = [_solved(s, hertz=hertz) for s in members]
        with_sigma, lost = _with_sigmas(solved, (sigmas or {}).get(members[0].file, ()))
        modes += with_sigma
        notes += lost
    if len({mode.scaled for mode in modes}) > 1:
        bare = next(mode for mode in modes if not mode.scaled)
        notes.append(
            f"{bare.stated.place}: it states no modal mass, unlike other modes: no shape is taken as mass-normalised"
        )
    return modes, notes


def _with_sigmas(modes: Sequence[Mode], sigmas: Sequence[SigmaSet]) -> tuple[list[Mode], list[str]]:
    """Return the modes of a file with the standard deviations of their shapes, and what belongs to none."""
    waiting, out = list(sigmas), []
    for mode in modes:
        hertz = abs(mode.pole) / (2 * np.pi)
        own = next((s for s in waiting if abs(s.frequency / hertz - 1) < 1e-9 and _same(s, mode)), None)
        if own is not None:
            waiting.remove(own)
        out.append(replace(mode, sigma=None if own is None else own.values * np.abs(mode.scale)))
    where = modes[0].stated.place if modes else ""
    return out, [f"{where}: shape sigma of mode {s.mode} belongs to no mode of its file" for s in waiting]


def _same(sigma: SigmaSet, mode: Mode) -> bool:
    return np.array_equal(sigma.nodes, mode.stated.nodes)


def describe(mode: Mode) -> str:
    """State what a mode was taken for."""
    text = f"{abs(mode.pole) / (2 * np.pi):.6g} Hz, {len(mode.stated.nodes)} nodes"
    if not mode.stated.is_complex:
        return f"{text}, normal mode"
    unit = "(damping, frequency) in Hz" if mode.hertz else "(real, imaginary) in rad/s"
    return f"{text}, complex mode, eigenvalue taken for {unit}"


def _in_hertz(sets: Sequence[ModeSet]) -> tuple[bool, str]:
    """Return whether the eigenvalues of a file are in Hz, and what had to be assumed."""
    if not sets:
        return False, ""
    votes = [vote for s in sets for vote in (_by_frequency(s), _by_modal_b(s)) if vote is not None]
    hertz = sum(votes) > len(votes) / 2
    name = "(damping, frequency) in Hz" if hertz else "(real, imaginary) in rad/s"
    if votes:
        doubt = any(vote != hertz for vote in votes)
        stated_values = (
            f"{sets[0].place}: the modes disagree on the unit of their eigenvalues; taken for {name}"
        )
        return hertz, stated_values if doubt else ""
    if any(s.eigenvalue.real > 0 for s in sets):
        return True, (
            f"{sets[0].place}: eigenvalues have positive real parts; taken for (damping, frequency) in Hz; "
            "put the frequency into an ID line to make sure"
        )
    return False, (
        f"{sets[0].place}: the unit of the eigenvalues is not stated; assumed: {name}; put the frequency "
        "into an ID line to make sure"
    )


def _by_frequency(mode: ModeSet) -> bool | None:
    """Return what the frequency in the ID lines states: in Hz or not; None if nothing."""
    ratio = mode.stated_values.frequency / abs(mode.eigenvalue)
    return next(
        (hertz for hertz, unit in ((True, 1.0), (False, 0.5 / np.pi)) if abs(ratio / unit - 1) < 0.02), None
    )


def _by_modal_b(mode: ModeSet) -> bool | None:
    """Return what modal B / modal A = -eigenvalue states; None if they are not stated."""
    if mode.modal_a == 0 or mode.modal_b == 0:
        return None
    ratio = abs(mode.modal_b / mode.modal_a) / abs(mode.eigenvalue)
    return next(
        (hertz for hertz, unit in ((True, 2 * np.pi), (False, 1.0)) if abs(np.log(ratio / unit)) < 0.3), None
    )


def _solved(mode: ModeSet, *, hertz: bool) -> Mode:
    if mode.is_complex:
        factor = 2 * np.pi if hertz else 1.0
        pole = factor * complex(-abs(mode.eigenvalue.real), abs(mode.eigenvalue.imag))
    else:
        omega = 2 * np.pi * mode.frequency
        pole = complex(-mode.damping * omega, omega * np.sqrt(1 - mode.damping**2))
    pole = _with_all_digits(mode, pole)
    mass = mode.mass if not mode.is_complex else mode.modal_a / (2j * pole.imag) if pole.imag else 0j
    scale = np.ones(6, dtype=np.complex128)
    if mass != 0:
        level = np.sqrt(mode.units.force / mode.units.length / np.complex128(mass))
        scale = level * np.array([1, 1, 1, *[mode.units.length] * 3])
    shape = mode.shape * scale
    damped = mode.is_complex or mode.damping > 0
    known = bool(mass != 0 and np.isfinite(shape).all())
    return Mode(mode, pole, hertz, damped and pole.real != 0, shape, known, scale)


def _with_all_digits(mode: ModeSet, pole: complex) -> complex:
    """Return the pole with the digits of the ID lines, where only rounding is between them."""
    omega, zeta = abs(pole), -pole.real / abs(pole)
    stated_values = mode.stated_values
    if abs(2 * np.pi * stated_values.frequency / omega - 1) < 1e-5:
        omega = 2 * np.pi * stated_values.frequency
    if abs(stated_values.damping - zeta) < 1e-5 * zeta + 1e-12 and stated_values.damping < 1:
        zeta = stated_values.damping
    return complex(-zeta * omega, omega * np.sqrt(max(1 - zeta**2, 0.0)))


def join_modes(modes: Sequence[Mode], geometry: Geometry) -> ModalData:
    """Return modes as one record over all nodes that move, in the order of frequency."""
    ordered = sorted(modes, key=lambda mode: abs(mode.pole))
    nodes = list(dict.fromkeys(n for mode in ordered for n in mode.stated.nodes.tolist()))
    row = {node: i for i, node in enumerate(nodes)}
    table = np.zeros((len(nodes), 6, len(ordered)), dtype=np.complex128)
    for column, mode in enumerate(ordered):
        table[[row[n] for n in mode.stated.nodes.tolist()], :, column] = mode.shape
    sigma = np.full((len(nodes), 6, len(ordered)), np.nan)
    for column, mode in enumerate(ordered):
        if mode.sigma is not None:
            sigma[[row[n] for n in mode.stated.nodes.tolist()], :, column] = mode.sigma
    moving = np.argwhere(np.any(table != 0, axis=-1))
    poles = np.array([mode.pole for mode in ordered])
    return ModalData(
        frequency=np.abs(poles) / (2 * np.pi),
        frequency_sigma=np.array([m.stated.stated_values.frequency_sigma for m in ordered]),
        damping=np.array([-m.pole.real / abs(m.pole) if m.damped else np.nan for m in ordered]),
        damping_sigma=np.array([m.stated.stated_values.damping_sigma for m in ordered]),
        dofs=tuple(Dof(nodes[n], int(axis) + 1) for n, axis in moving),
        shapes=table[moving[:, 0], moving[:, 1]] if len(moving) else None,
        shape_sigma=_known(sigma[moving[:, 0], moving[:, 1]]),
        scaled=all(mode.scaled for mode in ordered),
        geometry=geometry,
    )


def _known(sigma: FloatArray) -> FloatArray | None:
    """Return standard deviations; None unless every component has one."""
    return sigma if sigma.size and np.isfinite(sigma).all() else None
