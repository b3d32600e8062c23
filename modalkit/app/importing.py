"""The import of text and of recorder files: files chosen, columns guessed and corrected, layout and study written."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from acquisition import FrfSet, HammerTest, UffContent, read_test
from acquisition.columns.blocks import read_text
from acquisition.columns.proposal import BEGINS
from acquisition.errors import InputError
from acquisition.readers import COLUMNS
from acquisition.recorders import ARRAYS, ENDINGS, all_arrays, is_recorded, listed
from modalkit.app.controller import Controller
from modalkit.app.doing import Doing
from modalkit.app.import_form import ROLES, layout_of, proposed_form
from modalkit.app.opened import open_path
from modalkit.app.store import Store
from modalkit.app.toml import toml_text
from modalkit.output.whole import write_text
from modalkit.workflow.joining import together
from modalkit.workflow.usable import usable

SHOWN, WIDEST = 14, 160
"""Lines of a file that the page shows, and characters of each."""

MOST_FILES = 2000
"""Files that are offered at the most [-]."""

DEEPEST = 3
"""Levels of folders below the one opened whose files are offered [-]."""

IMPORTED = COLUMNS | ENDINGS
"""Endings of files that an import reads."""

STUDY, LAYOUT = "study.toml", "layout.toml"


class Importing:
    """A folder of column text or recorder files that is made a test.

    Parameters
    ----------
    folder : Path
        Where the files are, in it or in folders below it, and where layout and study will stand.
    first : str
        The file it was opened with; "" for the folder.
    why : str
        Why that file is not opened as it is.
    warm : bool
        Whether the study made has a process for long work at hand.

    Raises
    ------
    InputError
        If there is no such file.
    """

    def __init__(self, folder: Path, first: str = "", why: str = "", *, warm: bool = False) -> None:
        """Find the files."""
        self._folder, self._why, self._warm = folder, why, warm
        self._names = imported_files(folder)
        if not self._names:
            raise InputError(
                f"{folder}: no column text or recorder file in it ({', '.join(sorted(IMPORTED))}) and no {STUDY}"
            )
        self._first = first
        self._doing = Doing(None)
        self._lock = threading.Lock()
        self.controller: Controller | None = None

    def state(self) -> dict[str, Any]:
        """Return what the head of the page shows."""
        return {"title": "Import", "file": self._folder.name, "importing": True, "has_files": True}

    def page(self) -> dict[str, Any]:
        """Return the files, which of them are proposed, and where layout and study would stand."""
        return {
            "folder": str(self._folder),
            "files": self._names,
            "chosen": alike(self._names, self._first),
            "why": self._why,
            "title": self._folder.resolve().name,
            "study": self._free(STUDY),
            "layout": self._free(LAYOUT),
            "roles": ROLES,
        }

    def proposed(self, names: Sequence[str], written: Mapping[str, Any]) -> dict[str, Any]:
        """Return the first lines of the files chosen, and the form with its guesses or why there is none."""
        with self._lock, self._doing.step("guessing the columns"):
            paths = self._paths(names)
            found: dict[str, Any] = {"file": names[0], "lines": [], "form": None, "error": ""}
            found["recorded"] = is_recorded(paths[0])
            try:
                lines = channels_in(paths[0]) if found["recorded"] else read_text(paths[0])[:SHOWN]
                found["lines"] = [line[:WIDEST] for line in lines]
                found["form"] = proposed_form(paths, written)
            except InputError as error:
                found["error"] = str(error)
            return found

    def checked(self, names: Sequence[str], form: Mapping[str, Any]) -> dict[str, Any]:
        """Return what would be read of the files with a form, or why nothing would."""
        with self._lock, self._doing.step("reading the files"):
            try:
                test = self._read(names, form)
            except InputError as error:
                return {"error": str(error), "usable": [], "table": []}
            return {"error": "", **in_numbers(test)}

    def write(
        self, names: Sequence[str], form: Mapping[str, Any], *, title: str, layout: str, study: str
    ) -> dict[str, Any]:
        """Write layout and study, and go on with the study.

        Raises
        ------
        InputError
            If nothing would be read, or a file of one of the names is there.
        """
        with self._lock, self._doing.step("reading the files"):
            places = [self._new(name) for name in (layout, study)]
            if layout == study:
                raise InputError(f"{study}: layout and study need different names")
            self._read(names, form)
            table, _ = layout_of(form)
            write_text(places[0], f"{BEGINS}, by its import.\n{toml_text(table)}")
            test = {"files": list(names), "layout": layout}
            write_text(places[1], toml_text({"title": title.strip() or self._folder.name, "test": test}))
            opened = open_path(places[1])
            self.controller = Controller(opened, Store.beside(places[1]), warm=self._warm)
            return self.controller.state()

    def doing(self) -> dict[str, Any]:
        """Return what is computed at this moment."""
        return self._doing.document()

    def interrupt(self) -> dict[str, Any]:
        """Stop what is computed."""
        self._doing.stop()
        return {}

    def close(self) -> None:
        """Stop all work of the study that was made."""
        if self.controller is not None:
            self.controller.close()

    def _paths(self, names: Sequence[str]) -> list[Path]:
        if not names:
            raise InputError("no file is chosen; choose those of one test")
        if strange := [name for name in names if name not in self._names]:
            raise InputError(f"{strange[0]}: not among the files of this folder")
        return [self._folder / name for name in names]

    def _read(self, names: Sequence[str], form: Mapping[str, Any]) -> HammerTest | FrfSet:
        paths, (_, layout) = self._paths(names), layout_of(form)
        found = read_test(paths, layout=layout)
        tests = [test for test in found if isinstance(test, HammerTest)]
        return tests[0] if tests else together([test for test in found if isinstance(test, FrfSet)])

    def _free(self, name: str) -> str:
        """Return a name that no file in the folder has."""
        stem, suffix = name.rsplit(".", 1)
        number = 1
        while (self._folder / name).exists():
            number += 1
            name = f"{stem}-{number}.{suffix}"
        return name

    def _new(self, name: str) -> Path:
        """Return the place of a file that is not there yet."""
        if not re.fullmatch(r"[\w .+-]+\.toml", name) or name.startswith("."):
            raise InputError(f"{name!r}: give a file name that ends with .toml, without a folder")
        if (self._folder / name).exists():
            raise InputError(f"{name}: is there already and is not replaced; give another name")
        return self._folder / name


def imported_files(folder: Path) -> list[str]:
    """Return the files that an import reads, in a folder and below it, by their paths from there.

    Folders that begin with a dot are passed over, and so are those deeper than three levels.
    """
    found: list[str] = []
    for at, folders, names in os.walk(folder):
        below = Path(at).relative_to(folder)
        deep = len(below.parts) >= DEEPEST
        folders[:] = [] if deep else sorted(name for name in folders if not name.startswith("."))
        found += [
            (below / name).as_posix() for name in sorted(names) if Path(name).suffix.lower() in IMPORTED
        ]
        if len(found) >= MOST_FILES:
            break
    return found[:MOST_FILES]


def channels_in(path: Path) -> list[str]:
    """Return a line for each array or channel of a recorder file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if path.suffix.lower() in ARRAYS:
        return [
            f"{name}: {' x '.join(map(str, values.shape)) or 'one number'}{', complex' * np.iscomplexobj(values)}"
            for name, values in all_arrays(path).items()
        ]
    record = listed(path)[0]
    return [
        f"{name}: {record.rates.get(i, 0.0):g} Hz" + (f", {unit}" if (unit := record.units.get(i)) else "")
        for i, name in enumerate(record.names)
    ]


def alike(names: Sequence[str], first: str = "") -> list[str]:
    """Return the files that probably are one test: names that differ in digits alone, most of them or with ``first``.

    Where all names differ, those of the commonest ending.
    """

    def kind(name: str) -> str:
        return re.sub(r"\d+", "0", name)

    kinds = [kind(name) for name in names]
    wanted = kind(first) if first else max(dict.fromkeys(kinds), key=kinds.count)
    found = [name for name in names if kind(name) == wanted]
    if len(found) > 1 or first:
        return found
    endings = [Path(name).suffix for name in names]
    usual = max(dict.fromkeys(endings), key=endings.count)
    return [name for name in names if Path(name).suffix == usual]


def in_numbers(test: HammerTest | FrfSet) -> dict[str, Any]:
    """Return what was read in words, and a row for each point: where it was hit, how often, the largest numbers.

    Numbers far from those expected show a wrong unit.
    """
    if isinstance(test, FrfSet):
        largest = np.abs(test.values).max(axis=1)
        of = {dof: [r == dof for r in test.references] for dof in dict.fromkeys(test.references)}
        return {
            "usable": usable(UffContent(frfs=test)),
            "columns": ["hit at", "FRFs", f"largest [{test.unit}]"],
            "table": [[str(dof), sum(own), f"{largest[own].max():.3g}"] for dof, own in of.items()],
        }
    unit = {"accelerance": "m/s²", "mobility": "m/s", "receptance": "m"}[test.form]
    return {
        "usable": [*usable(UffContent(tests=(test,))), f"records of {test.duration:.4g} s"],
        "columns": ["hit at", "hits", "measured at", "largest force [N]", f"largest response [{unit}]"],
        "table": [
            [
                str(hits.reference),
                hits.count,
                ", ".join(map(str, hits.responses)),
                f"{np.abs(hits.force).max():.3g}",
                f"{np.abs(hits.motion).max():.3g}",
            ]
            for hits in test.points
        ],
    }
