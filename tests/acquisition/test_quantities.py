"""One rule for each kind of quantity, for every output."""

import pytest

from acquisition.quantities import (
    SMALLEST_P,
    bare_p,
    closed,
    estimate,
    hertz,
    number,
    p_value,
    percent,
    place,
    probability,
    quantity,
    raised,
    severity,
    sigmas,
    uncertainty,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (12.0, "12"),
        (9353.7, "9350"),
        (0.98765, "0.988"),
        (123456.0, "123000"),
        (999600.0, "1.00e+06"),
        (0.0009996, "0.001"),
        (-0.0004, "-4.00e-04"),
        (float("nan"), "–"),
    ],
)
def test_a_number_has_three_digits_and_an_exponent_only_where_it_is_needed(value: float, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0125, "kg", "12.5 g"),
        (0.5, "kg", "500 g"),
        (1.0, "kg", "1 kg"),
        (0.344, "m", "344 mm"),
        (0.02, "s", "20 ms"),
        (2e-5, "s", "20 us"),
        (0.9, "-", "0.9"),
        (3.0, "node", "3"),
        (0.02, "N", "0.02 N"),
        (0.0, "kg", "0 kg"),
    ],
)
def test_a_quantity_stands_in_a_unit_that_keeps_it_at_one_or_more(value: float, unit: str, text: str) -> None:
    assert quantity(value, unit) == text


def test_the_largest_of_value_and_interval_chooses_the_unit() -> None:
    assert estimate(0.0125, "m", 0.0119, 0.0131) == "12.5 mm (11.9 to 13.1)"
    assert estimate(0.0125, "m", 0.0119, 0.0131, level="95 %") == "12.5 mm (95 %: 11.9 to 13.1)"
    assert estimate(0.9, "kg", 0.7, 1.2) == "0.9 kg (0.7 to 1.2)"
    assert estimate(-0.9, "kg", -1.2, -0.7) == "-0.9 kg (-1.2 to -0.7)"
    assert estimate(0.9, "-", 0.89, 0.91) == "0.9 (0.89 to 0.91)"
    assert estimate(9353.7, "N m/rad", 8163.9, 11300.1) == "9350 N m/rad (8160 to 11300)"


def test_exponents_are_raised_where_something_is_drawn() -> None:
    assert raised("998 kg/m^3, 3 mm^4, m s^-2 and 12^") == "998 kg/m³, 3 mm⁴, m s⁻² and 12^"


def test_errors_have_two_digits_and_from_ten_on_three() -> None:
    values = (0.0, 0.0123, 1.234, 9.94, 9.96, 12.34, 123.4, 1e-5)
    written = ["0 %", "0.012 %", "1.2 %", "9.9 %", "10 %", "12.3 %", "123 %", "1e-05 %"]
    assert [percent(v) for v in values] == written
    assert percent(float("nan")) == "–"
    assert [sigmas(v) for v in (0.123, 2.345, 262.0)] == ["0.12 sigma", "2.3 sigma", "260 sigma"]
    assert [uncertainty(v) for v in (0.0364, 1.23)] == ["3.6 %", "120 %"]
    assert [severity(v) for v in (0.0123, 8.46, 76.2, 1234.5, 7.53e7)] == [
        "0.012",
        "8.5",
        "76",
        "1230",
        "7.53e+07",
    ]
    assert closed(98.6, 96.6, 100.0) == "99 % (97 to 100)"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.0, "> 99.9 %"),
        (0.9995, "> 99.9 %"),
        (0.9994, "99.9 %"),
        (0.991, "99.1 %"),
        (0.9904, "99 %"),
        (0.5, "50 %"),
        (0.1, "10 %"),
        (0.0999, "10 %"),
        (0.034, "3.4 %"),
        (0.02, "2 %"),
        (0.0006, "0.1 %"),
        (0.0004, "< 0.1 %"),
        (0.0, "< 0.1 %"),
    ],
)
def test_a_probability_is_never_a_false_0_or_100(value: float, text: str) -> None:
    assert probability(value) == text


def test_a_p_value_ends_where_no_noise_is_known() -> None:
    assert [p_value(p) for p in (0.4, 0.0123, 1.23e-9)] == ["p = 0.4", "p = 0.012", "p = 1e-09"]
    assert p_value(0.0) == p_value(0.99 * SMALLEST_P) == "p < 1e-15"
    assert p_value(SMALLEST_P) == "p = 1e-15"
    assert bare_p(0.0) == "< 1e-15"


def test_a_frequency_has_four_digits_and_at_most_two_decimals() -> None:
    written = ["1.23 Hz", "12.35 Hz", "100.0 Hz", "123.5 Hz", "1000 Hz", "12346 Hz"]
    assert [hertz(f) for f in (1.2345, 12.346, 99.997, 123.46, 999.97, 12345.7)] == written


def test_a_place_is_in_millimetres_and_zeros_of_a_beam_are_left_out() -> None:
    assert place((0.13, 0.0, 0.0)) == "x = 130 mm"
    assert place((0.13, 0.0, 0.0), plate=True) == "x = 130, y = 0 mm"
    assert place((0.13, 0.05, 0.012)) == "x = 130, y = 50, z = 12 mm"
    assert place([-0.0]) == "x = 0 mm"
