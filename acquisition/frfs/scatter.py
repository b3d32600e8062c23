"""How each hit moves the FRFs: their covariance, kept as one deviation per hit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray, frozen_array
from acquisition.display import Displayed
from acquisition.errors import InputError


@dataclass(frozen=True, eq=False)
class HitGroup(Displayed):
    """FRFs that were averaged over the same hits.

    Parameters
    ----------
    rows : (n_rows,) int array
        Row numbers of these FRFs in their set.
    deviations : (n_hits, n_rows, n_lines) complex array
        What each hit adds to the error of each FRF [unit of the FRFs].
    """

    rows: IntArray
    deviations: ComplexArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", frozen_array(self.rows, np.int64))
        object.__setattr__(self, "deviations", frozen_array(self.deviations, complex_type(self.deviations)))
        if self.deviations.ndim != 3 or self.deviations.shape[1] != len(self.rows):
            raise InputError(
                f"scatter of hits: deviations have shape {self.deviations.shape} for {len(self.rows)} FRFs; "
                "give (hits, FRFs, lines)"
            )

    @property
    def count(self) -> int:
        """Number of hits."""
        return int(self.deviations.shape[0])


@dataclass(frozen=True, eq=False)
class HitScatter(Displayed):
    """Covariance of averaged FRFs, as deviations of the single hits.

    Responses measured in the same hit share its force and its noise, and a window ties neighbouring lines
    together. All of that is in one statement: the estimate of Cov(H_i(f), H_j(g)) is
    sum_k s_ik(f) conj(s_jk(g)) over the hits k that both FRFs have in common, and nothing between FRFs of
    different hits. Without the conjugate it is the estimate of the complementary covariance. The correction
    for the few hits is in the deviations: the estimate has no bias for noise equal in all hits. Any smooth
    function of the FRFs has, to first order, the deviations J s_k and the covariance
    sum_k (J s_k)(J s_k)^T.

    Parameters
    ----------
    groups : tuple of HitGroup
        One entry per set of hits. An FRF that was corrected by another (for the mass of a sensor) is a member
        of both groups.
    """

    groups: tuple[HitGroup, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "groups", tuple(self.groups))
        if len({group.deviations.shape[2] for group in self.groups}) != 1:
            raise InputError("scatter of hits: no groups, or groups with different numbers of lines")

    @property
    def n_lines(self) -> int:
        """Number of frequency lines."""
        return int(self.groups[0].deviations.shape[2])

    @property
    def hit_groups(self) -> tuple[IntArray, ...]:
        """Row numbers of the FRFs that share hits, one array per set of hits."""
        return tuple(group.rows for group in self.groups)

    def of_hits(self) -> Iterator[tuple[IntArray, ComplexArray]]:
        """Go through all hits: the rows of the FRFs a hit took part in, and its (n_rows, n_lines) deviations."""
        for group in self.groups:
            for deviation in group.deviations:
                yield group.rows, deviation

    def of_frf(self, row: int) -> ComplexArray:
        """Return the deviations of one FRF, shape (n_hits, n_lines)."""
        return np.concatenate(
            [g.deviations[:, g.rows == row].sum(axis=1) for g in self.groups if row in g.rows]
        )

    def variance(self, n_frf: int) -> FloatArray:
        """Return E|dH|^2 of every FRF at every line, shape (n_frf, n_lines) [unit of the FRFs squared]."""
        total = np.zeros((n_frf, self.n_lines))
        for group in self.groups:
            real, imag = (
                np.asarray(p, dtype=np.float64) for p in (group.deviations.real, group.deviations.imag)
            )
            np.add.at(total, group.rows, np.einsum("hrl,hrl->rl", real, real))
            np.add.at(total, group.rows, np.einsum("hrl,hrl->rl", imag, imag))
        return total

    def covariance(self, row: int, other: int) -> ComplexArray:
        """Return Cov(H_row(f), H_other(g)) for all pairs of lines, shape (n_lines, n_lines) [unit squared]."""
        total = np.zeros((self.n_lines, self.n_lines), dtype=np.complex128)
        for group in self.groups:
            one, two = (group.deviations[:, group.rows == r].sum(axis=1) for r in (row, other))
            total += np.einsum("hf,hg->fg", one, two.conj(), dtype=np.complex128)
        return total

    def lines(self, keep: slice) -> HitScatter:
        """Return the scatter on some of the lines (a view, nothing is copied)."""
        return HitScatter(tuple(HitGroup(g.rows, g.deviations[:, :, keep]) for g in self.groups))

    def select(self, rows: Sequence[int]) -> HitScatter | None:
        """Return the scatter of some of the FRFs, renumbered as given; None if that of none is known."""
        wanted = np.asarray(rows, dtype=np.int64)
        groups = []
        for group in self.groups:
            new, old = np.nonzero(wanted[:, None] == group.rows[None, :])
            if len(new):
                groups.append(HitGroup(new, group.deviations[:, old]))
        return HitScatter(tuple(groups)) if groups else None

    def times(self, factor: Any) -> HitScatter:
        """Return the scatter of FRFs multiplied by a factor.

        Parameters
        ----------
        factor : scalar, or array that broadcasts to (n_frf, n_lines)
            What the FRFs were multiplied by [any].
        """
        wide = np.atleast_2d(np.asarray(factor))
        parts = (wide if len(wide) == 1 else wide[g.rows] for g in self.groups)
        return HitScatter(
            tuple(
                HitGroup(g.rows, (g.deviations * part).astype(g.deviations.dtype))
                for g, part in zip(self.groups, parts, strict=True)
            )
        )

    @classmethod
    def joined(cls, scatters: Sequence[HitScatter | None], counts: Sequence[int]) -> HitScatter | None:
        """Return the scatter of several sets put one after the other; None if that of any is not known.

        Parameters
        ----------
        scatters : sequence of HitScatter or None
            One per set.
        counts : sequence of int
            Number of FRFs of each set.
        """
        first = np.concatenate([[0], np.cumsum(counts)])
        groups: list[HitGroup] = []
        for scatter, start in zip(scatters, first[:-1], strict=True):
            if scatter is None:
                return None
            groups += [HitGroup(g.rows + start, g.deviations) for g in scatter.groups]
        return cls(tuple(groups))


def complex_type(values: Any) -> type[np.complex64] | type[np.complex128]:
    """Return complex64 for values in single precision, else complex128."""
    single = getattr(values, "dtype", None) in (np.dtype(np.complex64), np.dtype(np.float32))
    return np.complex64 if single else np.complex128


def variance_of_groups(contributions: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return variances of quantities worked out from FRFs, and how many degrees of freedom they stand on.

    Parameters
    ----------
    contributions : sequence of (n_hits, n) arrays
        What each hit adds to the error of each quantity, J s_k, one array per group of hits [any].

    Returns
    -------
    variance : (n,) array
        Their sum of squares [any squared].
    freedom : (n,) array
        (sum v_g)^2 / sum v_g^2 / (n_g - 1), with v_g the part of group g: few hits determine the variance poorly, and
        an interval of 95 % takes Student's t of so many degrees of freedom (Satterthwaite, Biometrics 2, 1946);
        infinite where the variance is zero [-].
    """
    parts = np.array([(np.asarray(c, dtype=np.float64) ** 2).sum(axis=0) for c in contributions])
    counts = np.array([max(len(c) - 1, 1) for c in contributions], dtype=np.float64)
    variance = parts.sum(axis=0)
    share = parts / np.where(variance > 0, variance, 1.0)
    below = (share**2 / counts[:, None]).sum(axis=0)
    return variance, np.divide(1.0, below, out=np.full(below.shape, np.inf), where=below > 0)
