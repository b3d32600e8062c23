"""Does a change of the code leave every result as it was?

Each sample study, table, simulation with a seed and blind run with a seed is run as a user would, its outputs kept in a
folder; two such folders, of the code before and after, are then compared number by number:

    python benchmarks/same_results.py record before            # in the checkout before; 10 to 20 minutes on one core
    python benchmarks/same_results.py record after             # in the checkout after
    python benchmarks/same_results.py compare before after     # code 1 if a number differs by more than 1e-9 of itself

What is new, gone or worded otherwise is listed; dates, seals and the time a run took are passed over.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STUDIES = ("beam_dry", "beam_wet", "plate_dry", "plate_wet", "tape_bare", "tape_taped", "beam_joint")
HIDDEN = (
    "lumped_mass:mass=0.05,x=0.3", "clamp_rotation:stiffness=4000", "damping_patch:x=0.2,extent=0.1,loss_factor=0.05",
    "E:factor=1.05",
)  # fmt: skip
# Keys whose values change from run to run: when, how long, random names, versions.
VOLATILE = frozenset(
    {"seconds", "cpu_seconds", "cost", "commitment", "salt", "version", "created", "workers", "elapsed"}
)
NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?")
PROGRESS = re.compile(r"(?m)^.* so far\)\s*\n?")  # a line every ten seconds of work
SEAL = re.compile(r"[0-9a-f]{32,}|\d+:\d\d(?::\d\d)?|\d{1,2}-[A-Z][a-z]{2}-\d{2,4}")
FOREIGN = 1e-300  # what is smaller than this is zero


def commands(out: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield a name for each command, and its words."""
    data = ROOT / "sample_data"
    for name in STUDIES:
        study = str(data / name / "study.toml")
        uff = str(data / name / f"{name}.uff")
        yield f"inspect-{name}", ["inspect", uff]
        yield f"frf-{name}", ["frf", uff, "-o", str(out / f"{name}.uff")]
        yield f"identify-{name}", ["identify", study, "--json", str(out / f"identify-{name}.json")]
        yield f"correlate-{name}", ["correlate", study]
        if "[update]" in Path(study).read_text(encoding="utf-8"):
            yield f"update-{name}", ["update", study, "--json", str(out / f"update-{name}.json")]
        yield f"diagnose-{name}", ["diagnose", study, "--json", str(out / f"diagnose-{name}.json")]
        published = data / name / "published.toml"
        if published.exists():
            yield (
                f"published-{name}",
                ["diagnose", str(published), "--json", str(out / f"published-{name}.json")],
            )
    for paper in ("A", "B"):
        yield f"tables-{paper}", ["tables", "--paper", paper, "-o", str(out / f"tables-{paper}.md")]
    for k, effect in enumerate(HIDDEN):
        file = str(out / f"simulated-{k}.uff")
        yield (
            f"simulate-{k}",
            ["simulate", str(data / "beam_dry/study.toml"), "--effect", effect, "--seed", "7", "-o", file],
        )
        yield f"simulated-{k}", ["identify", file, "--json", str(out / f"simulated-{k}.json")]
    yield "effects", ["effects", "--json", str(out / "effects.json")]
    yield (
        "blind",
        [
            "blind",
            "--trials",
            "12",
            "--seed",
            "77",
            "--kinds",
            "beam,plate",
            "--json",
            str(out / "blind.json"),
        ],
    )
    yield "blind-study", ["blind", str(data / "beam_dry/study.toml"), "--json", str(out / "blind-study.json")]


def record(out: Path) -> None:
    """Run every command, keep what it printed and wrote."""
    out.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "COLUMNS": "200"}
    for name, words in commands(out.resolve()):
        done = subprocess.run(
            [sys.executable, "-P", "-m", "modalkit", *words], capture_output=True, text=True, cwd=out, env=environment,
            check=False,
        )  # fmt: skip
        text = done.stdout + done.stderr
        (out / f"{name}.txt").write_text(
            text.replace(str(out.resolve()), "").replace(str(ROOT), ""), encoding="utf-8"
        )
        print(f"{name}: code {done.returncode}", flush=True)


def differences(one: object, two: object, tolerance: float, where: str = "") -> Iterator[str]:
    """Yield where two contents differ."""
    if isinstance(one, dict) and isinstance(two, dict):
        for key in sorted({*one, *two} - VOLATILE):
            if key not in one or key not in two:
                yield f"{where}.{key}: only {'before' if key in one else 'after'}"
            else:
                yield from differences(one[key], two[key], tolerance, f"{where}.{key}")
    elif isinstance(one, list) and isinstance(two, list):
        if len(one) != len(two):
            yield f"{where}: {len(one)} items before, {len(two)} after"
        for k, (a, b) in enumerate(zip(one, two, strict=False)):
            yield from differences(a, b, tolerance, f"{where}[{k}]")
    elif isinstance(one, str) and isinstance(two, str):
        yield from _texts(one, two, tolerance, where)
    elif _numbers(one, two):
        if not _near(float(one), float(two), tolerance):  # type: ignore[arg-type]
            yield f"{where}: {one} -> {two}"
    elif one != two:
        yield f"{where}: {one!r} -> {two!r}"


def _numbers(one: object, two: object) -> bool:
    return all(isinstance(x, int | float) and not isinstance(x, bool) for x in (one, two))


def _near(one: float, two: float, tolerance: float) -> bool:
    return (
        one == two
        or math.isclose(one, two, rel_tol=tolerance, abs_tol=FOREIGN)
        or (math.isnan(one) and math.isnan(two))
    )


def _texts(one: str, two: str, tolerance: float, where: str) -> Iterator[str]:
    """Compare texts line by line: the words, and the numbers among them."""
    before, after = (
        [line.rstrip() for line in SEAL.sub("", PROGRESS.sub("", text)).splitlines()] for text in (one, two)
    )
    if len(before) != len(after):
        yield f"{where}: {len(before)} lines before, {len(after)} after"
    for a, b in zip(before, after, strict=False):
        same = a == b or (
            NUMBER.sub("", a) == NUMBER.sub("", b)
            and all(
                _near(float(x), float(y), tolerance)
                for x, y in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
            )
        )
        if not same and "second" not in a and "minute" not in a:
            yield f"{where}:\n    - {a.strip()}\n    + {b.strip()}"


def compare(before: Path, after: Path, tolerance: float) -> int:
    """Print where the files of two folders differ; return how many do."""
    names = sorted({p.name for folder in (before, after) for p in folder.iterdir() if p.is_file()})
    different = 0
    for name in names:
        files = before / name, after / name
        if not all(f.exists() for f in files):
            print(f"{name}: only {'before' if files[0].exists() else 'after'}")
            different += 1
            continue
        one, two = (f.read_text(encoding="utf-8", errors="replace") for f in files)
        if name.endswith(".json"):
            found = list(differences(json.loads(one), json.loads(two), tolerance))
        else:
            found = list(_texts(one, two, tolerance, ""))
        different += bool(found)
        for line in found[:20]:
            print(f"{name}{line}")
        if len(found) > 20:
            print(f"{name}: and {len(found) - 20} more")
    print(f"{len(names)} files, {different} differ")
    return different


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("task", choices=("record", "compare"))
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--tolerance", type=float, default=1e-9)
    arguments = parser.parse_args()
    if arguments.task == "record":
        for folder in arguments.folders:
            record(folder)
        return 0
    before, after = arguments.folders
    return 1 if compare(before, after, arguments.tolerance) else 0


if __name__ == "__main__":
    sys.exit(main())
