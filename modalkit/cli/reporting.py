"""What the commands that write a report share."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition.errors import ModalkitError
from modalkit.cli.common import drawing, is_study, out
from modalkit.output.destinations import Kind
from modalkit.workflow.existing import Modes
from modalkit.workflow.stages import REPORTING

if TYPE_CHECKING:
    from identification import ModalModel
    from modalkit.report.document import Document
    from modalkit.study.read import Study
    from modalkit.views.charts.damping import ExpectedDamping
    from modalkit.workflow.case import Session
    from modalkit.workflow.processed import Processed


def report_wanted(path: Path | None) -> Iterator[tuple[Path, Kind]]:
    """Yield the report as an output of a command, where one is wanted."""
    if path is None:
        return
    from modalkit.report.place import report_kind
    from modalkit.report.word import WORD, check_word

    kind = report_kind(path)
    if kind is WORD:
        check_word(path)
    yield path, kind


def save_report(path: Path | None, build: Callable[[], Document]) -> None:
    """Write a report if a file is given, and say where it is."""
    if path is None:
        return
    from modalkit.report.place import write_report

    with drawing(REPORTING):
        write_report(path, build())
    out.print(f"report: {path}", markup=False)


def now() -> datetime:
    """Return the date of a report."""
    return datetime.now().astimezone()


def this_command() -> str:
    """Return the command as it was typed."""
    return shlex.join(["modalkit", *sys.argv[1:]])


def identified_report(
    files: Sequence[Path],
    processed: Processed | None,
    modes: ModalModel | Modes,
    named: tuple[Sequence[float], Sequence[float]],
    warnings: Sequence[str],
) -> Document:
    """Return the report of an identification; a study with a model has its shapes beside the test's."""
    from modalkit.report import Basis, identification_report

    study = _study(files)
    named = named_by_hand(files, named)
    title = "" if processed is None else processed.content.title
    if study is None:
        basis = Basis(now(), this_command(), files=files, settings=_settings(processed, modes))
        return identification_report(
            processed,
            modes,
            basis,
            named=named,
            warnings=warnings,
            title=title or ", ".join(p.name for p in files),
        )
    basis = Basis(now(), this_command(), [study], settings=_settings(processed, modes))
    session = _session(study, processed, modes)
    return identification_report(
        processed, modes, basis, named=named, session=session, warnings=warnings, title=study.name
    )


def expected_damping(
    files: Sequence[Path], processed: Processed | None, modes: ModalModel | Modes
) -> ExpectedDamping | None:
    """Return the damping that the model of a study expects; None without a study."""
    from modalkit.report.tested import expected_of

    study = _study(files)
    session = None if study is None else _session(study, processed, modes)
    return None if session is None else expected_of(session)


def _settings(processed: Processed | None, modes: ModalModel | Modes) -> dict[str, str]:
    """Return how the test was treated, as far as it is not by default."""
    stated = {} if isinstance(modes, Modes) else {"band": f"{modes.band[0]:g} to {modes.band[1]:g} Hz"}
    if not isinstance(modes, Modes):
        stated["highest model order"] = str(int(modes.chart.orders.max()))
    if processed is None:
        return stated
    options = processed.processing
    for one in fields(options):
        value = getattr(options, one.name)
        if value != one.default and value not in ((), None):
            stated[one.name.replace("_", " ")] = str(value)
    return stated


def named_by_hand(
    files: Sequence[Path], named: tuple[Sequence[float], Sequence[float]]
) -> tuple[Sequence[float], Sequence[float]]:
    """Return the frequencies added and dropped by options and, of a study, by its own table [Hz]."""
    study = _study(files)
    if study is None:
        return named
    return [*study.test.add, *named[0]], [*study.test.drop, *named[1]]


def _study(files: Sequence[Path]) -> Study | None:
    if len(files) != 1 or not is_study(files[0]):
        return None
    from modalkit.study.read import read_study

    return read_study(files[0])


def _session(study: Study, processed: Processed | None, modes: ModalModel | Modes) -> Session | None:
    """Return the study with its model; None where it has none, or one that does not go with the test."""
    from modalkit.workflow.case import open_study

    if study.model is None or processed is None or isinstance(modes, Modes):
        return None
    try:
        return open_study(study, with_baseline=False, known=(processed, modes))
    except ModalkitError:
        return None
