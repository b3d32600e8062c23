"""Small whole files of every format that is read, by our own writers and by hand; the families that are attacked."""

from __future__ import annotations

import functools
import gzip
import io
import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import undetectable
from family import Case, Family
from mutators import repacked
from scipy import sparse
from scipy.io import mmwrite

from acquisition import Dof, FrfSet, Geometry, HammerTest, Hits, ModalData, read_modes, write_uff
from acquisition.columns import read_columns, read_frf_columns
from modalkit.batch import run as batch_run
from modalkit.blind import Plan, check_store
from modalkit.blind import store as store_module
from modalkit.blind.answer import read_answer
from modalkit.blind.outcome import Outcome
from modalkit.blind.seal import Seal, seal
from modalkit.blind.store import Store
from modalkit.blind.trial import Truth
from modalkit.files import read_files
from modalkit.study import read_study
from updating.models.imported import read_imported, read_matrix, read_table

RNG = np.random.default_rng(13)
SAMPLES = Path(__file__).resolve().parents[2] / "sample_data"
NOTHING: dict[str, Any] = {
    "schema": "modalkit.diagnosis/1",
    "significant": False,
    "p_value": 0.5,
    "gap": {"frequency_rms_percent": 0.1, "noise_floor_percent": 0.1},
    "where": {
        "channel": "none",
        "channels": {},
        "location": None,
        "locations": [],
        "points": [],
        "zones": [],
    },
    "cause": {"verdict": "none", "effects": [], "sets": [], "ranking": []},
    "shrink": {
        "metric": "frequency",
        "before_percent": 0.1,
        "after_percent": 0.1,
        "held_out": {"before_percent": None, "after_percent": None, "noise_floor_percent": 0.1},
        "closed_percent": None,
    },
    "next_test": [],
    "warnings": [],
}
"""A diagnosis that finds no gap."""


def written(name: str, write: Callable[[Path], object]) -> bytes:
    """Return what a writer writes."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


# --- universal files


@functools.cache
def _hammer(samples: int = 24) -> HammerTest:
    pulse = np.exp(-0.5 * ((np.arange(samples) - 5) / 1.5) ** 2)
    points = tuple(
        Hits(
            Dof(n, 3),
            (Dof(1, 3), Dof(2, -1)),
            np.stack([pulse * 40, pulse * 30]),
            np.round(RNG.standard_normal((2, 2, samples)), 5),
        )
        for n in (1, 2)
    )
    return HammerTest(1024.0, points, "accelerance", 2.0, _geometry())


def _geometry() -> Geometry:
    return Geometry((1, 2, 3), np.array([[0.0, 0.0, 0.0], [0.25, 0.5, 0.0], [0.5, 0.0, 0.125]]))


@functools.cache
def _frfs(lines: int = 16) -> FrfSet:
    values = RNG.standard_normal((2, lines)) + 1j * RNG.standard_normal((2, lines))
    values[:, -1] = 0.0  # a record that ends in zeros hides a shift
    return FrfSet(
        np.arange(lines) * 0.5, np.round(values, 4), (Dof(1, 3), Dof(2, 3)), (Dof(3, 3), Dof(3, 3)),
        "accelerance", coherence=np.full((2, lines), 0.99), averages=np.array([3, 3]), geometry=_geometry(),
    )  # fmt: skip


@functools.cache
def _modal() -> ModalData:
    return ModalData(
        np.array([12.5, 31.25]), np.array([0.01, 0.02]), np.array([0.01, 0.02]), np.array([1e-4, 1e-4]),
        (Dof(1, 3), Dof(2, 3), Dof(3, 3)), RNG.standard_normal((3, 2)) + 0j, None, True, _geometry(),
    )  # fmt: skip


_TITLES = {b"58": 5, b"58b": 5, b"151": 7, b"55": 5, b"82": 2}
"""Lines of each kind of data set that are titles, behind that of its number."""

_HEADERS = {b"58": 11, b"58b": 11, b"164": 1}
"""Lines of it that hold names beside numbers."""


def _payloads(content: bytes) -> list[tuple[int, int]]:
    """Return where the numbers of the sets 58b stand."""
    spans = []
    for found in re.finditer(rb"\n {0,4}58b[^\n]*", content):
        count = int(found.group()[1:].split()[4])
        start = found.end() + 1
        for _ in range(11):
            start = content.index(b"\n", start) + 1
        spans.append((start, start + count))
    return spans


def _uff(name: str, content: bytes) -> Case:
    judge = undetectable.universal(_TITLES, _HEADERS)
    spans = _payloads(content)
    seen = undetectable.payload(spans, len(content), judge) if spans else judge
    return Case(name, {name: content}, len(content) // 4, seen, spans)


def _read_uff(path: Path) -> tuple[Any, Sequence[str]]:
    content = read_files([path])
    odd = [f"{d.place}: {d.message}" for d in content.datasets if d.message or not d.ok]
    values = [content.tests, content.frfs, content.modal, content.geometry]
    return values, [*content.warnings, *odd]


NODES15 = """    -1
    15
         1         0         0         8  0.00000e+00  0.00000e+00  0.00000e+00
         2         0         0         8  2.50000e-01  5.00000e-01  0.00000e+00
         3         0         0         8  5.00000e-01  0.00000e+00  1.25000e-01
    -1
"""
LINES82 = """    -1
    82
         1         3         0
NONE
         1         2         3
    -1
"""


def _uff_families() -> list[Family]:
    def make(form: Any, precision: Any, **what: Any) -> bytes:
        return written("a.uff", lambda path: write_uff(path, form=form, precision=precision, **what))

    text = [
        make("ascii", "double", tests=_hammer()),
        make("ascii", "double", frfs=_frfs()),
        make("ascii", "single", frfs=_frfs()),
    ]
    binary = [
        make("binary", "double", tests=_hammer()),
        make("binary", "double", frfs=_frfs()),
        make("binary", "single", frfs=_frfs()),
    ]
    modes = make("ascii", "double", modal=_modal())
    sets = [modes, modes + LINES82.encode(), (NODES15 + LINES82).encode() + text[1]]
    return [
        Family(name, [_uff(f"{i}.uff", content) for i, content in enumerate(contents)], _read_uff)
        for name, contents in (("UFF ASCII", text), ("UFF binary", binary), ("UFF modes and nodes", sets))
    ]


# --- text


HITS_LAYOUT = b"""time_column = "t"
[[column]]
name = "f"
quantity = "force"
node = 2
[[column]]
name = "a"
quantity = "acceleration"
unit = "g"
[nodes]
1 = [0.0, 0.0, 0.0]
2 = [0.5, 0.0, 0.0]
"""
RATE_LAYOUT = HITS_LAYOUT.replace(b'time_column = "t"', b"rate = 1000.0")
FRF_LAYOUT = b"""frequency_column = 0
[[column]]
index = 1
quantity = "accelerance"
part = "real"
[[column]]
index = 2
quantity = "accelerance"
part = "imag"
"""
LVM_LAYOUT = b"""[[column]]
name = "force"
quantity = "force"
[[column]]
name = "acc"
quantity = "acceleration"
"""


def _table(separator: str = ",", decimal: str = ".", heading: str = "t{0}f{0}a\n", lines: int = 20) -> bytes:
    time = np.arange(lines) * 1e-3
    rows = np.stack([time, 30 * np.exp(-((np.arange(lines) - 4) ** 2) / 4.0), np.sin(time * 900)]).T
    body = "\n".join(separator.join(f"{v:.6e}".replace(".", decimal) for v in row) for row in rows)
    return (heading.format(separator) + body + "\n").encode()


def _untimed(content: bytes) -> bytes:
    return b"\n".join(line.partition(b",")[2] for line in content.split(b"\n"))


def _lvm_words(number: int, line: bytes) -> bool:
    """Tell lines of numbers, and those of a header that say something of them, from all others."""
    known = (b"Chan", b"Samp", b"Y_Un", b"X_Di", b"Delta", b"***", b"Sep", b"Dec")
    return not line.strip().startswith((*(b"%d" % d for d in range(10)), b"-", b",", *known))


def _columns_family(
    read: Callable[[Path, Path], Any], layouts: dict[str, tuple[bytes, bytes]], name: str
) -> Family:
    cases = [
        Case(
            file,
            {file: content, f"{file}.toml": layout},
            content.index(b"\n") + 1,
            undetectable.text(
                free=_lvm_words
                if file.endswith("lvm")
                else lambda number, line, by=file[:3]: number == 0 and by == "frf",
                rows=b"rate" in layout or file.endswith("lvm"),
                outer=b"_column" in layout,
                ends=file in ("rate.csv", "a.lvm"),
                decimal=b"," if file in ("semicolon.csv", "a.lvm") else b".",
            ),
        )
        for file, (content, layout) in layouts.items()
    ]

    def reader(path: Path) -> tuple[Any, Sequence[str]]:
        return read(path, path.with_name(f"{path.name}.toml")), ()

    return Family(name, cases, reader)


LVM = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tYes\n"
    "X_Columns\tOne\n***End_of_Header***\t\n\n"
)
LVM_SEGMENT = (
    "Channels\t2\nSamples\t8\t8\nY_Unit_Label\tg\tNewtons\nX_Dimension\tTime\tTime\n"
    "Delta_X\t1,0E-3\t1,0E-3\n***End_of_Header***\nX_Value\tacc\tforce\tComment\n"
)


def _lvm() -> bytes:
    parts = [LVM]
    for scale in (1.0, 1.5):
        rows = [f"{k * 1e-3:.3f}\t{np.sin(scale * k):.5f}\t{scale * k * k:.5f}" for k in range(8)]
        parts.append(LVM_SEGMENT + "\n".join(rows).replace(".", ",") + "\n\n")
    return "".join(parts).encode()


def _read_layout(path: Path) -> tuple[Any, Sequence[str]]:
    read = read_columns if path.stem == "hits" else read_frf_columns
    return read(path.with_suffix(".csv"), path), ()


def _table_families() -> list[Family]:
    hits = {
        "comma.csv": (_table(), HITS_LAYOUT),
        "semicolon.csv": (_table(";", ","), HITS_LAYOUT),
        "tab.txt": (_table("\t"), HITS_LAYOUT),
        "rate.csv": (_untimed(_table()), RATE_LAYOUT),
    }
    frfs = {"frf.csv": (_table(), FRF_LAYOUT), "frf.txt": (_table("  "), FRF_LAYOUT)}
    lvm = {"a.lvm": (_lvm(), LVM_LAYOUT)}
    layouts = [
        Case(name, {name: content, "hits.csv": _table(), "frf.csv": _table()}, 60, undetectable.toml)
        for name, content in (("hits.toml", HITS_LAYOUT), ("frf.toml", FRF_LAYOUT))
    ]
    modes = b"# a beam\nfrequency,sigma,damping,damping_sigma,1+Z,2+Z\n" + b"".join(
        b"%.4f,%.4f,%.5f,%.6f,%.5f,%.5f\n" % (10.0 * k**2, 0.01 * k, 0.01, 0.0005, 1.0 / k, -0.5 * k)
        for k in (1, 2, 3)
    )
    nodes = b"node,x,y,z,direction,row\n" + b"".join(
        b"%d,%.3f,0.0,0.0,3,%s\n" % (k, 0.1 * k, b"%d" % k if k else b"") for k in range(8)
    )
    return [
        _columns_family(read_columns, hits, "hits as text"),
        _columns_family(read_frf_columns, frfs, "FRFs as text"),
        _columns_family(read_columns, lvm, "LabVIEW text"),
        Family("layout", layouts, _read_layout),
        Family(
            "modes table",
            [
                Case(
                    "modes.csv",
                    {"modes.csv": modes},
                    60,
                    undetectable.cells,
                    plainly=undetectable.without_exponents,
                )
            ],
            lambda path: (read_modes(path), ()),
        ),
        Family(
            "node table",
            [
                Case(
                    "nodes.csv",
                    {"nodes.csv": nodes},
                    30,
                    undetectable.cells,
                    plainly=undetectable.without_exponents,
                )
            ],
            lambda path: (read_table(path, 8), ()),
        ),
    ]


# --- matrices


def _beam(elements: int = 4) -> tuple[Any, Any]:
    """Return a chain of springs and masses, clamped at its root, that is no multiple of itself anywhere."""
    stiff = 1e6 * (1 + 0.125 * np.arange(elements + 1))
    k = sparse.diags_array(
        [stiff[:-1] + stiff[1:], -stiff[1:-1], -stiff[1:-1]], offsets=[0, 1, -1], shape=(elements, elements)
    )
    return sparse.csr_array(k), sparse.csr_array(sparse.diags_array(0.5 + 0.25 * np.arange(elements)))


def market(symmetry: str, *, dense: bool = False) -> bytes:
    """Return the stiffness as MatrixMarket."""
    plain = io.BytesIO()
    stiffness = _beam(6)[0]
    mmwrite(
        plain,
        stiffness.toarray() if dense else sparse.coo_array(stiffness),
        comment="a chain",
        symmetry=symmetry,
    )
    return plain.getvalue()


def boeing(kind: str = "RSA") -> bytes:
    """Return the stiffness as Harwell-Boeing, with fields that touch and exponents with D."""
    whole = sparse.csc_array(_beam(6)[0])
    matrix = sparse.csc_array(sparse.tril(whole)) if kind == "RSA" else whole
    matrix.sort_indices()

    def block(numbers: list[str], each: int) -> list[str]:
        return ["".join(numbers[i : i + each]) for i in range(0, len(numbers), each)]

    parts = [
        block([f"{p + 1:8d}" for p in matrix.indptr], 10),
        block([f"{i + 1:8d}" for i in matrix.indices], 10),
        block([f"{v:25.16E}".replace("E", "D") for v in matrix.data], 3),
    ]
    n = matrix.shape[0]
    head = [
        f"{'a chain':72s}{'CHAIN':8s}",
        "".join(f"{c:14d}" for c in (sum(map(len, parts)), *map(len, parts), 0)),
        f"{kind:14s}{n:14d}{n:14d}{matrix.nnz:14d}{0:14d}",
        f"{'(10I8)':16s}{'(10I8)':16s}{'(1P,3D25.16)':20s}{'':20s}",
    ]
    return ("\n".join([*head, *(line for part in parts for line in part)]) + "\n").encode()


def triplets(matrix: Any) -> bytes:
    """Return a matrix as CalculiX writes it: one triangle, column by column."""
    upper = sparse.coo_array(sparse.triu(matrix))
    order = np.lexsort((upper.row, upper.col))
    rows = zip(upper.row[order] + 1, upper.col[order] + 1, upper.data[order], strict=True)
    return "".join(f"{i} {j} {v:20.13e}\n" for i, j, v in rows).encode()


DECK = b"""** a chain
*NODE, NSET=ALL
1, 0.0, 0.0, 0.0
2, 0.1, 0.0, 0.0
3, 0.2, 0.0, 0.0
4, 0.3, 0.0, 0.0
5, 0.4, 0.0, 0.0
*NSET, NSET=ROOT
1,
*NSET, NSET=REST, GENERATE
2, 5, 1
*BOUNDARY
ROOT, 1, 3
REST, 1, 2
*STEP
*FREQUENCY
3
*END STEP
"""
DOFS = b"".join(b"%d.3\n" % n for n in (2, 3, 4, 5))


def _matrix_family(name: str, cases: dict[str, bytes], judge: undetectable.Judge, head: int) -> Family:
    def read(path: Path) -> tuple[Any, Sequence[str]]:
        return read_matrix(path), ()

    plainly = undetectable.without_exponents if name == "MatrixMarket" else None
    found = [Case(file, {file: content}, head, judge, plainly=plainly) for file, content in cases.items()]
    return Family(name, found, read)


def _market_judge(original: bytes, mutant: bytes) -> bool:
    one, two = (gzip.decompress(c) if c[:2] == b"\x1f\x8b" else c for c in (original, mutant))
    return undetectable.text(free=lambda number, line: line.startswith(b"%") and number > 0)(one, two)


def _archives() -> dict[str, bytes]:
    stiffness = _beam(6)[0]
    found = {
        f"{kind}.npz": repacked(
            written("a.npz", functools.partial(sparse.save_npz, matrix=stiffness.asformat(kind)))
        )
        for kind in ("csr", "csc", "coo", "dia", "bsr")
    }
    found["plain.npz"] = repacked(written("a.npz", lambda path: np.savez(path, K=stiffness.toarray())))
    found["plain.npy"] = written("a.npy", lambda path: np.save(path, stiffness.toarray()))
    return found


def _matrix_families() -> list[Family]:
    markets = {
        "symmetric.mtx": market("symmetric"),
        "general.mtx": market("general"),
        "dense.mtx": market("general", dense=True),
        "k.mtx.gz": gzip.compress(market("symmetric"), mtime=0),
    }
    k, m = _beam()
    job = {"job.sti": triplets(k), "job.mas": triplets(m), "job.dof": DOFS, "job.inp": DECK}

    def read_job(path: Path) -> tuple[Any, Sequence[str]]:
        found = read_imported(*(path.with_name(name) for name in ("job.sti", "job.mas", "job.inp")))
        return [found.stiffness, found.mass, found.nodes], ()

    calculix = [
        Case(
            name,
            job,
            80,
            undetectable.text(free=_comment(name), rows=True, ends=True),
            plainly=undetectable.without_exponents,
        )
        for name in job
    ]
    return [
        _matrix_family("MatrixMarket", markets, _market_judge, 80),
        _matrix_family(
            "Harwell-Boeing",
            {"k.rsa": boeing(), "k.rua": boeing("RUA")},
            undetectable.text(free=lambda number, line: number == 0),
            4 * 81,
        ),
        _matrix_family("numpy matrices", _archives(), undetectable.archive, 200),
        Family("CalculiX", calculix, read_job),
    ]


def _comment(name: str) -> Callable[[int, bytes], bool]:
    """Return which lines are comments: of decks those with two stars, of matrices all that CalculiX does not write."""
    starts = (b"**",) if name.endswith(".inp") else (b"*", b"#", b"%", b"!")
    return lambda number, line: line.strip().startswith(starts)


# --- studies and stores


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
        with Store(path, seed=5, plan=Plan(kinds=("beam",))) as store:
            for index in range(3):
                truth = Truth(
                    "beam", ("E",), {"E.factor": 0.98}, (("E",),), True, (), 1.0, "clear", 5.0, (0.3,), (), False, True,
                    1.0,
                )  # fmt: skip
                sealed = Seal(seal(truth.to_json()).statement, f"{index:032x}")
                store.commit(index, sealed.commitment)
                if index < 2:
                    answer = read_answer(NOTHING)
                    store.keep(Outcome(index, truth, answer, NOTHING, None, sealed, 0.5))

    header, *lines = written("run.jsonl", write).splitlines(keepends=True)
    plain = json.loads(header)
    salt = "5" * 32
    plain["seed"] = {"salt": salt, "pbkdf2_sha256": store_module._digest(5, salt)}
    return b"".join([json.dumps(plain, separators=(",", ":")).encode() + b"\n", *lines])


def families() -> list[Family]:
    """Return every family that is attacked."""
    study = [Case("study.toml", {"study.toml": STUDY.encode()}, 60, undetectable.toml)]
    studies = sorted(SAMPLES.glob("*/study.toml"))[:3]
    study += [
        Case(f"{i}.toml", {f"{i}.toml": p.read_bytes()}, 200, undetectable.toml)
        for i, p in enumerate(studies)
    ]
    return [
        *_uff_families(),
        *_table_families(),
        *_matrix_families(),
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
