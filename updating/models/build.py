"""One door to every kind of structure."""

from __future__ import annotations

from updating.models.base import Structure
from updating.models.imported_structure import ImportedStructure
from updating.models.spec import Spec
from updating.models.structure import build_field_structure


def build_structure(spec: Spec) -> Structure:
    """Build the model that a specification describes.

    Raises
    ------
    StudyError
        If a region lies off the structure, or imported matrices belong to no structure.
    """
    if spec.kind == "matrices":
        return ImportedStructure(spec)
    return build_field_structure(spec)
