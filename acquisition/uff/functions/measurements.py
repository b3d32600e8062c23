"""Functions in SI units: what each data set 58 measures."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.uff.functions.header58 import Header58
from acquisition.uff.functions.quantities import quantity_of
from acquisition.uff.functions.stored import Values, put
from acquisition.uff.functions.units import Quantity, Units, abscissa_factor
from acquisition.uff.functions.values58 import Located

FUNCTION_TYPES = {
    0: "general function",
    1: "time record",
    2: "auto-spectrum",
    3: "cross-spectrum",
    4: "FRF",
    5: "transmissibility",
    6: "coherence",
    7: "auto-correlation",
    8: "cross-correlation",
    9: "power spectral density",
    10: "energy spectral density",
    11: "probability density",
    12: "spectrum",
    25: "orders",
}
# The largest value that can be meant [SI]: its square must not overflow. Doubling it changes nothing.
LARGEST = 1e100


@dataclass(frozen=True, eq=False)
class Measurement:
    """One function, whose numbers are read when their place in memory is there.

    Parameters
    ----------
    function_type : int
        1, 2, 3, 4, 6 or 9.
    quantity : str
        Form of the motion or FRF, or "force"; "other" for a coherence.
    response, reference : Dof
        Degrees of freedom.
    minimum, step : float
        First abscissa and spacing [s or Hz].
    values : Values or None
        Where the ordinate is; None where the data set is broken, so that its place in the count of hits is kept.
    factor : float
        What turns the values into SI [-].
    decay : float
        Decay of an exponential window, as the data set states it [1/s].
    place : str
        File, data set and line, for messages.
    averages : int
        Number of averages, 0 if not stated.
    file, order : int
        Which file it is from, and its place in the order of all records.
    hit, stamp : str
        Number of the hit and ID line with the time of day, as the data set states them.
    single : bool
        Whether it is a time record that the file calls single precision, though its text is read as double.
    density : bool or None
        Whether a spectrum is per hertz; None if not stated.
    key : bytes
        Digest of header and values, to find copies.
    """

    function_type: int
    quantity: Quantity
    response: Dof
    reference: Dof
    minimum: float
    step: float
    values: Values | None
    factor: float
    decay: float
    place: str
    averages: int = 0
    file: int = 0
    order: int = 0
    hit: str = ""
    stamp: str = ""
    single: bool = False
    density: bool | None = None
    key: bytes = b""

    @property
    def points(self) -> int:
        """Number of values."""
        return 0 if self.values is None else self.values.points

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Type of the values, 8-byte real numbers where they are broken."""
        kept = np.dtype(np.float64) if self.values is None else self.values.dtype
        return np.dtype(np.float32) if self.single and kept.kind == "f" else kept

    @property
    def axis(self) -> tuple[float, float, int]:
        """First abscissa, spacing and length, rounded so that equal axes compare equal."""
        return float(f"{self.minimum:.6g}"), float(f"{self.step:.6g}"), self.points

    def into(self, out: AnyArray) -> None:
        """Write the values in SI units to an array of their length."""
        assert self.values is not None
        self.values.into(out, self.factor)

    def read(self) -> AnyArray:
        """Return the values in SI units."""
        out = np.empty(self.points, self.dtype)
        self.into(out)
        return out


def measure(
    located: Located, units: Units, place: str, *, file: int, order: int, digest: bool
) -> tuple[Measurement, list[str]]:
    """Check the numbers of a function piece by piece; return what it measures, and what had to be assumed.

    Parameters
    ----------
    located : Located
        The function.
    units : Units
        The file's units.
    place : str
        File, data set and line, for messages.
    file, order : int
        Which file it is from, and its place in the order of all records.
    digest : bool
        Whether to search for copies.

    Raises
    ------
    InputError
        If its abscissa is uneven or it holds values that are not finite.
    """
    header = located.header
    found, notes = described(header, units, place, file=file, order=order)
    minimum, step = _even_abscissa(located)
    seconds = abscissa_factor(header.abscissa)
    key = _checked(located, found, minimum, digest)
    complete = replace(found, values=located.stored, minimum=minimum * seconds, step=step * seconds, key=key)
    return complete, notes


def described(
    header: Header58, units: Units, place: str, *, file: int, order: int
) -> tuple[Measurement, list[str]]:
    """Return a measurement without values, from its header alone, and what had to be assumed."""
    quantity, factor, density, notes = quantity_of(header, units)
    found = Measurement(
        function_type=header.function_type,
        quantity=quantity,
        response=header.response,
        reference=header.reference,
        minimum=0.0,
        step=1.0,
        values=None,
        factor=factor,
        decay=header.decay,
        place=place,
        averages=header.averages,
        file=file,
        order=order,
        hit=header.hit,
        stamp=header.stamp,
        single=header.function_type == 1 and header.item_size == 4,
        density=density,
    )
    return found, [*header.notes, *notes]


def _checked(located: Located, found: Measurement, minimum: float, digest: bool) -> bytes:
    """Look for values that are not finite in SI; return a digest of header and values where one is wanted."""
    factor, spare_first = found.factor, found.function_type in (4, 6) and minimum == 0
    kept = located.stored.dtype
    dtype = np.dtype(np.float32) if found.single and kept.kind == "f" else kept
    total, first_bad = 0, -1
    sum_ = hashlib.blake2b(located.raw_header, digest_size=16)
    for first, values in located.stored.chunks():
        if digest:
            sum_.update(np.ascontiguousarray(values).data)
        scaled = values
        if factor != 1 or values.dtype != dtype:
            scaled = np.empty_like(values, dtype=dtype)
            put(scaled, values, factor)
        plain = scaled.view(scaled.real.dtype)
        if not max(float(plain.max()), -float(plain.min())) < LARGEST:  # nan is not either
            good = np.abs(scaled).astype(np.float64) < LARGEST
            bad = np.flatnonzero(~good) + first
            first_bad = int(bad[0]) if first_bad < 0 else first_bad
            total += len(bad)
    if total and not (spare_first and total == 1 and first_bad == 0):
        raise InputError(
            f"{total} of its {located.header.points} values are not finite or implausibly large, "
            f"the first at point {first_bad + 1}"
        )
    return sum_.digest() if digest else b""


def _even_abscissa(located: Located) -> tuple[float, float]:
    header = located.header
    if header.even:
        return header.minimum, simplest_within(header.increment, header.resolution)
    abscissa = located.abscissa()
    if not np.all(np.abs(abscissa) < 1e30):  # nan is not either
        raise InputError("its abscissa holds values that are not finite")
    steps = np.diff(abscissa)
    step = float((abscissa[-1] - abscissa[0]) / max(len(steps), 1))
    printed = np.spacing(np.float32(np.abs(abscissa).max()))
    if len(steps) == 0 or not 1e-12 < step < 1e12 or np.ptp(steps) > 1e-4 * step + 4 * printed:
        raise InputError("its abscissa is unevenly spaced: resample it evenly")
    return float(abscissa[0]), step


def simplest_within(value: float, tolerance: float) -> float:
    """Return a spacing with the digits that a short printed field cut off.

    A rate of 4096 Hz is printed as an increment of 2.44141e-04. Within the rounding of the field,
    the value whose reciprocal is the simplest fraction is taken.
    """
    if tolerance <= 0 or tolerance >= 1e-3 * value:
        return value
    low, high = 1 / (value + tolerance * 1.0001), 1 / (value - tolerance * 1.0001)
    numerator, denominator = _simplest_fraction(low, high)
    return denominator / numerator


def _simplest_fraction(low: float, high: float) -> tuple[int, int]:
    """Return the fraction with the smallest denominator in [low, high] (Stern-Brocot descent)."""
    whole = int(np.floor(low))
    if whole == low:
        return whole, 1
    if whole + 1 <= high:
        return whole + 1, 1
    numerator, denominator = _simplest_fraction(1 / (high - whole), 1 / (low - whole))
    return whole * numerator + denominator, numerator
