"""No test, nor what it runs in this process, may reach another machine: such calls are refused and counted."""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import sys
from typing import Any

CALLS_OUT: list[str] = []
_WATCHED = ("socket.connect", "socket.sendto", "socket.getaddrinfo", "socket.gethostbyname")


def _own_names() -> set[str]:
    names = {"", "localhost", socket.gethostname(), socket.getfqdn()}
    # a machine may have no name of its own
    with contextlib.suppress(OSError):
        names.update(str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None))
    return names


_OWN = _own_names()


def _stays_here(host: Any, connects: bool) -> bool:
    if not isinstance(host, str):
        return True  # None, or bytes of a local socket
    if host in _OWN:
        return True
    try:
        number = ipaddress.ip_address(host)
    except ValueError:
        return False
    # looking at the digits of an address asks nobody
    return not connects or number.is_loopback or number.is_unspecified


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if event not in _WATCHED:
        return
    connects = event in ("socket.connect", "socket.sendto")
    place = arguments[1] if connects else arguments[0]
    host = place[0] if connects and isinstance(place, tuple) and place else None if connects else place
    if not _stays_here(host, connects):
        CALLS_OUT.append(f"{event} {place}")
        raise PermissionError(f"{event} {place}: leaves the machine")


def watch() -> None:
    """From now on, for the whole process."""
    sys.addaudithook(_hook)
