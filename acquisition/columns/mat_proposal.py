"""A layout written for a MATLAB file of FRFs: which variable is what, and what the file does not state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.columns.guesses import is_even, is_rate, text_of


@dataclass(frozen=True, eq=False)
class FrfArray:
    """An array of FRFs, and what makes its lines.

    Parameters
    ----------
    name : str
        Its name.
    shape : tuple of int
        Its dimensions.
    axis : int
        Which of them are the lines.
    lines, rate : str
        Variable of the lines, or of the sampling rate; one of them is "".
    hertz : float
        The last line, or the sampling rate [Hz].
    """

    name: str
    shape: tuple[int, ...]
    axis: int
    lines: str
    rate: str
    hertz: float


def frf_array(values: Mapping[str, AnyArray]) -> FrfArray | None:
    """Return the array of FRFs among variables: complex, along lines that rise in even steps or that a rate makes.

    Parameters
    ----------
    values : mapping of str to array
        All variables of numbers.
    """
    frfs = {name: v for name, v in values.items() if np.iscomplexobj(v) and v.ndim <= 3 and v.size > 2}
    if not frfs:
        return None
    name = max(frfs, key=lambda n: frfs[n].size)
    shape = frfs[name].shape
    real = {n: np.asarray(v, dtype=np.float64).ravel() for n, v in values.items() if not np.iscomplexobj(v)}
    for lines, axis_values in real.items():
        if len(axis_values) > 2 and len(axis_values) in shape and is_even(axis_values):
            return FrfArray(name, shape, shape.index(len(axis_values)), lines, "", float(axis_values[-1]))
    for rate, number in real.items():
        if is_rate(rate) and len(number) == 1:
            return FrfArray(name, shape, int(np.argmax(shape)), "", rate, float(number[0]))
    return None


def of_mat(found: FrfArray) -> list[str]:
    """Return the lines of a layout for an array of FRFs."""
    count = found.shape[found.axis]
    others = [n for i, n in enumerate(found.shape) if i != found.axis]
    names = ["response" if n == max(others) else "reference" for n in others]
    if len(names) == 2 and names[0] == names[1]:
        names = ["response", "reference"]
    axes = [*names[: found.axis], "line", *names[found.axis :]]
    sizes = dict(zip(names, others, strict=True))
    if found.lines:
        above, lines = (
            [],
            [f"frequency = {text_of(found.lines)}  # rises in even steps to {found.hertz:g} Hz"],
        )
    else:
        lines = []
        above = [
            f"rate = {text_of(found.rate)}  # {found.hertz:.9g} Hz: by its name",
            f"samples = {2 * count - 2}  # number transformed; or {2 * count - 1}, or {count} if the lines go on to "
            "the rate: correct it",
            "",
        ]
    return [
        *above,
        "[mat]",
        *lines,
        f"frfs = {text_of(found.name)}  # complex, {' x '.join(map(str, found.shape))}",
        f"axes = [{', '.join(map(text_of, axes))}]  # by their lengths: correct response and reference",
        'quantity = "accelerance"  # not in the file: correct it (mobility, receptance)',
        '# unit = "g/N"  # not in the file: SI units are assumed; correct it',
        _places("responses", sizes.get("response", 1), "where it was measured"),
        _places("references", sizes.get("reference", 1), "where it was hit"),
    ]


def _places(key: str, count: int, what: str) -> str:
    places = [text_of(f"{n + 1}+Z") for n in range(count)]
    return f"{key} = [{', '.join(places)}]  # {what}, not in the file: correct it"
