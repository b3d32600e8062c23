"""Real structures with their cause withheld: the known truth compared with the answers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from acquisition.errors import InputError
from modalkit.cli.common import out, show_table
from modalkit.cli.progress import working
from modalkit.output.destinations import check_outputs, json_of
from modalkit.output.whole import write_json
from modalkit.papers.a.chain import sample_folder
from modalkit.papers.real import CASES, RULES, RealOutcome, counts, real_document, real_table, run_real
from modalkit.workflow.stages import REAL

_GAP = """\
Gap: r.m.s. error of the frequencies unless otherwise stated, before and after, the latter on modes held out; beside
it the runner-up and the tolerances alone on the same modes, and the floor set by noise. "synthetic" files are not real
data: they were made from the numbers of the papers (sample_data/README.md).
"""


def show_real(data: Path | None, json: Path | None, workers: int) -> None:
    """Diagnose real structures whose cause is withheld, and print what is known and what was answered.

    Parameters
    ----------
    data : Path or None
        Folder of measured data; without it the cases that need it are skipped, with the reason.
    json : Path or None
        File for the record.
    workers : int
        Diagnoses at a time [-].

    Raises
    ------
    InputError
        If the folder of data does not exist, or the record cannot be written.
    """
    check_outputs((json, json_of("modalkit.real/1")))
    if data is not None and not data.is_dir():
        raise InputError(f"{data}: no such folder; name the one of the measured data")
    with working(REAL) as work:
        outcomes = run_real(CASES, sample_folder(), data, workers=workers, progress=work.counter(len(CASES)))
    print_real(outcomes)
    if json is not None:
        write_json(json, real_document(outcomes))
        out.print(f"written: {json}", markup=False)


def print_real(outcomes: Sequence[RealOutcome]) -> None:
    """Print the outcomes: the library whole, then with the true effects taken out, then the rules."""
    whole = [o for o in outcomes if not o.case.removed]
    left_out = [o for o in outcomes if o.case.removed]
    if whole:
        show_table(real_table(whole), "Real structures, their cause withheld")
    if left_out:
        show_table(real_table(left_out), "The same trials with the true effects removed from the library")
    out.print("How answers are graded:", style="bold")
    out.print(RULES, markup=False)
    out.print(_GAP, markup=False)
    missing = sum(o.missing is not None for o in outcomes)
    line = ", ".join(f"{n} {grade}" for grade, n in counts(outcomes).items())
    out.print(f"{len(outcomes)} cases: {line}, {missing} skipped or failed", markup=False)
    for outcome in outcomes:
        if outcome.missing is not None:
            out.print(f"skipped: {outcome.case.name}: {outcome.missing}", markup=False)
