"""``[model] type = "matrices"``: what the study file states about them, read and made a specification."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models import Damping, Material, PointMass, Region, Spec
from updating.models.imported import SI, Imported, read_imported

if TYPE_CHECKING:
    from modalkit.study.model_tables import ModelTable

FOREIGN = ("length", "width", "thickness", "elements", "clamped", "theory")
"""Keys of ``[model]`` that beams and plates have and matrices do not."""

FACTORS_ALONE = Material(1.0, 1.0)
"""Material of matrices for which none is stated: modulus and density are factors."""


LIGHTEST = 0.1
"""Below any solid's density [kg/m^3]."""


def matrices_of(model: ModelTable, file: Callable[[str], Path]) -> Imported:
    """Read the files that a ``[model]`` of type matrices names.

    Parameters
    ----------
    model : ModelTable
        The table.
    file : callable
        Takes a name of the study file to its path.

    Raises
    ------
    StudyError
        If a key is missing or does not belong there, or a file cannot be read.
    """
    if foreign := [key for key in FOREIGN if getattr(model, key)]:
        raise StudyError(
            f"[model] of type matrices takes no {', '.join(foreign)}: the matrices come with their supports and size"
        )
    names = {"stiffness": model.stiffness, "mass": model.mass_matrix, "nodes": model.nodes}
    if missing := [key for key, name in names.items() if name is None]:
        raise StudyError(f"[model] of type matrices needs {', '.join(missing)}, each a file")
    for key in ("stiffness_parts", "mass_parts"):
        parts: list[str] = getattr(model, key)
        if parts and len(parts) != len(model.region):
            raise StudyError(
                f"[model] {key} has {len(parts)} files for {len(model.region)} [[model.region]]; give one for each, in "
                "their order"
            )
    return read_imported(
        file(str(model.stiffness)),
        file(str(model.mass_matrix)),
        file(str(model.nodes)),
        stiffness_parts=[file(name) for name in model.stiffness_parts],
        mass_parts=[file(name) for name in model.mass_parts],
        units=model.units or SI,
        names=(model.stiffness_name, model.mass_name),
    )


def matrices_spec(model: ModelTable, imported: Imported, damping: Damping) -> Spec:
    """Return the specification of a structure given by matrices.

    Parameters
    ----------
    model : ModelTable
        What the study states beside them.
    imported : Imported
        The matrices.
    damping : Damping
        What the modeller expects.

    Raises
    ------
    StudyError
        If a region has no place.
    """
    material = model.material
    if material is not None and material.density < LIGHTEST:
        raise StudyError(
            f"[model.material] density = {material.density:g}: no solid is so light; it is in kg/m3, and E in Pa, "
            "whatever the units of the matrices"
        )
    if named := [region.name for region in model.region if region.set]:
        raise StudyError(f"[[model.region]] {named[0]!r} has a set; those are of decks, type calculix")
    made = FACTORS_ALONE if material is None else Material(material.E, material.density, material.poisson)
    return spec_of(model, imported, made, _regions(model, imported), damping)


def spec_of(
    model: ModelTable, imported: Imported, material: Material, regions: tuple[Region, ...], damping: Damping
) -> Spec:
    """Return the specification of matrices that have been read, on regions that have been placed."""
    low, high = imported.extents
    size = np.maximum(high - low, 1e-6 * max(float((high - low).max()), 1e-9))
    return Spec(
        "matrices",
        length=float(size[0]),
        width=float(size[1]),
        thickness=float(size[2]),
        elements=(),
        clamped=(),
        theory="imported",
        material=material,
        regions=regions,
        masses=tuple(PointMass(tuple(mass.at), mass.mass, mass.inertia) for mass in model.mass),
        damping=damping,
        imported=imported,
    )


def _regions(model: ModelTable, imported: Imported) -> tuple[Region, ...]:
    """Return the regions, placed where the study states, else where their parts are; one of all if there is none."""
    if not model.region:
        return (Region("all", *sides_of(imported, imported.extents)),)
    found = []
    for i, table in enumerate(model.region):
        stated = table.model_dump(exclude={"set"})
        if table.x is None:
            box = imported.box(i)
            if box is None:
                raise StudyError(
                    f"[[model.region]] {table.name!r} needs x, or a part of the stiffness or mass of its own"
                )
            along, across = sides_of(imported, box)
            stated["x"], stated["y"] = along, stated["y"] or across
        if given := [key for key in ("thickness", "area", "inertia") if stated[key] is not None]:
            raise StudyError(f"[[model.region]] {table.name!r}: imported matrices have no {', '.join(given)}")
        found.append(Region(**stated))
    return tuple(found)


def sides_of(
    imported: Imported, box: tuple[FloatArray, FloatArray]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the limits of a box along x and y, never without area [m]."""
    low, high = box
    least = 1e-6 * float(max((imported.extents[1] - imported.extents[0]).max(), 1e-9))
    top = np.maximum(high, low + least)
    return (float(low[0]), float(top[0])), (float(low[1]), float(top[1]))
