"""The command of the blind rig."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from acquisition.display import counted
from acquisition.errors import InputError
from modalkit.blind import BlindResult, DrawRanges, check_store, run_blind, score
from modalkit.cli.common import check_folder, check_workers, names_of, out, read_by, show_figures
from modalkit.cli.options import Figures, Report
from modalkit.cli.progress import progress, working
from modalkit.cli.reporting import report_wanted
from modalkit.cli.scores import MARKDOWN, score_figures, show_score, write_markdown
from modalkit.output.destinations import check_outputs, json_of, store_of
from modalkit.output.whole import write_json
from modalkit.workflow.stages import TRIALS

_SEED_BITS = 63
_MOST_TRIALS = 10_000_000  # their numbers alone take 80 MB
_USED = {
    "STUDY": ("--trials", "--seed", "--json", "--figures", "--report"),
    "--real": ("--json",),
    "--check": ("--seed",),
}
_DOCUMENTS = {"": "blind", "STUDY": "plan", "--real": "real", "--check": "blind"}
"""What is written as JSON."""

OwnStudy = Annotated[
    Path | None,
    typer.Argument(help="your own study: which effects can its test separate? (docs/tutorials/plan.md)"),
]
Trials = Annotated[int | None, typer.Option(help="number of trials; default 60, with a STUDY none")]
Seed = Annotated[int | None, typer.Option(help="seed of the run; default: drawn at random and printed")]
Workers = Annotated[int, typer.Option(help="trials run in parallel")]
Scheduler = Annotated[
    str | None, typer.Option(help="address of a Dask scheduler whose workers run the trials")
]
StoreFile = Annotated[
    Path | None, typer.Option(help="file for commitments and outcomes, written as they arrive")
]
Resume = Annotated[bool, typer.Option("--resume", help="continue the run of a store")]
Kinds = Annotated[
    str,
    typer.Option(
        help="specimens: beam, plate, frame, and with CalculiX solid, ribbed, bracket; default beam,plate"
    ),
]
Effects = Annotated[str, typer.Option(help="effects that may be hidden, comma-separated; default all")]
LeaveOut = Annotated[
    bool, typer.Option("--leave-out", help="remove the true effect from the library in every trial")
]
Real = Annotated[
    bool, typer.Option("--real", help="diagnose real structures whose cause is withheld, instead of trials")
]
Data = Annotated[Path | None, typer.Option(help="folder of measured data for --real")]
Check = Annotated[
    Path | None, typer.Option(help="check the commitments of a stored run without running trials")
]
Json = Annotated[Path | None, typer.Option("--json", help="file for the score as JSON")]
Markdown = Annotated[
    Path | None, typer.Option(help="Markdown page to put the score into, between its marks or at its end")
]


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(blind)


def blind(
    study: OwnStudy = None,
    trials: Trials = None,
    seed: Seed = None,
    workers: Workers = 2,
    scheduler: Scheduler = None,
    store: StoreFile = None,
    resume: Resume = False,
    kinds: Kinds = "",
    effects: Effects = "",
    leave_out: LeaveOut = False,
    real: Real = False,
    data: Data = None,
    check: Check = None,
    json: Json = None,
    markdown: Markdown = None,
    report: Report = None,
    figures: Figures = None,
) -> None:
    """Hide effects in simulated tests, diagnose these blind, and score the answers."""
    given = {
        "--trials": trials, "--seed": seed, "--scheduler": scheduler, "--store": store, "--resume": resume,
        "--kinds": kinds, "--effects": effects, "--leave-out": leave_out, "--json": json, "--markdown": markdown,
        "--figures": figures, "--report": report,
    }  # fmt: skip
    asked = {"STUDY": study is not None, "--real": real or data is not None, "--check": check is not None}
    job = _only_one([name for name, is_asked in asked.items() if is_asked])
    if report is not None and job != "STUDY":
        raise InputError("--report needs a STUDY; name one, or use --markdown and --json")
    _check_together(job, [name for name, value in given.items() if _is_given(value)])
    _check_numbers(trials, seed, workers, least=0 if study is not None else 1)
    check_outputs(
        (json, json_of(f"modalkit.{_DOCUMENTS[job]}/1")),
        (markdown, MARKDOWN),
        (store, store_of("modalkit.blindrun/2")),
        *report_wanted(report),
        reads=read_by([study] if study is not None else []),
    )
    check_folder(figures)
    if check is not None:
        _check(check, seed)
    elif job == "--real":
        from modalkit.cli.real import show_real

        show_real(data, json, workers)
    elif study is not None:
        from modalkit.cli.planning import plan_study

        plan_study(
            study, trials=trials or 0, seed=1 if seed is None else seed, workers=workers, json=json,
            figures=figures, report=report,
        )  # fmt: skip
    else:
        named = names_of(kinds) or DrawRanges().kinds
        plan = DrawRanges(kinds=named, effects=names_of(effects), leave_out=leave_out)
        count, drawn = 60 if trials is None else trials, _seed(seed, store, resume)
        _show(_run(count, drawn, plan, workers, scheduler, store, resume), json, markdown, figures)


def _show(result: BlindResult, json: Path | None, markdown: Path | None, figures: Path | None) -> None:
    """Print the score of a run, and write it where it is wanted."""
    table = score(result)
    show_score(table)
    out.print(f"seed: {result.seed}", markup=False)
    if json is not None:
        write_json(json, table.to_json())
        out.print(f"written: {json}", markup=False)
    if markdown is not None:
        write_markdown(markdown, table)
        out.print(f"written: {markdown}", markup=False)
    show_figures(figures, lambda: score_figures(table))


def _is_given(value: object) -> bool:
    return value is not None and value is not False and value != ""


def _only_one(asked: Sequence[str]) -> str:
    """Return what is asked for in place of trials; "" for trials."""
    if len(asked) > 1:
        raise InputError(f"{' and '.join(asked)}: these are different commands; give one")
    return asked[0] if asked else ""


def _check_together(job: str, given: Sequence[str]) -> None:
    """Refuse options that do not go together."""
    idle = [name for name in given if job and name not in _USED[job]]
    if idle:
        them = "it" if len(idle) == 1 else "them"
        raise InputError(f"{', '.join(idle)} cannot be used with {job}; leave {them} out")
    if "--resume" in given and "--store" not in given:
        raise InputError("--resume needs the --store of the run to continue")


def _check_numbers(trials: int | None, seed: int | None, workers: int, *, least: int) -> None:
    """Refuse numbers that no run can have."""
    if trials is not None and trials < least:
        raise InputError(f"--trials {trials}: at least {least} is needed")
    if trials is not None and trials > _MOST_TRIALS:
        raise InputError(f"--trials {trials}: at most {_MOST_TRIALS} go into one run")
    check_workers(workers)
    if seed is not None and seed < 0:
        raise InputError(f"--seed {seed}: give 0 or a positive number")


def _seed(seed: int | None, store: Path | None, resume: bool) -> int:
    """Return the seed; one that is drawn is needed to resume, and so is printed before the run."""
    if seed is not None:
        return seed
    if store is not None and resume and store.exists():
        raise InputError(f"{store}: resuming needs its seed; give the --seed printed when the run began")
    drawn = secrets.randbits(_SEED_BITS)
    if store is not None:
        progress.print(
            f"seed: {drawn} (to go on with {store} after an interruption)", markup=False, soft_wrap=True
        )
    return drawn


def _run(
    trials: int,
    seed: int,
    plan: DrawRanges,
    workers: int,
    scheduler: str | None,
    store: Path | None,
    resume: bool,
) -> BlindResult:
    with working(TRIALS) as work:
        return run_blind(
            trials, seed, plan=plan, workers=workers, scheduler=scheduler, store=store, resume=resume,
            progress=work.counter(trials), documents=False,
        )  # fmt: skip


def _check(store: Path, seed: int | None) -> None:
    """Check the seals of a stored run, and say what is in it."""
    found = check_store(store, seed=seed)
    out.print(
        f"{store}: {counted(len(found.outcomes), 'trial')}, each opened with the commitment published before it; "
        f"modalkit {found.version}",
        markup=False,
    )
    if found.in_flight:
        out.print(
            f"committed but not scored, because the run stopped: {', '.join(map(str, found.in_flight))}",
            markup=False,
        )
