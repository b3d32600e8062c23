"""What several of the tests beside it need."""

from __future__ import annotations

from acquisition import (
    UffContent,
)


def numbers(content: UffContent | None) -> tuple:
    """Return all numbers of a content."""
    assert content is not None
    waves = [(p.force.tobytes(), p.motion.tobytes()) for t in content.tests for p in t.points]
    frfs = None if content.frfs is None else content.frfs.values.tobytes()
    geometry = content.geometry
    modal = content.modal
    shapes = (
        None if modal is None or modal.shapes is None else (modal.frequency.tobytes(), modal.shapes.tobytes())
    )
    return waves, frfs, shapes, geometry.nodes, geometry.coordinates.tobytes(), geometry.lines.tobytes()


def silent(before: UffContent, after: UffContent | None) -> bool:
    """Tell whether numbers changed without a word."""
    return (
        after is not None
        and not set(after.warnings) - set(before.warnings)
        and numbers(after) != numbers(before)
    )


def table(number: int, *lines: str) -> bytes:
    return (f"    -1\n{number:6d}\n" + "".join(line + "\n" for line in lines) + "    -1\n").encode()


def row(pattern: str, values) -> str:
    return "".join(pattern % v for v in values)
