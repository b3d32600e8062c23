"""Are the modes of realistic hammer tests all found, none invented, and do 95 % intervals hold the truth?

Noise of the force and the place of a hit are common to all outputs of that hit, and filters, converters and drift
leave traces that no independent noise has. These kinds of test are simulated from poles and residues:

* ``beam``: a roving hammer along a cantilever, one accelerometer;
* ``plate``: a roving hammer on a plate clamped along one edge, two accelerometers, pairs of modes now and then;
* ``array``: the same plate or cantilever hit at one or two points, with accelerometers at all others;
* ``roving``: 74 points and three references, two pairs of modes closer than 2 %, and frequencies that differ by
  0.1 to 0.2 % (one standard deviation) from point to point as the set-up is moved;
* ``long``: a beam hit once or more in records ten times as long as it rings, with no window;
* ``force_window``: a beam whose analyser sets the force to zero behind the pulse and puts an exponential window on the
  responses alone;
* ``odd mounting``: ``beam``, one point of which is hit with another mounting, by which frequencies fall by 1 to 4 %;
* ``softening``, ``hardening``: ``beam``, hit with forces that scatter by 60 %, whose frequencies follow the force
  by up to 2 % at its median. Poles alone follow it: there are no products of modes;
* ``absorber``: ``beam`` with an absorber on it, tuned near one of its modes: a mode of 1 to 5 % beside sharp ones;
* ``averaged``: FRFs averaged over blocks with a Hann window, the force random, lines as wide as the peaks;
* ``coarse``: FRFs on lines half as far apart as peaks are wide up to twice, half of them smoothed over three lines;
* ``fading``: ``averaged`` with a force that gets weak from 0.6 of the band's end on; half of them with coherence.

    python benchmarks/bench_hammer.py --kinds beam plate roving --seeds 50

A mode *stands out* if the power of its own peak is ten times that of the noise, the middle one of all FRFs.
*Level* is the median of identified over true modal constants: least, middle and largest of all tests.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

import numpy as np
from hammer.counts import Outcome
from hammer.kinds import DRAWN
from hammer.trial import judged
from scipy import stats


def share(good: int, total: int) -> str:
    """Return a count with its 95 % interval."""
    low, high = stats.binomtest(good, max(total, 1)).proportion_ci(0.95)
    return f"{good}/{total} = {100 * good / max(total, 1):.1f} % [{100 * low:.1f}, {100 * high:.1f}]"


def _spread(levels: list[float]) -> str:
    """Return the least, middle and largest level."""
    known = np.array([level for level in levels if np.isfinite(level)])
    return " ".join(f"{x:.3f}" for x in np.quantile(known, [0, 0.5, 1])) if len(known) else "unknown"


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", default=list(DRAWN), choices=DRAWN)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    everything: list[Outcome] = []
    for kind in arguments.kinds:
        here = [judged(kind, seed) for seed in range(arguments.first, arguments.first + arguments.seeds)]
        everything += here
        for o in here:
            if o.missed or o.invented:
                print(f"  {kind} {o.seed}: missed {[round(f, 2) for f in o.missed]}, invented {o.invented}")
        found, modes = sum(o.found for o in here), sum(o.modes for o in here)
        missed, invented = sum(len(o.missed) for o in here), sum(len(o.invented) for o in here)
        print(
            f"{kind}: {len(here)} tests, {modes} modes stand out, {missed} missed, {invented} invented in "
            f"{sum(bool(o.invented) for o in here)} tests; 95 % intervals hold frequency "
            f"{share(sum(o.frequency_inside for o in here), found)}, damping "
            f"{share(sum(o.damping_inside for o in here), found)}; level "
            f"{_spread([o.level for o in here])}; {np.mean([o.cpu for o in here]):.2f} s of CPU each",
            flush=True,
        )
    if arguments.json:
        with open(arguments.json, "w") as stream:  # noqa: PTH123
            json.dump([asdict(o) for o in everything], stream)


if __name__ == "__main__":
    main()
