"""A file of rules, ``diagnose --rules FILE``: what the verdict is decided by, where not by the defaults."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from acquisition.errors import InputError, StudyError
from modalkit.study.errors import nearest
from modalkit.study.toml import read_toml
from updating.diagnosis.answer.rules import DecisionRules


def read_rules(path: Path | str) -> DecisionRules:
    """Read rules from a TOML file, one ``name = number`` a line; those that it does not name have their defaults.

    Parameters
    ----------
    path : path
        The TOML file.

    Raises
    ------
    StudyError
        If it cannot be read, is no TOML, or has a key that is no rule or a value that a rule cannot have.
    """
    content = read_toml(Path(path), "file of rules")
    known = [one.name for one in fields(DecisionRules)]
    for name, value in content.items():
        if name not in known:
            raise StudyError(f"{path}: no rule {name!r}{nearest(name, known)}; there are {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise StudyError(f"{path}: {name} = {value!r}: must be a number")
    try:
        return DecisionRules(**content)
    except InputError as error:
        raise StudyError(f"{path}: {error}") from error
