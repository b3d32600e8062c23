"""A TOML file, or a line that states why it is not one."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from acquisition.encoding import not_utf8
from acquisition.errors import StudyError


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Return the content of a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    kind : str
        What it is: ``study file``.

    Raises
    ------
    StudyError
        If it cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}); give the path of a {kind}") from error
    except UnicodeDecodeError as error:
        binary = f"{path}: not a valid TOML file but binary data; give a {kind} that names it"
        raise StudyError(not_utf8(path, path.read_bytes()) or binary) from error
    except (ValueError, RecursionError) as error:
        raise StudyError(f"{path}: not a valid TOML file: {error}") from error
