"""All that is computed of a study in the app, by the functions of the command line, each thing once."""

from __future__ import annotations

from pathlib import Path

from acquisition import InputError, UffContent
from acquisition.modal_data import ModalData
from identification import ModalModel
from identification.identify import Provisional
from identification.pole_reasons import Origins, pole_origins
from modalkit.app.digests import digest_of
from modalkit.app.kept import Kept
from modalkit.study.read import Study, UpdateTable
from modalkit.workflow.case import Session, modes_in_band, open_study, processing_of
from modalkit.workflow.existing import Modes
from modalkit.workflow.files import read_files
from modalkit.workflow.identification import Processed, from_content
from modalkit.workflow.processing_options import ProcessingOptions
from updating.correlation.correlate import Correlation, correlate
from updating.nominal import predictor_of
from updating.prediction.predict import Predictor

SEVERAL = 6
"""States whose results are kept: so many steps can be undone at once without anything being computed anew."""


class Workbench:
    """Results by the part of a study that they depend on.

    Nothing in it can be changed from outside; what it returns is what the command line prints of the same study.
    """

    def __init__(self) -> None:
        """Begin with nothing computed."""
        self._contents: Kept[UffContent] = Kept(2)
        self._processed: Kept[Processed] = Kept(SEVERAL)
        self._modes: Kept[ModalModel | Modes] = Kept(4 * SEVERAL)
        self._sessions: Kept[Session] = Kept(SEVERAL)
        self._predictors: Kept[Predictor] = Kept(SEVERAL)
        self._correlations: Kept[Correlation] = Kept(SEVERAL)

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
        return self._processed.get(key, lambda: from_content(self._content(*key), files, processing))

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
        key = (self._test_key(study), test.band, test.order, tuple(test.add), tuple(test.drop))
        return self._modes.get(
            key,
            lambda: processed.identify(band=test.band, order=test.order, add=test.add, drop=test.drop),
        )

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
        """Return the modes as a plain record."""
        return self.modes(study).modal

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
    """Return what test beside model depends on: all of the study but its table of the update, and its files."""
    tables = study.model_copy(update={"update": UpdateTable()}).model_dump_json()
    return tables, digest_of(study.inputs()[1:])


def _existing(study: Study) -> Modes:
    """Return the modes that a study's file holds."""
    assert study.test.modes is not None
    modal, _, warnings = modes_in_band(study, study.test, "test")
    source = str(study.file(study.test.modes))
    return Modes(modal, source, study.title, (*warnings, *modal.doubts()))
