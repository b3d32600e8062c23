"""Memory and time of reading a large file of binary single-precision time records, against its payload."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SAMPLES = 1 << 16
RESPONSES = 3

READER = """
import json, resource, sys, time
import numpy as np
from acquisition import read_uff
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
before, start, told = peak(), time.perf_counter(), []
content = read_uff(sys.argv[1], progress=told.append)
seconds, after = time.perf_counter() - start, peak()
points = content.tests[0].points
kept = sum(p.force.nbytes + p.motion.nbytes for p in points)
dtype = str(points[0].motion.dtype)
print(json.dumps([kept, dtype, before, after, seconds, len(told), told[-1], len(content.warnings)]))
"""


def write(path: Path, megabytes: float) -> None:
    """Write hits of one force and three responses, all at one point, set by set."""
    from acquisition import Dof, HammerTest, Hits, write_uff

    count = max(1, int(megabytes * 1e6 / (4 * SAMPLES * (RESPONSES + 1))))
    rng = np.random.default_rng(1)
    force = rng.standard_normal((4, SAMPLES), dtype=np.float32)
    motion = rng.standard_normal((4, RESPONSES, SAMPLES), dtype=np.float32)
    responses = tuple(Dof(n, 3) for n in (1, 2, 3))
    with path.open("wb") as out:
        for first in range(0, count, 4):
            n = min(4, count - first)
            part = path.with_suffix(".part")
            write_uff(
                part,
                tests=HammerTest(51200.0, (Hits(Dof(1, 3), responses, force[:n], motion[:n]),)),
                precision="single",
            )
            body = part.read_bytes()
            start = body.index(b"    -1\n    58b") if first else 0
            out.write(body[start:].replace(b"hit ", b"    "))
            part.unlink()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("megabytes", nargs="*", type=float, default=[300.0])
    for megabytes in parser.parse_args().megabytes:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "large.uff"
            write(path, megabytes)
            command = [sys.executable, "-c", READER, str(path)]
            environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1])}
            done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
            size = path.stat().st_size
        kept, dtype, before, after, seconds, calls, last, warned = json.loads(done.stdout)
        print(
            f"file {size / 1e6:.0f} MB, payload {kept / 1e6:.0f} MB ({dtype}): peak {after / 1e6:.0f} MB, "
            f"{before / 1e6:.0f} MB of it before reading; "
            f"ratio {after / kept:.2f} in all, {(after - before) / kept:.2f} net; "
            f"{seconds:.1f} s; progress told {calls} times, last {last}; {warned} warnings"
        )


if __name__ == "__main__":
    main()
