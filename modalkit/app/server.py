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
from modalkit.app.guard import Asgi, Guard
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
    "hits": lambda controller, a: controller.hits(),
    "record": lambda controller, a: controller.record(str(a["point"]), int(a["hit"])),
    "frf": lambda controller, a: controller.frf(int(a["index"])),
    "modes": lambda controller, a: controller.modes(),
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
    "stop": lambda controller, a: controller.stop(),
    "export": lambda controller, a: controller.export(),
}
"""What is sent, by name."""


def application(controller: Controller, *, token: str, port: int) -> Asgi:
    """Return the app as ASGI has it, behind its guard.

    Parameters
    ----------
    controller : Controller
        The study.
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
    inner.state.controller = controller
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
    return await _answered(request, PAGES, dict(request.query_params))


async def _changed(request: Request) -> Response:
    try:
        arguments = json.loads(await request.body() or b"{}")
    except ValueError:
        return JSONResponse({"error": "the request is not JSON"}, 400)
    if not isinstance(arguments, dict):
        return JSONResponse({"error": "the request is not an object"}, 400)
    return await _answered(request, CHANGES, arguments)


async def _answered(
    request: Request, answers: Mapping[str, Answer], arguments: Mapping[str, Any]
) -> Response:
    """Return what a function of the controller returns, or its error on purpose in a line."""
    answer = answers.get(request.path_params["name"])
    if answer is None:
        return JSONResponse({"error": "not found"}, 404)
    controller: Controller = request.app.state.controller
    try:
        found = await run_in_threadpool(lambda: plain(answer(controller, arguments)))
    except ModalkitError as error:
        return JSONResponse({"error": str(error)}, 422)
    except (KeyError, TypeError, ValueError) as error:
        return JSONResponse({"error": f"the request is not understood: {error}"}, 400)
    return JSONResponse(found)


async def _report(request: Request) -> Response:
    controller: Controller = request.app.state.controller
    page = await run_in_threadpool(controller.report, request.path_params["kind"])
    if page is None:
        return Response("there is no report of this state yet", 404)
    return HTMLResponse(page, headers={"content-security-policy": SANDBOX})


def _mapping(value: Any) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError("an object of names and values is needed")
    return value


def _numbers(value: Any) -> dict[str, float]:
    return {str(name): float(number) for name, number in _mapping(value).items()}
