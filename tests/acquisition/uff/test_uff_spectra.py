"""FRFs from auto- and cross-spectra, against the H1 estimate of the hits they were made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, UffContent, read_uff
from acquisition.uff.functions.units import is_density, product_of, square_of
from acquisition.uff.writing.data_sets import Record58, function_set, header_set, units_set

LINES, HITS, DF = 200, 5, 2.0
RESPONSES = (Dof(1, 3), Dof(2, -1))
AT = Dof(1, 3)
HERTZ = (18, "Frequency", "Hz")


class Spectra:
    """Spectra of noisy hits on a single-degree-of-freedom system, and H1 and coherence by the book."""

    def __init__(self) -> None:
        rng = np.random.default_rng(8)
        s = 2j * np.pi * DF * np.arange(LINES)
        h = np.stack([s**2 / (s**2 + 40 * s + (2 * np.pi * 120) ** 2), 0.4 * s**2 / (s**2 + 60 * s + 9e5)])
        force = rng.standard_normal((HITS, LINES)) + 1j * rng.standard_normal((HITS, LINES)) + 3
        noise = rng.standard_normal((2, HITS, 2, LINES)) * 0.01
        motion = h * force[:, None] + noise[0] + 1j * noise[1]
        self.gff = np.mean(np.abs(force) ** 2, axis=0)
        self.gxx = np.mean(np.abs(motion) ** 2, axis=0)
        self.gxf = np.mean(motion * force.conj()[:, None], axis=0)

    @property
    def h1(self) -> np.ndarray:
        return self.gxf / self.gff

    @property
    def coherence(self) -> np.ndarray:
        return np.abs(self.gxf) ** 2 / (self.gxx * self.gff)


def write(path: Path, spectra: Spectra, **options: object) -> UffContent:
    """Write spectra and read them; options change what is written."""
    auto_type = options.get("auto_type", 2)
    label = options.get("label", ("N^2", "(m/s^2)^2", "NONE"))
    averages = ("spectra", "NONE", "NONE", "NONE", f"averages {HITS}")
    records = []
    if options.get("force", True):
        axes = (HERTZ, (13, "Force", label[0]), (0, "NONE", "NONE"))
        records.append(
            Record58(
                title=averages,
                function_type=auto_type,
                response=AT,
                reference=AT,
                minimum=0.0,
                increment=DF,
                values=spectra.gff,
                axes=axes,
            )
        )
    for row, dof in enumerate(RESPONSES):
        gxf = spectra.gxf[row].conj() if options.get("conjugate") else spectra.gxf[row]
        axes = (HERTZ, (12, "Acceleration", label[2]), (13, "Force", "N"))
        records.append(
            Record58(
                title=averages,
                function_type=3,
                response=dof,
                reference=AT,
                minimum=0.0,
                increment=DF,
                values=gxf,
                axes=axes,
            )
        )
        if options.get("motion", True):
            axes = (HERTZ, (12, "Acceleration", label[1]), (0, "NONE", "NONE"))
            scale = options.get("scale", 1.0)
            records.append(
                Record58(
                    title=averages,
                    function_type=auto_type,
                    response=dof,
                    reference=dof,
                    minimum=0.0,
                    increment=DF,
                    values=scale * spectra.gxx[row],
                    axes=axes,
                )
            )
    head = options.get("units", units_set())
    parts = [header_set("spectra"), head]
    for record in records:
        parts += function_set(record, form=options.get("form", "binary"), precision="double")
    path.write_bytes(b"".join(bytes(p) for p in parts))
    return read_uff(path)


@pytest.mark.parametrize("form", ["binary", "ascii"])
@pytest.mark.parametrize("auto_type", [2, 9])
def test_h1_and_coherence_by_the_book(tmp_path, form, auto_type):
    spectra = Spectra()
    content = write(tmp_path / "a.uff", spectra, form=form, auto_type=auto_type)
    assert content.warnings == () and content.frfs is not None and content.frfs.coherence is not None
    assert content.frfs.responses == RESPONSES and content.frfs.references == (AT, AT)
    assert content.frfs.form == "accelerance" and content.frfs.df == DF
    assert np.allclose(content.frfs.values, spectra.h1, rtol=1e-10, atol=1e-12)
    assert np.allclose(content.frfs.coherence, spectra.coherence, rtol=1e-10, atol=1e-12)
    assert content.frfs.averages is not None and content.frfs.averages.tolist() == [HITS, HITS]
    expected = np.abs(spectra.h1) ** 2 * (1 - spectra.coherence) / (spectra.coherence * (HITS - 1))
    printed = (
        1e-12 / (1 - spectra.coherence).min() if form == "ascii" else 0.0
    )  # 13 digits, 1 - coherence cancels
    assert np.allclose(content.frfs.variance, expected, rtol=1e-8 + 10 * printed, atol=1e-15)


def test_without_spectra_of_the_responses_no_coherence(tmp_path):
    spectra = Spectra()
    content = write(tmp_path / "a.uff", spectra, motion=False)
    assert content.frfs is not None and content.frfs.coherence is None
    assert np.allclose(content.frfs.values, spectra.h1, rtol=1e-12)


def test_units_are_squared(tmp_path):
    """A file in millimetres and newtons: FRFs a thousandth, coherence the same."""
    spectra = Spectra()
    si = write(tmp_path / "a.uff", spectra)
    units = units_set().replace(b"1.00000000000000000D+00", b"1.00000000000000000D+03", 1)
    content = write(tmp_path / "b.uff", spectra, units=units)
    assert content.frfs is not None and si.frfs is not None
    assert np.allclose(content.frfs.values, si.frfs.values / 1e3, rtol=1e-12)
    assert np.allclose(content.frfs.coherence, si.frfs.coherence, rtol=1e-10)


def test_conjugate_cross_spectra_are_noticed(tmp_path):
    spectra = Spectra()
    content = write(tmp_path / "a.uff", spectra, conjugate=True)
    assert content.frfs is not None and np.allclose(content.frfs.values, spectra.h1, rtol=1e-12)
    assert any("conjugate" in w for w in content.warnings)


def test_what_cannot_be_combined_is_said(tmp_path):
    spectra = Spectra()
    content = write(tmp_path / "a.uff", spectra, force=False)
    assert content.frfs is None and any(
        "no single auto-spectrum of the force at 1+Z" in w for w in content.warnings
    )
    assert len(content.datasets) == 6 and all(info.ok for info in content.datasets)
    content = write(tmp_path / "b.uff", spectra, scale=1e-3)
    assert content.frfs is None and any("exceeds 1" in w for w in content.warnings)
    content = write(tmp_path / "c.uff", spectra, label=("N^2/Hz", "NONE", "(m/s^2)*N"))
    assert content.frfs is None and any("axis and scaling" in w for w in content.warnings)


@pytest.mark.parametrize(
    ("label", "quantity", "factor"),
    [
        ("N^2", "force", 1.0),
        ("(m/s^2)^2/Hz", "accelerance", 1.0),
        ("g^2/Hz", "accelerance", 9.80665),
        ("g²/Hz", "accelerance", 9.80665),
        ("m2/s4", "accelerance", 1.0),
        ("m^2/s^2", "mobility", 1.0),
        ("mm^2", "receptance", 1e-3),
        ("lbf^2", "force", 4.4482216152605),
        ("N", "force", 1.0),
        ("m/s^2", "accelerance", 1.0),
    ],
)
def test_labels_of_squares(label, quantity, factor):
    found = square_of(label)
    assert found is not None and found[0] == quantity and found[1] == pytest.approx(factor, rel=1e-12)
    assert is_density(label) == label.endswith("/Hz")


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("(m/s^2)*N", ("accelerance", 1.0)),
        ("N*(m/s^2)/Hz", ("accelerance", 1.0)),
        ("g N", ("accelerance", 9.80665)),
        ("mm.kN", ("receptance", 1.0)),
        ("V^2", None),
        ("N*N", None),
        ("NONE", None),
    ],
)
def test_labels_of_products(label, expected):
    found = product_of(label)
    assert (found is None) == (expected is None)
    if expected is not None and found is not None:
        assert found[0] == expected[0] and found[1] == pytest.approx(expected[1], rel=1e-12)
