"""How often a clean hit raises an alarm and a faulty one is found, over random measuring chains.

Run: OPENBLAS_NUM_THREADS=1 uv run python benchmarks/bench_hits.py [cases per kind]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "acquisition" / "hits"))
import hit_cases as cases

from acquisition.hits.quality import judge_hits

FORCES = {
    "clean": ({}, ""),
    "clean, low-pass 4th-8th order, any kind": ({"filtered": "any"}, ""),
    "clean, linear phase (pre-ringing)": ({"filtered": "fir"}, ""),
    "clean, filtered below the pulse's band": ({"filtered": "any", "lowest": 0.4}, ""),
    "second hit of 10 %, 1.3-10 widths": ({"second": (1.3, 10), "height": 0.1}, "double"),
    "second hit 10-60 %, 1.3-10 widths": ({"second": (1.3, 10)}, "double"),
    "second hit 10-60 %, on the tail (0.9-1.3 widths)": ({"second": (0.9, 1.3)}, "double"),
    "second hit 10-60 %, late (20-400 widths)": ({"second": (20, 400)}, "double"),
    "smaller hit before the main one": ({"second": (-6, -1.3)}, "double"),
    "second hit of 10 %, filtered, 2-10 widths": (
        {"second": (2, 10), "height": 0.1, "filtered": "any"},
        "double",
    ),
    "second hit 10-60 %, filtered, 1.3-2 widths": ({"second": (1.3, 2), "filtered": "any"}, "double"),
    "force clipped at 60-95 %": ({"clip": (0.6, 0.95)}, "overload"),
    "force clipped at 60-90 %, then filtered": ({"clip": (0.6, 0.9), "filtered": "any"}, "overload"),
}
RESPONSES = {
    "response clipped": ("clip", "overload"),
    "response clipped, then filtered": ("clip and filter", "overload"),
    "response cut off to zeros": ("cut", "cut off"),
    "response cut off, cable noise left": ("mute", "cut off"),
    "response drops out and comes back": ("drop", "drops out"),
}
TESTS = {
    "5 clean hits": ("", ""),
    "5 hits, 2 or more at the converter's limit": ("limit", "overload"),
    "5 hits, one of a twentieth": ("weak", "too weak"),
    "5 hits, one elsewhere": ("elsewhere", "outlier"),
}


def main() -> None:
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    rng = np.random.default_rng(1)
    begin = time.perf_counter()
    for name, (faults, word) in FORCES.items():
        hits = []
        for _ in range(number):
            s = cases.setting(rng)
            drawn = {k: rng.uniform(*v) if k == "clip" else v for k, v in faults.items()}
            if "clip" in faults:
                # a clipped top wants some samples, and no noise beyond the converter's own
                s = cases.setting(rng, rate=(8e3, 5e4))
                s = s if "filtered" in faults else cases.Setting(**{**vars(s), "noise": 0.0})
            hits.append((judge_hits(cases.one_force(rng, s, **drawn)), {0} if word else set()))
        report(name, word, hits)
    for name, (fault, word) in RESPONSES.items():
        hits = []
        for _ in range(number):
            s = cases.setting(rng, rate=(8e3, 5e4))
            hits.append((judge_hits(cases.one_response(rng, s, fault)), {0}))
        report(name, word, hits)
    for name, (fault, word) in TESTS.items():
        hits = []
        for _ in range(max(80, number // 5)):
            test, bad = cases.several(rng, cases.setting(rng), fault)
            hits.append((judge_hits(test), bad))
        report(name, word, hits)
    print(f"{time.perf_counter() - begin:.0f} s")


def report(name: str, word: str, judged: list) -> None:
    found = [
        any(word in r for r in verdicts[i].reasons) and not verdicts[i].used
        for verdicts, bad in judged
        for i in bad
    ]
    alarms = [not v.used for verdicts, bad in judged for i, v in enumerate(verdicts) if i not in bad]
    parts = [interval("found", found)] if found else []
    parts += [interval("false alarms", alarms)] if alarms else []
    print(f"{name:52s} {'; '.join(parts)}", flush=True)


def interval(what: str, outcomes: list) -> str:
    result = binomtest(sum(outcomes), len(outcomes))
    low, high = result.proportion_ci(method="exact")
    return f"{what} {sum(outcomes)}/{len(outcomes)} ({100 * low:.1f}-{100 * high:.1f} %)"


if __name__ == "__main__":
    main()
