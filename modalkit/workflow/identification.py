"""From files to FRFs to modes: the part of the chain without a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from acquisition import (
    FrfSet,
    InputError,
    UffContent,
)
from acquisition.display import named_files
from acquisition.warned import in_order
from modalkit.workflow.existing import Modes, existing
from modalkit.workflow.files import Progress, read_files
from modalkit.workflow.frf_checks import identical, without_constant
from modalkit.workflow.hit_warnings import on_coherence, on_hits
from modalkit.workflow.judged_hits import Proposals, check_decay, decided, proposed
from modalkit.workflow.processed import Processed, frfs_of
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.references import among_references, with_references
from modalkit.workflow.sensors import without_sensors

AS_READ = ProcessingOptions()


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
            f"{modes.source}: contains modes; decay, windows, hits, estimator and sensor masses are for hits and FRFs"
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
            f'{found.source}: contains modes, but neither raw hits nor FRFs; a study names them by modes = "..."'
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


def from_content(
    content: UffContent,
    paths: Sequence[Path],
    processing: ProcessingOptions,
    proposals: Proposals | None = None,
) -> Processed:
    """Return the FRFs of a test whose files are read already.

    Parameters
    ----------
    content : UffContent
        What they hold; it stays as it is.
    paths : sequence of path
        Their names, for messages.
    processing : ProcessingOptions
        How records are treated.
    proposals : Proposals, optional
        Those of the same content and processing, where they are there already.

    Raises
    ------
    InputError
        If there are neither hits nor FRFs, or what is stated about their treatment does not fit them.
    """
    warnings = list(content.warnings)
    if processing.references:
        content = with_references(content, processing.references)
        processing = among_references(processing)
    if proposals is None:
        proposals = proposed(content.tests, processing)
    judged = decided(proposals, processing, warnings)
    if judged and processing.frf_window is not None:
        raise InputError(
            f"{named_files(paths)}: --frf-window (frf_window in a study) is for files of FRFs, but these hold raw "
            "hits; leave it out"
        )
    if judged:
        warnings += on_hits([(j.test, j.verdicts) for j in judged])
        frfs = frfs_of(judged, content, processing, warnings)
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
    given = {"--use": processing.use, "--leave": processing.leave, "--window": processing.window}
    useless = [name for name, value in given.items() if value]
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
            f"{frfs.source}: the files hold FRFs; a window on the responses alone cannot be corrected there"
        )
    if processing.decay and frfs.decay:
        check_decay(frfs.source, frfs.decay, processing.decay)
    if processing.frf_window is not None:
        frfs = replace(frfs, window=processing.frf_window)
    return replace(frfs, decay=processing.decay) if processing.decay and not frfs.decay else frfs
