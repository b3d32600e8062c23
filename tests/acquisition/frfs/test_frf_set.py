"""What a set of FRFs keeps and what it makes of itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition import FORMS, Dof, FrfSet, InputError

FREQUENCY = np.arange(0.0, 50.0, 0.5)
DOFS = (Dof(1, 3), Dof(2, -3))


def frfs(dtype=np.complex128, **more) -> FrfSet:
    rng = np.random.default_rng(1)
    values = rng.standard_normal((2, 100)) + 1j * rng.standard_normal((2, 100))
    return FrfSet(
        FREQUENCY, values.astype(dtype), DOFS, (Dof(1, 3),) * 2, variance=np.abs(values) ** 2 * 1e-4, **more
    )


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
def test_precision_is_kept(dtype):
    one = frfs(dtype)
    changed = [one, one.band(1.0, 20.0), one.select([1]), one.to("receptance"), one.scaled(2.0)]
    assert {s.values.dtype for s in changed} == {np.dtype(dtype)}
    double = one.double()
    assert double.values.dtype == np.complex128 and np.array_equal(double.values, one.values)
    assert double.double() is double


def test_what_is_read_only_already_is_not_copied():
    values = np.ones((2, 100), dtype=np.complex64)
    values.setflags(write=False)
    one = FrfSet(FREQUENCY, values, DOFS, (Dof(1, 3),) * 2)
    assert np.shares_memory(one.values, values)
    assert np.shares_memory(one.band(5.0, 20.0).values, values)
    writable = np.ones((2, 100), dtype=complex)
    other = FrfSet(FREQUENCY, writable, DOFS, (Dof(1, 3),) * 2)
    writable[:] = 0.0
    assert np.all(other.values == 1)


@given(decay=st.floats(0.0, 50.0), start=st.sampled_from(FORMS), through=st.sampled_from(FORMS))
def test_forms_differ_by_powers_of_s_and_come_back(decay, start, through):
    one = frfs(form=start, decay=decay).band(0.5, 49.5)
    other = one.to(through)
    power = FORMS.index(through) - FORMS.index(start)
    s = 2j * np.pi * one.frequency + decay
    assert np.allclose(other.values, one.values * s**power, rtol=1e-12)
    assert np.allclose(other.variance, one.variance * np.abs(s) ** (2 * power), rtol=1e-12)
    assert np.allclose(other.to(start).values, one.values, rtol=1e-12)


def test_only_the_line_at_the_origin_is_dropped():
    assert frfs().to("receptance").frequency[0] == 0.5
    assert frfs(decay=1.0).to("receptance").frequency[0] == 0.0
    assert frfs(form="receptance").to("accelerance").frequency[0] == 0.0


def test_calibration_factors():
    one = frfs()
    each = one.scaled(np.array([2.0, -0.5]))
    assert np.allclose(each.values, one.values * [[2.0], [-0.5]])
    assert np.allclose(each.variance, one.variance * [[4.0], [0.25]])
    assert np.allclose(one.scaled(3.0).values, 3 * one.values)
    for wrong in (0.0, np.nan, np.ones(3), np.ones((2, 100))):
        with pytest.raises(InputError, match="factor"):
            one.scaled(wrong)


def test_bands_and_rows():
    one = frfs()
    assert one.band(10.0, 12.0).frequency.tolist() == [10.0, 10.5, 11.0, 11.5, 12.0]
    assert one.select([-1]).responses == (Dof(2, -3),)
    with pytest.raises(InputError, match="holds 1 lines"):
        one.band(10.1, 10.6)
    with pytest.raises(InputError, match="not evenly"):
        replace(one, frequency=np.r_[FREQUENCY[:-1], 60.0])
