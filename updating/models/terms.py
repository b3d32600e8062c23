"""The energy terms of beams and plates: which fields meet with which coefficient, and how each grows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.base import scale_of
from updating.models.fields import Fields
from updating.models.spec import Spec


@dataclass(frozen=True, eq=False)
class FieldTerm:
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
        return scale_of(self.powers, factors)


def product(
    term: FieldTerm, sampled: Mapping[str, FloatArray], rows: IntArray, weights: FloatArray | None = None
) -> FloatArray:
    """Return a term over some quadrature points on a basis whose fields are ``sampled`` there, (r, r) [SI]."""
    coefficient = term.coefficient[rows]
    if weights is not None:
        coefficient = coefficient * weights
    part = sampled[term.left][rows].T @ (coefficient[:, None] * sampled[term.right][rows])
    return np.asarray((part + part.T) / 2)


def _local(spec: Spec, region_of: IntArray, name: str, default: float) -> FloatArray:
    """Return a property at the quadrature points: a region's own value, else the model's."""
    own = [getattr(region, name) for region in spec.regions]
    table = np.array([default if value is None else value for value in own] + [default])
    return np.asarray(table[region_of])


def modelled_mass(spec: Spec, region_of: IntArray) -> FloatArray:
    """Return the mass per length of a beam [kg/m], per area of a plate [kg/m2], at places in given regions (n,)."""
    thickness = _local(spec, region_of, "thickness", spec.thickness)
    density = _local(spec, region_of, "density", spec.material.density)
    if spec.kind == "plate":
        return density * thickness
    own = _local(spec, region_of, "area", np.nan)
    return density * np.where(np.isnan(own), spec.width * thickness, own)


def beam_terms(spec: Spec, fields: Fields, region_of: IntArray) -> tuple[FieldTerm, ...]:
    """Return the stiffness and mass of a beam: Euler-Bernoulli, Rayleigh or Timoshenko."""
    thickness = _local(spec, region_of, "thickness", spec.thickness)
    area = _local(spec, region_of, "area", np.nan)
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
    mass = FieldTerm("mass", "w", "w", w * modelled_mass(spec, region_of), inertial)
    if spec.theory != "timoshenko":
        terms = [
            FieldTerm("stiffness", "wxx", "wxx", w * modulus * inertia, bending | {"length": -3.0}),
            mass,
        ]
        if spec.theory == "rayleigh":
            terms.append(FieldTerm("mass", "wx", "wx", w * density * inertia, rotary | {"length": -1.0}))
        return tuple(terms)
    nu = spec.material.poisson
    shear_modulus = modulus / (2 * (1 + nu))
    stiff = w * _local(spec, region_of, "shear_coefficient", shear_coefficient(nu)) * shear_modulus * area
    return (
        FieldTerm("stiffness", "rx", "rx", w * modulus * inertia, bending | {"length": -3.0}),
        FieldTerm("stiffness", "wx", "wx", stiff, shearing),
        FieldTerm("stiffness", "wx", "r", -2 * stiff, shearing),
        FieldTerm("stiffness", "r", "r", stiff, shearing),
        mass,
        FieldTerm("mass", "r", "r", w * density * inertia, rotary | {"length": -1.0}),
    )


def shear_coefficient(poisson: float) -> float:
    """Shear coefficient of a rectangular section, Cowper (1966): 10 (1 + nu) / (12 + 11 nu) [-]."""
    return 10 * (1 + poisson) / (12 + 11 * poisson)


ACROSS, TWIST, COUPLING = "stiffness across", "stiffness in twist", "coupling of bending"
"""Factors of an orthotropic plate: D_y / D_x; 2 D_xy and D_1 over those of Huber, who has the geometric mean of both
directions [-]."""

PLATE_SHEAR = 5 / 6
"""Shear coefficient of plates; Reissner, J. Appl. Mech. 12 (1945) A69 [-]."""


def plate_terms(spec: Spec, fields: Fields, region_of: IntArray) -> tuple[FieldTerm, ...]:
    """Return the stiffness and mass of a plate: Kirchhoff's, or Mindlin's with shear and rotary inertia.

    Mindlin, J. Appl. Mech. 18 (1951) 31-38, with Reissner's shear coefficient. Powers of D_y / D_x are those of Huber
    (1923) for a thin plate; in a thick one the shear moduli across its thickness go with the twist.
    """
    thickness = _local(spec, region_of, "thickness", spec.thickness)
    modulus = _local(spec, region_of, "E", spec.material.E)
    density = _local(spec, region_of, "density", spec.material.density)
    nu = spec.material.poisson
    w = fields.weights
    rigidity = w * modulus * thickness**3 / (12 * (1 - nu**2))
    bending = {"E": 1.0, "thickness": 3.0}
    along = bending | {"length": -3.0, "width": 1.0}
    across = bending | {"length": 1.0, "width": -3.0, ACROSS: 1.0}
    mixed = bending | {"length": -1.0, "width": -1.0, ACROSS: 0.5}
    coupled, twisted = mixed | {COUPLING: 1.0}, mixed | {TWIST: 1.0}
    inertial = {"density": 1.0, "thickness": 1.0, "width": 1.0, "length": 1.0}
    mass = FieldTerm("mass", "w", "w", w * modelled_mass(spec, region_of), inertial)
    if spec.theory == "kirchhoff":
        return (
            FieldTerm("stiffness", "wxx", "wxx", rigidity, along),
            FieldTerm("stiffness", "wyy", "wyy", rigidity, across),
            FieldTerm("stiffness", "wxx", "wyy", 2 * nu * rigidity, coupled),
            FieldTerm("stiffness", "wxy", "wxy", 2 * (1 - nu) * rigidity, twisted),
            mass,
        )
    # rotations are per unit of stretched length, as those of Timoshenko's beam
    stiff = w * PLATE_SHEAR * modulus / (2 * (1 + nu)) * thickness
    turning = w * density * thickness**3 / 12
    shear, rotary = {"E": 1.0, "thickness": 1.0, ACROSS: 0.5}, {"density": 1.0, "thickness": 3.0}
    over_length, over_width = {"length": -1.0, "width": 1.0}, {"length": 1.0, "width": -1.0}
    return (
        FieldTerm("stiffness", "rxx", "rxx", rigidity, along),
        FieldTerm("stiffness", "ryy", "ryy", rigidity, across),
        FieldTerm("stiffness", "rxx", "ryy", 2 * nu * rigidity, coupled),
        FieldTerm("stiffness", "rt", "rt", (1 - nu) / 2 * rigidity, twisted),
        FieldTerm("stiffness", "gx", "gx", stiff, shear | over_length),
        FieldTerm("stiffness", "gy", "gy", stiff, shear | over_width),
        mass,
        FieldTerm("mass", "rx", "rx", turning, rotary | over_length),
        FieldTerm("mass", "ry", "ry", turning, rotary | over_width),
    )
