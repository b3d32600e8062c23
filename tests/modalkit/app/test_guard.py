"""Nobody but the page itself is answered, and nothing but the study is shown."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from opening import opened
from starlette.testclient import TestClient

from acquisition import Dof, FrfSet, write_uff
from modalkit.app.guard import LARGEST
from modalkit.app.server import application

TOKEN, PORT = "a-token-that-nobody-knows", 8123
HOME = f"http://127.0.0.1:{PORT}"


@pytest.fixture
def client(beam: Path) -> TestClient:
    return TestClient(application(opened(beam), token=TOKEN, port=PORT), base_url=HOME)


def test_the_page_and_its_parts_are_served_under_the_token(client):
    page = client.get(f"/{TOKEN}/")
    assert page.status_code == 200
    for part in ("main.js", "style.css", "pages/hits.js", "plotly-cartesian.min.js", "three.module.min.js"):
        assert client.get(f"/{TOKEN}/static/{part}").status_code == 200, part
    assert client.get(f"/{TOKEN}/api/state").json()["title"] == "Cantilever beam, dry"
    policy = page.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy
    assert page.headers["referrer-policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path", ["/", "/api/state", "/static/main.js", "/another-token/api/state", f"/{TOKEN}x/"]
)
def test_without_its_token_an_address_is_refused(client, path):
    assert client.get(path).status_code == 403


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        f"evil.example:{PORT}",
        "127.0.0.1",
        "127.0.0.1:80",
        f"127.0.0.1.evil.example:{PORT}",
        "",
    ],
)
def test_a_name_rebound_to_this_machine_is_refused(client, host):
    """DNS rebinding: the browser of a foreign page asks this machine under the page's own name."""
    answer = client.get(f"/{TOKEN}/api/state", headers={"host": host})
    assert answer.status_code == 403
    assert "Cantilever" not in answer.text


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", f"https://127.0.0.1:{PORT}", "http://127.0.0.1:1"]
)
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_foreign_origin_is_refused(client, origin, method):
    answer = client.request(method, f"/{TOKEN}/api/undo", json={}, headers={"origin": origin})
    assert answer.status_code == 403


def test_a_request_that_a_browser_calls_cross_site_is_refused(client):
    headers = {"sec-fetch-site": "cross-site"}
    assert client.get(f"/{TOKEN}/api/state", headers=headers).status_code == 403
    for kind in ("iframe", "script", "empty"):
        assert client.get(f"/{TOKEN}/", headers=headers | {"sec-fetch-dest": kind}).status_code == 403


def test_a_link_with_the_token_may_be_followed_from_anywhere(client):
    """The address stands in a terminal, which may be a page itself."""
    headers = {"sec-fetch-site": "cross-site", "sec-fetch-dest": "document"}
    assert client.get(f"/{TOKEN}/", headers=headers).status_code == 200
    assert client.get(f"/{TOKEN}/api/state", headers=headers).status_code == 403
    assert client.get("/", headers=headers).status_code == 403


def test_a_report_in_its_sandbox_may_be_read_again(client):
    """Its own links make of a reload the request of another site."""
    headers = {"sec-fetch-site": "cross-site", "sec-fetch-dest": "document"}
    path = f"/{TOKEN}/report/diagnosis"
    assert client.get(path, headers=headers).status_code == client.get(path).status_code != 403
    assert client.get(path, headers=headers | {"sec-fetch-dest": "iframe"}).status_code == 403


def test_a_form_of_another_page_cannot_send_a_change(client):
    answer = client.post(f"/{TOKEN}/api/undo", data={"a": "b"})
    assert answer.status_code == 403
    assert "JSON" in answer.text


def test_a_request_that_is_too_long_is_not_read(client):
    answer = client.post(
        f"/{TOKEN}/api/act", content=b"{}" + b" " * LARGEST, headers={"content-type": "application/json"}
    )
    assert answer.status_code == 403


@pytest.mark.parametrize(
    "name",
    [
        "../server.py",
        "..%2fserver.py",
        "%2e%2e/%2e%2e/study.toml",
        "/etc/passwd",
        "pages/../../server.py",
        "..\\server.py",
        "study.toml",
        "beam_dry.uff",
    ],
)
def test_no_path_leads_to_a_file(client, name):
    answer = client.get(f"/{TOKEN}/static/{name}")
    assert answer.status_code in {403, 404}
    assert "import" not in answer.text


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "../beam_joint/beam_joint.uff", "sub/../../beam_joint/beam_joint.uff"]
)
def test_no_change_names_a_file_outside_the_folder(client, name):
    change = {"name": "set", "arguments": {"path": ["test", "files"], "value": [name]}}
    answer = client.post(f"/{TOKEN}/api/act", json=change)
    assert answer.status_code == 422
    assert "outside" in answer.json()["error"]
    text = {"name": "text", "arguments": {"text": f'[test]\nfiles = ["{name}"]\n'}}
    assert "outside" in client.post(f"/{TOKEN}/api/act", json=text).json()["error"]


def test_a_link_that_leads_out_of_the_folder_is_no_way_out(client, beam, tmp_path):
    shutil.copy(beam.parent / "beam_dry.uff", tmp_path / "elsewhere.uff")
    (beam.parent / "link.uff").symlink_to(tmp_path / "elsewhere.uff")
    change = {"name": "set", "arguments": {"path": ["test", "files"], "value": ["link.uff"]}}
    assert "outside" in client.post(f"/{TOKEN}/api/act", json=change).json()["error"]


@pytest.mark.long
def test_files_that_the_study_began_with_may_lie_elsewhere(samples):
    study = samples / "beam_dry" / "other.toml"
    study.write_text(
        '[test]\nfiles = ["../beam_joint/beam_joint.uff"]\nband = [5.0, 500.0]\n', encoding="utf-8"
    )
    controller = opened(study)
    assert controller.act("order", {"order": 40})["undo"] == "order 40"


@pytest.mark.parametrize("body", [b"", b"[]", b"{", b'{"name": "act"}', b'{"name": "hit", "arguments": []}'])
def test_a_request_that_is_none_is_answered_with_an_error(client, body):
    answer = client.post(f"/{TOKEN}/api/act", content=body, headers={"content-type": "application/json"})
    assert answer.status_code in {400, 422}
    assert answer.json()["error"]


def test_a_title_that_is_a_script_stays_text(tmp_path, small_frfs: FrfSet):
    """The page makes elements of data alone; what is sent is JSON, and no page holds the title."""
    title = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    path = tmp_path / "evil.uff"
    write_uff(path, frfs=small_frfs, title=title)
    study = tmp_path / "evil.toml"
    study.write_text(f'title = "{title}"\n[test]\nfiles = ["evil.uff"]\n', encoding="utf-8")
    for opening, shown in ((study, title), (path, path.name)):
        client = TestClient(application(opened(opening), token=TOKEN, port=PORT), base_url=HOME)
        state = client.get(f"/{TOKEN}/api/state")
        assert state.headers["content-type"] == "application/json"
        assert state.headers["x-content-type-options"] == "nosniff"
        assert state.json()["title"] == shown
        assert "<script>alert" not in client.get(f"/{TOKEN}/").text


MARKUP = (
    *("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function"),
    *("http://", "https://"),
)
"""What would make markup or a script of a text, or ask another machine."""


def test_no_module_of_the_page_makes_markup_of_text():
    static = Path(__file__).resolve().parents[3] / "modalkit" / "app" / "static"
    for path in sorted(static.rglob("*.js")):
        text = path.read_text(encoding="utf-8")
        assert not [word for word in MARKUP if word in text], path.name


@pytest.fixture
def small_frfs() -> FrfSet:
    import numpy as np

    lines = np.arange(1.0, 201.0)
    s = 2j * np.pi * lines
    modes = [(50.0, 0.01, [1.0, 0.4]), (120.0, 0.008, [0.5, -1.0])]
    values = sum(
        np.outer(shape, s**2 / (s**2 + 2 * z * (2 * np.pi * f) * s + (2 * np.pi * f) ** 2))
        for f, z, shape in modes
    )
    return FrfSet(lines, values, (Dof(1, 3), Dof(2, 3)), (Dof(1, 3), Dof(1, 3)))
