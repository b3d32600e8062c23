"""A beam or plate as a sum of energy terms over regions.

Paper A, Eqs. 11-14, and paper B, Eqs. 1 and 3, divide the model in regions whose matrices are summed.
Here every matrix is a sum of *terms*: two fields, a coefficient at each quadrature point, and the power with
which the term grows with modulus, density, thickness, width and length. So K and M are exact for any change
of these, and their logarithmic sensitivities are the powers themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.fields import Fields, Sparse, beam_fields, plate_fields, timoshenko_fields
from updating.models.spec import Region, Spec

FACTORS = ("E", "density", "thickness", "width", "length", "section", "area", "inertia")
"""What a model can be scaled by; ``section`` scales stiffness and mass alike, ``area`` and ``inertia`` are a beam's."""


@dataclass(frozen=True, eq=False)
class Term:
    """One energy term of the model.

    Parameters
    ----------
    kind : {"stiffness", "mass"}
        Which matrix it belongs to.
    left, right : str
        Names of the two fields; the matrix is symmetrised when they differ.
    coefficient : (n_points,) array
        Physical coefficient at the quadrature points, times their weights [SI].
    powers : mapping
        Power of the term in each factor; what is missing is 0, but every term grows with ``section`` [-].
    """

    kind: str
    left: str
    right: str
    coefficient: FloatArray
    powers: Mapping[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "powers", MappingProxyType({"section": 1.0, **self.powers}))

    def scale(self, factors: Mapping[str, float]) -> float:
        """Return the product of the factors to their powers [-]."""
        scale = 1.0
        for name, value in factors.items():
            scale *= value ** self.powers.get(name, 0.0)
        return scale


@dataclass(frozen=True, eq=False)
class Structure:
    """A finite-element model of a beam or a plate, ready to be reduced or solved.

    Parameters
    ----------
    spec : Spec
        What it is a model of.
    fields : Fields
        Its fields.
    terms : tuple of Term
        Its stiffness and mass.
    region_of : (n_points,) int array
        Region in which each quadrature point lies, -1 for none.
    fixed : mapping of str to int array
        Degrees of freedom that a clamp holds: its ``translation`` and its ``rotation``.
    """

    spec: Spec
    fields: Fields
    terms: tuple[Term, ...]
    region_of: IntArray
    fixed: Mapping[str, IntArray] = field(default_factory=lambda: MappingProxyType({}))

    def matrix(self, kind: str, weights: FloatArray | float = 1.0) -> Sparse:
        """Assemble the stiffness or mass matrix over all degrees of freedom [SI].

        Parameters
        ----------
        kind : {"stiffness", "mass"}
            Which one.
        weights : (n_points,) array or float
            Factor on the coefficient at every quadrature point [-]; masks give region matrices.
        """
        n = self.fields.n_dofs
        total = Sparse((n, n))
        for term in self.terms:
            if term.kind == kind:
                left, right = self.fields.sampled[term.left], self.fields.sampled[term.right]
                part = left.T @ sparse.diags_array(term.coefficient * weights) @ right
                total = total + (part if term.left == term.right else (part + part.T) / 2)
        if kind == "mass":
            total = total + self.point_masses()
        return Sparse(total)

    def point_masses(self) -> Sparse:
        """Assemble the masses the modeller knows of [kg in w]."""
        n = self.fields.n_dofs
        total = Sparse((n, n))
        for mass in self.spec.masses:
            rows = self.fields.at(np.array([mass.at[: self.fields.dim]]))
            total = total + mass.mass * (rows["w"].T @ rows["w"])
            for slope in ("wx", "wy"):
                if mass.inertia and slope in rows:
                    total = total + mass.inertia * (rows[slope].T @ rows[slope])
        return total

    def free(self, released: frozenset[str] = frozenset()) -> IntArray:
        """Return the degrees of freedom that the clamps leave free, where some kinds are released."""
        held = [dofs for kind, dofs in self.fixed.items() if kind not in released]
        keep = np.ones(self.fields.n_dofs, dtype=bool)
        keep[np.concatenate(held).astype(int) if held else np.zeros(0, dtype=int)] = False
        return np.flatnonzero(keep)

    @cached_property
    def rigid_modes(self) -> int:
        """Number of rigid-body modes that the clamps leave."""
        if self.fixed:
            return 0
        return 2 if self.fields.dim == 1 else 3

    def eigen(
        self,
        count: int,
        *,
        stiffness: Sparse | None = None,
        mass: Sparse | None = None,
        released: frozenset[str] = frozenset(),
    ) -> tuple[FloatArray, FloatArray]:
        """Solve for the lowest modes of the full model, rigid-body modes included.

        Parameters
        ----------
        count : int
            Number of modes.
        stiffness, mass : sparse arrays, optional
            Matrices in place of the nominal ones [SI].
        released : frozenset of str
            Parts of the clamps that do not hold.

        Returns
        -------
        eigenvalues : (count,) array
            Squares of the angular frequencies [rad^2/s^2].
        vectors : (n_dofs, count) array
            Mass-normalised eigenvectors over all degrees of freedom [kg^-1/2].

        Raises
        ------
        StudyError
            If the model has fewer degrees of freedom than modes asked for.
        """
        free = self.free(released)
        k = (self.matrix("stiffness") if stiffness is None else stiffness)[free][:, free]
        m = (self.matrix("mass") if mass is None else mass)[free][:, free]
        if count > len(free):
            raise StudyError(
                f"the model has {len(free)} degrees of freedom, too few for {count} modes; use more elements"
            )
        values, vectors = _lowest(k, m, count)
        full = np.zeros((self.fields.n_dofs, count))
        full[free] = vectors
        return values, full

    def region_mask(self, region: Region) -> BoolArray:
        """Tell which quadrature points lie in a region, shape (n_points,)."""
        return region_mask(region, self.fields.points)


def _lowest(k: Sparse, m: Sparse, count: int) -> tuple[FloatArray, FloatArray]:
    """Solve dense where the model is small, by shift and invert where it is not."""
    from scipy.linalg import eigh

    n = k.shape[0]
    if n <= 400 or count > n // 3:
        values, vectors = eigh(k.toarray(), m.toarray(), subset_by_index=(0, count - 1))
        return values, vectors
    shift = -1e-3 * k.diagonal().sum() / m.diagonal().sum() * 1e-3
    start = np.ones(n)
    values, vectors = linalg.eigsh(k.tocsc(), count, m.tocsc(), sigma=shift, which="LM", v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def region_mask(region: Region, points: FloatArray) -> BoolArray:
    """Tell which points (n_points, dim) [m] lie in a region, shape (n_points,)."""
    inside = (points[:, 0] >= region.x[0]) & (points[:, 0] <= region.x[1])
    if region.y is not None and points.shape[1] > 1:
        inside &= (points[:, 1] >= region.y[0]) & (points[:, 1] <= region.y[1])
    return np.asarray(inside)


def build_structure(spec: Spec) -> Structure:
    """Build the finite-element model of a beam or plate.

    Raises
    ------
    StudyError
        If a region lies off the structure.
    """
    if spec.kind == "plate":
        fields = plate_fields(spec.length, spec.width, (spec.elements[0], spec.elements[1]))
    elif spec.theory == "timoshenko":
        fields = timoshenko_fields(spec.length, spec.elements[0])
    else:
        fields = beam_fields(spec.length, spec.elements[0])
    region_of = np.full(len(fields.weights), -1)
    for index, region in enumerate(spec.regions):
        inside = region_mask(region, fields.points)
        if not inside.any():
            raise StudyError(f"region {region.name!r} holds no part of the model; check its x and y")
        region_of[inside] = index
    terms = (
        _plate_terms(spec, fields, region_of)
        if spec.kind == "plate"
        else _beam_terms(spec, fields, region_of)
    )
    return Structure(spec, fields, terms, region_of, _fixed(spec, fields))


def _local(spec: Spec, region_of: IntArray, name: str, default: float) -> FloatArray:
    """Return a property at the quadrature points: a region's own value, else the model's."""
    own = [getattr(region, name) for region in spec.regions]
    table = np.array([default if value is None else value for value in own] + [default])
    return np.asarray(table[region_of])


def _beam_terms(spec: Spec, fields: Fields, region_of: IntArray) -> tuple[Term, ...]:
    thickness = _local(spec, region_of, "thickness", spec.thickness)
    area = np.array([np.nan if r.area is None else r.area for r in spec.regions] + [np.nan])[region_of]
    area = np.where(np.isnan(area), spec.width * thickness, area)
    inertia = np.array([np.nan if r.inertia is None else r.inertia for r in spec.regions] + [np.nan])[
        region_of
    ]
    inertia = np.where(np.isnan(inertia), spec.width * thickness**3 / 12, inertia)
    modulus = _local(spec, region_of, "E", spec.material.E)
    density = _local(spec, region_of, "density", spec.material.density)
    w = fields.weights
    bending = {"E": 1.0, "thickness": 3.0, "width": 1.0, "inertia": 1.0}
    # r is the rotation per unit of stretched length, so that r = dw/dx stays r = dw/dx when the beam grows
    shearing = {"E": 1.0, "thickness": 1.0, "width": 1.0, "length": -1.0, "area": 1.0}
    inertial = {"density": 1.0, "thickness": 1.0, "width": 1.0, "length": 1.0, "area": 1.0}
    rotary = {"density": 1.0, "thickness": 3.0, "width": 1.0, "inertia": 1.0}
    mass = Term("mass", "w", "w", w * density * area, inertial)
    if spec.theory != "timoshenko":
        terms = [Term("stiffness", "wxx", "wxx", w * modulus * inertia, bending | {"length": -3.0}), mass]
        if spec.theory == "rayleigh":
            terms.append(Term("mass", "wx", "wx", w * density * inertia, rotary | {"length": -1.0}))
        return tuple(terms)
    nu = spec.material.poisson
    shear_modulus = modulus / (2 * (1 + nu))
    stiff = w * shear_coefficient(nu) * shear_modulus * area
    return (
        Term("stiffness", "rx", "rx", w * modulus * inertia, bending | {"length": -3.0}),
        Term("stiffness", "wx", "wx", stiff, shearing),
        Term("stiffness", "wx", "r", -2 * stiff, shearing),
        Term("stiffness", "r", "r", stiff, shearing),
        mass,
        Term("mass", "r", "r", w * density * inertia, rotary | {"length": -1.0}),
    )


def shear_coefficient(poisson: float) -> float:
    """Shear coefficient of a rectangular section, Cowper (1966): 10 (1 + nu) / (12 + 11 nu) [-]."""
    return 10 * (1 + poisson) / (12 + 11 * poisson)


def _plate_terms(spec: Spec, fields: Fields, region_of: IntArray) -> tuple[Term, ...]:
    thickness = _local(spec, region_of, "thickness", spec.thickness)
    modulus = _local(spec, region_of, "E", spec.material.E)
    density = _local(spec, region_of, "density", spec.material.density)
    nu = spec.material.poisson
    w = fields.weights
    rigidity = w * modulus * thickness**3 / (12 * (1 - nu**2))
    bending = {"E": 1.0, "thickness": 3.0}
    along, across = bending | {"length": -3.0, "width": 1.0}, bending | {"length": 1.0, "width": -3.0}
    mixed = bending | {"length": -1.0, "width": -1.0}
    inertial = {"density": 1.0, "thickness": 1.0, "width": 1.0, "length": 1.0}
    return (
        Term("stiffness", "wxx", "wxx", rigidity, along),
        Term("stiffness", "wyy", "wyy", rigidity, across),
        Term("stiffness", "wxx", "wyy", 2 * nu * rigidity, mixed),
        Term("stiffness", "wxy", "wxy", 2 * (1 - nu) * rigidity, mixed),
        Term("mass", "w", "w", w * density * thickness, inertial),
    )


def _fixed(spec: Spec, fields: Fields) -> Mapping[str, IntArray]:
    """Sort the degrees of freedom of the clamped edges into what holds translation and what rotation."""
    if not spec.clamped:
        return MappingProxyType({})
    held: dict[str, list[IntArray]] = {"translation": [], "rotation": []}
    for edge in spec.clamped:
        axis, end = "xy".index(edge[0]), int(edge[1])
        normal = "u_x" if axis == 0 else "u_y"
        for component in fields.components:
            place = component.basis.mesh.p[axis].max() if end else component.basis.mesh.p[axis].min()
            found = component.basis.get_dofs(lambda p, a=axis, at=place: np.isclose(p[a], at))
            for name, dofs in found.nodal.items():
                turns = component.offset > 0 or name in (normal, "u_xy")
                if spec.theory == "timoshenko" and name == normal:
                    continue  # the slope of a clamped Timoshenko beam is its shear strain, and free
                held["rotation" if turns else "translation"].append(np.asarray(dofs) + component.offset)
    return MappingProxyType({k: np.unique(np.concatenate(v)) for k, v in held.items()})
