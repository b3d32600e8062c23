"""One study in the app: its history, what is computed of it, the work on it; all that the server serves."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from acquisition.errors import InputError, ModalkitError
from identification import ModalModel
from modalkit.app.acceptance import accepted_entries
from modalkit.app.actions import ACTIONS
from modalkit.app.digests import digest_of
from modalkit.app.export import Handed, export, free_folder, study_text
from modalkit.app.history import History, State
from modalkit.app.jobs import Jobs, drawings_of, report_of, result_of
from modalkit.app.model_page import Moved, model_page, moved_page
from modalkit.app.opened import Opened
from modalkit.app.store import Store
from modalkit.app.work import KINDS
from modalkit.app.workbench import Workbench
from modalkit.output.schemas.diagnosis import SOMETHING_ELSE
from modalkit.study.read import Study
from modalkit.views.hits import frf_page, hits_page, record_page
from modalkit.views.modes import fit_page, modes_page, provisional_page
from modalkit.views.shapes import Beside, shapes_page
from modalkit.workflow.identification import Processed
from modalkit.workflow.references import references_of

NEEDS_MODES = frozenset({"hit", "pick", "drop", "band", "order", "references", "estimator", "text", "set"})
"""Changes that are made only if the modes can be identified after them."""

EXPORT = "modalkit-export"


class Controller:
    """The state of the app and what follows from it.

    Parameters
    ----------
    opened : Opened
        What was opened.
    store : Store
        Where its state is kept; one that is there is gone on with.
    """

    def __init__(self, opened: Opened, store: Store) -> None:
        """Go on where the last session ended."""
        self._opened, self._store = opened, store
        self._workbench, self._jobs = Workbench(), Jobs()
        self._lock = threading.RLock()
        self._history = store.load() or History((State.of(opened.content, "open"),))

    @property
    def study(self) -> Study:
        """The study as it stands."""
        return self._opened.study(self._history.now.content)

    @property
    def title(self) -> str:
        """What it is called."""
        return str(self._history.now.content.get("title") or self._opened.path.name)

    @property
    def _key(self) -> str:
        """What results are kept under: the study as it stands, and its files as they are."""
        return self._history.now.key(digest_of(self.study.inputs()[1:]))

    def _folder(self, kind: str) -> Path:
        """Return where the results of a kind of work stand."""
        return self._store.results(kind, self._key)

    def state(self) -> dict[str, Any]:
        """Return what the head of the page shows."""
        job = self._jobs.last
        history = self._history
        return {
            "title": self.title,
            "file": self._opened.path.name,
            "is_study": self._opened.is_study,
            "has_model": history.now.content.get("model") is not None,
            "has_files": bool(history.now.content.get("test", {}).get("files")),
            "key": self._key,
            "position": history.position,
            "undo": history.undo_label,
            "redo": history.redo_label,
            "job": None if job is None else job.document(),
            "results": [kind for kind in KINDS if self._result(kind) is not None],
        }

    def act(self, name: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Make a change, if the study is one after it and its modes can be identified; save it.

        Raises
        ------
        InputError
            If there is no such change, or it cannot be made; the study then stays as it is.
        """
        if name not in ACTIONS:
            raise InputError(f"unknown change {name!r}")
        with self._lock:
            content, label = ACTIONS[name](self._history.now.content, arguments)
            study = self._opened.study(content)
            if study.model is not None:
                study.spec()
                study.accepted()
            if name in NEEDS_MODES:
                self._workbench.modes(study)
            elif study.model is not None:
                self._beside(study)
            self._keep(self._history.then(content, label))
        return self.state()

    def step(self, *, back: bool) -> dict[str, Any]:
        """Undo or redo one change."""
        with self._lock:
            self._keep(self._history.undone() if back else self._history.redone())
        return self.state()

    def _keep(self, history: History) -> None:
        """Save a history, and then show it."""
        self._store.save(history)
        self._history = history

    def hits(self) -> dict[str, Any]:
        """Return the page of the hits."""
        with self._lock:
            return hits_page(self._workbench.processed(self.study), self.study)

    def record(self, point: str, hit: int) -> dict[str, Any]:
        """Return the records of one hit."""
        with self._lock:
            return record_page(self._processed(), point, hit)

    def frf(self, index: int) -> dict[str, Any]:
        """Return one FRF."""
        with self._lock:
            return frf_page(self._processed(), index)

    def _processed(self) -> Processed:
        processed = self._workbench.processed(self.study)
        if processed is None:
            raise InputError("this test has modes only, without hits or FRFs")
        return processed

    def modes(self) -> dict[str, Any]:
        """Return the page of the modes."""
        with self._lock:
            controller, study = self._workbench, self.study
            processed, content = controller.processed(study), controller.content(study)
            origins = None if processed is None else controller.origins(study)
            references = [] if content is None else references_of(content)
            return modes_page(processed, controller.modes(study), origins, study, references)

    def fit(self, index: int) -> dict[str, Any]:
        """Return one FRF with its fit."""
        with self._lock:
            return fit_page(self._workbench.identified(self.study), index)

    def provisional(self, hertz: float, index: int) -> dict[str, Any]:
        """Return what a picture needs of a pick, before its last digits are there."""
        with self._lock:
            return provisional_page(self._workbench.provisional(self.study, hertz), index)

    def shapes(self) -> dict[str, Any]:
        """Return the page of the shapes."""
        with self._lock:
            modal = self._workbench.modal(self.study)
            beside, why = (None, "") if modal.shapes is None else self._beside_or_why()
            page = shapes_page(modal, beside) | {"no_model": why}
            if page.get("model") is not None:
                page["changed"] = self._changed()
            return page

    def _changed(self) -> list[dict[str, Any]]:
        """Return the models that finished work on this state has made, drawn."""
        return [
            model
            for kind in KINDS
            if (found := drawings_of(self._folder(kind))) is not None
            for model in found["models"]
        ]

    def model(self) -> dict[str, Any]:
        """Return the page of the model."""
        with self._lock:
            beside, why = self._beside_or_why()
            content = self._history.now.content
            return model_page(content, self.study, beside, why) | self._frfs()

    def _frfs(self) -> dict[str, Any]:
        """Return the names of the FRFs, and which is shown first."""
        page = self.modes() if self.study.test.files else {"frfs": [], "first": 0}
        return {key: page[key] for key in ("frfs", "first")}

    def moved(self, moved: Moved, index: int) -> dict[str, Any]:
        """Return the model with effects and factors moved; nothing is kept of it."""
        with self._lock:
            study = self.study
            identified: ModalModel | None = None
            if study.test.files:
                identified = self._workbench.identified(study)
            return moved_page(self._beside(study), identified, moved, index)

    def _beside(self, study: Study) -> Beside:
        session = self._workbench.session(study)
        return Beside(session, self._workbench.predictor(study), self._workbench.correlation(study))

    def _beside_or_why(self) -> tuple[Beside | None, str]:
        if self.study.model is None:
            return None, "the study has no [model]"
        try:
            return self._beside(self.study), ""
        except ModalkitError as error:
            return None, str(error)

    def _result(self, kind: str) -> dict[str, Any] | None:
        return result_of(self._folder(kind))

    def work(self, kind: str) -> dict[str, Any]:
        """Return how a kind of work on this state stands."""
        if kind not in KINDS:
            raise InputError(f"unknown job {kind!r}")
        job = self._jobs.last
        mine = job is not None and job.kind == kind and job.key == self._key
        return {
            "job": job.document() if job is not None and (mine or job.state == "running") else None,
            "result": self._result(kind),
        }

    def drawings(self, kind: str) -> dict[str, Any] | None:
        """Return what is drawn of a finished piece of work on this state; None where there is none."""
        return drawings_of(self._folder(kind)) if kind in KINDS else None

    def report(self, kind: str) -> str | None:
        """Return the report of a finished piece of work on this state."""
        return report_of(self._folder(kind)) if kind in KINDS else None

    def start(self, kind: str) -> dict[str, Any]:
        """Start a piece of work on this state.

        Raises
        ------
        InputError
            If something is running already, or the study has no model.
        """
        with self._lock:
            self.study.spec()
            key = self._key
            folder = self._store.results(kind, key)
            text = study_text(self._opened, self._history.now.content, self._name(), folder)
            self._jobs.start(kind, key, text, folder)
            self._store.trim()
        return self.state()

    def _name(self) -> str:
        return self.study.name if self._opened.is_study else self._opened.path.stem

    def accept(self, row: int) -> dict[str, Any]:
        """Put the effects of a row of the diagnosis into the model, with the values found.

        Raises
        ------
        InputError
            If there is no such row.
        """
        with self._lock:
            found = self._result("diagnose")
            every = [] if found is None else found["document"]["cause"]["ranking"]
            ranking = [one for one in every if one["effects"] != [SOMETHING_ELSE]]
            if not 0 <= row < len(ranking):
                raise InputError(f"the diagnosis has no row {row + 1}; diagnose first")
            predictor, since_baseline = self._workbench.predictor(self.study), self.study.baseline is not None
            entries = accepted_entries(ranking[row], predictor, since_baseline=since_baseline)
            return self.act("accept", {"effects": entries})

    def stop(self) -> dict[str, Any]:
        """Stop the work that runs."""
        self._jobs.stop()
        return self.state()

    def export(self) -> dict[str, Any]:
        """Write all of this state into a folder of its own beside the study, or into the store's."""
        with self._lock:
            study, now = self.study, self._history.now
            handed = Handed(
                self._workbench.processed(study),
                self._workbench.modes(study),
                {kind: self._folder(kind) for kind in KINDS},
            )
            folder = free_folder(self._place(), f"{self._opened.path.stem}-{EXPORT}")
            text = study_text(self._opened, now.content, self._name(), folder)
            return {"folder": str(folder), "files": export(folder, text, handed)}

    def _place(self) -> Path:
        """Return the study's folder, or the store's where that is read-only."""
        beside = self._opened.study_path.parent.resolve()
        return beside if self._store.folder.resolve().is_relative_to(beside) else self._store.folder
