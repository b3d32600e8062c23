"""One study in the app: its history, what is computed of it, the work on it; all that the server serves."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from acquisition.errors import InputError, ModalkitError
from identification import ModalModel
from modalkit.app.acceptance import exchanged_points
from modalkit.app.actions import ACCEPTED, ACTIONS
from modalkit.app.asked import asks
from modalkit.app.digests import digest_of
from modalkit.app.doing import Doing
from modalkit.app.export import Handed, export, free_folder, study_text
from modalkit.app.form import form_page
from modalkit.app.history import History, State
from modalkit.app.jobs import Jobs, drawings_of, report_of, result_of
from modalkit.app.model_page import Moved, model_page, moved_page
from modalkit.app.opened import Opened
from modalkit.app.store import Store
from modalkit.app.work import KINDS, UNREAD
from modalkit.app.workbench import Workbench
from modalkit.study.read import Study
from modalkit.views.charts.damping import ExpectedDamping, damping_chart, expected_damping
from modalkit.views.hits import frf_page, hits_page, others_page, record_page
from modalkit.views.modes import fit_page, indicators_page, measured_page, modes_page, provisional_page
from modalkit.views.shapes import Beside, shapes_page
from modalkit.workflow.processed import Processed
from modalkit.workflow.references import references_of

NEEDS_MODES = frozenset(
    {"hit", "pick", "drop", "band", "order", "references", "estimator", "text", "model", "set"}
)
"""Changes that are made only if the modes can be identified after them. Those after a hit are identified when a page
asks for them."""

EXPORT = "modalkit-export"


class Controller:
    """The state of the app and what follows from it.

    Parameters
    ----------
    opened : Opened
        What was opened.
    store : Store
        Where its state is kept; one that is there is gone on with.
    warm : bool
        Whether a process for long work is kept ready once a page of such work is asked for; :meth:`close` ends it.
    """

    def __init__(self, opened: Opened, store: Store, *, warm: bool = False) -> None:
        """Go on where the last session ended."""
        self._opened, self._store, self._warm = opened, store, warm
        times = store.folder / "times.json"
        self._doing, self._jobs = Doing(times), Jobs(times)
        self._workbench = Workbench(self._doing)
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

    def _key(self, kind: str = "") -> str:
        """Return what results of a kind of work are kept under: what it reads of the study, and the files of it."""
        return self._history.now.key(digest_of(self.study.inputs()[1:]), UNREAD.get(kind, ()))

    def _folder(self, kind: str) -> Path:
        """Return where the results of a kind of work stand."""
        return self._store.results(kind, self._key(kind))

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
            "key": self._key(),
            "position": history.position,
            "undo": history.undo_label,
            "redo": history.redo_label,
            "accepted": history.labels(ACCEPTED),
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
            if name == "hit":
                self._workbench.processed(study)
            elif name == "join":
                self._workbench.modal(study)
            elif name in NEEDS_MODES:
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
            return _asking(hits_page(self._workbench.processed(self.study), self.study))

    def record(self, point: str, hit: int) -> dict[str, Any]:
        """Return the records of one hit."""
        with self._lock:
            return record_page(self._processed(), point, hit)

    def frf(self, index: int) -> dict[str, Any]:
        """Return one FRF."""
        with self._lock:
            return frf_page(self._processed(), index)

    def others(self, index: int) -> dict[str, Any]:
        """Return the magnitudes of the other FRFs of the same force."""
        with self._lock:
            return others_page(self._processed(), index)

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
            return _asking(modes_page(processed, controller.modes(study), origins, study, references))

    def measured(self) -> dict[str, Any] | None:
        """Return the FRFs that modes are to be identified from; None where that is done, or there are none."""
        with self._lock:
            study = self.study
            if self._workbench.has_modes(study):
                return None
            return measured_page(self._processed(), study)

    def fit(self, index: int) -> dict[str, Any]:
        """Return one FRF with its fit."""
        with self._lock:
            return fit_page(self._workbench.identified(self.study), index)

    def indicators(self) -> dict[str, Any]:
        """Return the mode indicator functions."""
        with self._lock:
            return indicators_page(self._workbench.identified(self.study))

    def damping(self) -> dict[str, Any] | None:
        """Return the chart of the damping over frequency; None where no damping is known."""
        with self._lock:
            chart = damping_chart(self._workbench.modes(self.study).modal, self._expected_damping())
            return None if chart is None else chart.data()

    def _expected_damping(self) -> ExpectedDamping | None:
        """Return what the model expects; it is solved only where it states any damping."""
        study = self.study
        try:
            if study.model is None or not self._workbench.predictor(study).expects_damping:
                return None
            return expected_damping(self._beside(study))
        except ModalkitError:  # the page of the model states it
            return None

    def provisional(self, hertz: float, index: int) -> dict[str, Any]:
        """Return what a picture needs of a pick, before its last digits are there."""
        with self._lock:
            return provisional_page(self._workbench.provisional(self.study, hertz), index)

    def shapes(self) -> dict[str, Any]:
        """Return the page of the shapes."""
        with self._lock:
            modal = self._workbench.modal(self.study)
            beside, why = (None, "") if modal.shapes is None else self._beside_or_why()
            page = shapes_page(modal, beside) | {"no_model": why, "stated": bool(self.study.test.lines)}
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
            page = model_page(content, self.study, beside, why) | self._frfs()
            page["asks"] = asks((page["correlation"] or {}).get("warnings", ()))
            page["form"] = form_page(self._opened.study_path.parent) if self.study.model is None else None
            return page

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
        mine = job is not None and job.kind == kind and job.key == self._key(kind)
        result = self._result(kind)
        if self._warm and self.study.model is not None:
            self._jobs.warm()
        return {
            "job": job.document() if job is not None and (mine or job.state == "running") else None,
            "result": result,
            "asks": asks(() if result is None else result["document"].get("warnings", ())),
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
            key = self._key(kind)
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
            rows = [] if found is None else found["rows"]
            if not 0 <= row < len(rows):
                raise InputError(f"the diagnosis has no row {row + 1}; diagnose first")
            if rows[row]["entries"] is None:
                raise InputError(
                    f"row {row + 1} cannot be accepted: {rows[row]['why_not'] or 'it has no effect'}"
                )
            frfs = self._workbench.processed(self.study)
            fixed = set() if frfs is None else _hit_and_measured(frfs)
            modal = self._workbench.modal(self.study)
            entries, places = exchanged_points(rows[row]["entries"], modal, fixed)
            return self.act("accept", {"effects": entries, "places": places})

    def stop(self) -> dict[str, Any]:
        """Stop the work that runs."""
        self._jobs.stop()
        return self.state()

    def doing(self) -> dict[str, Any]:
        """Return what is computed for a page at this moment."""
        return self._doing.document()

    def interrupt(self) -> dict[str, Any]:
        """Stop what is computed for a page; what was not finished is not kept."""
        self._doing.stop()
        return {}

    def close(self) -> None:
        """Stop all work; nothing can be started any more."""
        self._jobs.close()

    def export(self) -> dict[str, Any]:
        """Write all of this state into a folder of its own beside the study, or into the store's."""
        with self._lock:
            study, now = self.study, self._history.now
            handed = Handed(
                self._workbench.processed(study),
                self._workbench.modes(study),
                self._workbench.modal(study).geometry,
                {kind: self._folder(kind) for kind in KINDS},
            )
            folder = free_folder(self._place(), f"{self._opened.path.stem}-{EXPORT}")
            text = study_text(self._opened, now.content, self._name(), folder)
            files = export(folder, text, handed)
            return {"folder": str(folder), "files": files, "missing": self._earlier()}

    def _earlier(self) -> list[dict[str, str]]:
        """Return the results that belong to another state alone, each with the change that parts it from this one."""
        history, digest = self._history, digest_of(self.study.inputs()[1:])
        found = []
        for kind in KINDS:
            if self._result(kind) is not None:
                continue
            for i, state in reversed(list(enumerate(history.states))):
                if result_of(self._store.results(kind, state.key(digest, UNREAD.get(kind, ())))) is not None:
                    after = history.states[min(i + 1, history.position)].label if i < history.position else ""
                    found.append({"kind": kind, "change": after})
                    break
        return found

    def _place(self) -> Path:
        """Return the study's folder, or the store's where that is read-only."""
        beside = self._opened.study_path.parent.resolve()
        return beside if self._store.folder.resolve().is_relative_to(beside) else self._store.folder


def _asking(page: dict[str, Any]) -> dict[str, Any]:
    """Return a page with what its warnings ask for."""
    return page | {"asks": asks(page["warnings"])}


def _hit_and_measured(processed: Processed) -> set[int]:
    """Return the nodes that are both hit and measured."""
    frfs = processed.frfs
    return {dof.node for dof in frfs.responses} & {dof.node for dof in frfs.references}
