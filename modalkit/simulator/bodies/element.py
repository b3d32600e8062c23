"""A six-node Timoshenko element: quintic deflection and quintic rotation, independent of each other.

Lagrange polynomials on the Gauss-Lobatto points; eight Gauss points integrate stiffness and mass of uniform
elements exactly. Polynomials of this order do not lock in slender beams, and need no other care in stocky
ones (Hughes, The Finite Element Method, 2000, sections 3.6 and 5.4). Properties may vary inside an element:
they are taken at the Gauss points.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

ORDER = 5
NODES = ORDER + 1
_LEGENDRE = np.polynomial.legendre.Legendre.basis(ORDER)
LOBATTO = 0.5 * (1.0 + np.concatenate([[-1.0], np.sort(_LEGENDRE.deriv().roots().real), [1.0]]))
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)
GAUSS = 0.5 * (1.0 + _POINTS)
_COEFFICIENTS = np.linalg.inv(np.vander(LOBATTO, increasing=True))


def lagrange(xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the six polynomials and their derivatives in ``xi``.

    Parameters
    ----------
    xi : (n,) array
        Place inside the element, 0 to 1 [-].

    Returns
    -------
    values, derivatives : (n, 6) arrays
        One column per node of the element [-].
    """
    powers = np.vander(xi, NODES, increasing=True)
    slopes = np.arange(1, NODES) * powers[:, :-1]
    return powers @ _COEFFICIENTS, slopes @ _COEFFICIENTS[1:]


def element_nodes(edges: FloatArray) -> FloatArray:
    """Return the positions of all nodes of a mesh, shape (5 n_elements + 1,) [m]."""
    inner = edges[:-1, None] + np.diff(edges)[:, None] * LOBATTO[:-1]
    return np.append(inner.ravel(), edges[-1])


def gauss_places(edges: FloatArray) -> FloatArray:
    """Return the positions of the Gauss points, shape (n_elements, 8) [m]."""
    return edges[:-1, None] + np.diff(edges)[:, None] * GAUSS


def gauss_rows(edges: FloatArray, local: FloatArray) -> FloatArray:
    """Spread an element's rows over all DOFs of the mesh, one row per Gauss point.

    Parameters
    ----------
    edges : (n_elements + 1,) array
        Borders of the elements [m].
    local : (n_elements, 8, 12) or (8, 12) array
        Rows that read a quantity at the Gauss points from an element's twelve DOFs.

    Returns
    -------
    (8 n_elements, n_dofs) array
        Each times the square root of the Gauss point's share of the length, so that ``rows.T @ rows``
        integrates the product of the quantity with itself.
    """
    count = len(edges) - 1
    share = np.sqrt(0.5 * _WEIGHTS * np.diff(edges)[:, None])
    element = np.arange(count)[:, None, None]
    out = np.zeros((count, len(GAUSS), 2 * (ORDER * count + 1)))
    columns = np.broadcast_to(2 * ORDER * element + np.arange(2 * NODES), (count, len(GAUSS), 2 * NODES))
    np.put_along_axis(out, columns, local * share[..., None], axis=2)
    return out.reshape(count * len(GAUSS), -1)


def readers(xi: FloatArray, length: FloatArray) -> dict[str, FloatArray]:
    """Return rows that read deflection, slope, rotation and curvature from an element's DOFs.

    Parameters
    ----------
    xi : (n,) array
        Places inside the elements [-].
    length : (n,) or (m, 1) array
        Lengths of the elements: one for each place, or m elements with the same places each [m].

    Returns
    -------
    dict of arrays, shape (n, 12), or (m, n, 12) for slopes in m elements
        ``w`` [-], ``slope`` [1/m], ``theta`` [-], ``curvature`` [1/m].
    """
    values, derivatives = lagrange(xi)
    scaled = derivatives / length[..., None]
    out = {}
    for name, part, offset in (
        ("w", values, 0),
        ("slope", scaled, 0),
        ("theta", values, 1),
        ("curvature", scaled, 1),
    ):
        out[name] = np.zeros((*part.shape[:-1], 2 * NODES))
        out[name][..., offset::2] = part
    return out
