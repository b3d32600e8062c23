"""Kill commands with -9 at random times, and when they write: is anything torn, is anything lost on going on?

``uv run python benchmarks/kills.py --kills 200 --seed 1``: some 30 minutes on two idle cores. Every command that writes
(all but ``inspect``) is run in a folder of its own, half the times over earlier results, and killed: a third of all
kills come after the first stored result of a batch or a blind run, a third at a random time, a third when a command
begins to write. Commands of minutes are killed in every sixth round only. Then

* every output is absent, the earlier one, or whole: byte for byte that of a run without a kill, but for a date;
* a store holds whole lines but for the last, and what it held stands in it after the run was gone on with;
* the run that goes on ends as one that was never killed (of commands without a store every fourth is run again);
* no process is left.

It ends with code 1 if anything is torn, lost or left.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = (sys.executable, "-P", "-m", "modalkit")
VARYING = re.compile(
    rb'"[0-9a-f]{32,}"|"seconds": [0-9.]+'
)  # salts, commitments, and how long something took
AGAIN = 0.25  # of the commands without a store, which begin from nothing anyway, so many are run again
SIXTH = 6  # rounds of which one is for commands of minutes; doubling it halves their kills and saves minutes
LATEST = 30.0  # s in which processes must end whose parent was killed
LOAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Job:
    """A command, where it writes, and how an earlier result looks that it may replace."""

    name: str
    words: tuple[str, ...]
    prepare: Callable[[Path], None]
    earlier: dict[str, bytes] = field(default_factory=dict)
    store: str = ""
    dated: tuple[str, ...] = ()  # outputs that hold the time, and so are never the same twice
    minutes: bool = False  # whether it takes a minute or more


@dataclass
class Whole:
    """What a run without a kill left, and how long it took."""

    files: dict[str, bytes]
    seconds: float
    stored: float  # s after which the first result was stored


def json_before(schema: str) -> bytes:
    return json.dumps({"schema": f"modalkit.{schema}/1", "before": True}).encode()


UFF_BEFORE = b"    -1\n   151\nbefore\nNONE\nmodalkit\n\n\n\n\n    -1\n"
BEAM = ROOT / "sample_data" / "beam_wet"


def sample(folder: Path) -> None:
    """Copy the samples of the beam, so that a study finds its baseline."""
    for name in ("beam_wet", "beam_dry"):
        shutil.copytree(ROOT / "sample_data" / name, folder / name)


def fleet(folder: Path) -> None:
    """Lay down studies of modes, which are quick, and of hits, which are not."""
    for number in range(6):
        place = folder / "fleet" / f"part{number}"
        place.mkdir(parents=True)
        if number % 3:
            (place / "modes.csv").write_text(f"frequency,sigma\n{10 + number},0.01\n65.1,0.02\n")
            (place / "study.toml").write_text('[test]\nmodes = "modes.csv"\n')
        else:
            shutil.copy(BEAM / "beam_wet.uff", place / "test.uff")
            (place / "study.toml").write_text('[test]\nfiles = ["test.uff"]\nband = [5.0, 400.0]\n')


STUDY, HITS = "beam_wet/published.toml", "beam_wet/beam_wet.uff"
JOBS = (
    Job("frf", ("frf", HITS, "-o", "o.uff", "--figures", "f"), sample, {"o.uff": UFF_BEFORE}),
    Job(
        "identify", ("identify", HITS, "--json", "o.json", "-o", "o.uff", "--figures", "f"), sample,
        {"o.uff": UFF_BEFORE, "o.json": json_before("modes")},
    ),
    Job("identify csv", ("identify", HITS, "-o", "o.csv"), sample, {"o.csv": b"frequency,sigma,scaled\n1.0,0.1,1\n"}),
    Job(
        "simulate", ("simulate", STUDY, "--seed", "3", "-o", "o.uff", "--figures", "f"), sample,
        {"o.uff": UFF_BEFORE},
    ),
    Job(
        "correlate", ("correlate", STUDY, "--json", "o.json", "--figures", "f"), sample,
        {"o.json": json_before("correlation")},
    ),
    Job(
        "update", ("update", STUDY, "--json", "o.json", "--figures", "f"), sample,
        {"o.json": json_before("update")},
    ),
    Job(
        "diagnose", ("diagnose", STUDY, "--json", "o.json", "--report", "o.html", "--figures", "f"), sample,
        {"o.json": json_before("diagnosis")}, dated=("o.html",),
    ),
    Job("effects", ("effects", "--json", "o.json"), lambda _: None, {"o.json": json_before("effects")}),
    Job(
        "plan", ("blind", STUDY, "--json", "o.json", "--figures", "f"), sample,
        {"o.json": json_before("plan")},
    ),
    Job(
        "tables", ("tables", "--paper", "B", "-o", "o.md", "--figures", "f"), lambda _: None,
        {"o.md": b"## Paper B, before\n"}, minutes=True,
    ),
    Job("demo", ("demo", "--figures", "f"), lambda _: None, minutes=True),
    Job(
        "real", ("blind", "--real", "--json", "o.json"), lambda _: None, {"o.json": json_before("real")},
        minutes=True,
    ),
    Job(
        "batch", ("batch", "fleet", "-o", "t.csv", "--json-dir", "parts", "--resume"), fleet,
        {"t.csv": b"study,title\nbefore,before\n"}, store="t.csv.jsonl",
    ),
    Job(
        "blind",
        (
            "blind", "--trials", "2", "--seed", "5", "--kinds", "beam", "--effects", "none,E",
            "--store", "s.jsonl", "--resume", "--json", "o.json", "--markdown", "o.md", "--figures", "f",
        ),
        lambda _: None, {"o.json": json_before("blind")}, store="s.jsonl",
    ),
)  # fmt: skip


def environment() -> dict[str, str]:
    return dict(os.environ) | LOAD


def start(job: Job, folder: Path) -> subprocess.Popen[bytes]:
    silent = subprocess.DEVNULL
    return subprocess.Popen(
        [*PROGRAM, *job.words], cwd=folder, env=environment(), stdout=silent, stderr=silent, stdin=silent
    )


def results_stored(job: Job, folder: Path) -> int:
    """Count the results in a store, without the header, commitments and the end."""
    try:
        lines = (folder / job.store).read_bytes().split(b"\n")[1:-1]
    except OSError:
        return 0
    return sum(b'"outcome"' in line or b'"digest"' in line for line in lines)


def written(folder: Path, inputs: Sequence[str]) -> dict[str, bytes]:
    """Return what a command left: every file that was not there before, drafts left out."""
    files = (p for p in folder.rglob("*") if p.is_file())
    found = {p.relative_to(folder).as_posix(): p for p in files}
    return {
        name: path.read_bytes()
        for name, path in sorted(found.items())
        if name not in inputs and not any(part.startswith(".") for part in Path(name).parts)
    }


def listing(folder: Path) -> list[str]:
    return [p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()]


def whole_run(job: Job, folder: Path) -> Whole:
    """Run a command without a kill."""
    job.prepare(folder)
    inputs, began, stored = listing(folder), time.monotonic(), 0.0
    process = start(job, folder)
    while process.poll() is None:
        if job.store and not stored and results_stored(job, folder):
            stored = time.monotonic() - began
        time.sleep(0.01)
    if process.returncode:
        raise SystemExit(f"{job.name}: ended with code {process.returncode} without a kill")
    return Whole(written(folder, inputs), time.monotonic() - began, stored)


def descendants(pid: int) -> set[int]:
    """Return the processes that a process has started, and those of theirs."""
    parents: dict[int, int] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            with contextlib.suppress(OSError, IndexError, ValueError):
                parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
    found = {pid}
    while more := {child for child, parent in parents.items() if parent in found} - found:
        found |= more
    return found - {pid}


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (OSError, IndexError):
        return False


def await_moment(job: Job, when: str, folder: Path, whole: Whole, rng: random.Random) -> Iterator[None]:
    """Yield until it is time to kill."""
    began = time.monotonic()
    if when == "random":
        end = rng.uniform(0.0, whole.seconds)
        while time.monotonic() - began < end:
            yield
    elif when == "stored":
        while not results_stored(job, folder):
            yield
        end = time.monotonic() + rng.uniform(0.0, max(0.05, whole.seconds - whole.stored))
        while time.monotonic() < end:
            yield
    else:
        before = state(folder)
        while state(folder) == before:
            yield
        end = time.monotonic() + rng.expovariate(50.0)
        while time.monotonic() < end:
            yield


def state(folder: Path) -> dict[str, int]:
    found = {}
    with contextlib.suppress(OSError):
        for entry in os.scandir(folder):
            if not entry.name.endswith(".jsonl"):
                with contextlib.suppress(OSError):
                    found[entry.name] = entry.stat().st_mtime_ns
    return found


def faults_of(job: Job, now: dict[str, bytes], whole: Whole, before: dict[str, bytes]) -> list[str]:
    """Return which outputs are neither absent, nor the earlier ones, nor whole."""
    faults = [f"{name}: lost" for name in before if name not in now]
    for name, content in now.items():
        if name == job.store or content == before.get(name):
            continue
        if name not in whole.files:
            faults.append(f"{name}: should not be there")
        elif not is_whole(content, whole.files[name], dated=name in job.dated):
            faults.append(f"{name}: torn, {len(content)} bytes of {len(whole.files[name])}")
    return faults


def is_whole(content: bytes, wanted: bytes, *, dated: bool) -> bool:
    """Tell whether an output is that of a run without a kill; one with a date is known by its end.

    The salts and commitments of a blind run are drawn anew in every run, and left out of the comparison with the
    seconds that the record of the real structures holds.
    """
    if dated:
        return content.endswith(b"</html>\n")
    return VARYING.sub(b"", content) == VARYING.sub(b"", wanted)


def kill_once(job: Job, when: str, whole: Whole, rng: random.Random) -> tuple[str, list[str]]:
    """Run a command, kill it, look, go on with it, look again."""
    with tempfile.TemporaryDirectory(prefix="kills-") as name:
        folder = Path(name)
        job.prepare(folder)
        inputs = listing(folder)
        before = job.earlier if rng.random() < 0.5 else {}
        for output, content in before.items():
            (folder / output).write_bytes(content)
        process = start(job, folder)
        for _ in await_moment(job, when, folder, whole, rng):
            if process.poll() is not None:
                break
            time.sleep(0.0005 if when == "writing" else 0.005)
        children = descendants(process.pid)
        process.send_signal(signal.SIGKILL)
        outcome = "killed" if process.wait() == -signal.SIGKILL else "had ended"
        faults = orphans(children)
        now = written(folder, inputs)
        faults += faults_of(job, now, whole, before)
        held = now.get(job.store, b"")
        held = held[: held.rfind(b"\n") + 1]
        if not job.store and rng.random() > AGAIN:
            return outcome, faults
        again = subprocess.run(
            [*PROGRAM, *job.words], cwd=folder, env=environment(), capture_output=True, text=True, check=False
        )
        if again.returncode:
            return outcome, [*faults, f"does not go on: {again.stderr.strip()[-200:]}"]
        after = written(folder, inputs)
        faults += [f"{n}: missing after going on" for n in whole.files if n not in after]
        faults += faults_of(job, after, whole, {})
        if job.store and not after[job.store].startswith(held):
            faults.append(f"{job.store}: lost what it held")
        return outcome, faults


def orphans(children: set[int]) -> list[str]:
    """Return processes that do not end when their parent was killed; they are ended here."""
    end = time.monotonic() + LATEST
    while (left := {pid for pid in children if alive(pid)}) and time.monotonic() < end:
        time.sleep(0.05)
    for pid in left:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    return [f"process {pid}: left over" for pid in left]


def schedule(kills: int, jobs: Sequence[Job]) -> list[tuple[Job, str]]:
    """Return what is killed when: a third each after a stored result, at random, and when it writes."""
    stores = [job for job in jobs if job.store]
    long = [job for job in jobs if job.minutes]
    short = [job for job in jobs if not job.minutes] or long
    plan = []
    for number in range(kills):
        turn = number // 3
        if number % 3 == 0 and stores:
            quick = stores[0] if turn % 3 else stores[-1]  # two batches to a blind run, which takes longer
            plan.append((quick, "stored"))
        else:
            among, at = (long, turn // SIXTH) if long and turn % SIXTH == 0 else (short, turn)
            plan.append((among[at % len(among)], "random" if number % 3 == 1 else "writing"))
    return plan


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="names of commands, comma-separated")
    chosen = parser.parse_args()
    jobs = [job for job in JOBS if not chosen.only or job.name in chosen.only.split(",")]
    wholes = {}
    for job in jobs:
        with tempfile.TemporaryDirectory(prefix="kills-") as name:
            wholes[job.name] = whole_run(job, Path(name))
        print(
            f"{job.name}: {wholes[job.name].seconds:.1f} s, {', '.join(wholes[job.name].files)}", flush=True
        )
    rng, counts, wrong = random.Random(chosen.seed), Counter[str](), 0
    for number, (job, when) in enumerate(schedule(chosen.kills, jobs), start=1):
        outcome, faults = kill_once(job, when, wholes[job.name], rng)
        counts[f"{job.name}, {when}: {outcome}"] += 1
        wrong += bool(faults)
        if number % 10 == 0:
            print(f"{number} of {chosen.kills}, {wrong} with faults", flush=True)
        for fault in faults:
            print(f"  {job.name}, {when}: {fault}", flush=True)
    for name, number in sorted(counts.items()):
        print(f"{number:4d}  {name}")
    killed = sum(n for name, n in counts.items() if name.endswith(": killed"))
    stored = sum(n for name, n in counts.items() if name.endswith("stored: killed"))
    print(f"{killed} killed with -9, {stored} of them after a stored result; {wrong} with faults")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
