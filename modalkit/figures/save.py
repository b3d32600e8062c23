"""Figures to files, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.output.destinations import PNG, check_output

RESOLUTION = 150
"""Dots per inch of the files: 1800 px at full width."""


def save_figures(figures: Mapping[str, Figure], folder: Path | str) -> list[Path]:
    """Write figures as PNG files.

    Every figure is drawn before the first file is written, and every file is put in place in one step; none
    replaces a file that modalkit has not drawn.

    Parameters
    ----------
    figures : mapping of str to Figure
        Figures by file name, without its ending.
    folder : path
        Where to; made if it is not there.

    Returns
    -------
    list of Path
        The files, in the order of ``figures``.

    Raises
    ------
    InputError
        If a name is not a plain file name, the folder cannot be written to, or another file stands there.
    """
    for name in figures:
        if not name or Path(name).name != name:
            raise InputError(f"figure name {name!r} is not a plain file name; leave out folders")
    folder = Path(folder)
    drawn = {folder / f"{name}.png": png(figure) for name, figure in figures.items()}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in drawn:
            check_output(path, PNG)
        for path, content in drawn.items():
            _put(path, content)
    except OSError as error:
        raise InputError(
            f"{folder}: figures cannot be written ({error.strerror}); give another folder"
        ) from error
    return list(drawn)


def png(figure: Figure) -> bytes:
    """Return a figure as the content of a PNG file."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=RESOLUTION, metadata={"Software": "modalkit"})
    return buffer.getvalue()


def _put(path: Path, content: bytes) -> None:
    """Write beside the place and rename, so that no reader ever sees half a file."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise
