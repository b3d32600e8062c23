"""Large files: the numbers go straight to their place, at the file's own precision."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from acquisition import Dof, HammerTest, Hits, read_uff, write_uff
from acquisition.arrays import frozen_array

SAMPLES = 1 << 17


@pytest.mark.parametrize("form", ["binary", "ascii"])
def test_peak_is_near_the_payload(tmp_path, rng, form):
    count = 24 if form == "binary" else 4
    force = rng.standard_normal((count, SAMPLES), dtype=np.float32)
    motion = rng.standard_normal((count, 1, SAMPLES), dtype=np.float32)
    test = HammerTest(51200.0, (Hits(Dof(1, 3), (Dof(1, 3),), force, motion),))
    write_uff(tmp_path / "a.uff", tests=test, precision="single", form=form)
    read_uff(tmp_path / "a.uff")  # what is loaded once is no part of it
    tracemalloc.start()
    (back,) = read_uff(tmp_path / "a.uff").tests
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    point = back.points[0]
    payload = force.nbytes + motion.nbytes
    assert point.force.dtype == point.motion.dtype == np.float32
    if form == "binary":
        assert np.array_equal(point.motion, motion) and np.array_equal(point.force, force)
        assert peak < 1.5 * payload
    else:
        assert np.allclose(point.motion, motion, rtol=1e-5)
        assert peak < 1.5 * payload + 64e6  # numbers from text wait in memory up to 64 MB, then in a file


def test_frozen_arrays_are_not_copied(rng):
    array = rng.standard_normal(10)
    copy = frozen_array(array)
    assert copy is not array and not copy.flags.writeable and array.flags.writeable
    assert frozen_array(copy) is copy and np.shares_memory(frozen_array(copy[2:5]), copy)
    view = array[:]
    view.setflags(write=False)  # read-only, but its owner can still be written to
    assert not np.shares_memory(frozen_array(view), array)


def test_single_precision_is_kept_where_it_is_wanted():
    single = np.ones(3, dtype=np.float32)
    assert frozen_array(single).dtype == np.float64
    assert frozen_array(single, keep_single=True).dtype == np.float32
    assert frozen_array(single + 0j, np.complex128, keep_single=True).dtype == np.complex64
    assert frozen_array(np.ones(3, dtype=np.int8), keep_single=True).dtype == np.float64
