"""A four-node Timoshenko element: cubic deflection and cubic rotation, independent of each other.

Lagrange polynomials on the Gauss-Lobatto points; six Gauss points integrate stiffness and mass of uniform
elements exactly. Cubics do not lock, and the error falls with the sixth power of the element's length however
short it is against the thickness (Hughes, The Finite Element Method, 2000, sections 3.6 and 5.4).
Properties may vary inside an element: they are taken at the Gauss points.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

ORDER = 3
LOBATTO = np.array([0.0, 0.5 - 0.5 / np.sqrt(5), 0.5 + 0.5 / np.sqrt(5), 1.0])
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)
GAUSS = 0.5 * (1.0 + _POINTS)
_COEFFICIENTS = np.linalg.inv(np.vander(LOBATTO, increasing=True))


def lagrange(xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the four polynomials and their derivatives in ``xi``.

    Parameters
    ----------
    xi : (n,) array
        Place inside the element, 0 to 1 [-].

    Returns
    -------
    values, derivatives : (n, 4) arrays
        One column per node of the element [-].
    """
    powers = np.vander(xi, ORDER + 1, increasing=True)
    slopes = np.arange(1, ORDER + 1) * powers[:, :-1]
    return powers @ _COEFFICIENTS, slopes @ _COEFFICIENTS[1:]


def element_nodes(edges: FloatArray) -> FloatArray:
    """Return the positions of all nodes of a mesh, shape (3 n_elements + 1,) [m]."""
    inner = edges[:-1, None] + np.diff(edges)[:, None] * LOBATTO[:-1]
    return np.append(inner.ravel(), edges[-1])


def gauss_places(edges: FloatArray) -> FloatArray:
    """Return the positions of the Gauss points, shape (n_elements, 6) [m]."""
    return edges[:-1, None] + np.diff(edges)[:, None] * GAUSS


def gauss_rows(edges: FloatArray, local: FloatArray) -> FloatArray:
    """Spread an element's rows over all DOFs of the mesh, one row per Gauss point.

    Parameters
    ----------
    edges : (n_elements + 1,) array
        Borders of the elements [m].
    local : (n_elements, 6, 8) or (6, 8) array
        Rows that read a quantity at the Gauss points from an element's eight DOFs.

    Returns
    -------
    (6 n_elements, n_dofs) array
        Each times the square root of the Gauss point's share of the length, so that ``rows.T @ rows``
        integrates the product of the quantity with itself.
    """
    count = len(edges) - 1
    share = np.sqrt(0.5 * _WEIGHTS * np.diff(edges)[:, None])
    element = np.arange(count)[:, None, None]
    out = np.zeros((count, len(GAUSS), 2 * (ORDER * count + 1)))
    columns = np.broadcast_to(
        2 * ORDER * element + np.arange(2 * (ORDER + 1)), (count, len(GAUSS), 2 * (ORDER + 1))
    )
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
    dict of arrays, shape (n, 8), or (m, n, 8) for slopes in m elements
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
        out[name] = np.zeros((*part.shape[:-1], 2 * (ORDER + 1)))
        out[name][..., offset::2] = part
    return out
