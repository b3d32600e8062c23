"""The store of a run: every commitment before its diagnosis, every outcome when it is there, one a line."""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from acquisition.errors import InputError, ModalkitError
from modalkit.blind.outcome import Outcome
from modalkit.blind.seal import SALT_BYTES, open_seal
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.version import __version__
from modalkit.workers.journal import Journal, read_journal

SCHEMA = "modalkit.blindrun/2"
_ROUNDS = 200_000  # of the hash of the seed, so that guessing many takes long


class Store:
    """The store of a run, open for what is still to come.

    Parameters
    ----------
    path : Path
        The file.
    seed : int
        Of the run; the file holds a salted hash of it.
    plan : DrawRanges
        What may be drawn.
    resume : bool
        Whether to go on with a store that stands there.

    Raises
    ------
    InputError
        If it stands there and is not to be resumed, belongs to another run, or was changed.
    """

    def __init__(self, path: Path, *, seed: int, plan: DrawRanges, resume: bool = False) -> None:
        """Open the file, and begin it where it is new."""
        self._journal = Journal(path, resume=resume)
        try:
            self.found = self._begin(path, seed, plan)
        except BaseException:
            self._journal.close()
            raise

    def _begin(self, path: Path, seed: int, plan: DrawRanges) -> dict[int, Outcome]:
        lines = self._journal.found
        if not lines:
            self._journal.append(_header(seed, plan))
            return {}
        _check_header(path, lines[0])
        _check_run(path, lines[0], seed, plan)
        return checked(path, lines)

    def __enter__(self) -> Self:
        """Return the store."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self._journal.close()

    def commit(self, index: int, commitment: str) -> None:
        """Publish a trial's commitment; it is on the disk when this returns."""
        self._journal.append({"trial": index, "commitment": commitment})

    def keep(self, outcome: Outcome) -> None:
        """Store an outcome; it is on the disk when this returns."""
        self._journal.append({"trial": outcome.index, "outcome": outcome.to_json()})


@dataclass(frozen=True)
class Checked:
    """What a store holds, every seal checked.

    Parameters
    ----------
    outcomes : dict
        Outcomes by the number of their trial.
    in_flight : tuple of int
        Trials that were sealed and never opened: their run was ended before.
    version : str
        Of modalkit, that made it.
    plan : dict
        What could be drawn.
    """

    outcomes: dict[int, Outcome]
    in_flight: tuple[int, ...]
    version: str
    plan: dict[str, Any]


def check_store(path: Path, *, seed: int | None = None) -> Checked:
    """Check a stored run: each truth against the commitment that was published before it was opened.

    Parameters
    ----------
    path : Path
        The store.
    seed : int, optional
        Where given, it must be the one of the run.

    Raises
    ------
    InputError
        With the number of the trial, if a statement, a salt or the order was changed; if it is no store.
    """
    lines, _ = read_journal(path)
    if not lines:
        raise InputError(f"{path}: holds nothing; name the store of a run")
    _check_header(path, lines[0])
    if seed is not None:
        _check_seed(path, lines[0], seed)
    outcomes = checked(path, lines)
    sealed = {line["trial"] for line in lines[1:] if "commitment" in line}
    return Checked(outcomes, tuple(sorted(sealed - outcomes.keys())), lines[0]["version"], lines[0]["plan"])


def checked(path: Path, lines: Sequence[Mapping[str, Any]]) -> dict[int, Outcome]:
    """Return the outcomes of a store by their trials, each opened with the commitment published last before it.

    Raises
    ------
    InputError
        With the number of the trial, if one does not open.
    """
    published: dict[int, str] = {}
    outcomes: dict[int, Outcome] = {}
    for number, line in enumerate(lines[1:], start=2):
        index = line.get("trial")
        where = f"{path}, line {number}: trial {index}"
        if not isinstance(index, int) or ("commitment" in line) == ("outcome" in line):
            raise InputError(f"{path}, line {number}: neither a commitment nor an outcome; it was changed")
        if index in outcomes:
            raise InputError(f"{where}: has entries after it was opened; the store was changed")
        if "commitment" in line:
            published[index] = str(line["commitment"])
            continue
        if index not in published:
            raise InputError(
                f"{where}: opened, but no commitment was published before; the store was changed"
            )
        outcomes[index] = _opened(where, index, line["outcome"], published[index])
    return outcomes


def _opened(where: str, index: int, document: Mapping[str, Any], commitment: str) -> Outcome:
    try:
        outcome = Outcome.from_json(document)
        open_seal(outcome.sealed, commitment)
    except ModalkitError as error:
        raise InputError(f"{where}: {error}") from error
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(
            f"{where}: cannot be read ({type(error).__name__} {error}); it was changed"
        ) from error
    if outcome.index != index:
        raise InputError(f"{where}: holds the outcome of trial {outcome.index}; the store was changed")
    return outcome


def _header(seed: int, plan: DrawRanges) -> dict[str, Any]:
    salt = secrets.token_hex(SALT_BYTES)
    return {
        "schema": SCHEMA,
        "version": __version__,
        "plan": _plain(plan),
        "seed": {"salt": salt, "pbkdf2_sha256": _digest(seed, salt)},
    }


def _plain(plan: DrawRanges) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(json.dumps(asdict(plan)))
    return content


def _digest(seed: int, salt: str) -> str:
    return hashlib.pbkdf2_hmac("sha256", str(seed).encode(), bytes.fromhex(salt), _ROUNDS).hex()


def _check_header(path: Path, header: Mapping[str, Any]) -> None:
    if header.get("schema") != SCHEMA or not {"version", "plan", "seed"} <= header.keys():
        raise InputError(f"{path}: not a store of a blind run ({SCHEMA}); name another file")
    seed = header["seed"]
    try:
        bytes.fromhex(seed["salt"])
        bytes.fromhex(seed["pbkdf2_sha256"])
    except (TypeError, KeyError, ValueError) as error:
        raise InputError(f"{path}, line 1: the hash of the seed cannot be read; it was changed") from error
    if not isinstance(header["plan"], dict) or not isinstance(header["version"], str):
        raise InputError(f"{path}, line 1: plan or version cannot be read; it was changed")


def _check_seed(path: Path, header: Mapping[str, Any], seed: int) -> None:
    digest = _digest(seed, header["seed"]["salt"])
    if not hmac.compare_digest(digest, header["seed"]["pbkdf2_sha256"]):
        raise InputError(
            f"{path}: the run was started with a seed other than {seed}; give the --seed that it printed"
        )


def _check_run(path: Path, header: Mapping[str, Any], seed: int, plan: DrawRanges) -> None:
    """Refuse a store of another version, plan or seed: its outcomes are not those of this run."""
    if header["version"] != __version__:
        raise InputError(
            f"{path}: made by modalkit {header['version']}, this is {__version__}; name another file, or resume with "
            "that version"
        )
    now = _plain(plan)
    for name in sorted(now.keys() | header["plan"].keys()):
        was, stated = header["plan"].get(name), now.get(name)
        if was != stated:
            raise InputError(
                f"{path}: the run was started with {name} = {was}, now it is {stated}; resume with the same options"
            )
    _check_seed(path, header, seed)
