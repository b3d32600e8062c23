"""How a synthetic hammer test is carried out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from acquisition.errors import InputError
from acquisition.form import FORMS, Form

BadHit = Literal["double", "clipped", "weak", "cut", "wrong place"]
BAD_HITS: tuple[BadHit, ...] = ("double", "clipped", "weak", "cut", "wrong place")


@dataclass(frozen=True)
class HammerPlan:
    """Everything about a synthetic hammer test that is not the structure.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    samples : int
        Samples per record.
    hits : int
        Hits at each point.
    peak : float
        Median peak force [N].
    level_scatter : float
        Standard deviation of the logarithm of the peak force [-].
    width : float
        Length of the pulse from first to last contact [s].
    width_scatter : float
        Standard deviation of the logarithm of the width [-].
    pulse : {"haversine", "half-sine"}
        Shape of the pulse.
    pre_trigger : float
        Time before the hit in each record [s].
    jitter : float
        Standard deviation of the start of the pulse [s]; a fraction of a sample is added in any case, as no
        hammer is synchronised with the sampling clock.
    force_noise : float
        Noise of the force channel, r.m.s. [N].
    response_noise : float
        Noise of each response record, r.m.s. relative to the largest magnitude of that record [-].
    response_floor : float
        Further noise of each response channel, r.m.s. [m/s^2, m/s or m, by ``form``].
    noise_slope : float
        Colour of all noise: its power spectral density goes as frequency to this power, 0 for white, -1 for
        pink, 2 for blue [-].
    adc_bits : int or None
        Resolution of the converter; None for none. The step is a power of two, so that records of up to 24
        bits are exact in single precision.
    headroom : float
        Full scale of each channel relative to its largest value in the test [-].
    force_range, response_range : float or None
        Full scale of the force channel and of the response channels instead; what is beyond saturates
        [N; m/s^2, m/s or m, by ``form``].
    position_sigma : float
        Scatter of the place of each hit along both in-plane axes [m].
    drift : float
        Standard deviation of the frequencies from point to point, as temperature and set-up make it: a factor
        common to all modes while a point is hit [-].
    ringing : float
        Height of the swing at 1 / ``width``, twice the frequency of the pulse, in which the hammer itself goes on
        after it, relative to the pulse's; force and responses both have it [-].
    noisy : mapping of int to float
        Rows of points, from 0, to how many times noisier than the others' their response records are [-].
    anti_alias : {"smooth", "sharp"}
        The filter in front of the converter: one that falls smoothly and does not ring, or an elliptic one of
        eighth order, as converters have, that rings for some tens of samples after a short pulse.
    decay : float
        Decay rate of an exponential window exp(-decay (t - t0)) applied to force and responses, with t0 the
        trigger [1/s]. Windowing both makes the FRFs exact samples of H(i omega + decay).
    gain : float
        Calibration error of the response channels, as a factor [-].
    delay : float
        Time by which the responses lag the force by fault of the equipment [s].
    form : {"receptance", "mobility", "accelerance"}
        Whether displacement, velocity or acceleration is measured.
    bad : mapping of (int, int) to str
        Faulty hits: (row number of the point, hit), both from 0, to "double", "clipped", "weak", "cut" (the
        response dies early) or "wrong place" (the hammer lands on the next point of the system).

    Raises
    ------
    InputError
        If a number is invalid.
    """

    rate: float = 4096.0
    samples: int = 8192
    hits: int = 5
    peak: float = 100.0
    level_scatter: float = 0.2
    width: float = 1e-3
    width_scatter: float = 0.05
    pulse: Literal["haversine", "half-sine"] = "haversine"
    pre_trigger: float = 0.01
    jitter: float = 0.0
    force_noise: float = 0.0
    response_noise: float = 0.0
    response_floor: float = 0.0
    noise_slope: float = 0.0
    adc_bits: int | None = 24
    headroom: float = 1.5
    force_range: float | None = None
    response_range: float | None = None
    position_sigma: float = 0.0
    drift: float = 0.0
    ringing: float = 0.0
    noisy: Mapping[int, float] = field(default_factory=dict)
    anti_alias: Literal["smooth", "sharp"] = "smooth"
    decay: float = 0.0
    gain: float = 1.0
    delay: float = 0.0
    form: Form = "accelerance"
    bad: Mapping[tuple[int, int], BadHit] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the entries."""
        positive = ("rate", "samples", "hits", "peak", "width", "headroom")
        wrong = [name for name in positive if not getattr(self, name) > 0]
        not_negative = ("level_scatter", "width_scatter", "pre_trigger", "jitter", "force_noise", "decay")
        wrong += [
            name for name in (*not_negative, "response_noise", "position_sigma") if getattr(self, name) < 0
        ]
        ranges = ("force_range", "response_range")
        wrong += [name for name in ranges if getattr(self, name) is not None and not getattr(self, name) > 0]
        if wrong:
            raise InputError(f"hammer plan: {wrong[0]} = {getattr(self, wrong[0])} is invalid")
        if self.anti_alias not in ("smooth", "sharp"):
            raise InputError(f'hammer plan: unknown filter {self.anti_alias!r}; use "smooth" or "sharp"')
        if self.form not in FORMS or self.pulse not in ("haversine", "half-sine"):
            raise InputError(f"hammer plan: unknown form {self.form!r} or pulse {self.pulse!r}")
        unknown = set(self.bad.values()) - set(BAD_HITS)
        if unknown:
            raise InputError(
                f"hammer plan: unknown kind of bad hit {unknown}; use one of {', '.join(BAD_HITS)}"
            )
        if self.pre_trigger + self.width >= self.samples / self.rate:
            raise InputError("hammer plan: the record ends before the pulse; take more samples")
