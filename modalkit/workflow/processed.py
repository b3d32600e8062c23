"""A test turned into FRFs, and its modes, identified as often as they are asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from acquisition import (
    EstimationError,
    FrfSet,
    HammerTest,
    HitVerdict,
    UffContent,
    Windows,
    estimate_frfs,
    force_range,
    hits_table,
    pulses_alone,
)
from acquisition.display import Shown
from acquisition.quantities import hertz
from acquisition.warned import Consequential, in_order
from modalkit.workflow.frf_checks import without_constant
from modalkit.workflow.joining import together
from modalkit.workflow.judged_hits import Judged
from modalkit.workflow.levels import Select, with_levels
from modalkit.workflow.mixed import with_read
from modalkit.workflow.processing_options import ProcessingOptions

if TYPE_CHECKING:
    import pandas as pd

    from identification import ModalModel, Prepared


KEPT = 4
"""Bands and orders whose fits a test keeps: what is undone and done again needs no new fit. Each takes some ten times
the memory of the FRFs [-]."""


@dataclass(frozen=True, eq=False)
class _Asked:
    """What is asked of an identification: band [Hz], highest order, modes to keep and to leave out [Hz]."""

    band: tuple[float, float] | None
    order: int | None
    add: tuple[float, ...]
    drop: tuple[float, ...]
    progress: Callable[[str], None] | None

    @property
    def named(self) -> tuple[float, ...]:
        """All modes that are named [Hz]."""
        return (*self.add, *self.drop)


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
        progress: Callable[[str], None] | None = None,
    ) -> ModalModel:
        """Identify the modes of a band; see :func:`identification.identify`.

        Left out, the band of FRFs made of hits ends where the force is 20 dB down. A band that is given is cut to
        the part in which the FRFs carry information, and what was done is among the warnings; so is what was found of
        the hits that changes a number, as a window that is not stated.

        ``progress`` is called with the name of every stage as it begins.
        """
        model = self._modes(_Asked(band, order, tuple(add), tuple(drop), progress))
        own = [w for w in self.warnings if isinstance(w, Consequential)]
        warnings = in_order([*own, *model.warnings])
        return model if warnings == model.warnings else replace(model, warnings=warnings)

    def _modes(self, asked: _Asked) -> ModalModel:
        """Identify, and say whether frequencies and constants follow the level of the hits."""

        def of(processed: Processed) -> Select:
            return lambda products: processed._identified(replace(asked, drop=(*asked.drop, *products)))

        if self.processing.sensor_masses:  # FRFs freed from a sensor's mass are not those of single hits
            return of(self)(())
        windows = Windows(decay=self.processing.window) if self.processing.window else None
        return with_levels(of(self), self._single, lambda data: of(self._of(data)), windows=windows)

    @cached_property
    def _single(self) -> list[tuple[HammerTest, tuple[HitVerdict, ...]]]:
        """The hits as each is used by itself, with what was decided on them."""
        return [(pulses_alone(j.test, averaged=False)[0], j.verdicts) for j in self.judged]

    def _of(self, data: FrfSet | Sequence[HammerTest]) -> Processed:
        """Return the same test with other FRFs, or those of other hits, all of which are used."""
        if isinstance(data, FrfSet):
            return replace(self, frfs=data)
        frfs = frfs_of([Judged(test, ()) for test in data], self.content, self.processing, [])
        return replace(self, frfs=without_constant(frfs, []))

    def _identified(self, asked: _Asked) -> ModalModel:
        reach = self._reach(asked.named) if asked.band is None else None
        if reach is None:
            return self._informed(asked)
        reason = Consequential(
            f"the force is 20 dB down at {hertz(reach[1])}: modes are sought below that; give a band to go "
            "further"
        )
        with _naming_band(self.frfs, None, reason):
            prepared = self.prepared(reach, asked.order, asked.progress)
            model = prepared.modes(add=asked.add, drop=asked.drop, progress=asked.progress)
        return replace(model, warnings=(*model.warnings, reason))

    def _informed(self, asked: _Asked) -> ModalModel:
        """Identify the modes of the part of a band in which the FRFs carry information."""
        from identification import at_cut_edge

        within, reason = self._informed_part(asked.band, asked.named)
        with _naming_band(self.frfs, asked.band, reason):
            prepared = self.prepared(within, asked.order, asked.progress)
            model = prepared.modes(add=asked.add, drop=asked.drop, progress=asked.progress)
            whole = asked.band or (float(self.frfs.frequency[0]), float(self.frfs.frequency[-1]))
            if beyond := at_cut_edge(model.modal.frequency, within or whole, whole, self.frfs.df):
                model = prepared.modes(add=asked.add, drop=[*asked.drop, *beyond])
        return model if reason is None else replace(model, warnings=(*model.warnings, reason))

    def _informed_part(
        self, band: tuple[float, float] | None, named: Sequence[float]
    ) -> tuple[tuple[float, float] | None, str | None]:
        """Return the part of a band that carries information and what was cut; all of it if a mode is named beyond."""
        from identification import informed_band

        if band not in self._informed_bands:
            judged = [(j.test, j.verdicts) for j in self.judged]
            self._informed_bands[band] = informed_band(self.frfs, judged, band)
        within, reason = self._informed_bands[band]
        if within is not None and any(not within[0] <= f <= within[1] for f in named):
            return band, None
        return within, reason

    def within(self, band: tuple[float, float] | None, named: Sequence[float]) -> tuple[float, float] | None:
        """Return the band that is identified where this one is asked for and modes are named [Hz]; None is all."""
        reach = self._reach(named) if band is None else None
        return self._informed_part(band, named)[0] if reach is None else reach

    def prepared(
        self,
        band: tuple[float, float] | None,
        order: int | None,
        progress: Callable[[str], None] | None = None,
    ) -> Prepared:
        """Return what of an identification does not depend on the modes named, kept for the next call.

        Parameters
        ----------
        band, order : tuple of float and int, optional
            As of :func:`identification.identify`.
        progress : function, optional
            Called with the name of every stage as it begins.
        """
        from identification import prepare

        if (band, order) not in self._prepared:
            if len(self._prepared) >= KEPT:
                self._prepared.pop(next(iter(self._prepared)))
            self._prepared[band, order] = prepare(self.frfs, band=band, order=order, progress=progress)
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
def _naming_band(frfs: FrfSet, asked: tuple[float, float] | None, reason: str | None) -> Iterator[None]:
    """Name the band that was asked for where nothing is found in the part of it that was used.

    Raises
    ------
    EstimationError
        If one is raised inside; with why only a part was used, if so.
    """
    try:
        yield
    except EstimationError as error:
        if reason is None:
            raise
        where = "" if asked is None else f" between {asked[0]:g} and {asked[1]:g} Hz"
        raise EstimationError(f"{frfs.source}: no mode is found{where}; {reason}") from error


def frfs_of(
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
