"""Sampled records of a synthetic hammer test, exact up to rounding."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.fft

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import InputError
from acquisition.form import FORMS
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.synthetic.faults import clip, coloured, cut_off, quantise
from acquisition.synthetic.procedure import HammerPlan
from acquisition.synthetic.pulses import anti_alias, pulse_transform, ringing, sharp_anti_alias
from acquisition.synthetic.system import ModalSystem


def hammer_test(
    system: ModalSystem | Callable[[float], ModalSystem],
    plan: HammerPlan,
    *,
    rng: np.random.Generator,
    geometry: Geometry | None = None,
    at_hit: Callable[[int, int, float], ModalSystem] | None = None,
) -> HammerTest:
    """Hit a structure and record force and responses.

    The continuous response to the continuous pulse passes the same anti-aliasing filter as the force and is
    then sampled. It is found in the frequency domain on a line right of the imaginary axis (numerical
    Laplace inversion), over twice the record, so that nothing wraps round however light the damping: what
    has not decayed at the end of a record is cut off there, as in reality.

    Parameters
    ----------
    system : ModalSystem or callable
        The structure, or a function from the peak force of a hit [N] to the structure at that level.
    plan : HammerPlan
        How it is hit and recorded.
    rng : numpy.random.Generator
        Source of all scatter and noise.
    geometry : Geometry, optional
        Nodes of the test.
    at_hit : callable, optional
        Row of the point, hit and peak force [N] to the structure at that very hit, where it changes from hit to
        hit; default ``system`` at the level.

    Raises
    ------
    InputError
        If a hit is to land in the wrong place and there is only one point.
    """
    at_level = system if callable(system) else (lambda level: system)
    first = at_level(plan.peak)
    if "wrong place" in plan.bad.values() and len(first.points) < 2:
        raise InputError("hammer plan: a hit in the wrong place needs a system with a second point")
    contour = _Contour.over(plan)
    count = len(first.points)
    drift = 1.0 + plan.drift * rng.standard_normal(count) if plan.drift else np.ones(count)
    force = np.empty((count, plan.hits, plan.samples))
    motion = np.empty((count, plan.hits, len(first.responses), plan.samples))
    for point, hit in np.ndindex(count, plan.hits):
        now = at_level if at_hit is None else partial(at_hit, point, hit)
        if plan.drift:
            now = partial(_drifted, now, float(drift[point]))
        force[point, hit], motion[point, hit] = _one_hit(now, plan, contour, (point, hit), rng)
    force, motion = _converted(force, motion, plan)
    return HammerTest(
        rate=plan.rate,
        points=tuple(
            Hits(reference=dof, responses=first.responses, force=f, motion=m)
            for dof, f, m in zip(first.points, force, motion, strict=True)
        ),
        form=plan.form,
        decay=plan.decay,
        geometry=Geometry.empty() if geometry is None else geometry,
        source="synthetic hammer test",
    )


@dataclass(frozen=True, eq=False)
class _Contour:
    """The line s = shift + i omega and the way back from it to samples."""

    laplace: ComplexArray
    gain: FloatArray | ComplexArray
    growth: FloatArray
    length: int
    rate: float

    @classmethod
    def over(cls, plan: HammerPlan) -> _Contour:
        length = scipy.fft.next_fast_len(2 * plan.samples, real=True)
        shift = 30.0 * plan.rate / length
        frequency = np.asarray(np.fft.rfftfreq(length, 1 / plan.rate), dtype=np.float64)
        laplace = np.asarray(shift + 2j * np.pi * frequency, dtype=np.complex128)
        smooth = plan.anti_alias == "smooth"
        return cls(
            laplace=laplace,
            gain=anti_alias(frequency, plan.rate) if smooth else sharp_anti_alias(laplace, plan.rate),
            growth=np.exp(shift * np.arange(plan.samples) / plan.rate),
            length=length,
            rate=plan.rate,
        )

    def samples(self, transform: ComplexArray) -> FloatArray:
        """Return the samples whose Laplace transform on the contour is given, along the last axis."""
        wave = scipy.fft.irfft(transform * self.gain * self.rate, self.length, axis=-1)
        return np.asarray(wave[..., : len(self.growth)] * self.growth, dtype=np.float64)


def _drifted(at_level: Callable[[float], ModalSystem], factor: float, level: float) -> ModalSystem:
    return at_level(level).with_frequencies(factor)


def _one_hit(
    at_level: Callable[[float], ModalSystem],
    plan: HammerPlan,
    contour: _Contour,
    place: tuple[int, int],
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray]:
    """Return the force record and the response records of one hit, noise included."""
    kind = plan.bad.get(place)
    scatter = rng.standard_normal(5)
    level = plan.peak * np.exp(plan.level_scatter * scatter[0]) * (0.03 if kind == "weak" else 1.0)
    width = plan.width * np.exp(plan.width_scatter * scatter[1])
    start = plan.pre_trigger + plan.jitter * scatter[2] + rng.uniform() / plan.rate
    s = contour.laplace
    push = level * pulse_transform(s, width, plan.pulse) * np.exp(-s * start)
    second = rng.uniform((0.15, 4 * plan.width), (0.5, 4 * plan.width + 0.015))
    if plan.ringing:
        push = push * (1 + ringing(s, width, plan.ringing))
    if kind == "double":
        push = push * (1 + second[0] * np.exp(-s * second[1]))
    structure = at_level(float(level))
    landed = (place[0] + (kind == "wrong place")) % len(structure.points)
    receptance = structure.receptance(s, landed, plan.position_sigma * scatter[3:])
    transducer = plan.gain * s ** FORMS.index(plan.form) * np.exp(-s * plan.delay)
    force, motion = contour.samples(push), contour.samples(receptance * (transducer * push))
    largest = np.abs(motion).max(axis=-1, keepdims=True)
    force = force + plan.force_noise * coloured(rng.standard_normal(force.shape), plan.noise_slope)
    noise = plan.noisy.get(place[0], 1.0) * np.hypot(plan.response_noise * largest, plan.response_floor)
    motion = motion + noise * coloured(rng.standard_normal(motion.shape), plan.noise_slope)
    if kind == "clipped":
        return clip(force), clip(motion)
    return force, cut_off(motion) if kind == "cut" else motion


def _converted(force: FloatArray, motion: FloatArray, plan: HammerPlan) -> tuple[FloatArray, FloatArray]:
    """Return the records as the converter and the exponential window leave them."""
    if plan.adc_bits is not None:
        scale = plan.headroom * np.abs(force).max(keepdims=True)
        force = quantise(force, plan.adc_bits, scale if plan.force_range is None else plan.force_range)
        scale = plan.headroom * np.abs(motion).max(axis=(0, 1, 3), keepdims=True)
        motion = quantise(
            motion, plan.adc_bits, scale if plan.response_range is None else plan.response_range
        )
    time = np.arange(plan.samples) / plan.rate
    window = np.exp(-plan.decay * (time - plan.pre_trigger))
    return force * window, motion * window
