"""A viser server that only its own user can drive.

viser 1.1.1 by default binds every interface, answers whoever comes, from any Origin (so every account of the machine,
and any web page the user has open, could press our buttons), may be framed by any page (so a page could lay itself over
our buttons and steal the clicks), hands out public share tunnels to whoever asks, and silently takes the next port when
one is busy. Here the port is chosen and known before the server starts, every request is judged by
explorer/server/access.py, and the share tunnel is off. What a browser that was let in may say is
explorer/server/guard.py's matter.

This leans on private facts of viser 1.1.1: it reads ``websockets.asyncio.server.serve`` at start and passes it
``process_request``. The version is pinned and tests/faults/test_page_guard.py fails when these facts change.
"""

from __future__ import annotations

import contextlib
import io
import ipaddress
import socket
from typing import Any

import viser
import websockets.asyncio.server as websocket_server
from viser import _messages

from explorer.server.access import Access
from explorer.server.wakeups import mend_wakeups
from hpsop_core.errors import InputError

_PORTS_TO_TRY = 50


def free_port(host: str, port: int) -> int:
    """The first port from ``port`` upwards that can be bound on ``host``.

    Raises InputError when the host is not one of this machine's or when no port near is free.
    """
    if not 1 <= port <= 65535:
        raise InputError(f"--port {port}: must lie between 1 and 65535")
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except (OSError, UnicodeError) as error:
        raise InputError(f"--host {host}: not an address of this machine ({error}); try 127.0.0.1") from None
    for candidate in range(port, min(port + _PORTS_TO_TRY, 65536)):
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((address[0], candidate))
                # Binding with SO_REUSEADDR succeeds on some systems while another process listens: listen() tells.
                probe.listen(1)
            except PermissionError:
                continue
            except OSError as error:
                if error.errno in (99, 49, 10049):
                    raise InputError(f"--host {host}: not an address of this machine; try 127.0.0.1") from None
                continue
            return candidate
    raise InputError(f"--port {port}: no free port up to {port + _PORTS_TO_TRY - 1}; name another")


def address_of(host: str, port: int, token: str) -> str:
    """What to open in a browser of this machine for a server on ``host`` (of any machine, when it is a name)."""
    try:
        number = ipaddress.ip_address(host)
    except ValueError:
        name = host
    else:
        name = "localhost" if number.is_unspecified else f"[{host}]" if number.version == 6 else host
    return f"http://{name}:{port}/?token={token}"


def secure_server(host: str, port: int, label: str, access: Access) -> viser.ViserServer:
    """Start viser on exactly this host and port, open to whom ``access`` lets in, without share tunnels."""
    mend_wakeups()
    serve = websocket_server.serve

    def guarded_serve(*arguments: Any, **settings: Any) -> Any:
        settings["process_request"] = access.judged(settings["process_request"])
        return serve(*arguments, **settings)

    websocket_server.serve = guarded_serve  # type: ignore[assignment, misc]
    try:
        # viser prints a banner of its own; the address is ours to print, once.
        with contextlib.redirect_stdout(io.StringIO()):
            server = viser.ViserServer(host=host, port=port, label=label, verbose=False)
    finally:
        websocket_server.serve = serve  # type: ignore[misc]
    if server.get_port() != port:
        server.stop()
        raise InputError(f"--port {port}: taken by another program a moment ago; start again")
    server.request_share_url = _refuse_share  # type: ignore[method-assign]
    for kind in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(kind)
    return server


def _refuse_share(*_args: Any, **_kwargs: Any) -> None:
    """Nobody gets a public tunnel to this machine."""
