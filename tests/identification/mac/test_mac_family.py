"""The MAC family against closed forms and against another package."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from identification import (
    auto_mac,
    comac,
    coordinate_table,
    ecomac,
    fdac,
    frac,
    frac_table,
    mac,
    mac_table,
    macx,
    mpc,
    msf,
)


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
    with pytest.raises(InputError, match="for each degree of freedom in common"):
        mac(shapes(rng), shapes(rng, n_dofs=6))
    for function in (msf, comac, ecomac):
        with pytest.raises(InputError, match="paired one to one"):
            function(shapes(rng), shapes(rng, n_modes=3))


def test_a_zero_shape_agrees_with_nothing(rng):
    a = shapes(rng)
    np.testing.assert_array_equal(mac(a, np.zeros_like(a)), 0.0)


def modes(frequency, shapes, nodes):
    dofs = tuple(Dof(n, 3) for n in nodes)
    return ModalData(
        frequency=frequency, frequency_sigma=np.full(len(frequency), np.nan), dofs=dofs, shapes=shapes
    )


def angle_to(a, b):
    """Angle between the lines two real vectors span, by construction of the vector of least distance."""
    return np.linalg.norm(a / np.linalg.norm(a) - (b @ a) * b / np.linalg.norm(b) ** 2 / np.linalg.norm(a))


def test_mac_is_the_squared_cosine(rng):
    a, b = rng.standard_normal((2, 9))
    np.testing.assert_allclose(mac(a, b)[0, 0], 1 - angle_to(a, b) ** 2, rtol=1e-10)


def test_mpc_by_the_principal_axes_of_the_components(rng):
    a = shapes(rng, n_dofs=30)
    for r, value in enumerate(mpc(a)):
        parts = np.stack([a[:, r].real, a[:, r].imag])
        small, large = np.linalg.eigvalsh(parts @ parts.T)
        np.testing.assert_allclose(value, ((large - small) / (large + small)) ** 2, rtol=1e-10)


def test_macx_by_the_published_sums(rng):
    a, b = shapes(rng), shapes(rng, n_modes=2)
    for i in range(4):
        for j in range(2):
            x, y = a[:, i], b[:, j]
            over = (abs(sum(x.conj() * y)) + abs(sum(x * y))) ** 2
            under = (sum(abs(x) ** 2) + abs(sum(x * x))) * (sum(abs(y) ** 2) + abs(sum(y * y)))
            np.testing.assert_allclose(macx(a, b)[i, j], over / under, rtol=1e-12)


def test_comac_and_ecomac_by_the_published_sums(rng):
    a, b = shapes(rng), shapes(rng)
    a, b = a / np.linalg.norm(a, axis=0), b / np.linalg.norm(b, axis=0)
    b = b * np.exp(-1j * np.angle(np.einsum("ij,ij->j", a.conj(), b)))
    for q in range(7):
        wanted = sum(abs(a[q]) * abs(b[q])) ** 2 / (sum(abs(a[q]) ** 2) * sum(abs(b[q]) ** 2))
        np.testing.assert_allclose(comac(a, b)[q], wanted, rtol=1e-12)
        np.testing.assert_allclose(ecomac(a, b)[q], sum(abs(a[q] - b[q])) / 8, rtol=1e-12)


def test_msf_is_the_least_squares_factor(rng):
    a, b = shapes(rng), shapes(rng)
    for r, value in enumerate(msf(a, b)):
        np.testing.assert_allclose(value, np.linalg.lstsq(a[:, [r]], b[:, r], rcond=None)[0][0], rtol=1e-10)


@pytest.mark.long
@given(st.integers(0, 10_000), st.permutations(range(7)), st.floats(-120, 120))
def test_order_of_points_conjugation_and_unit_change_nothing(seed, order, power):
    rng = np.random.default_rng(seed)
    a, b = shapes(rng), shapes(rng)
    unit = 10.0**power
    for measure in (mac, macx, comac, ecomac):
        plain = measure(a, b)
        rows = measure(a[order], b[order])
        np.testing.assert_allclose(rows, plain[order] if plain.ndim == 1 else plain, atol=1e-10)
        np.testing.assert_allclose(measure(a.conj(), b.conj()), plain, atol=1e-10)
        np.testing.assert_allclose(measure(unit * a, b), plain, atol=1e-10)
        np.testing.assert_allclose(measure(b, a), plain.T, atol=1e-10)
        assert plain.min() >= 0
        assert plain.max() <= 1
    np.testing.assert_allclose(macx(a, b.conj()), macx(a, b), atol=1e-10)
    np.testing.assert_allclose(mpc(a.conj()[order] * unit), mpc(a), atol=1e-10)
    np.testing.assert_allclose(msf(a.conj(), b.conj()), msf(a, b).conj(), atol=1e-10)


def test_one_degree_of_freedom_compares_nothing():
    one = np.array([[2.0 + 1j, -3.0]])
    for values in (mac(one, one), auto_mac(one), macx(one, one), mpc(one), ecomac(one, one)):
        assert np.isnan(values).all()
    np.testing.assert_allclose(msf(one, 2 * one), 2.0)
    assert np.isnan(comac(np.ones((5, 1)), np.ones((5, 1)))).all()
    assert np.isnan(frac(np.ones((5, 1)), np.ones((5, 1)))).all()


def test_a_point_at_rest_in_both_sets_says_nothing_of_them(rng):
    a = shapes(rng)
    a[3] = 0
    b = a.copy()
    b[4] = 0
    values = comac(a, b)
    assert np.isnan(values[3])
    assert values[4] == 0


def test_values_that_are_not_finite_are_refused(rng):
    a = shapes(rng)
    a[2, 1] = np.nan
    with pytest.raises(InputError, match="row 2, column 1"):
        mac(a, a)
    with pytest.raises(InputError, match="not a set of mode shapes"):
        mpc(np.ones((2, 2, 2)))


def test_tables_bear_the_names_of_what_both_sets_hold(rng):
    a = shapes(rng)
    first = modes([10.0, 20.0, 30.0, 40.0], a, range(1, 8))
    second = modes([11.0, 22.0, 33.0, 44.0], a[[6, 5, 4, 3]], [7, 6, 5, 4])
    table = mac_table(first, second)
    assert list(table.index) == ["1: 10.00 Hz", "2: 20.00 Hz", "3: 30.00 Hz", "4: 40.00 Hz"]
    assert table.columns[3] == "4: 44.00 Hz"
    np.testing.assert_allclose(np.diag(table), 1.0)
    np.testing.assert_allclose(mac_table(first).to_numpy(), mac(a, a))
    points = coordinate_table(first, second, [(0, 0), (2, 2)])
    assert list(points.index) == ["4+Z", "5+Z", "6+Z", "7+Z"]
    np.testing.assert_allclose(points["CoMAC"], 1.0)
    np.testing.assert_allclose(points["ECoMAC"], 0.0, atol=1e-12)
    with pytest.raises(InputError, match="no degree of freedom in common"):
        mac_table(first, modes([1.0], a[:, :1], range(11, 18)))
    with pytest.raises(InputError, match="no pairs of modes"):
        coordinate_table(first, second, [])


def test_frac_table_compares_what_both_sets_hold_in_one_form(rng):
    frequency = np.arange(1.0, 40.0)
    values = rng.standard_normal((3, 39)) + 1j * rng.standard_normal((3, 39))
    dofs, hit = tuple(Dof(i, 3) for i in (1, 2, 3)), (Dof(9, 3),) * 3
    first = FrfSet(frequency, values, dofs, hit)
    other = first.select([2, 0]).to("receptance")
    table = frac_table(first, other)
    assert list(table["response"]) == ["1+Z", "3+Z"]
    np.testing.assert_allclose(table["FRAC"], 1.0)
    with pytest.raises(InputError, match="different frequency lines"):
        frac_table(first, first.band(5.0, 20.0))
