"""What has to be sure before a gap is explained: that model and data are good enough to state one.

A model that is coarser, or a theory that is simpler, than the noise allows shows a gap of its own, and a search would
find some effect for it. How far mesh and theory are off, :mod:`updating.problem.theory_error` estimates.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import hertz, percent, quantity
from updating.models.accuracy import CHANGED, every_second, reduction_error
from updating.models.spec import Spec
from updating.prediction.predict import Predictor
from updating.problem.theory_error import TheoryError
from updating.test_data.measured import Measured
from updating.thresholds import IMPORTED_MESH_DOUBT


def notes_on(found: TheoryError, measured: Measured, spec: Spec) -> list[str]:
    """Return notes where mesh or theory are off by more than the noise of the frequencies.

    Parameters
    ----------
    found : TheoryError
        What mesh and theory are off by, of the modes measured.
    measured : Measured
        The test.
    spec : Spec
        The model.
    """
    if not found.known:
        solid = spec.imported is not None and spec.imported.places.solid
        doubt = (
            f"; each frequency may be off by up to {_percent(IMPORTED_MESH_DOUBT)} (1 sigma)" if solid else ""
        )
        return [f"the mesh of imported matrices cannot be refined, so its convergence is not checked{doubt}"]
    noise = np.hypot(measured.frequency_sigma / measured.frequency, measured.repeatability)
    notes = []
    worst = int(np.argmax(np.abs(found.mesh) / noise))
    if abs(found.mesh[worst]) > noise[worst]:
        notes.append(
            f"the error of the mesh in mode {worst + 1} is {_percent(found.mesh[worst])}, more than the noise of "
            f"{_percent(noise[worst])}: use more elements"
        )
    worst = int(np.argmax(np.abs(found.theory) / noise))
    if abs(found.theory[worst]) > noise[worst]:
        notes.append(
            f"{spec.theory} theory neglects shear and rotary inertia: {_percent(found.theory[worst])} in mode "
            f'{worst + 1}, more than the noise of {_percent(noise[worst])}; theory = "{spec.fuller}" includes them'
        )
    worst = int(np.argmax(found.width / noise))
    if found.width[worst] > noise[worst]:
        notes.append(
            "beam theory ignores bending across the width and its restraint at clamps: up to "
            f"{_percent(found.width[worst])} in mode {worst + 1}, more than the noise of {_percent(noise[worst])}; "
            'this is treated as model uncertainty. type = "plate" includes both'
        )
    return notes


def on_reduction(predictor: Predictor, count: int) -> list[str]:
    """Return a note on how far the reduced basis of imported matrices is off in the lowest ``count`` modes."""
    reduced, imported = predictor.reduced, predictor.spec.imported
    size = reduced.basis.shape[1]
    if imported is None or not imported.stiffness_parts or size >= reduced.structure.unknowns:
        return []
    worst = float(reduction_error(reduced, every_second(reduced), count).max())
    return [
        f"the model of {reduced.structure.n_dofs} degrees of freedom is reduced to {size} shapes: frequencies are off "
        f"by at most {_percent(worst)}, checked with every second region at {CHANGED:g} of its stiffness"
    ]


def _percent(share: float) -> str:
    return percent(100 * abs(share))


def on_modes(
    measured: Measured, predicted: FloatArray, order: IntArray | None = None, *, fewest: int = 3
) -> list[str]:
    """Return notes on too few modes and, where only frequencies are known, on a mode that seems to be missing.

    Parameters
    ----------
    measured : Measured
        The test.
    predicted : (n,) array
        The model's frequencies from the lowest, at least one more than the test has [Hz].
    order : (n_modes,) int array, optional
        Rank of the model mode of each measured one; left out, its own. Where the pairing has left modes out already,
        no further warning is given.
    fewest : int
        With fewer modes paired few effects can be separated: an effect and the tolerances are as many.
    """
    count = len(measured.frequency)
    notes = []
    if count < fewest:
        notes.append(f"only {count} mode{'s' * (count > 1)} paired: few effects can be separated")
    if measured.has_shapes or (order is not None and np.any(order != np.arange(count))):
        return notes
    skipped = missing_mode(measured.frequency, predicted)
    if skipped is not None:
        notes.append(
            f"without shapes, modes are paired by rank. From mode {skipped + 1} on they fit far better if the test "
            f"missed the model's mode {skipped + 1} at {hertz(predicted[skipped])}: check whether a mode is missing"
        )
    return notes


def missing_mode(
    test: FloatArray, model: FloatArray, *, gain: float = 4.0, unlike: float = 0.02
) -> int | None:
    """Return after how many modes one seems to be missing in a sequence of frequencies, or None.

    Parameters
    ----------
    test : (n,) array
        Measured frequencies [Hz].
    model : (m,) array
        The model's from the lowest [Hz].
    gain : float
        By how much leaving one out must lower the scatter of the frequency ratios [-]. Judged. Doubled: fewer
        warnings, of test and model paired by rank.
    unlike : float
        Scatter of the frequency ratios, relative, below which nothing is suspected [-]: what most effects make.

    Returns
    -------
    int or None
        Rank of the model mode that the test skipped: leaving it out lowers the scatter of the ratios of frequency
        about their mean to a quarter. A factor common to all modes does not count: it is what is sought.
    """
    count = len(test)
    if count < 3 or len(model) <= count:
        return None
    plain = float(np.std(np.log(test / model[:count])))
    ranks = np.arange(count)[None, :] + (np.arange(count)[None, :] >= np.arange(1, count)[:, None])
    scatter = np.std(np.log(test[None, :] / model[ranks]), axis=1)
    best = int(np.argmin(scatter))
    suspect = plain > unlike and plain > gain * scatter[best]
    return best + 1 if suspect else None


def on_levels(measured: Measured, *, fluid: bool) -> list[str]:
    """Return a note where frequencies follow the force of the hits beyond chance.

    Parameters
    ----------
    measured : Measured
        The test.
    fluid : bool
        Whether the structure is in a fluid that was taken to be still.
    """
    if measured.slope is None or measured.slope_sigma is None or not measured.level:
        return []
    known = np.isfinite(measured.slope) & (measured.slope_sigma > 0)
    if not known.any():
        return []
    weight = 1 / measured.slope_sigma[known] ** 2
    slope, sigma = float(weight @ measured.slope[known] / weight.sum()), float(1 / np.sqrt(weight.sum()))
    chi = float(np.sum(weight * measured.slope[known] ** 2))
    beyond = chi > known.sum() + 4.5 * np.sqrt(2.0 * known.sum())
    if abs(slope) < 4 * sigma and not beyond:
        return []
    size = 100 * slope * measured.level
    stated = f"frequencies follow the force of the hits: {size:+.2g} % on average at {quantity(measured.level, 'N')}"
    if fluid:
        return [
            f"{stated}; the fluid moves, or a joint is nonlinear: the added "
            "mass is computed for small motion in a fluid at rest"
        ]
    return [f"{stated}: the structure is not linear at the level of this test; hit more softly"]
