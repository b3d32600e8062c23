"""How results display themselves, and that strings are paths."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pandas as pd
import pytest
from figure_cases import model_of
from matplotlib.text import Text
from report_pages import complete
from test_localisation_figure import diagnosis_with

import acquisition
import identification
import modalkit
import updating
from acquisition.display import Displayed, described, formats, named_files
from acquisition.quantities import decimals
from modalkit import figures
from modalkit.samples import sample_file
from updating import Diagnosis

LONGEST = 2500  # characters: some 25 lines of a terminal


@pytest.fixture(scope="module")
def session() -> modalkit.Session:
    return modalkit.open_study(str(sample_file("beam_dry/study.toml")))


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    return modalkit.diagnose_studies([str(sample_file("beam_wet/study.toml"))])


def parts(result: Any, depth: int = 0) -> Iterator[Any]:
    """Yield a result and all dataclasses in it."""
    if is_dataclass(result) and depth < 7:
        yield result
        for f in fields(result):
            yield from parts(getattr(result, f.name), depth + 1)
    elif isinstance(result, tuple | list):
        for item in result[:30]:
            yield from parts(item, depth + 1)
    elif isinstance(result, dict):
        yield from parts(list(result.values()), depth)


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.long
def test_every_result_has_a_short_repr_and_sound_html(
    session: modalkit.Session, diagnosis: Diagnosis
) -> None:
    results = [session, diagnosis, modalkit.simulate_test(session.study), modalkit.correlate(session.case)]
    results.append(modalkit.update_studies([session]))
    shown = set()
    for part in (p for result in results for p in parts(result)):
        assert len(repr(part)) < LONGEST, type(part)
        if isinstance(part, Displayed):
            shown.add(type(part).__name__)
            assert repr(part).startswith(f"{type(part).__name__}: ")
            tags = _Tags()
            tags.feed(part._repr_html_())
            assert not tags.open
    assert {
        "HammerTest",
        "FrfSet",
        "ModalModel",
        "Processed",
        "Diagnosis",
        "Update",
        "Session",
        "Case",
    } <= shown


def test_a_repr_says_what_is_in_it(session: modalkit.Session, diagnosis: Diagnosis) -> None:
    assert session.processed is not None
    assert repr(session.processed.content.tests[0]).startswith(
        "HammerTest: 75 hits at 5 points, 1024 samples"
    )
    assert "5 FRFs (accelerance)" in repr(session.processed)
    assert "429.15" in repr(session.identified)
    assert "fluid_added_mass" in repr(diagnosis).splitlines()[0]


def test_what_a_file_says_is_escaped() -> None:
    content = acquisition.UffContent(title="<script>alert(1)</script>", warnings=("<b>",))
    assert "<script>" not in content._repr_html_() and "<b>&lt;" not in content._repr_html_()
    assert "&lt;script&gt;" in content._repr_html_() and "&lt;b&gt;" in content._repr_html_()


def test_a_dataclass_is_described_by_the_size_of_its_parts(session: modalkit.Session) -> None:
    assert session.identified is not None
    text = described(session.identified)
    assert "poles: array 3" in text and "pole_covariance: array 3x2x2" in text and len(text) < 1500


def test_the_ranking_prints_its_probability_at_any_width(diagnosis: Diagnosis) -> None:
    table = diagnosis.table()
    for width in (60, 80, 200):
        rows = table.to_string(line_width=None) if width == 200 else _printed(table, width)
        assert "probability" in rows and "fluid_added_mass" in rows
    best = diagnosis.ranking[0]
    assert table["probability"].iloc[0] == pytest.approx(best.probability, abs=5e-5)
    assert "e-" not in table["probability"].to_string()


def test_a_diagnosis_prints_every_size_whole(diagnosis: Diagnosis) -> None:
    message = str(diagnosis)
    assert "[...]" not in message and "..." not in message
    first = diagnosis.ranking[0]
    assert first.parameters
    for name, estimate in first.parameters.items():
        assert name in message and str(estimate) in message
        assert str(estimate) in diagnosis.sizes().to_string()


def _printed(table: Any, width: int) -> str:
    import pandas as pd

    with pd.option_context("display.width", width):
        return repr(table)


def test_strings_are_paths_everywhere() -> None:
    for room in (acquisition, identification, updating, modalkit, figures):
        for name in room.__all__:
            for where, function in _functions(name, getattr(room, name)):
                for parameter, kind in inspect.get_annotations(function).items():
                    if parameter != "return" and "Path" in str(kind):
                        assert "str" in str(kind), f"{room.__name__}.{where}: {parameter} takes no string"


def _functions(name: str, thing: Any) -> Iterator[tuple[str, Any]]:
    if inspect.isfunction(thing):
        yield name, thing
    elif inspect.isclass(thing) and thing.__module__.partition(".")[0] in {
        "acquisition",
        "modalkit",
        "updating",
    }:
        yield from ((f"{name}.{n}", f) for n, f in vars(thing).items() if inspect.isfunction(f))


@pytest.mark.long
def test_strings_are_taken_as_paths(tmp_path: Any, session: modalkit.Session) -> None:
    study = str(sample_file("beam_dry/study.toml"))
    assert modalkit.read_study(study).name == session.study.name
    processing = modalkit.ProcessingOptions(layout=study)
    assert processing.layout == sample_file("beam_dry/study.toml")
    test = modalkit.simulate_test(study)
    test.write(str(tmp_path / "t.uff"))
    assert modalkit.read(str(tmp_path / "t.uff")).hits
    assert figures.save_figures({}, str(tmp_path / "figures")) == []


def test_a_notebook_gets_a_table_without_row_numbers_nobody_named(session: modalkit.Session) -> None:
    assert session.processed is not None
    html = session.processed.frfs._repr_html_()
    assert "<th>0</th>" not in html and "<th>response</th>" in html
    modes = session.case.measured._repr_html_()
    assert modes.count("<tr") == 1 + len(session.case.measured.frequency)  # one row of headings
    assert "<th>mode</th>" in modes


@pytest.mark.long
def test_an_update_is_drawn_in_one_call(session: modalkit.Session, tmp_path: Any) -> None:
    result = modalkit.update_studies([session], ["E", "length"])
    drawn = modalkit.draw(result, folder=str(tmp_path / "figures"))
    assert set(drawn) == {"update", "evolution"}
    assert (tmp_path / "figures" / "update.png").is_file()
    keys = [text.get_text() for text in drawn["evolution"].findobj(Text)]
    assert all(any(key.startswith(f"{name} ") for key in keys) for name in ("E", "length"))
    words = " ".join(text.get_text() for text in drawn["update"].texts)
    assert (
        "Errors, mode by mode" in words
        and "length" in words
        and "Updating takes the frequency error" in words
    )


def test_many_files_take_one_short_line() -> None:
    assert named_files(["a.csv", "b.csv"]) == "a.csv, b.csv"
    assert named_files([f"h{n}.csv" for n in range(18)]) == "18 files, h0.csv to h17.csv"


def test_values_have_the_digits_that_their_deviation_determines() -> None:
    sigmas = (0.006, 0.00028, 0.5, 15.0, 250.0, 0.0096, 0.0, float("nan"))
    assert list(map(decimals, sigmas)) == [3, 5, 1, 0, 0, 3, None, None]
    modes = modalkit.ModalData(
        frequency=np.array([98.7654321, 1206.298]), frequency_sigma=np.array([0.02, 0.006])
    )
    for text in (repr(modes), modes._repr_html_()):
        assert "1206.298" in text and "98.765" in text and "0.006" in text
    table = pd.DataFrame({"error [%]": [1.23456789], "sigma [Hz]": [0.5]})
    assert formats(table) == {}


def test_a_diagnosis_answers_in_five_lines() -> None:
    found = complete(diagnosis_with("beam", "class"))
    lines = repr(found).splitlines()
    starts = [line.partition(":")[0] for line in lines[-5:]]
    assert starts == ["Cause", "Where", "Closes", "Sure", "Next"]
    assert lines[0].startswith("Diagnosis: ")
    page = found._repr_html_()
    assert page.count("<dt>") == 5 and "<table" in page


def test_drawings_are_pictures_in_a_notebook() -> None:
    drawn = modalkit.draw(model_of(3))
    page = drawn._repr_html_()
    assert page.count("<img ") == len(drawn) == page.count("data:image/png;base64,iVBOR")
    assert repr(drawn).startswith("Drawings: frf (") and isinstance(drawn, dict)
