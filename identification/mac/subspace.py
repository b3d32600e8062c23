"""Do two sets of shapes span the same space, though no single shape agrees with one of the other set?"""

from __future__ import annotations

from scipy.linalg import qr, svdvals

from acquisition.arrays import AnyArray
from identification.mac.columns import both, unit


def subspace_mac(a: AnyArray, b: AnyArray) -> float:
    """Squared cosine of the largest principal angle between the spaces two sets of shapes span.

    Björck and Golub, Math. Comput. 27 (1973) 579-594. Two modes close in frequency are mixed by the smallest
    change of the structure: their shapes turn in the plane they span, single MACs fall to a half and the
    plane stays. For one shape each this is the MAC.

    Parameters
    ----------
    a, b : (n_dofs, n) arrays
        Shapes, as many in one set as in the other [any unit].

    Returns
    -------
    float
        1 for the same space; nan if there are not twice as many degrees of freedom as shapes, for then the
        spaces meet whatever the shapes are, or if the shapes of a set depend on each other [-].

    Raises
    ------
    InputError
        If the degrees of freedom disagree.
    """
    first, second = (unit(x) for x in both(a, b))
    count = max(first.shape[1], second.shape[1])
    if first.shape[1] != second.shape[1] or count == 0 or len(first) < 2 * count:
        return float("nan")
    if min(svdvals(first)[-1], svdvals(second)[-1]) < 1e-6:
        return float("nan")
    bases = [qr(x, mode="economic")[0] for x in (first, second)]
    smallest = float(svdvals(bases[0].conj().T @ bases[1])[-1])
    return min(smallest**2, 1.0)
