"""Modes to a file of the kind that its ending names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition import HitVerdict, InputError, write_uff
from acquisition.modes.csv_table import modes_csv
from acquisition.readers import UFF
from modalkit.output.destinations import Kind, check_output, json_of, uff_of
from modalkit.output.whole import write_json, write_text
from modalkit.workflow.existing import Modes

if TYPE_CHECKING:
    from identification import ModalModel

ENDINGS = (*sorted(UFF), ".csv", ".json")
"""What modes can be written as."""


def modes_kind(path: Path | None) -> Kind:
    """Return the kind of file that modes are written as, by its ending; None is no file and of any kind.

    Raises
    ------
    InputError
        If the ending is none of `ENDINGS`.
    """
    if path is None:
        return uff_of("modes")
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise InputError(
            f"{path}: the ending states the format, {', '.join(ENDINGS)}; name another file, as "
            f"{path.stem}_modes.uff"
        )
    if ending == ".csv":
        return Kind("a table of modes written by modalkit", "modes", ending, _is_our_table)
    return json_of("modalkit.modes/1") if ending == ".json" else uff_of("modes")


def _is_our_table(path: Path) -> bool:
    with path.open("rb") as file:
        # bytes of a header row; that of 10 000 degrees of freedom takes a quarter of it
        names = file.readline(1_000_000).rstrip().split(b",")
    # a column that every table of modes written here has, and one written by hand seldom
    return names[0] == b"frequency" and b"scaled" in names


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
        Where to; its ending selects the format.
    modes : ModalModel or Modes
        The modes.
    hits : sequence of HitVerdict
        What is thought of the hits they come from; only JSON keeps it.
    warnings : sequence of str, optional
        What the user should know; left out: those of the modes. Only JSON keeps them.
    title : str
        Title of a universal file.

    Raises
    ------
    InputError
        If the ending is none of these, something else than such a file stands there, or it cannot be written.
    """
    path = Path(path)
    check_output(path, modes_kind(path))
    if path.suffix.lower() in UFF and modes.modal.shapes is None:
        raise InputError(
            f"{path}: a data set of modes needs shapes, but these modes have none; write them as .csv or .json"
        )
    shown = modes.warnings if warnings is None else warnings
    ending = path.suffix.lower()
    if ending == ".csv":
        write_text(path, modes_csv(modes.modal))
    elif ending == ".json":
        from modalkit.output.documents import modes_document

        write_json(path, modes_document(modes, hits, shown))
    else:
        write_uff(path, modal=modes.modal, geometry=modes.modal.geometry, title=title)
