"""Who may talk to the app: this machine's own browser, by the address that was printed."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from typing import Any

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Asgi = Callable[[Scope, Receive, Send], Awaitable[None]]

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)
"""No script but ours, and no request to anywhere else. Styles may stand in the page, as plotly writes them there."""

HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)

LARGEST = 1_000_000
"""Bytes of a request: the text of a study takes some thousands. More is refused before it is read [byte]."""


@dataclass(frozen=True)
class Guard:
    """Let through what comes from the page itself, and nothing else.

    A site elsewhere cannot know the token; should its name be rebound to this machine, Host is its own and no
    loopback address; and its Origin is not ours.

    Parameters
    ----------
    app : callable
        What is behind it, at paths without the token.
    token : str
        First part of every path.
    port : int
        Where the server listens.
    """

    app: Asgi
    token: str
    port: int

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 403 or hand on."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        why = self._refusal(scope)
        if why:
            await _refuse(send, why)
            return
        await self.app(self._within(scope), receive, _with_headers(send))

    def _refusal(self, scope: Scope) -> str:
        """Return why a request is refused; empty where it is not."""
        headers: dict[bytes, list[bytes]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.lower(), []).append(value)
        hosts = {f"{name}:{self.port}".encode() for name in ("127.0.0.1", "localhost", "[::1]")}
        if len(headers.get(b"host", [])) != 1 or headers[b"host"][0] not in hosts:
            return "this address does not belong to the app"
        origins = {b"http://" + host for host in hosts}
        if any(origin not in origins for origin in headers.get(b"origin", [])):
            return "requests from another site are refused"
        elsewhere = any(site not in (b"same-origin", b"none") for site in headers.get(b"sec-fetch-site", []))
        # a link to the page, in a terminal that is a page itself, may be followed, and a report within a sandbox, which
        # is a site of its own, be read again
        pages = (f"/{self.token}/", f"/{self.token}/report/")
        page = scope["path"] == pages[0] or scope["path"].startswith(pages[1])
        if elsewhere and not (page and headers.get(b"sec-fetch-dest") == [b"document"]):
            return "requests from another site are refused"
        if scope["method"] not in ("GET", "HEAD") and headers.get(b"content-type") != [b"application/json"]:
            return "changes must be sent as JSON"
        if any(not n.isdigit() or int(n) > LARGEST for n in headers.get(b"content-length", [])):
            return "the request is too long"
        if b"transfer-encoding" in headers:
            return "a request must state its length"
        given = scope["path"].split("/", 2)[1] if scope["path"].startswith("/") else ""
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            return "the address lacks its token; use the one that the command printed"
        return ""

    def _within(self, scope: Scope) -> Scope:
        """Return the request with a path that begins behind the token."""
        rest = scope["path"][1 + len(self.token) :]
        return {**scope, "path": rest or "/", "raw_path": (rest or "/").encode()}


async def _refuse(send: Send, why: str) -> None:
    body = why.encode()
    headers = [(b"content-type", b"text/plain; charset=utf-8"), *HEADERS]
    await send({"type": "http.response.start", "status": 403, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def _with_headers(send: Send) -> Send:
    """Return a way to send that adds the headers every answer has, but for those that it has itself."""

    async def sending(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            own = list(message.get("headers", []))
            known = {name.lower() for name, _ in own}
            message = {**message, "headers": own + [h for h in HEADERS if h[0] not in known]}
        await send(message)

    return sending
