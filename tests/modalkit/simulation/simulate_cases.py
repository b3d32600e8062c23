"""What several of the tests beside it need."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from modalkit.samples import sample_file
from updating import Material

Run = Callable[..., tuple[int, str, str]]


STUDY = sample_file("beam_dry/study.toml")


STEEL = Material(210e9, 7850.0, 0.3)


def pointed_at(data: Path, folder: Path, model_damping: str = "") -> Path:
    """The sample's study with another file."""
    path = folder / "other.toml"
    text = STUDY.read_text().replace("beam_dry.uff", str(data))
    path.write_text(text.replace("[tolerances]", f"{model_damping}\n[tolerances]"))
    return path
