"""The current folder does not belong on the module path: a ``scipy.py`` beside a study is not to be run.

Only what the interpreter has loaded at its start is used here, for whatever else is imported before the folder is off
the path could be somebody's file in it.
"""

import os
import sys

HOME = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))  # noqa: PTH120
"""Where the packages of modalkit are found."""


def leave_current_folder() -> None:
    """Take the current folder off the module path of this process.

    Stays what the user put into ``PYTHONPATH`` by its full name. Run from the folder that holds modalkit itself, that
    folder goes to the end of the path.
    """
    sys.path[:] = _without_current_folder(sys.path)


def started_as_module(package: str) -> bool:
    """Return whether this process is ``python -m package``, and the package is only just being imported for it."""
    words = sys.orig_argv
    return sys.argv[:1] == ["-m"] and any(
        words[i - 1] == "-m" and (words[i] == package or words[i].startswith(package + "."))
        for i in range(1, len(words))
    )


def child_environment() -> dict[str, str]:
    """Return the variables with which an interpreter started from here finds the same modalkit, and no other module.

    To be used with the option ``-P``, which keeps the current folder out where the variable is not the reason.
    """
    given = [os.path.abspath(p) for p in _given() if p]  # noqa: PTH100
    kept = [p for p in given if not _is_current(p) or p in _asked_for()]
    if not _is_installed():
        kept.append(HOME)
    return {"PYTHONPATH": os.pathsep.join(dict.fromkeys(kept)), "PYTHONSAFEPATH": "1"}


def _without_current_folder(path: list[str]) -> list[str]:
    kept = [p for p in path if not _is_current(p) or p in _asked_for()]
    if len(kept) < len(path) and _is_current(HOME):
        kept.append(HOME)
    return kept


def _is_current(folder: str) -> bool:
    """Return whether an entry of the module path is the current folder; an empty one is."""
    try:
        return not folder or os.path.samefile(folder, os.curdir)  # noqa: PTH121
    except OSError:
        return False


def _given() -> list[str]:
    return os.environ.get("PYTHONPATH", "").split(os.pathsep)


def _asked_for() -> list[str]:
    """Return what stands in PYTHONPATH by its full name; an empty entry and ``.`` are seldom meant."""
    return [p for p in _given() if os.path.isabs(p)]  # noqa: PTH117


def _is_installed() -> bool:
    """Return whether modalkit stands where the interpreter finds it anyway."""
    return os.path.basename(HOME) in ("site-packages", "dist-packages")  # noqa: PTH119
