"""Studies, and the stores of a blind run and of a batch."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import undetectable
from family import Case, Family, written

from modalkit.batch import run as batch_run
from modalkit.blind import DrawRanges, check_store
from modalkit.blind import store as store_module
from modalkit.blind.answer import read_answer
from modalkit.blind.outcome import Outcome
from modalkit.blind.seal import Seal, seal
from modalkit.blind.store import Store
from modalkit.blind.trial import Truth
from modalkit.study.read import read_study
from updating.problem.stated_doubts import check_doubts

SAMPLES = Path(__file__).resolve().parents[2] / "sample_data"
NOTHING: dict[str, Any] = json.loads((Path(__file__).resolve().parents[1] / "no_gap.json").read_text())
"""A diagnosis that finds no gap."""

STUDY = """title = "a beam"
[test]
modes = "modes.csv"
band = [5.0, 500.0]
axes = { origin = [0.0, 0.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0] }
[model]
type = "beam"
length = 0.376
width = 0.0305
thickness = 0.0047625
elements = 10
clamped = ["x0"]
theory = "euler-bernoulli"
[model.material]
E = 210e9
density = 7850.0
[model.damping]
alpha = 1.0
beta = 5e-7
[[model.mass]]
at = [0.376]
mass = 0.01
[[model.region]]
name = "root"
x = [0.0, 0.0376]
[tolerances]
E = 0.01
damping = 0.3
[environment]
fluid_density = 998.0
walls = [-1.0, 1.0, -1.0, 1.0]
[update]
method = "eigenvalue"
parameters = ["E", "root.E"]
"""


def _read_study(path: Path) -> tuple[Any, Sequence[str]]:
    study = read_study(path)
    plain = study.model_dump(exclude={"path"})
    study.axes(study.test)
    check_doubts(study.doubts(), study.spec(), study.update.named)
    return [plain, study.spec(), study.doubts().damping, study.accepted(), study.surroundings()], ()


def _read_store(path: Path) -> tuple[Any, Sequence[str]]:
    found = check_store(path)
    outcomes = {str(i): json.dumps(o.to_json(), sort_keys=True) for i, o in found.outcomes.items()}
    lost = [f"trial {i} was never opened" for i in found.in_flight]
    return [outcomes, found.version, found.plan], lost


def _read_batch(path: Path) -> tuple[Any, Sequence[str]]:
    with batch_run._journal(path, True) as journal:
        return batch_run._kept(journal), ()


def _batch() -> bytes:
    record = {"schema": "modalkit.part/1", "title": "a", "modes": [{"frequency_hz": 12.5}], "warnings": []}
    lines = [
        {"schema": batch_run.SCHEMA, "version": batch_run.__version__},
        *(batch_run._line(batch_run.Part(f"{n}/study.toml", n * 64, record, None)) for n in "abc"),
        {"finished": True},
    ]
    return b"".join(json.dumps(line, separators=(",", ":")).encode() + b"\n" for line in lines)


def _blind_store() -> bytes:
    """Return the store of a blind run of two trials and one that was never opened."""

    def write(path: Path) -> None:
        with Store(path, seed=5, plan=DrawRanges(kinds=("beam",))) as store:
            for index in range(3):
                truth = Truth(
                    kind="beam", effects=("E",), parameters={"E.factor": 0.98}, accepted=(("E",),),
                    in_library=True, without=(), severity=1.0, level="clear", visibility=5.0, size=(0.3,),
                    places=(), baseline=False, calibrated=True, gap_percent=1.0,
                )  # fmt: skip
                sealed = Seal(seal(truth.to_json()).statement, f"{index:032x}")
                store.commit(index, sealed.commitment)
                if index < 2:
                    answer = read_answer(NOTHING)
                    store.keep(
                        Outcome(
                            index=index,
                            truth=truth,
                            answer=answer,
                            document=NOTHING,
                            failure=None,
                            sealed=sealed,
                            seconds=0.5,
                        )
                    )

    header, *lines = written("run.jsonl", write).splitlines(keepends=True)
    plain = json.loads(header)
    salt = "5" * 32
    plain["seed"] = {"salt": salt, "pbkdf2_sha256": store_module._digest(5, salt)}
    return b"".join([json.dumps(plain, separators=(",", ":")).encode() + b"\n", *lines])


def store_families() -> list[Family]:
    """Return the families of studies and stores."""
    study = [Case("study.toml", {"study.toml": STUDY.encode()}, 60, undetectable.toml)]
    studies = sorted(SAMPLES.glob("*/study.toml"))[:3]
    study += [
        Case(f"{i}.toml", {f"{i}.toml": p.read_bytes()}, 200, undetectable.toml)
        for i, p in enumerate(studies)
    ]
    return [
        Family("study", study, _read_study),
        Family(
            "store of a blind run",
            [Case("run.jsonl", {"run.jsonl": _blind_store()}, 600, undetectable.sealed)],
            _read_store,
        ),
        Family(
            "store of a batch",
            [Case("batch.jsonl", {"batch.jsonl": _batch()}, 60, undetectable.json_lines)],
            _read_batch,
        ),
    ]
