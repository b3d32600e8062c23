"""The user's word on which poles are modes."""

from __future__ import annotations

import numpy as np
import pytest
from identification_cases import column, lines, structure

from acquisition.errors import InputError
from identification import identify


@pytest.fixture(scope="module")
def truth():
    found = structure((60.0, 110.0, 170.0), (0.01, 0.008, 0.006), 6, seed=31)
    found.shapes[:, 1] *= 0.07  # hardly stands out of the noise
    return found


@pytest.fixture
def frfs(truth):
    return truth.frfs(lines(high=250.0), column(6), noise=0.05, rng=np.random.default_rng(3))


def test_a_mode_the_data_hardly_show_is_kept_where_the_user_sees_it(truth, frfs):
    assert len(identify(frfs)) == 2
    model = identify(frfs, add=(109.0,))
    assert len(model) == 3
    score = (model.modal.frequency - truth.hertz) / model.modal.frequency_sigma
    assert np.abs(score).max() < 4
    assert model.modal.frequency_sigma[1] > 10 * model.modal.frequency_sigma[0]


def test_what_is_dropped_stays_in_the_fit_and_out_of_the_result(truth, frfs):
    both, one = identify(frfs), identify(frfs, drop=(60.3,))
    assert len(one) == 1
    np.testing.assert_allclose(one.poles, both.poles[1:], rtol=1e-12)
    np.testing.assert_allclose(one.synthesise().values, both.synthesise().values, rtol=1e-9)


def test_frequencies_that_mean_nothing_are_refused(frfs):
    with pytest.raises(InputError, match=r"no mode near 90 Hz.*at 60.*170 Hz"):
        identify(frfs, drop=(90.0,))
    with pytest.raises(InputError, match="400 Hz was asked for, outside"):
        identify(frfs, add=(400.0,))
    with pytest.raises(InputError, match=r"no mode can be kept at 60\.3 Hz"):
        identify(frfs, add=(60.3,))  # beside a strong mode there is no second one
