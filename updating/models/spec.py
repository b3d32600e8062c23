"""What a modeller states about a beam or a plate, before any matrix exists."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from acquisition.display import Displayed, counted
from acquisition.errors import StudyError
from updating.models.parts import PointMass, Region

if TYPE_CHECKING:
    from updating.models.imported.hypothesis import Hypothesis
    from updating.models.imported.matrices import Imported

Kind = Literal["beam", "plate", "matrices"]
Theory = Literal["euler-bernoulli", "rayleigh", "timoshenko", "kirchhoff", "mindlin", "imported"]

EDGES = {"beam": {"x0", "x1"}, "plate": {"x0", "x1", "y0", "y1"}, "matrices": set[str]()}
"""Edges that can be clamped; imported matrices come with their supports."""

THEORIES = {
    "beam": {"euler-bernoulli", "rayleigh", "timoshenko"},
    "plate": {"kirchhoff", "mindlin"},
    "matrices": {"imported"},
}
"""Theories of each kind of model."""

FULLER: dict[Kind, Theory] = {"beam": "timoshenko", "plate": "mindlin"}
"""The theory of each kind of model that leaves out neither shear nor rotary inertia."""

MOST_ELEMENTS = 20_000
"""More elements than this of a uniform beam or plate add nothing new and cost memory: some 2 GB on a plate [-]."""

CALLED = {"beam": "a beam", "plate": "a plate", "matrices": "imported matrices"}
"""Kinds of model in a sentence."""

DIMENSIONS = {"beam": 1, "plate": 2, "matrices": 3}
"""How many coordinates a place on the model has."""


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material.

    Parameters
    ----------
    E : float
        Modulus of elasticity [Pa].
    density : float
        Mass density [kg/m^3].
    poisson : float
        Poisson's ratio [-].
    """

    E: float
    density: float
    poisson: float = 0.3


@dataclass(frozen=True)
class Damping:
    """What the modeller expects of the damping; all None is 'unknown'.

    Parameters
    ----------
    alpha, beta : float, optional
        C = alpha M + beta K [1/s, s].
    loss_factor : float, optional
        Structural loss factor [-].
    ratios : tuple of float, optional
        Damping ratio of each mode [-].
    """

    alpha: float | None = None
    beta: float | None = None
    loss_factor: float | None = None
    ratios: tuple[float, ...] | None = None

    @property
    def known(self) -> bool:
        """Whether anything is expected at all."""
        return any(v is not None for v in (self.alpha, self.beta, self.loss_factor, self.ratios))


@dataclass(frozen=True)
class Spec(Displayed):
    """A beam or a rectangular plate: x from 0 to length, y from 0 to width, hit along z; or imported matrices.

    Parameters
    ----------
    kind : {"beam", "plate", "matrices"}
        What it is.
    length, width, thickness : float
        Dimensions along x, y and z; of imported matrices the extents of their nodes [m].
    elements : tuple of int
        Number of elements along x, and along y for a plate; empty for matrices.
    clamped : tuple of str
        Clamped edges, of x0, x1 and for plates y0, y1; empty is free.
    theory : str
        euler-bernoulli, rayleigh (with rotary inertia) or timoshenko for beams, kirchhoff or mindlin
        (with shear and rotary inertia) for plates; imported.
    material : Material
        Material of everything that no region overrides.
    regions : tuple of Region
        Macro-elements; empty means ten along x for a beam, 5 x 3 for a plate.
    masses : tuple of PointMass
        Masses stated by the modeller.
    damping : Damping
        What the modeller expects.
    imported : Imported, optional
        The matrices, where they are given.
    hypotheses : tuple of Hypothesis
        What the modeller thinks may be so.

    Raises
    ------
    StudyError
        If a dimension is not positive, an edge or a theory does not exist for this kind, or a mass or region cannot be
        or lies off the structure.
    """

    kind: Kind
    _: KW_ONLY
    length: float
    width: float
    thickness: float
    elements: tuple[int, ...]
    clamped: tuple[str, ...]
    theory: Theory
    material: Material
    regions: tuple[Region, ...] = ()
    masses: tuple[PointMass, ...] = ()
    damping: Damping = field(default_factory=Damping)
    imported: Imported | None = None
    hypotheses: tuple[Hypothesis, ...] = ()

    def __post_init__(self) -> None:
        for name in ("length", "width", "thickness"):
            if not 0 < getattr(self, name) < float("inf"):
                raise StudyError(f"model: {name} must be positive and finite, found {getattr(self, name)}")
        edges = EDGES[self.kind]
        if unknown := set(self.clamped) - edges:
            raise StudyError(f"model: a {self.kind} has no edge {sorted(unknown)}; use {sorted(edges)}")
        theories = THEORIES[self.kind]
        if self.theory not in theories:
            raise StudyError(f"model: no theory {self.theory!r} for a {self.kind}; use {sorted(theories)}")
        if (
            len(self.elements) != (0 if self.kind == "matrices" else self.dim)
            or min(self.elements, default=1) < 1
        ):
            raise StudyError(f"model: elements = {list(self.elements)} does not fit a {self.kind}")
        if math.prod(self.elements) > MOST_ELEMENTS:
            raise StudyError(
                f"model: elements = {list(self.elements)} are more than {MOST_ELEMENTS}; fewer are as accurate and "
                "need less memory"
            )
        for mass in self.masses:
            mass.check(self.dim, self.called)
        for region in self.regions:
            region.check(self.kind)
        if not self.regions:
            object.__setattr__(self, "regions", _default_regions(self))

    @property
    def dim(self) -> int:
        """How many coordinates a place on the model has: 1 for a beam, 2 for a plate, 3 for matrices."""
        return DIMENSIONS[self.kind]

    @property
    def called(self) -> str:
        """How a sentence names this kind of model."""
        return CALLED[self.kind]

    @property
    def outlined(self) -> bool:
        """Whether length, width and thickness are its own, so that any place on it and any caliper mean something."""
        return self.imported is None

    @property
    def fuller(self) -> Theory | None:
        """The theory with the shear and rotary inertia that the model leaves out; None where it leaves out nothing."""
        fuller = FULLER.get(self.kind)
        return None if fuller == self.theory else fuller

    def with_theory(self, theory: Theory) -> Spec:
        """Return the same specimen under another theory."""
        return replace(self, theory=theory)

    def with_elements(self, *elements: int) -> Spec:
        """Return the same specimen with another mesh."""
        return replace(self, elements=elements)

    def _headline(self) -> str:
        held = f"clamped at {', '.join(self.clamped)}" if self.clamped else "free"
        size = " x ".join(f"{n:g}" for n in (self.length, self.width, self.thickness))
        return f"{self.kind} of {size} m, {held}, {self.theory}, {counted(len(self.regions), 'region')}"


def _default_regions(spec: Spec) -> tuple[Region, ...]:
    n_x, n_y = (10, 1) if spec.kind == "beam" else (5, 3)
    dx, dy = spec.length / n_x, spec.width / n_y
    if spec.kind == "beam":
        return tuple(Region(f"zone{i + 1}", (i * dx, (i + 1) * dx)) for i in range(n_x))
    return tuple(
        Region(f"zone{i + 1}{'abc'[j]}", (i * dx, (i + 1) * dx), (j * dy, (j + 1) * dy))
        for i in range(n_x)
        for j in range(n_y)
    )
