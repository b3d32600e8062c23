"""Start the app: a free port of this machine, a token, the browser."""

from __future__ import annotations

import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path

from acquisition.errors import InputError
from modalkit.app.controller import Controller
from modalkit.app.importing import IMPORTED, STUDY, Importing
from modalkit.app.opened import open_path
from modalkit.app.store import Store

LOOPBACK = "127.0.0.1"


def serve(
    path: Path,
    *,
    layout: Path | None = None,
    port: int = 0,
    browser: bool = True,
    ready: Callable[[str], None] = lambda address: None,
) -> None:
    """Serve a study, a data file or a folder to import until the process is interrupted.

    Parameters
    ----------
    path : Path
        The file or folder.
    layout : Path, optional
        Of column text.
    port : int
        Port to listen at; 0 is any that is free.
    browser : bool
        Whether the page is opened.
    ready : function, optional
        Called with the address once the server listens.

    Raises
    ------
    InputError
        If the file cannot be read, the port is taken, or the extra ``app`` is not installed.
    """
    try:
        import uvicorn

        from modalkit.app.server import application
    except ImportError as error:
        raise InputError(f"the app needs {error.name}; install the extra: pip install '.[app]'") from error
    subject = subject_of(path, layout=layout)
    token = secrets.token_urlsafe(24)
    listener = _listening(port)
    own_port = int(listener.getsockname()[1])
    address = f"http://{LOOPBACK}:{own_port}/{token}/"
    config = uvicorn.Config(
        application(subject, token=token, port=own_port),
        log_level="error",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=1,
    )
    ready(address)
    if browser:
        threading.Timer(0.5, webbrowser.open, (address,)).start()
    try:
        uvicorn.Server(config).run(sockets=[listener])
    finally:
        subject.close()
        listener.close()


def subject_of(path: Path, *, layout: Path | None = None) -> Controller | Importing:
    """Return the study that a path is or begins, or the import of files that lack a layout.

    Parameters
    ----------
    path : Path
        A file, or a folder: one with a ``study.toml`` is that study, any other is imported.
    layout : Path, optional
        Of column text.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if path.is_dir():
        if not (path / STUDY).is_file():
            return Importing(path, warm=True)
        path = path / STUDY
    try:
        opened = open_path(path, layout=layout)
    except InputError as error:
        if layout is not None or path.suffix.lower() not in IMPORTED or not path.is_file():
            raise
        return Importing(path.parent, path.name, str(error), warm=True)
    return Controller(opened, Store.beside(path), warm=True)


def _listening(port: int) -> socket.socket:
    """Return a socket of this machine alone."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((LOOPBACK, port))
    except OSError as error:
        listener.close()
        raise InputError(f"--port {port}: cannot be used ({error.strerror}); give another") from error
    listener.listen(64)
    return listener
