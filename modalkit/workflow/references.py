"""Some of the forces of a test, by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition import InputError, UffContent
from modalkit.workflow.processing_options import ProcessingOptions


def references_of(content: UffContent) -> list[str]:
    """Return the degrees of freedom that were hit, or that FRFs refer to, as printed, each once."""
    names = [str(point.reference) for test in content.tests for point in test.points]
    if content.frfs is not None:
        names += [str(dof) for dof in content.frfs.references]
    return list(dict.fromkeys(names))


def with_references(content: UffContent, names: Sequence[str]) -> UffContent:
    """Return what files hold of some references alone.

    Parameters
    ----------
    content : UffContent
        What the files hold.
    names : sequence of str
        Degrees of freedom as printed, ``12+Z``.

    Raises
    ------
    InputError
        If one is not there.
    """
    known, wanted = references_of(content), {name.strip().upper() for name in names}
    if strange := sorted(wanted - {name.upper() for name in known}):
        raise InputError(f"no force at {strange[0]}; references are {', '.join(known[:12])}")
    points = [[p for p in test.points if str(p.reference).upper() in wanted] for test in content.tests]
    tests = [
        replace(test, points=tuple(kept)) for test, kept in zip(content.tests, points, strict=True) if kept
    ]
    frfs = content.frfs
    if frfs is not None:
        rows = np.flatnonzero([str(dof).upper() in wanted for dof in frfs.references])
        frfs = frfs.select(rows) if len(rows) else None
    return replace(content, tests=tuple(tests), frfs=frfs)


def among_references(processing: ProcessingOptions) -> ProcessingOptions:
    """Return processing options whose decisions on hits are those at the references used."""
    wanted = {name.strip().upper() for name in processing.references}
    use, leave = (
        tuple(hit for hit in hits if hit[0].strip().upper() in wanted)
        for hits in (processing.use, processing.leave)
    )
    return replace(processing, use=use, leave=leave)
