"""Writing 250 FRFs of 8193 lines as binary double UFF: modalkit beside pyuff and beside the bare bytes."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyuff

from acquisition import Dof, FrfSet, read_functions, write_uff

FRFS, LINES = 250, 8193


def seconds(run: Callable[[], None], repeats: int) -> float:
    """Best of some runs [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def theirs(frfs: FrfSet, path: Path) -> None:
    """The same FRFs with pyuff."""
    path.unlink(missing_ok=True)
    sets = [
        pyuff.prepare_58(
            binary=1,
            func_type=4,
            rsp_node=int(response.node),
            rsp_dir=3,
            ref_node=1,
            ref_dir=3,
            data=values,
            x=frfs.frequency,
            id1="FRF",
            rsp_ent_name="NONE",
            ref_ent_name="NONE",
            abscissa_spacing=1,
            abscissa_spec_data_type=18,
            ordinate_spec_data_type=12,
            orddenom_spec_data_type=13,
        )
        for response, values in zip(frfs.responses, frfs.values, strict=True)
    ]
    pyuff.UFF(str(path)).write_sets(sets, mode="add")


def bare(frfs: FrfSet, path: Path) -> None:
    """The same bytes with nothing around them."""
    partial = path.with_suffix(".part")
    with partial.open("wb") as out:
        for values in frfs.values:
            out.write(values.data)
    os.replace(partial, path)  # noqa: PTH105


def main() -> None:
    rng = np.random.default_rng(1)
    values = rng.standard_normal((FRFS, LINES)) + 1j * rng.standard_normal((FRFS, LINES))
    responses = tuple(Dof(i + 1, 3) for i in range(FRFS))
    frfs = FrfSet(0.5 * np.arange(LINES), values, responses, (Dof(1, 3),) * FRFS)
    with tempfile.TemporaryDirectory() as folder:
        one, two, three = (Path(folder) / name for name in ("ours.uff", "theirs.uff", "bare.bin"))
        floor = seconds(lambda: bare(frfs, three), 7)
        own = seconds(lambda: write_uff(one, frfs=frfs), 7)
        peer = seconds(lambda: theirs(frfs, two), 1)
        back = read_functions(one)
        same = len(back) == FRFS and all(
            np.array_equal(f.values, v) for f, v in zip(back, values, strict=True)
        )
    print(
        f"{FRFS} FRFs x {LINES} lines: {own:.3f} s, pyuff {peer:.2f} s, ratio {peer / own:.0f}; "
        f"floor {floor:.3f} s, {own / floor:.2f} times the floor; read back bit for bit: {same}"
    )


if __name__ == "__main__":
    main()
