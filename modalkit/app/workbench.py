"""All that is computed of a study in the app, by the functions of the command line, each thing once."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

from acquisition import InputError, UffContent
from acquisition.modal_data import ModalData
from identification import ModalModel
from identification.identify import Provisional
from identification.pole_reasons import Origins, pole_origins
from modalkit.app.digests import digest_of
from modalkit.app.doing import Doing
from modalkit.app.kept import Kept
from modalkit.study.read import Study
from modalkit.study.tables import UpdateTable
from modalkit.workflow.case import Session, modes_in_band, open_study, processing_of
from modalkit.workflow.existing import Modes
from modalkit.workflow.files import read_files
from modalkit.workflow.identification import from_content
from modalkit.workflow.judged_hits import Proposals, proposals_of
from modalkit.workflow.processed import Processed
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.stated_places import with_places
from updating.correlation.correlate import Correlation, correlate
from updating.nominal import predictor_of
from updating.prediction.predict import Predictor

SEVERAL = 6
"""States whose results are kept: so many steps can be undone at once without anything being computed anew."""


class Workbench:
    """Results by the part of a study that they depend on.

    Nothing in it can be changed from outside; what it returns is what the command line prints of the same study.

    Parameters
    ----------
    doing : Doing
        To which each step is named as it is computed.
    """

    def __init__(self, doing: Doing) -> None:
        """Begin with nothing computed."""

        self._stage = doing.stage

        def step(name: str) -> Callable[[], AbstractContextManager[None]]:
            return lambda: doing.step(name)

        self._contents: Kept[UffContent] = Kept(2, step("reading the files"))
        self._proposals: Kept[Proposals] = Kept(2, step("judging the hits"))
        self._processed: Kept[Processed] = Kept(SEVERAL, step("estimating FRFs"))
        self._modes: Kept[ModalModel | Modes] = Kept(4 * SEVERAL, step("identifying the modes"))
        self._sessions: Kept[Session] = Kept(SEVERAL, step("placing the test on the model"))
        self._predictors: Kept[Predictor] = Kept(SEVERAL, step("solving the model"))
        self._correlations: Kept[Correlation] = Kept(SEVERAL, step("pairing the modes"))

    def processed(self, study: Study) -> Processed | None:
        """Return the FRFs of a study's test; None where it has modes alone.

        Raises
        ------
        InputError
            If the files hold neither hits nor FRFs.
        """
        if not study.test.files:
            return None
        key = self._test_key(study)
        files, _, processing = key
        return self._processed.get(
            key,
            lambda: from_content(self._content(*key), files, processing, self._proposals_of(*key)),
        )

    def _proposals_of(self, files: tuple[Path, ...], digest: str, processing: ProcessingOptions) -> Proposals:
        """Return what is proposed of the hits, which no decision on them changes."""
        common = replace(processing, use=(), leave=(), estimator="H1")
        content = self._content(files, digest, processing)
        return self._proposals.get((files, digest, common), lambda: proposals_of(content, processing))

    def _test_key(self, study: Study) -> tuple[tuple[Path, ...], str, ProcessingOptions]:
        """Return what the FRFs of a test depend on: its files, what they hold, how they are taken."""
        processing = processing_of(study, study.test)
        files = tuple(study.file(name) for name in study.test.files)
        layout = () if processing.layout is None else (processing.layout,)
        return files, digest_of((*files, *layout)), processing

    def _content(self, files: tuple[Path, ...], digest: str, processing: ProcessingOptions) -> UffContent:
        layout = processing.layout
        return self._contents.get((files, layout, digest), lambda: read_files(files, layout=layout))

    def content(self, study: Study) -> UffContent | None:
        """Return what the files of a test hold, before anything was left out; None where it has modes alone."""
        if self.processed(study) is None:
            return None
        return self._content(*self._test_key(study))

    def modes(self, study: Study) -> ModalModel | Modes:
        """Return the modes of a study's test.

        Raises
        ------
        InputError
            If there are none, or what was named among them is not there.
        """
        processed = self.processed(study)
        if processed is None:
            return _existing(study)
        test = study.test
        return self._modes.get(
            self._modes_key(study),
            lambda: processed.identify(
                band=test.band, order=test.order, add=test.add, drop=test.drop, progress=self._stage
            ),
        )

    def has_modes(self, study: Study) -> bool:
        """Return whether the modes of a study need no computation."""
        return not study.test.files or self._modes_key(study) in self._modes

    def _modes_key(self, study: Study) -> Hashable:
        """Return what the modes of a test depend on."""
        test = study.test
        return self._test_key(study), test.band, test.order, tuple(test.add), tuple(test.drop)

    def identified(self, study: Study) -> ModalModel:
        """Return the modes of a test that was identified here.

        Raises
        ------
        InputError
            If the test has modes alone.
        """
        modes = self.modes(study)
        if isinstance(modes, Modes):
            raise InputError("this test has modes only, without the FRFs they were identified from")
        return modes

    def modal(self, study: Study) -> ModalData:
        """Return the modes as a plain record, points where the study or its model places them.

        Raises
        ------
        StudyError
            If a place is stated of a point that the test does not have.
        """
        modal, test = self.modes(study).modal, study.test
        if study.model is None:
            return with_places(modal, test)[0]
        return with_places(modal, test, study.axes(test), study.spec())[0]

    def origins(self, study: Study) -> Origins:
        """Return what became of every pole of the chart."""
        return pole_origins(self.identified(study), add=study.test.add, drop=study.test.drop)

    def session(self, study: Study) -> Session:
        """Return test beside model; the baseline is left to the diagnosis, which works it out by itself.

        Raises
        ------
        StudyError
            If there is no model.
        """
        return self._sessions.get(
            _study_key(study), lambda: open_study(study, with_baseline=False, known=self._known(study))
        )

    def _known(self, study: Study) -> tuple[Processed, ModalModel] | None:
        processed = self.processed(study)
        return None if processed is None else (processed, self.identified(study))

    def predictor(self, study: Study) -> Predictor:
        """Return the model of a study as it predicts the points of its test, accepted effects in it."""
        session = self.session(study)
        return self._predictors.get(_study_key(study), lambda: predictor_of(session.case))

    def correlation(self, study: Study) -> Correlation:
        """Return pairs and MAC of test and model."""
        session = self.session(study)
        return self._correlations.get(_study_key(study), lambda: correlate(session.case))

    def provisional(self, study: Study, hertz: float) -> Provisional:
        """Return the modes with one more as far as a picture needs it.

        Raises
        ------
        InputError
            If that is not among the lines, or the test has modes alone.
        """
        processed = self.processed(study)
        if processed is None:
            raise InputError("this test has modes only; there are no FRFs to pick poles from")
        test = study.test
        band = processed.within(test.band, [*test.add, *test.drop, hertz])
        return processed.prepared(band, test.order).provisional(hertz, add=test.add)


def _study_key(study: Study) -> tuple[str, str]:
    """Return what test beside model depends on: all of the study but update and drawn lines, and its files."""
    test = study.test.model_copy(update={"lines": []})
    tables = study.model_copy(update={"update": UpdateTable(), "test": test}).model_dump_json()
    return tables, digest_of(study.inputs()[1:])


def _existing(study: Study) -> Modes:
    """Return the modes that a study's file holds."""
    assert study.test.modes is not None
    modal, _, warnings = modes_in_band(study, study.test, "test")
    source = str(study.file(study.test.modes))
    return Modes(modal, source, study.title, (*warnings, *modal.doubts()))
