"""From files to FRFs to modes: the part of the chain without a model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition import (
    Dof,
    EstimationError,
    FrfSet,
    HammerTest,
    HitVerdict,
    InputError,
    UffContent,
    Windows,
    decide,
    estimate_frfs,
    force_range,
    hits_table,
    holds_several_hits,
    judge_hits,
    pulses_alone,
    split_hits,
    state_window,
)
from acquisition.display import Displayed, Shown, named_files
from acquisition.quantities import hertz
from acquisition.warned import Consequential, in_order
from modalkit.workflow.existing import Modes, existing
from modalkit.workflow.files import Progress, read_files
from modalkit.workflow.frf_checks import identical, without_constant
from modalkit.workflow.hit_warnings import on_coherence, on_hits, on_window
from modalkit.workflow.joining import together
from modalkit.workflow.levels import Select, with_levels
from modalkit.workflow.mixed import with_read
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.references import among_references, with_references
from modalkit.workflow.sensors import without_sensors

if TYPE_CHECKING:
    import pandas as pd

    from identification import ModalModel, Prepared

AS_READ = ProcessingOptions()
KEPT = 4
"""Bands and orders whose fits a test keeps: what is undone and done again needs no new fit. Each takes some ten times
the memory of the FRFs [-]."""

SAME_DECAY = 1e-3  # relative difference of decays that are the same


@dataclass(frozen=True, eq=False)
class Judged(Displayed):
    """A test with what is thought of its hits.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    verdicts : tuple of HitVerdict
        On each hit, the user's decisions included.
    """

    test: HammerTest
    verdicts: tuple[HitVerdict, ...]

    def _headline(self) -> str:
        return f"{self.test._headline()}; {sum(not v.used for v in self.verdicts)} left out"

    def _frame(self) -> pd.DataFrame:
        return self.test.table()


@dataclass(frozen=True, eq=False)
class Processed(Shown):
    """A test, turned into FRFs.

    Parameters
    ----------
    content : UffContent
        What the files held.
    frfs : FrfSet
        FRFs, estimated from the hits or read.
    judged : tuple of Judged
        The hits they were estimated from; empty where the files held FRFs.
    processing : ProcessingOptions
        What the user stated.
    warnings : tuple of str
        What the user should know.
    """

    content: UffContent
    frfs: FrfSet
    judged: tuple[Judged, ...]
    processing: ProcessingOptions
    warnings: tuple[str, ...]

    @property
    def hits(self) -> tuple[HitVerdict, ...]:
        """Verdict on every hit."""
        return tuple(v for judged in self.judged for v in judged.verdicts)

    def hits_table(self) -> pd.DataFrame:
        """Return one row per hit, with its verdict."""
        return hits_table(self.hits)

    def identify(
        self,
        *,
        band: tuple[float, float] | None = None,
        order: int | None = None,
        add: Sequence[float] = (),
        drop: Sequence[float] = (),
    ) -> ModalModel:
        """Identify the modes of a band; see :func:`identification.identify`.

        Left out, the band of FRFs made of hits ends where the force is 20 dB down. A band that is given is cut to
        the part in which the FRFs carry information, and what was done is among the warnings; so is what was found of
        the hits that changes a number, as a window that is not stated.
        """
        model = self._modes(band, order, add, drop)
        own = [w for w in self.warnings if isinstance(w, Consequential)]
        warnings = in_order([*own, *model.warnings])
        return model if warnings == model.warnings else replace(model, warnings=warnings)

    def _modes(
        self, band: tuple[float, float] | None, order: int | None, add: Sequence[float], drop: Sequence[float]
    ) -> ModalModel:
        """Identify, and say whether frequencies and constants follow the level of the hits."""

        def of(processed: Processed) -> Select:
            return lambda products: processed._identified(band, order, add, [*drop, *products])

        if self.processing.sensor_masses:  # FRFs freed from a sensor's mass are not those of single hits
            return of(self)(())
        windows = Windows(decay=self.processing.window) if self.processing.window else None
        tests = [(j.test, j.verdicts) for j in self.judged]
        single = [(pulses_alone(test, averaged=False)[0], verdicts) for test, verdicts in tests]
        return with_levels(of(self), single, lambda data: of(self._of(data)), windows=windows)

    def _of(self, data: FrfSet | Sequence[HammerTest]) -> Processed:
        """Return the same test with other FRFs, or those of other hits, all of which are used."""
        if isinstance(data, FrfSet):
            return replace(self, frfs=data)
        frfs = _frfs_of([Judged(test, ()) for test in data], self.content, self.processing, [])
        return replace(self, frfs=without_constant(frfs, []))

    def _identified(
        self, band: tuple[float, float] | None, order: int | None, add: Sequence[float], drop: Sequence[float]
    ) -> ModalModel:
        reach = self._reach([*add, *drop]) if band is None else None
        if reach is None:
            return self._informed(band, order, add, drop)
        statement = Consequential(
            f"the force is 20 dB down at {hertz(reach[1])}: modes are sought below that; give a band to go "
            "further"
        )
        with _naming_band(self.frfs, None, statement):
            model = self.prepared(reach, order).modes(add=add, drop=drop)
        return replace(model, warnings=(*model.warnings, statement))

    def _informed(
        self, band: tuple[float, float] | None, order: int | None, add: Sequence[float], drop: Sequence[float]
    ) -> ModalModel:
        """Identify the modes of the part of a band in which the FRFs carry information."""
        from identification import at_cut_edge

        within, statement = self._informed_part(band, [*add, *drop])
        with _naming_band(self.frfs, band, statement):
            prepared = self.prepared(within, order)
            model = prepared.modes(add=add, drop=drop)
            whole = band or (float(self.frfs.frequency[0]), float(self.frfs.frequency[-1]))
            if beyond := at_cut_edge(model.modal.frequency, within or whole, whole, self.frfs.df):
                model = prepared.modes(add=add, drop=[*drop, *beyond])
        return model if statement is None else replace(model, warnings=(*model.warnings, statement))

    def _informed_part(
        self, band: tuple[float, float] | None, named: Sequence[float]
    ) -> tuple[tuple[float, float] | None, str | None]:
        """Return the part of a band that carries information and what was cut; all of it if a mode is named beyond."""
        from identification import informed_band

        if band not in self._informed_bands:
            judged = [(j.test, j.verdicts) for j in self.judged]
            self._informed_bands[band] = informed_band(self.frfs, judged, band)
        within, statement = self._informed_bands[band]
        if within is not None and any(not within[0] <= f <= within[1] for f in named):
            return band, None
        return within, statement

    def within(self, band: tuple[float, float] | None, named: Sequence[float]) -> tuple[float, float] | None:
        """Return the band that is identified where this one is asked for and modes are named [Hz]; None is all."""
        reach = self._reach(named) if band is None else None
        return self._informed_part(band, named)[0] if reach is None else reach

    def prepared(self, band: tuple[float, float] | None, order: int | None) -> Prepared:
        """Return what of an identification does not depend on the modes named, kept for the next call.

        Parameters
        ----------
        band, order : tuple of float and int, optional
            As of :func:`identification.identify`.
        """
        from identification import prepare

        if (band, order) not in self._prepared:
            if len(self._prepared) >= KEPT:
                self._prepared.pop(next(iter(self._prepared)))
            self._prepared[band, order] = prepare(self.frfs, band=band, order=order)
        return self._prepared[band, order]

    @cached_property
    def _prepared(self) -> dict[tuple[tuple[float, float] | None, int | None], Prepared]:
        return {}

    @cached_property
    def _informed_bands(
        self,
    ) -> dict[tuple[float, float] | None, tuple[tuple[float, float] | None, str | None]]:
        return {}

    def _reach(self, named: Sequence[float]) -> tuple[float, float] | None:
        """Return the band that the force reaches, if it ends before the lines do and no mode is named beyond."""
        force, lines = force_range(self.hits), self.frfs.frequency
        low = float(lines[lines > 0][0])
        if force is None or not low < force.band20 < lines[-1] or max(named, default=0.0) >= force.band20:
            return None
        return low, force.band20

    def _headline(self) -> str:
        hits = f"; {len(self.hits)} hits, {sum(not v.used for v in self.hits)} left out" if self.hits else ""
        return f"{self.frfs._headline()}{hits}"

    def _frame(self) -> pd.DataFrame:
        return self.frfs.table()


@contextmanager
def _naming_band(frfs: FrfSet, asked: tuple[float, float] | None, statement: str | None) -> Iterator[None]:
    """Name the band that was asked for where nothing is found in the part of it that was used.

    Raises
    ------
    EstimationError
        If one is raised inside; with why only a part was used, if so.
    """
    try:
        yield
    except EstimationError as error:
        if statement is None:
            raise
        where = "" if asked is None else f" between {asked[0]:g} and {asked[1]:g} Hz"
        raise EstimationError(f"{frfs.source}: no mode is found{where}; {statement}") from error


def read(
    path: Path | str | Sequence[Path | str],
    *,
    decay: float = 0.0,
    layout: Path | str | None = None,
    processing: ProcessingOptions = AS_READ,
    progress: Progress | None = None,
) -> Processed | Modes:
    """Read files as one test: hits are turned into FRFs; modes that exist already are taken as they are.

    Parameters
    ----------
    path : path or sequence of paths
        The files: UFF, column text or .mat with a layout, a table or a JSON file of modes, or what an installed
        reader supports.
    decay : float
        Decay rate of an exponential window applied before the files were written, where they do not say it
        themselves; short for ``ProcessingOptions(decay=...)`` [1/s].
    layout : path, optional
        Layout of column text; short for ``ProcessingOptions(layout=...)``.
    processing : ProcessingOptions
        All that may be stated about how records are treated.
    progress : function, optional
        Called with the part of the files that is read, from 0 to 1.

    Returns
    -------
    Processed or Modes
        Modes where the files hold these and neither hits nor FRFs. Both have `identify`, and that a table.

    Raises
    ------
    InputError
        If the files hold nothing of that, or what is stated about their treatment does not fit them.
    """
    processing = _statement(processing, decay, layout)
    paths = [Path(p) for p in ([path] if isinstance(path, str | Path) else path)]
    content = read_files(paths, layout=processing.layout, progress=progress)
    modes = existing(content.modal, paths, content.title, content.warnings)
    if modes is None or content.tests or content.frfs is not None:
        return from_content(content, paths, processing)
    if replace(processing, layout=None) != AS_READ:
        raise InputError(
            f"{modes.source}: holds modes; decay, windows, hits, estimator and sensor masses are for hits and FRFs"
        )
    return modes


def read_frfs(
    path: Path | str | Sequence[Path | str],
    *,
    processing: ProcessingOptions = AS_READ,
    progress: Progress | None = None,
) -> Processed:
    """Read files as `read` does, hits and FRFs only.

    Parameters
    ----------
    path, processing, progress
        As of `read`.

    Raises
    ------
    InputError
        If the files hold neither.
    """
    found = read(path, processing=processing, progress=progress)
    if isinstance(found, Modes):
        raise InputError(
            f'{found.source}: holds modes, but neither raw hits nor FRFs; a study names them by modes = "..."'
        )
    return found


def _statement(processing: ProcessingOptions, decay: float, layout: Path | str | None) -> ProcessingOptions:
    """Return the processing options with what was stated beside them."""
    processing = replace(processing, decay=decay) if decay else processing
    processing = processing if layout is None else replace(processing, layout=Path(layout))
    if processing.window_on is not None and not processing.decay:
        raise InputError(
            f"a window on {processing.window_on} is stated without its decay; add --decay, or "
            "exponential_window in a study"
        )
    return processing


def from_content(content: UffContent, paths: Sequence[Path], processing: ProcessingOptions) -> Processed:
    """Return the FRFs of a test whose files are read already.

    Parameters
    ----------
    content : UffContent
        What they hold; it stays as it is.
    paths : sequence of path
        Their names, for messages.
    processing : ProcessingOptions
        How records are treated.

    Raises
    ------
    InputError
        If there are neither hits nor FRFs, or what is stated about their treatment does not fit them.
    """
    warnings = list(content.warnings)
    if processing.references:
        content = with_references(content, processing.references)
        processing = among_references(processing)
    judged = _judged(content.tests, processing, warnings)
    if judged and processing.frf_window is not None:
        raise InputError(
            f"{named_files(paths)}: --frf-window (frf_window in a study) is for files of FRFs, but these hold raw "
            "hits; leave it out"
        )
    if judged:
        warnings += on_hits([(j.test, j.verdicts) for j in judged])
        frfs = _frfs_of(judged, content, processing, warnings)
    elif content.frfs is not None:
        frfs = _as_read(content.frfs, processing, warnings)
    else:
        raise InputError(_nothing_usable(content, paths))
    frfs = without_constant(frfs, warnings)
    warnings += [*identical(frfs), *on_coherence(frfs, [(j.test, j.verdicts) for j in judged])]
    frfs = without_sensors(frfs, processing.sensor_masses, warnings)
    return Processed(content, frfs, judged, processing, in_order(warnings))


def _nothing_usable(content: UffContent, paths: Sequence[Path]) -> str:
    """State why there is nothing to work on: the first reason why something was left out, or that nothing is there."""
    if not content.reasons:
        return f"{named_files(paths)}: neither raw hits nor FRFs in it; `modalkit inspect` lists what is"
    first, *others = content.reasons
    more = f"; `modalkit inspect` lists what else is not used ({len(others)})" if others else ""
    return f"{first}; no raw hits and no FRFs are usable{more}"


def _as_read(frfs: FrfSet, processing: ProcessingOptions, warnings: list[str]) -> FrfSet:
    """Return FRFs that were read, with the window stated; what is stated about hits has nothing to act on."""
    statement = {"--use": processing.use, "--leave": processing.leave, "--window": processing.window}
    useless = [name for name, value in statement.items() if value]
    if useless:
        raise InputError(
            f"{frfs.source}: {', '.join(useless)} (or the same in a study) is for raw hits, but the files hold FRFs; "
            "leave it out or give the time records"
        )
    if processing.estimator != "H1":
        warnings.append(
            f"{frfs.source}: the files hold FRFs, which stay as they are; estimator {processing.estimator} is not used"
        )
    if processing.window_on == "responses":
        warnings.append(
            f"{frfs.source}: the files hold FRFs; a window on the responses alone cannot be set right in them"
        )
    if processing.decay and frfs.decay:
        _check_decay(frfs.source, frfs.decay, processing.decay)
    if processing.frf_window is not None:
        frfs = replace(frfs, window=processing.frf_window)
    return replace(frfs, decay=processing.decay) if processing.decay and not frfs.decay else frfs


def _check_decay(source: str, stated: float, statement: float) -> None:
    if abs(stated - statement) > SAME_DECAY * stated:
        raise InputError(
            f"{source}: the file states an exponential window of {stated:g} 1/s, but {statement:g} 1/s is "
            "given; leave one out or correct the other"
        )


def _judged(
    tests: Sequence[HammerTest], processing: ProcessingOptions, warnings: list[str]
) -> tuple[Judged, ...]:
    """Split long records, state the window and judge the hits; decisions go to the test that has the hit."""
    split = []
    for test in tests:
        one = test
        if holds_several_hits(one):
            one, statement = split_hits(replace(one, decay=one.decay or processing.decay))
            warnings += statement
        split.append(stated(one, processing, warnings))
    proposals = numbered([judge_hits(test) for test in split])
    every = tuple(v for verdicts in proposals for v in verdicts)
    decided = iter(decide(every, use=processing.use, leave=processing.leave) if every else ())
    cleared = [pulses_alone(test) for test in split]
    warnings += [text for _, statement in cleared for text in statement]
    return tuple(
        Judged(test, tuple(next(decided) for _ in verdicts))
        for (test, _), verdicts in zip(cleared, proposals, strict=True)
    )


def stated(test: HammerTest, processing: ProcessingOptions, warnings: list[str]) -> HammerTest:
    """Return a test with the window stated that was applied; warn of one that is not stated.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    processing : ProcessingOptions
        What the user states about the window.
    warnings : list of str
        What was found is added to it.

    Raises
    ------
    InputError
        If the file states another window.
    """
    if processing.decay and test.decay:
        _check_decay(test.source, test.decay, processing.decay)
    elif processing.decay:
        test, statement = state_window(test, decay=processing.decay, on=processing.window_on)
        warnings += statement
    else:
        warnings += on_window(test)
    return test


def numbered(tests: Sequence[tuple[HitVerdict, ...]]) -> list[tuple[HitVerdict, ...]]:
    """Return the verdicts on the hits of several tests, the hits at each point numbered through.

    Parameters
    ----------
    tests : sequence of tuple of HitVerdict
        Verdicts of `judge_hits` on each test.
    """
    seen: dict[Dof, int] = {}
    answer = []
    for verdicts in tests:
        before = dict(seen)
        answer.append(tuple(replace(v, hit=before.get(v.point, 0) + v.hit) for v in verdicts))
        for v in verdicts:
            seen[v.point] = seen.get(v.point, 0) + 1
    return answer


def _frfs_of(
    judged: Sequence[Judged], content: UffContent, processing: ProcessingOptions, warnings: list[str]
) -> FrfSet:
    """Return the FRFs of hits, and with them those that were read beside these."""
    frfs = _estimated(judged, processing)
    if content.frfs is None:
        return frfs
    return with_read(frfs, content.frfs, content.tests, warnings, decay=processing.decay)


def _estimated(judged: Sequence[Judged], processing: ProcessingOptions) -> FrfSet:
    windows = Windows(decay=processing.window) if processing.window else None
    return together(
        [
            estimate_frfs(j.test, estimator=processing.estimator, verdicts=j.verdicts, windows=windows)
            for j in [j for j in judged if not j.verdicts or any(v.used for v in j.verdicts)] or judged[:1]
        ]
    )
