"""Modes to a file of the kind that its ending names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from acquisition import HitVerdict, InputError, write_uff
from acquisition.modal_csv import modes_csv
from acquisition.readers import UFF
from identification import ModalModel
from modalkit.existing import Modes
from modalkit.records import modes_record
from modalkit.write import check_place, write_json, write_text

ENDINGS = (*sorted(UFF), ".csv", ".json")
"""What modes can be written as."""


def check_modes_place(path: Path | str | None) -> None:
    """See that modes could be written there, before work begins whose result would be lost; None is no file.

    Raises
    ------
    InputError
        If the ending is none of `ENDINGS`, or the folder cannot be written.
    """
    if path is None:
        return
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: modes are written by their ending: {', '.join(ENDINGS)}")
    check_place(path)


def write_modes(
    path: Path | str,
    modes: ModalModel | Modes,
    *,
    hits: Sequence[HitVerdict] = (),
    warnings: Sequence[str] | None = None,
    title: str = "",
) -> None:
    """Write modes as data sets 55 (.uff), as a table (.csv) or as ``modalkit.modes/1`` (.json); each is read back.

    Parameters
    ----------
    path : path
        Where to; its ending says as what.
    modes : ModalModel or Modes
        The modes.
    hits : sequence of HitVerdict
        What is thought of the hits they come from; only JSON keeps it.
    warnings : sequence of str, optional
        What the user ought to know; left out: those of the modes. Only JSON keeps them.
    title : str
        Title of a universal file.

    Raises
    ------
    InputError
        If the ending is none of these, or the file cannot be written.
    """
    check_modes_place(path)
    path = Path(path)
    said = modes.warnings if warnings is None else warnings
    ending = path.suffix.lower()
    if ending == ".csv":
        write_text(path, modes_csv(modes.modal))
    elif ending == ".json":
        write_json(path, modes_record(modes, hits, said))
    else:
        write_uff(path, modal=modes.modal, geometry=modes.modal.geometry, title=title)
