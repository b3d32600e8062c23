"""Two sets of modes side by side: who belongs to whom, who has no partner, who is mixed with whom."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.display import Displayed, counted
from acquisition.dof import Dof
from acquisition.modal_data import ModalData
from identification.mac import common_dofs, mac
from identification.pairing.assignment import Pair, common_factor, pair
from identification.pairing.turned import Subspace, turned_subspaces

_MIN_MAC = 0.5
_FACTOR = 2.5
_SPREAD = 0.1


@dataclass(frozen=True, eq=False)
class Correlation(Displayed):
    """What two sets of modes have to do with each other.

    Parameters
    ----------
    test, model : ModalData
        The two sets.
    dofs : tuple of Dof
        Degrees of freedom both have.
    mac : (n_test, n_model) array
        MAC there; nan if there are fewer than two [-].
    pairs : tuple of Pair
        Modes that belong together.
    subspaces : tuple of Subspace
        Close modes that span the same space in both sets but are mixed differently; their single MACs mean
        nothing.
    notes : tuple of str
        What the reader should know.
    """

    test: ModalData
    model: ModalData
    dofs: tuple[Dof, ...]
    mac: FloatArray
    pairs: tuple[Pair, ...]
    subspaces: tuple[Subspace, ...]
    notes: tuple[str, ...]

    @property
    def test_alone(self) -> tuple[int, ...]:
        """Modes of the test without a partner, counted from 0."""
        return tuple(sorted(set(range(len(self.test))) - {p.test for p in self.pairs}))

    @property
    def model_alone(self) -> tuple[int, ...]:
        """Modes of the model without a partner, counted from 0."""
        return tuple(sorted(set(range(len(self.model))) - {p.model for p in self.pairs}))

    def table(self) -> pd.DataFrame:
        """Return one row per mode of either set, rising in frequency; nan where there is no partner.

        Frequencies in Hz, error in %; "mixed with" names the test modes whose shapes are turned among one
        another, "space" the squared cosine of the largest angle between the spaces they span.
        """
        mixed = {i: s for s in self.subspaces for i in s.test}
        rows = [self._row(p.test, p.model, p.mac, 100 * p.error, mixed) for p in self.pairs]
        rows += [self._row(i, None, np.nan, np.nan, mixed) for i in self.test_alone]
        rows += [self._row(None, j, np.nan, np.nan, {}) for j in self.model_alone]
        table = pd.DataFrame(
            rows,
            columns=["test", "test [Hz]", "model", "model [Hz]", "error [%]", "MAC", "mixed with", "space"],
        )
        order = table["test [Hz]"].fillna(table["model [Hz]"]).argsort(kind="stable")
        return table.iloc[order].reset_index(drop=True)

    def _row(
        self, i: int | None, j: int | None, value: float, error: float, mixed: dict[int, Subspace]
    ) -> list[object]:
        group = None if i is None else mixed.get(i)
        others = "" if group is None else ", ".join(str(k + 1) for k in group.test if k != i)
        return [
            np.nan if i is None else float(i + 1),
            np.nan if i is None else float(self.test.frequency[i]),
            np.nan if j is None else float(j + 1),
            np.nan if j is None else float(self.model.frequency[j]),
            error,
            value,
            others,
            np.nan if group is None else group.mac,
        ]

    def _headline(self) -> str:
        return (
            f"{counted(len(self.pairs), 'pair')} of {len(self.test)} and {len(self.model)} modes, compared at "
            f"{counted(len(self.dofs), 'degree')} of freedom"
        )


def correlate(test: ModalData, model: ModalData, *, min_mac: float = _MIN_MAC) -> Correlation:
    """Pair two sets of modes by the shapes and frequencies they have in common.

    Shapes are compared at the degrees of freedom both sets have. With fewer than two of them, frequencies
    alone decide. Close modes that are only mixed differently count by the space they span.

    Parameters
    ----------
    test, model : ModalData
        Modes, with shapes or without.
    min_mac : float
        MAC under which two modes are no partners [-].

    Returns
    -------
    Correlation
        Pairs, modes without a partner, and turned groups.
    """
    shared = common_dofs(test, model)
    if len(shared.dofs) < 2:
        values = np.full((len(test), len(model)), np.nan)
        pairs = pair(test.frequency, model.frequency)
        stated = f"{len(shared.dofs)} degrees of freedom in common: paired by frequency alone"
        return Correlation(test, model, shared.dofs, values, pairs, (), (stated,))
    values = mac(shared.first, shared.second)
    groups = _groups(test, model, (shared.first, shared.second), values, min_mac)
    priced = values.copy()
    for group in groups:
        priced[np.ix_(group.test, group.model)] = group.mac
    pairs = tuple(
        replace(p, mac=float(values[p.test, p.model]))
        for p in pair(test.frequency, model.frequency, priced, min_mac=min_mac)
    )
    return Correlation(test, model, shared.dofs, values, pairs, groups, _notes(groups, len(shared.dofs)))


def _groups(
    test: ModalData,
    model: ModalData,
    shapes: tuple[ComplexArray, ComplexArray],
    values: FloatArray,
    min_mac: float,
) -> tuple[Subspace, ...]:
    if not values.size:
        return ()
    shift = np.log(model.frequency)[None, :] - np.log(test.frequency)[:, None]
    centre = common_factor(shift, values, min_mac, float(np.log(_FACTOR)), _SPREAD)
    frequency = (test.frequency, model.frequency)
    return turned_subspaces(frequency, shapes, factor=float(np.exp(centre)))


def _notes(groups: tuple[Subspace, ...], n_dofs: int) -> tuple[str, ...]:
    stated = []
    for group in groups:
        ours, theirs = (", ".join(str(i + 1) for i in side) for side in (group.test, group.model))
        stated.append(
            f"test modes {ours} and model modes {theirs} span the same space (largest angle "
            f"{group.angle:.0f} degrees), but are mixed differently: close modes mix after the smallest "
            "change, so their single MACs are meaningless"
        )
    if n_dofs < 4:
        stated.append(f"{n_dofs} degrees of freedom in common: a high MAC is weak evidence")
    return tuple(stated)
