"""What the app hands over: a folder from whose study the command line gives the same numbers."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition import Geometry, write_uff
from acquisition.errors import InputError
from acquisition.modes.csv_table import modes_csv
from acquisition.warned import in_order
from identification import ModalModel
from modalkit.app.jobs import report_of, result_of
from modalkit.app.opened import Opened, relocated
from modalkit.app.toml import toml_text
from modalkit.output.documents import modes_document
from modalkit.output.whole import plain, write_text
from modalkit.workflow.existing import Modes
from modalkit.workflow.processed import Processed


@dataclass(frozen=True, eq=False)
class Handed:
    """What there is to hand over.

    Parameters
    ----------
    processed : Processed or None
        The FRFs, where there are any.
    modes : ModalModel or Modes
        The modes.
    geometry : Geometry
        The points of the test where the study or its model places them.
    results : mapping of str to Path
        Folders of finished work on this very state, by kind.
    """

    processed: Processed | None
    modes: ModalModel | Modes
    geometry: Geometry
    results: Mapping[str, Path]


def study_text(opened: Opened, content: Mapping[str, Any], title: str, folder: Path) -> str:
    """Return the study as a file in another folder.

    Parameters
    ----------
    opened : Opened
        What was opened.
    content : mapping
        Its tables as they stand.
    title : str
        What it is called where it does not say so itself.
    folder : Path
        Where the file will stand.
    """
    moved = relocated(content, opened.study_path.parent, folder)
    return toml_text({"title": title} | moved)


def export(folder: Path, study: str, handed: Handed) -> list[str]:
    """Write study, FRFs and modes as UFF, modes as JSON and CSV, and what work is finished; whole or not at all.

    Parameters
    ----------
    folder : Path
        It must not exist yet.
    study : str
        The study's text, its files named from this folder.
    handed : Handed
        What there is.

    Returns
    -------
    list of str
        The names of the files.

    Raises
    ------
    InputError
        If the folder exists already, or cannot be written.
    """
    if folder.exists():
        raise InputError(f"{folder}: exists; it is not overwritten")
    half = folder.with_name(f".{folder.name}.half")
    shutil.rmtree(half, ignore_errors=True)
    try:
        half.mkdir(parents=True)
        _write(half, study, handed)
        half.rename(folder)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written ({error.strerror})") from error
    finally:
        shutil.rmtree(half, ignore_errors=True)
    return sorted(path.name for path in folder.iterdir())


def _write(folder: Path, study: str, handed: Handed) -> None:
    processed, modes, geometry = handed.processed, handed.modes, handed.geometry
    write_text(folder / "study.toml", study)
    hits = () if processed is None else processed.hits
    title = "" if processed is None else processed.content.title
    warnings = in_order([*(() if processed is None else processed.warnings), *modes.warnings])
    _json(folder / "modes.json", modes_document(modes, hits, warnings))
    write_text(folder / "modes.csv", modes_csv(modes.modal))
    if modes.modal.shapes is not None:
        write_uff(folder / "modes.uff", modal=modes.modal, geometry=geometry, title=title)
    if processed is not None:
        write_uff(folder / "frfs.uff", frfs=processed.frfs, geometry=geometry, title=title)
    for kind, where in handed.results.items():
        found = result_of(where)
        if found is not None:
            _json(folder / f"{kind}.json", found["document"])
        page = report_of(where)
        if page is not None:
            write_text(folder / f"{kind}.html", page)


def _json(path: Path, document: Mapping[str, object]) -> None:
    """Write a document as `--json` does."""
    write_text(path, json.dumps(plain(document), indent=1, allow_nan=False) + "\n")


def free_folder(parent: Path, name: str) -> Path:
    """Return a folder of this name that is not there yet, numbered where it is."""
    number, folder = 1, parent / name
    while folder.exists():
        number += 1
        folder = parent / f"{name}-{number}"
    return folder
