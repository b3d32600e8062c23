"""The server of the app: pages as JSON, changes, work, and the page itself; no path leads to a file of the user's."""

from __future__ import annotations

import json
import mimetypes
from collections.abc import Callable, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from acquisition.errors import InputError, ModalkitError
from modalkit.app.controller import Controller
from modalkit.app.doing import Stopped
from modalkit.app.guard import Asgi, Guard
from modalkit.app.importing import Importing
from modalkit.app.model_page import Moved
from modalkit.output.whole import plain
from modalkit.vendor import PLOTLY, THREE, vendored
from modalkit.views.static import shared

SANDBOX = (
    "default-src 'none'; script-src 'unsafe-inline' blob:; style-src 'unsafe-inline'; img-src data: blob:; "
    "sandbox allow-scripts allow-downloads"
)
"""What a report may do: draw itself and hand over its numbers. It has no origin here, and can ask for nothing; its own
policy lets no script run but its own."""

Answer = Callable[[Controller, Mapping[str, Any]], Any]

PAGES: dict[str, Answer] = {
    "state": lambda controller, a: controller.state(),
    "doing": lambda controller, a: controller.doing(),
    "hits": lambda controller, a: controller.hits(),
    "record": lambda controller, a: controller.record(str(a["point"]), int(a["hit"])),
    "frf": lambda controller, a: controller.frf(int(a["index"])),
    "others": lambda controller, a: controller.others(int(a["index"])),
    "measured": lambda controller, a: controller.measured(),
    "modes": lambda controller, a: controller.modes(),
    "indicators": lambda controller, a: controller.indicators(),
    "damping": lambda controller, a: controller.damping(),
    "fit": lambda controller, a: controller.fit(int(a["index"])),
    "provisional": lambda controller, a: controller.provisional(float(a["hertz"]), int(a.get("index", 0))),
    "shapes": lambda controller, a: controller.shapes(),
    "model": lambda controller, a: controller.model(),
    "work": lambda controller, a: controller.work(str(a["kind"])),
    "drawings": lambda controller, a: controller.drawings(str(a["kind"])),
}
"""What is asked for, by name; nothing is changed by it."""

CHANGES: dict[str, Answer] = {
    "act": lambda controller, a: controller.act(str(a["name"]), _mapping(a.get("arguments", {}))),
    "accept": lambda controller, a: controller.accept(int(a["row"])),
    "undo": lambda controller, a: controller.step(back=True),
    "redo": lambda controller, a: controller.step(back=False),
    "moved": lambda controller, a: controller.moved(
        Moved(tuple(_mapping(e) for e in a.get("effects", [])), _numbers(a.get("factors", {}))),
        int(a.get("index", 0)),
    ),
    "start": lambda controller, a: controller.start(str(a["kind"])),
    "interrupt": lambda controller, a: controller.interrupt(),
    "stop": lambda controller, a: controller.stop(),
    "export": lambda controller, a: controller.export(),
}
"""What is sent, by name."""

Step = Callable[[Importing, Mapping[str, Any]], Any]

IMPORT_PAGES: dict[str, Step] = {
    "state": lambda importing, a: importing.state(),
    "doing": lambda importing, a: importing.doing(),
    "import": lambda importing, a: importing.page(),
}
"""What is asked for as long as text is imported and no study is there."""

IMPORT_CHANGES: dict[str, Step] = {
    "proposed": lambda importing, a: importing.proposed(_names(a["files"]), _mapping(a.get("written", {}))),
    "checked": lambda importing, a: importing.checked(_names(a["files"]), _mapping(a["form"])),
    "write": lambda importing, a: importing.write(
        _names(a["files"]),
        _mapping(a["form"]),
        title=str(a["title"]),
        layout=str(a["layout"]),
        study=str(a["study"]),
    ),
    "interrupt": lambda importing, a: importing.interrupt(),
}
"""What is sent as long as that is so."""


def application(subject: Controller | Importing, *, token: str, port: int) -> Asgi:
    """Return the app as ASGI has it, behind its guard.

    Parameters
    ----------
    subject : Controller or Importing
        The study, or the text that becomes one.
    token : str
        First part of every path.
    port : int
        Where it is served.
    """
    routes = [
        Route("/", _page),
        Route("/static/{name:path}", _static),
        Route("/api/{name}", _asked, methods=["GET"]),
        Route("/api/{name}", _changed, methods=["POST"]),
        Route("/report/{kind}", _report),
    ]
    inner = Starlette(routes=routes)
    inner.state.subject = subject
    return Guard(inner, token, port)


async def _page(request: Request) -> Response:
    return HTMLResponse(files("modalkit.app").joinpath("static", "index.html").read_bytes())


async def _static(request: Request) -> Response:
    """Serve one of the files of the page, by its exact name."""
    name = request.path_params["name"]
    if name not in SERVED:
        return Response("not found", 404)
    content = SERVED[name].read_bytes()
    kind = "text/javascript" if name.endswith(".js") else mimetypes.guess_type(name)[0]
    return Response(content, media_type=kind)


def _served() -> dict[str, Traversable]:
    """Return the files of the page by their names: its own, those it shares with the report, and the libraries."""
    own = files("modalkit.app").joinpath("static")
    folders = {"": own, "pages/": own.joinpath("pages")}
    found = {f"{at}{e.name}": e for at, folder in folders.items() for e in folder.iterdir() if e.is_file()}
    return found | shared() | {name: vendored(name) for name in (PLOTLY, *THREE)}


SERVED = _served()


async def _asked(request: Request) -> Response:
    return await _answered(request, PAGES, IMPORT_PAGES, dict(request.query_params))


async def _changed(request: Request) -> Response:
    try:
        arguments = json.loads(await request.body() or b"{}")
    except ValueError:
        return JSONResponse({"error": "the request is not JSON"}, 400)
    if not isinstance(arguments, dict):
        return JSONResponse({"error": "the request is not an object"}, 400)
    return await _answered(request, CHANGES, IMPORT_CHANGES, arguments)


def _controller(request: Request) -> Controller | None:
    """Return the study; None as long as text is imported."""
    subject: Controller | Importing = request.app.state.subject
    return subject.controller if isinstance(subject, Importing) else subject


async def _answered(
    request: Request,
    answers: Mapping[str, Answer],
    steps: Mapping[str, Step],
    arguments: Mapping[str, Any],
) -> Response:
    """Return what a function of the study or of the import returns, or its error on purpose in a line."""
    name, controller = request.path_params["name"], _controller(request)
    answer: Callable[[Any, Mapping[str, Any]], Any] | None = (
        steps.get(name) if controller is None else answers.get(name)
    )
    if answer is None:
        return JSONResponse({"error": "not found"}, 404)
    subject = request.app.state.subject if controller is None else controller
    try:
        found = await run_in_threadpool(lambda: plain(answer(subject, arguments)))
    except Stopped:
        return JSONResponse({"error": "stopped; nothing was changed, and this page is not complete"}, 422)
    except ModalkitError as error:
        return JSONResponse({"error": str(error)}, 422)
    except (KeyError, TypeError, ValueError) as error:
        return JSONResponse({"error": f"the request is not understood: {error}"}, 400)
    return JSONResponse(found)


async def _report(request: Request) -> Response:
    controller = _controller(request)
    kind = request.path_params["kind"]
    page = None if controller is None else await run_in_threadpool(controller.report, kind)
    if page is None:
        return Response("there is no report of this state yet", 404)
    return HTMLResponse(page, headers={"content-security-policy": SANDBOX})


def _mapping(value: Any) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError("an object of names and values is needed")
    return value


def _names(value: Any) -> list[str]:
    if not isinstance(value, list):
        raise InputError("a list of names is needed")
    return [str(name) for name in value]


def _numbers(value: Any) -> dict[str, float]:
    return {str(name): float(number) for name, number in _mapping(value).items()}
