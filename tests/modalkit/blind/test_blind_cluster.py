"""Trials on a cluster of two worker processes: the same results, whatever happens to the workers."""

from __future__ import annotations

import builtins
import os
import signal
import socket
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import blind_stub
import pytest

from acquisition.errors import InputError
from modalkit.blind import DrawRanges, Outcome, check_store, run_blind
from modalkit.blind.cluster import cluster_outcomes
from modalkit.workers import cluster as cluster_module
from modalkit.workers.cluster import Keeper

pytestmark = pytest.mark.long

distributed = pytest.importorskip("distributed")

FAST = DrawRanges(kinds=("beam",), effects=("none", "E", "clamp_rotation"), pairs=0.0, outside=0.0)


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit=0
    ) as cluster:
        yield cluster


def stated(outcomes: Mapping[int, Outcome]) -> list[dict[str, Any]]:
    return [outcomes[i].to_json() | {"salt": "", "seconds": 0} for i in sorted(outcomes)]


@pytest.fixture(scope="module")
def alone() -> list[dict[str, Any]]:
    return stated({o.index: o for o in run_blind(6, 5, plan=FAST, diagnose=blind_stub.diagnose).outcomes})


def test_the_cluster_gives_what_one_machine_gives(
    cluster: Any, alone: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "run.jsonl"
    address = cluster.scheduler_address
    run_blind(3, 5, plan=FAST, scheduler=address, store=path, diagnose=blind_stub.diagnose)
    result = run_blind(
        6, 5, plan=FAST, scheduler=address, store=path, resume=True, diagnose=blind_stub.diagnose
    )
    assert stated({o.index: o for o in result.outcomes}) == alone
    assert stated(check_store(path, seed=5).outcomes) == alone


def test_commitments_come_before_outcomes_and_a_lost_worker_loses_nothing(
    cluster: Any, alone: list[dict[str, Any]]
) -> None:
    published: dict[int, list[str]] = {}
    outcomes: dict[int, Outcome] = {}
    victims = worker_pids(cluster)[:1]
    for outcome in cluster_outcomes(
        range(6), seed=5, plan=FAST, scheduler=cluster.scheduler_address,
        publish=lambda i, c: published.setdefault(i, []).append(c),
        command=blind_stub.command("slow", 0.3),
    ):  # fmt: skip
        assert outcome.sealed.commitment == published[outcome.index][-1]
        outcomes[outcome.index] = outcome
        while victims:
            os.kill(victims.pop(), signal.SIGKILL)
    assert stated(outcomes) == alone


def worker_pids(cluster: Any) -> list[int]:
    with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
        return list(client.run(os.getpid).values())


def test_a_scheduler_that_is_not_there_is_an_error() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    with pytest.raises(InputError, match="no answer there; start one"):
        run_blind(1, 5, plan=FAST, scheduler=address)


@pytest.mark.parametrize("address", ["nonsense://", "tcp://", "", "localhost", "tcp://host:port"])
def test_an_address_that_is_none_is_an_error(address: str) -> None:
    with pytest.raises(InputError, match="not an address"):
        run_blind(1, 5, plan=FAST, scheduler=address)


def test_somebody_else_at_the_address_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "_CONNECT", 0.5)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(InputError, match="is not a compatible Dask scheduler"):
            run_blind(1, 5, plan=FAST, scheduler=address)


def test_a_missing_extra_is_an_error_that_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    found = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.partition(".")[0] == "distributed":
            raise ImportError(name)
        return found(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"pip install 'modalkit-ema\[cluster\]'"):
        run_blind(1, 5, plan=FAST, scheduler="tcp://127.0.0.1:8786")


class Worker:
    address = "tcp://worker:1"


def test_another_version_on_a_worker_is_refused() -> None:
    with pytest.raises(InputError, match=r"the run 9\.9; install the same"):
        Keeper(version="9.9").setup(Worker())


def test_no_process_is_started_on_a_worker_where_none_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "warm_pool", None)  # cannot be called
    keeper = Keeper(command=None)
    keeper.setup(Worker())
    keeper.teardown(Worker())
