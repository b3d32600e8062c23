"""The same measures with names on them: of modes and FRFs with their degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray
from acquisition.display import Displayed
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from acquisition.quantities import hertz
from identification.mac.coordinates import comac, ecomac
from identification.mac.frfs import frac
from identification.mac.shapes import auto_mac, mac, mpc

UNSEEN = 1e-6
"""Largest component at the common degrees of freedom, over that at all, under which a mode does not move there [-]:
rounding leaves 1e-16 to 1e-7 of it, in any shape."""


@dataclass(frozen=True, eq=False)
class CommonDofs(Displayed):
    """Shapes of two sets of modes at the degrees of freedom both have.

    Parameters
    ----------
    dofs : tuple of Dof
        Degrees of freedom, directions positive, in the order of the first set.
    first, second : (n_dofs, n_modes) complex arrays
        Shapes there, signs of directions applied, 0 for a mode that does not move there [as in the sets].
    """

    dofs: tuple[Dof, ...]
    first: ComplexArray
    second: ComplexArray


def common_dofs(first: ModalData, second: ModalData) -> CommonDofs:
    """Cut two sets of modes to the degrees of freedom both have.

    Parameters
    ----------
    first, second : ModalData
        Modes; without shapes there is nothing in common.

    Returns
    -------
    CommonDofs
        Possibly without a degree of freedom.
    """
    one, other = _by_dof(first), _by_dof(second)
    shared = tuple(dof for dof in one if dof in other)
    return CommonDofs(shared, _rows(first, one, shared), _rows(second, other, shared))


def _by_dof(modes: ModalData) -> dict[Dof, tuple[int, int]]:
    """Return row and sign of each unsigned degree of freedom."""
    if modes.shapes is None:
        return {}
    return {Dof(d.node, abs(d.direction)): (i, d.sign) for i, d in enumerate(modes.dofs)}


def _rows(modes: ModalData, place: dict[Dof, tuple[int, int]], wanted: tuple[Dof, ...]) -> ComplexArray:
    if modes.shapes is None:
        return np.zeros((0, len(modes)), complex)
    index = np.array([place[d][0] for d in wanted], dtype=int)
    sign = np.array([place[d][1] for d in wanted], dtype=float)
    shapes = modes.shapes[index] * sign[:, None]
    moves = np.abs(shapes).max(axis=0, initial=0.0) >= UNSEEN * np.abs(modes.shapes).max(axis=0, initial=0.0)
    return np.asarray(np.where(moves, shapes, 0.0))


def mode_names(modes: ModalData) -> list[str]:
    """Name modes by number and frequency: ``3: 187.02 Hz``."""
    return [f"{i}: {hertz(f)}" for i, f in enumerate(modes.frequency, start=1)]


def modes_table(modes: ModalData) -> pd.DataFrame:
    """Return one row per mode: frequency [Hz], damping ratio [%], their standard deviations, MPC [-].

    Parameters
    ----------
    modes : ModalData
        Modes, identified or read; those without shapes have no MPC.
    """
    table = modes.table()
    if modes.shapes is not None:
        table["MPC"] = mpc(modes.shapes)
    return table


def mac_table(first: ModalData, second: ModalData | None = None) -> pd.DataFrame:
    """MAC of two sets of modes at the degrees of freedom both have, or of one set with itself.

    Parameters
    ----------
    first : ModalData
        Modes of the rows.
    second : ModalData, optional
        Modes of the columns; default the same.

    Returns
    -------
    DataFrame
        Rows and columns named by number and frequency; nan if there is but one degree of freedom [-].

    Raises
    ------
    InputError
        If there is no shape or no degree of freedom in common.
    """
    if second is None:
        if first.shapes is None:
            raise InputError("these modes have no shapes to compare")
        return pd.DataFrame(auto_mac(first.shapes), mode_names(first), mode_names(first))
    shared = _shared(first, second)
    return pd.DataFrame(mac(shared.first, shared.second), mode_names(first), mode_names(second))


def coordinate_table(
    first: ModalData, second: ModalData, pairs: Sequence[tuple[int, int]] | None = None
) -> pd.DataFrame:
    """CoMAC and ECoMAC at each degree of freedom both sets have.

    Parameters
    ----------
    first, second : ModalData
        Modes.
    pairs : sequence of (int, int), optional
        Which mode of the first belongs to which of the second, counted from 0; default the same numbers.

    Returns
    -------
    DataFrame
        One row per degree of freedom; nan where a measure does not exist [-].

    Raises
    ------
    InputError
        If there is no degree of freedom in common, or there are no pairs.
    """
    shared = _shared(first, second)
    wanted = list(pairs) if pairs is not None else [(i, i) for i in range(min(len(first), len(second)))]
    if not wanted:
        raise InputError("no pairs of modes were given; pair them first")
    a, b = shared.first[:, [i for i, _ in wanted]], shared.second[:, [j for _, j in wanted]]
    index = pd.Index([str(d) for d in shared.dofs], name="degree of freedom")
    return pd.DataFrame({"CoMAC": comac(a, b), "ECoMAC": ecomac(a, b)}, index=index)


def frac_table(first: FrfSet, second: FrfSet) -> pd.DataFrame:
    """FRAC of the FRFs two sets have in common, measured and fitted ones for instance.

    Parameters
    ----------
    first, second : FrfSet
        FRFs on the same lines; the second is brought to the form of the first.

    Returns
    -------
    DataFrame
        One row per FRF in common: response, reference, FRAC [-].

    Raises
    ------
    InputError
        If the lines differ, or no FRF is in common.
    """
    other = second.to(first.form)
    if len(other.frequency) != len(first.frequency) or not np.allclose(
        other.frequency, first.frequency, rtol=0, atol=1e-3 * first.df
    ):
        raise InputError("the FRFs lie on different frequency lines; evaluate them on the same ones")
    place = {p: i for i, p in enumerate(zip(other.responses, other.references, strict=True))}
    names = list(zip(first.responses, first.references, strict=True))
    rows = [(i, place[p]) for i, p in enumerate(names) if p in place]
    if not rows:
        raise InputError(
            "the two sets have no FRF in common; compare pairs of degrees of freedom that are in both"
        )
    values = frac(first.values[[i for i, _ in rows]], other.values[[j for _, j in rows]])
    text = {k: [str(names[i][n]) for i, _ in rows] for n, k in enumerate(("response", "reference"))}
    return pd.DataFrame({**text, "FRAC": values})


def _shared(first: ModalData, second: ModalData) -> CommonDofs:
    shared = common_dofs(first, second)
    if not shared.dofs:
        raise InputError(
            f"no degree of freedom in common: {len(first.dofs)} and {len(second.dofs)} of them; node numbers "
            "and directions must be the same in both"
        )
    return shared
