"""Whether a test looks as if it were not of this model: single wild frequencies, or all of them."""

from __future__ import annotations

import numpy as np

from acquisition.quantities import hertz, percent
from updating.problem.specimen import SpecimenProblem


def notes_on_doubtful(
    problem: SpecimenProblem,
    explained: str = "",
    *,
    another: float = 0.5,
    alone: float = 0.08,
    deviations: float = 6.0,
) -> list[str]:
    """Return what ought to be checked before an answer is believed.

    Parameters
    ----------
    problem : Problem
        Test and model.
    explained : str, optional
        What the answer states causes the gap; left out, nothing that is sure.
    another : float
        R.m.s. error of the frequencies from which test and model are hardly the same structure [-]: a stiffness off
        by a factor of two and more. Doubled: the warning comes for models in wrong units only.
    alone, deviations : float
        A frequency so far from the others' median error [-], and so many times the median deviation of the others [-],
        stands alone. Judged: few effects move one mode only, and none by that much. Doubled: only mistaken modes are
        still pointed out. Of fewer than four modes none can be identified as deviating: half of them would be.
    """
    test, model = problem.measured, problem.nominal
    error = np.log(model.frequency / test.frequency)
    if not np.isfinite(error).all():
        return []
    notes = []
    if np.sqrt(np.mean(np.expm1(error) ** 2)) > another:
        if explained:
            return []
        size = 100 * np.sqrt(np.mean(np.expm1(error) ** 2))
        notes.append(
            f"frequencies are {percent(size)} off (r.m.s.): test and model are probably different "
            "structures, or the modes are wrongly paired; first check size, material, clamps and band"
        )
        return notes
    if len(error) >= 4:
        away = np.abs(error - np.median(error))
        bar = max(alone, deviations * float(np.median(away)))
        settle = "check for a mistake or a wrong pair before you draw conclusions"
        if explained:
            settle = (
                f"{explained} explains it and depends on it: make sure that it is neither a mistake "
                "nor another mode"
            )
        notes += [
            f"the mode at {hertz(test.frequency[i])} deviates from the others: the model is off by "
            f"{100 * np.expm1(error[i]):+.0f} % there and by {100 * np.expm1(np.median(error)):+.0f} % in "
            f"most other modes; {settle}"
            for i in np.flatnonzero(away > bar).tolist()
        ]
    return notes
