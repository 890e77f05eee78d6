"""The page by its address with the token, through a tunnel and through a proxy, in a real browser."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Callable, Iterator
from urllib.parse import urlsplit

import pytest
from conftest import PATIENCE, new_context
from playwright.sync_api import Browser, Page

from explorer.app import Explorer


class Forwarder:
    """One end of a tunnel: what comes to its own port goes to the page's, through ``change`` at first."""

    def __init__(self, port: int, change: Callable[[bytes], bytes] = lambda head: head) -> None:
        self._target, self._change = port, change
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._server.getsockname()[1])
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._server.accept()
                far = socket.create_connection(("127.0.0.1", self._target))
                threading.Thread(target=_pump, args=(near, far, self._change), daemon=True).start()
                threading.Thread(target=_pump, args=(far, near, lambda data: data), daemon=True).start()

    def close(self) -> None:
        """No further connections."""
        self._server.close()


def _pump(source: socket.socket, sink: socket.socket, change: Callable[[bytes], bytes]) -> None:
    with contextlib.suppress(OSError):
        while data := source.recv(65536):
            sink.sendall(change(data))
    for end in (source, sink):
        with contextlib.suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    """A browser that was never here before."""
    context = new_context(chromium, 1366, 768)
    fresh = context.new_page()
    fresh.set_default_timeout(PATIENCE)
    yield fresh
    context.close()


def _stands(page: Page) -> None:
    page.wait_for_selector("svg[data-chart=pareto]")
    page.wait_for_selector("[data-selected]", state="attached")


def test_the_address_opens_the_page_and_the_browser_keeps_its_token(explorer: Explorer, page: Page) -> None:
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(explorer.address)
    _stands(page)
    assert "token" not in page.url
    # the policy of what may be fetched is kept by everything the page does
    assert not complaints
    page.goto(explorer.address.partition("?")[0])
    _stands(page)


def test_without_the_token_the_page_says_where_it_is(explorer: Explorer, page: Page) -> None:
    answer = page.goto(explorer.address.partition("?")[0])
    assert answer is not None
    assert answer.status == 403
    assert page.get_by_role("heading", name="This address lacks its token").is_visible()
    assert page.get_by_text(f"{explorer.address.partition('?')[0]}?token=...").is_visible()


def test_a_tunnel_with_another_port_works(explorer: Explorer, page: Page) -> None:
    tunnel = Forwarder(int(explorer.server.get_port()))
    page.goto(f"http://localhost:{tunnel.port}/?{urlsplit(explorer.address).query}")
    _stands(page)
    tunnel.close()


def test_behind_a_proxy_that_was_not_allowed_the_page_says_what_to_type(explorer: Explorer, page: Page) -> None:
    port = int(explorer.server.get_port())
    proxy = Forwarder(port, lambda data: data.replace(f"localhost:{proxy.port}\r\n".encode(), b"server.inside\r\n", 1))
    page.goto(f"http://localhost:{proxy.port}/?{urlsplit(explorer.address).query}")
    page.wait_for_selector("[data-refused]")
    assert page.get_by_text(f"hpsop-explore --allow-origin http://localhost:{proxy.port}", exact=True).is_visible()
    proxy.close()
