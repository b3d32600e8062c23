"""The MAC family against closed forms and against another package."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from acquisition.errors import InputError
from identification import auto_mac, comac, ecomac, fdac, frac, mac, macx, mpc, msf


def shapes(rng, n_dofs=7, n_modes=4):
    return rng.standard_normal((n_dofs, n_modes)) + 1j * rng.standard_normal((n_dofs, n_modes))


def test_mac_agrees_with_another_package(rng):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from sdypy.EMA import tools

        a, b = shapes(rng), shapes(rng, n_modes=3)
        wanted = tools.MAC(a, b)
    np.testing.assert_allclose(mac(a, b), wanted, rtol=1e-12)


def test_mac_of_45_degrees_is_a_half():
    np.testing.assert_allclose(mac([1.0, 0.0], [1.0, 1.0]), [[0.5]])
    np.testing.assert_allclose(auto_mac(np.eye(3)), np.eye(3))


@given(
    hnp.arrays(np.float64, (5, 3), elements=st.floats(-10, 10)).filter(
        lambda x: (np.abs(x).max(axis=0) > 0.1).all()
    ),
    st.floats(0.01, 100),
    st.floats(0, 6.28),
)
def test_complex_scale_changes_neither_mac_nor_mpc(a, factor, phase):
    turned = a * factor * np.exp(1j * phase)
    np.testing.assert_allclose(mac(a, turned), mac(a, a), atol=1e-9)
    np.testing.assert_allclose(np.diag(mac(a, turned)), 1.0, atol=1e-9)
    np.testing.assert_allclose(mpc(turned), 1.0, atol=1e-9)
    np.testing.assert_allclose(msf(a, turned), factor * np.exp(1j * phase), rtol=1e-9)


def test_msf_scales_one_set_to_the_other_with_the_conjugate_right(rng):
    a = shapes(rng)
    factor = np.array([2.0, -1j, 0.5 + 0.5j, 3j])
    np.testing.assert_allclose(a * msf(a, a * factor), a * factor, rtol=1e-12)


def test_macx_takes_a_conjugate_for_the_shape_and_is_mac_for_real_shapes(rng):
    a = shapes(rng)
    np.testing.assert_allclose(np.diag(macx(a, a.conj())), 1.0, rtol=1e-12)
    np.testing.assert_allclose(macx(a.real, a.imag), mac(a.real, a.imag), rtol=1e-12)
    assert np.diag(mac(a, a.conj())).max() < 0.9


def test_mpc_of_a_travelling_wave_is_zero():
    angle = 2 * np.pi * np.arange(8) / 8
    np.testing.assert_allclose(mpc(np.exp(1j * angle)), [0.0], atol=1e-15)


def test_comac_and_ecomac_point_at_the_bad_degree_of_freedom(rng):
    a = rng.standard_normal((7, 4))
    a[2] = 2.0
    b = -3.0 * a * np.exp(0.3j)
    np.testing.assert_allclose(comac(a, b), 1.0, rtol=1e-12)
    np.testing.assert_allclose(ecomac(a, b), 0.0, atol=1e-12)
    b[2] *= np.array([-1.0, 1.0, -1.0, 1.0])
    assert ecomac(a, b).argmax() == 2
    b[2] = rng.standard_normal(4)
    assert comac(a, b).argmin() == 2


def test_frac_and_fdac(rng):
    h = rng.standard_normal((3, 50)) + 1j * rng.standard_normal((3, 50))
    np.testing.assert_allclose(frac(h, h * np.array([[2.0], [1j], [-5.0]])), 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.diag(fdac(h, -h)), -1.0, rtol=1e-12)
    np.testing.assert_allclose(np.diag(fdac(h, 1j * h)), 0.0, atol=1e-12)
    assert fdac(h, h[:, :20]).shape == (50, 20)


def test_what_does_not_fit_is_refused(rng):
    with pytest.raises(InputError, match="same degrees of freedom"):
        mac(shapes(rng), shapes(rng, n_dofs=6))
    for function in (msf, comac, ecomac):
        with pytest.raises(InputError, match="paired one to one"):
            function(shapes(rng), shapes(rng, n_modes=3))


def test_a_zero_shape_agrees_with_nothing(rng):
    a = shapes(rng)
    np.testing.assert_array_equal(mac(a, np.zeros_like(a)), 0.0)
