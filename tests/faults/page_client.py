"""Programs that speak to the page as a browser does: with its token, or without."""

from __future__ import annotations

import http.client
import socket
import time
from typing import Any
from urllib.parse import urlsplit

import msgspec
import viser
from websockets.sync.client import ClientConnection, connect

from explorer.app import Explorer
from tests.patience import patience


def token_of_address(address: str) -> str:
    """The secret at the end of an address."""
    return urlsplit(address).query.removeprefix("token=")


def connect_as(
    explorer: Explorer,
    origin: str | None,
    token: str | None = None,
    host: str | None = None,
    cookie: str | None = None,
) -> ClientConnection:
    """Open the page's WebSocket.

    Args:
        explorer: whose.
        origin: of the page that asks.
        token: in the address; the right one unless told.
        host: what the address names (a tunnel's or proxy's), unless it is the server's own.
        cookie: the Cookie header.
    """
    port = int(explorer.server.get_port())
    query = token_of_address(explorer.address) if token is None else token
    headers = {} if cookie is None else {"Cookie": cookie}
    uri = f"ws://{host or f'127.0.0.1:{port}'}"
    # a page that builds four others on a busy machine answers late; websockets itself gives up after 10 s
    patient = patience(60.0)
    # whatever end of a tunnel the address names, the connection goes to the server
    wire = socket.create_connection(("127.0.0.1", port), timeout=patient)
    return connect(
        uri + (f"/?token={query}" if query else "/"),
        origin=origin,  # type: ignore[arg-type]
        subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
        additional_headers=headers,
        compression=None,
        max_size=None,
        open_timeout=patient,
        sock=wire,
    )


def fetch(explorer: Explorer, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    """Status, headers (names in lower case) and body of one answer; no redirect is followed."""
    connection = http.client.HTTPConnection("127.0.0.1", int(explorer.server.get_port()), timeout=60)
    try:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()
    finally:
        connection.close()


class Hostile:
    """A program that speaks viser's protocol and says what no browser of ours would."""

    def __init__(self, explorer: Explorer) -> None:
        known = set(explorer.state.sessions)
        self._explorer = explorer
        self.socket = connect_as(explorer, f"http://127.0.0.1:{explorer.server.get_port()}")
        camera = {
            "type": "ViewerCameraMessage",
            "wxyz": (1.0, 0.0, 0.0, 0.0),
            "position": (1.0, 1.0, 1.0),
            "fov": 1.0,
            "near": 0.1,
            "far": 100.0,
            "look_at": (0.0, 0.0, 0.0),
            "up_direction": (0.0, 0.0, 1.0),
            "image_height": 100,
            "image_width": 100,
        }
        self.send(camera)
        give_up = time.monotonic() + 60.0
        while not (fresh := set(explorer.state.sessions) - known) and time.monotonic() < give_up:
            time.sleep(0.02)
        self.session = explorer.state.sessions[fresh.pop()]
        self.told: list[str] = []
        self.session.notify = lambda title, body, color: self.told.append(body)

    def send(self, message: dict[str, Any]) -> None:
        self.socket.send(msgspec.msgpack.encode(message))

    def update(self, widget: Any, **updates: Any) -> None:
        self.send({"type": "GuiUpdateMessage", "uuid": widget._impl.uuid, "updates": updates})

    def refused(self, widget: Any, **updates: Any) -> str:
        """The notification that follows such a message."""
        before = len(self.told)
        self.update(widget, **updates)
        give_up = time.monotonic() + 60.0
        while len(self.told) == before:
            assert time.monotonic() < give_up, f"nobody was told about {updates}"
            time.sleep(0.01)
        return self.told[-1]
