"""The sample data, wherever the package was installed: beside it in a clone, inside it from a wheel."""

from __future__ import annotations

from pathlib import Path

from acquisition.errors import InputError
from modalkit.module_path import HOME

FOLDERS = (Path(HOME) / "modalkit" / "_sample_data", Path(HOME) / "sample_data")


def sample_file(name: str) -> Path:
    """Return the path of a file of the sample data.

    Parameters
    ----------
    name : str
        Folder and file, as ``beam_dry/beam_dry.uff`` or ``plate_dry/study.toml``.

    Returns
    -------
    Path
        Where it lies.

    Raises
    ------
    InputError
        If there is no such file, or the samples were not installed.
    """
    for folder in FOLDERS:
        if (folder / name).is_file():
            return folder / name
    known = sorted({path.parent.name for folder in FOLDERS for path in folder.glob("*/study.toml")})
    if not known:
        raise InputError("the sample data are not installed; clone the repository and work there")
    raise InputError(f"no sample file {name!r}; the folders are {', '.join(known)}, each with a study.toml")
