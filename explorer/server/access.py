"""Who may open the page: whoever brings the token of its address, from a page of its own address.

Every request is judged here before viser sees it: the page, its files and the WebSocket that drives it. Two things are
asked for. The *token*, in the address or as the cookie that an address with the token leaves behind: without it, an
answer that says where it is found. And, for the WebSocket, an *Origin* that is the page's own (equal to the Host that
the browser named: so the machine's own names and a tunnel with another local port work) or one that was allowed with
``--allow-origin``: otherwise another page that the same person has open could press our buttons with their cookie.
A page that a browser got from an address whose Origin will be refused says so itself (assets/access.js).
"""

from __future__ import annotations

import gzip
import hashlib
import hmac
import json
import re
from collections.abc import Callable, Sequence
from http import HTTPStatus
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qsl, urlencode, urlsplit

from websockets import Headers
from websockets.http11 import Request, Response

from explorer.server.bridge import page_style
from explorer.server.notices import Notices
from hpsop_core.errors import InputError
from hpsop_core.markup import fill

_SCRIPT, _FRAMES, _STYLE = "hpsop-access.js", "hpsop-frames.js", "hpsop-page.css"
_YEAR = 365 * 24 * 3600
# most of the page is packed inside already: a browser would wait for nothing
_FAST = 1
_HOST = re.compile(r"(?:[A-Za-z0-9._-]{1,253}|\[[0-9A-Fa-f:.]{2,45}\])(?::[0-9]{1,5})?")
_ORIGIN = re.compile(rf"(https?)://({_HOST.pattern})")
# viser's client obeys these in an address: a link could make our page talk to another server, or play its recording
_OF_VISER = ("websocket", "playbackPath")
# Nothing is fetched from anywhere else, no other page frames this one. viser's client is one inline script that makes
# workers, fonts, WebAssembly and formatted text out of its own text.
_POLICY = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; connect-src 'self' {sockets} data: blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


def origin_of(text: str) -> str:
    """An Origin in its one spelling, from what was given to ``--allow-origin``.

    Raises:
        InputError: it is no http address of a host.
    """
    found = _ORIGIN.fullmatch(text.rstrip("/"))
    if found is None:
        shown = text if len(text) <= 60 else text[:57] + "..."
        raise InputError(
            f"--allow-origin {shown!r}: give the address without its path, as https://host or http://host:8080"
        )
    return _spelled(found[1], found[2])


def _spelled(scheme: str, host: str) -> str:
    default = ":443" if scheme == "https" else ":80"
    return f"{scheme}://{host.lower().removesuffix(default)}"


class Access:
    """Judges requests.

    Args:
        token: the secret of the address.
        origins: Origins beside the page's own, as ``origin_of`` spells them.
        notices: told what was refused.
    """

    def __init__(self, token: str, origins: Sequence[str] = (), notices: Notices | None = None) -> None:
        self._token = token.encode("ascii")
        self._origins = tuple(origins)
        self._notices = notices or Notices()
        # cookies know no ports: the name tells the servers of one host apart
        self._cookie = f"hpsop-{hashlib.sha256(self._token).hexdigest()[:12]}"
        self._page: dict[int, bytes] = {}

    def judged(self, answer: Callable[[Any, Request], Response | None]) -> Callable[[Any, Request], Response | None]:
        """viser's answer to a request, for those who may have it (None opens the WebSocket)."""

        def judge(connection: Any, request: Request) -> Response | None:
            host = request.headers.get_all("Host")
            if len(host) != 1 or not _HOST.fullmatch(host[0]):
                return _sealed(_text(HTTPStatus.BAD_REQUEST, "the request names no host"), "")
            response = self._answer(connection, request, host[0], answer)
            return None if response is None else _sealed(response, host[0])

        return judge

    def _answer(
        self, connection: Any, request: Request, host: str, answer: Callable[[Any, Request], Response | None]
    ) -> Response | None:
        query = _query(request.path)
        in_address = [value for name, value in query if name == "token"]
        wants_socket = "Upgrade" in request.headers
        if not self._known(in_address + self._cookies(request)):
            return self._without_token(host, request, wants_socket)
        if wants_socket:
            origins = request.headers.get_all("Origin")
            if len(origins) != 1 or not self._own(origins[0], host):
                return self._foreign(origins, host)
            if "viser-v" not in request.headers.get("Sec-WebSocket-Protocol", ""):
                return _text(HTTPStatus.BAD_REQUEST, "only the page itself speaks to this server")
            return answer(connection, request)
        kept = [(name, value) for name, value in query if name != "token" and name not in _OF_VISER]
        if len(kept) != len(query):
            return self._welcome(kept, bool(in_address))
        if urlsplit(request.path).path == f"/{_SCRIPT}":
            return self._script(host)
        if urlsplit(request.path).path == f"/{_FRAMES}":
            return _text(HTTPStatus.OK, _asset("frames.js"), "application/javascript")
        if urlsplit(request.path).path == f"/{_STYLE}":
            return _text(HTTPStatus.OK, page_style(), "text/css")
        zipped = "gzip" in request.headers.get("Accept-Encoding", "")
        # asked for it as it is: what viser would pack, slowly, would have to be unpacked again
        request.headers.pop("Accept-Encoding", None)
        response = answer(connection, request)
        if response is not None and response.headers.get("Content-Type", "").startswith("text/html"):
            self._add_script(response, zipped)
        return response

    def _known(self, candidates: Sequence[str]) -> bool:
        # each in a time that does not depend on where it differs
        return any(hmac.compare_digest(self._token, value.encode("utf-8", "replace")) for value in candidates)

    def _cookies(self, request: Request) -> list[str]:
        pairs = [pair.strip().partition("=") for line in request.headers.get_all("Cookie") for pair in line.split(";")]
        return [value for name, _, value in pairs if name == self._cookie]

    def _own(self, origin: str, host: str) -> bool:
        found = _ORIGIN.fullmatch(origin)
        if found is None:
            return False
        spelled = _spelled(found[1], found[2])
        return spelled == _spelled("http", host) or spelled in self._origins

    def _without_token(self, host: str, request: Request, wants_socket: bool) -> Response:
        if wants_socket or urlsplit(request.path).path in ("/", "/index.html"):
            self._notices.tell(
                "token",
                f"refused a browser at http://{host} that came without the token: "
                f"open http://{host}/?token=... there, with the token of the address shown at the start",
            )
        if wants_socket:
            return _text(HTTPStatus.FORBIDDEN, "no token: open the address that the terminal shows, with ?token=...")
        page = fill(_asset("refused.html"), f"http://{host}/?token=...")
        return _text(HTTPStatus.FORBIDDEN, str(page), "text/html")

    def _foreign(self, origins: Sequence[str], host: str) -> Response:
        found = _ORIGIN.fullmatch(origins[0]) if len(origins) == 1 else None
        if found is None:
            self._notices.tell("no origin", "refused a connection that names no page it comes from")
            return _text(HTTPStatus.FORBIDDEN, "the Origin header must name the page's own address")
        remedy = f"start hpsop-explore with --allow-origin {_spelled(found[1], found[2])}"
        self._notices.tell(
            "origin", f"refused a page of {found[0]}, as this server is http://{host}: if it is yours, {remedy}"
        )
        return _text(HTTPStatus.FORBIDDEN, f"a page of {found[0]} may not drive this one: if it is yours, {remedy}")

    def _welcome(self, kept: Sequence[tuple[str, str]], with_token: bool) -> Response:
        """On to the page without the secret in its address (and in the browser's history), which becomes a cookie."""
        # relative, so that it holds behind a proxy's prefix as well; the cookie's path is then that prefix
        headers = Headers(Location="./" + (f"?{urlencode(kept)}" if kept else ""))
        if with_token:
            value = self._token.decode("ascii")
            headers["Set-Cookie"] = f"{self._cookie}={value}; Max-Age={_YEAR}; HttpOnly; SameSite=Lax"
        headers["Content-Length"] = "0"
        return Response(HTTPStatus.SEE_OTHER, "See Other", headers, b"")

    def _script(self, host: str) -> Response:
        own = json.dumps([_spelled("http", host), *self._origins])
        return _text(HTTPStatus.OK, f"({_asset('access.js')})({own});\n", "application/javascript")

    def _add_script(self, response: Response, zipped: bool) -> None:
        if zipped not in self._page:
            plain = bytes(response.body)
            ours = (
                f'<head><script src="{_SCRIPT}"></script><script src="{_FRAMES}"></script>'
                f'<link rel="stylesheet" href="{_STYLE}">'
            )
            plain = plain.replace(b"<head>", ours.encode(), 1).replace(b"<title>Viser<", b"<title>hpsop<", 1)
            self._page[zipped] = gzip.compress(plain, _FAST) if zipped else plain
        response.body = self._page[zipped]
        for name, value in (
            ("Content-Length", str(len(response.body))),
            ("Content-Encoding", "gzip" if zipped else "identity"),
        ):
            del response.headers[name]
            response.headers[name] = value


def _query(path: str) -> list[tuple[str, str]]:
    try:
        return parse_qsl(path.partition("?")[2], keep_blank_values=True, max_num_fields=50)
    except ValueError:
        return []


def _text(status: HTTPStatus, text: str, kind: str = "text/plain") -> Response:
    body = text.encode("utf-8")
    headers = Headers({"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body))})
    return Response(int(status), status.phrase, headers, body)


def _asset(name: str) -> str:
    return (files("explorer") / "assets" / name).read_text(encoding="utf-8")


def _sealed(response: Response, host: str) -> Response:
    sockets = f"ws://{host} wss://{host}" if host else ""
    response.headers["Content-Security-Policy"] = _POLICY.format(sockets=sockets)
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Referrer-Policy"] = "no-referrer"
    response.headers["Cache-Control"] = "no-store"
    return response
