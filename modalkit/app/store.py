"""Where the app keeps its state and results: beside the study, or in the user's own folder where that is read-only."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from acquisition.errors import InputError
from modalkit.app.history import History, State
from modalkit.output.whole import write_text

SCHEMA = "modalkit.app/1"

RESULTS = 40
"""Results of diagnoses and updates that are kept, the newest; each is a report of some hundred kilobytes."""


@dataclass(frozen=True)
class Store:
    """The folder of one study or file.

    Parameters
    ----------
    folder : Path
        It exists.
    fingerprint : str
        Of the file as it was opened: a state is only gone on with where it is the same.
    """

    folder: Path
    fingerprint: str

    @classmethod
    def beside(cls, path: Path) -> Store:
        """Return the store of a study or data file, made where there is none.

        Raises
        ------
        InputError
            If there is no place for it.
        """
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        name = hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:12]
        for folder in (path.parent / ".modalkit" / path.name, _own_folder() / f"{path.name}-{name}"):
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError:
                continue
            if os.access(folder, os.W_OK):
                return cls(folder, digest)
        raise InputError(f"{path}: neither its folder nor {_own_folder()} can be written; make room for one")

    @property
    def _file(self) -> Path:
        return self.folder / "session.json"

    def save(self, history: History) -> None:
        """Write the history, whole or not at all."""
        states = [{"text": state.text, "label": state.label} for state in history.states]
        document = {
            "schema": SCHEMA,
            "fingerprint": self.fingerprint,
            "position": history.position,
            "states": states,
        }
        write_text(self._file, json.dumps(document, ensure_ascii=False))

    def load(self) -> History | None:
        """Return the history that was written for this very file; None where there is none that can be read."""
        try:
            document = json.loads(self._file.read_text(encoding="utf-8"))
            if document["schema"] != SCHEMA or document["fingerprint"] != self.fingerprint:
                return None
            states = tuple(State(str(s["text"]), str(s["label"])) for s in document["states"])
            history = History(states, int(document["position"]))
            _ = history.now.content
        except (OSError, ValueError, KeyError, TypeError, IndexError):
            return None
        return history

    def results(self, kind: str, key: str) -> Path:
        """Return the folder of the results of a kind of work on a state, whether it is there or not."""
        return self.folder / "results" / f"{kind}-{key}"

    def trim(self) -> None:
        """Throw out the oldest results beyond those that are kept."""
        folder = self.folder / "results"
        if not folder.is_dir():
            return
        by_age = sorted(folder.iterdir(), key=lambda one: one.stat().st_mtime, reverse=True)
        for old in by_age[RESULTS:]:
            shutil.rmtree(old, ignore_errors=True)


def _own_folder() -> Path:
    """Return where programs keep the state of a user."""
    stated = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(stated) if stated else Path.home() / ".local" / "state") / "modalkit"
