"""A page that only its own user can drive: tokens, Origins, tunnels, frames and what the refused are told."""

from __future__ import annotations

import gzip
import json
import logging
import os
from pathlib import Path
from typing import Any

import pytest
from page_client import connect_as, fetch, token_of_address
from websockets.exceptions import InvalidStatus

from explorer.app import Explorer, main
from explorer.server.access import origin_of
from explorer.server.notices import Notices
from explorer.server.security import address_of, free_port
from explorer.server.token import door, token_of
from hpsop_core.errors import InputError
from tests.two_speeds import stated_case

PROXY = "https://hub.example.org"


@pytest.fixture(scope="module")
def explorer(tmp_path_factory: pytest.TempPathFactory) -> Any:
    # stated waves: the initial design then needs level 1 alone
    case = stated_case()
    port = free_port("127.0.0.1", 8590)
    page = Explorer(case, port=port, folder=tmp_path_factory.mktemp("runs"), workers=1, origins=[PROXY])
    yield page
    page.close()


@pytest.fixture
def told(explorer: Explorer, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> Any:
    """What the terminal says; each test hears the first of every kind."""
    monkeypatch.setattr(explorer.access, "_notices", Notices())
    caplog.set_level(logging.WARNING, "hpsop.explorer")
    return caplog


def _port(explorer: Explorer) -> int:
    return int(explorer.server.get_port())


def _cookie(explorer: Explorer) -> str:
    status, headers, _ = fetch(explorer, f"/?token={token_of_address(explorer.address)}")
    assert status == 303
    return headers["set-cookie"].partition(";")[0]


def _refused(explorer: Explorer, origin: str | None, **how: Any) -> str:
    with pytest.raises(InvalidStatus) as caught:
        connect_as(explorer, origin, **how)
    assert caught.value.response.status_code == 403
    return bytes(caught.value.response.body or b"").decode()


def test_without_the_token_nothing_is_served_and_the_answer_says_why(explorer: Explorer, told: Any) -> None:
    token = token_of_address(explorer.address)
    for path in (
        "/",
        "/index.html",
        "/hpsop-access.js",
        "/?token=",
        "/?token=x",
        f"/?token={token}x",
        "/?Token=" + token,
    ):
        status, _, body = fetch(explorer, path)
        assert status == 403, path
        assert b"lacks its token" in body
        assert token.encode() not in body
    for cookie in ("hpsop=1", f"other={token}", f"{_cookie(explorer)}x", "=;;=", "\xff"):
        assert fetch(explorer, "/", Cookie=cookie)[0] == 403, cookie
    lines = [record.getMessage() for record in told.records]
    # the terminal tells once, what to type and where; never the secret, as the Host may be a stranger's
    assert len(lines) == 1
    assert f"http://127.0.0.1:{_port(explorer)}/?token=..." in lines[0]
    assert token not in lines[0]


def test_what_is_typed_comes_back_as_text(explorer: Explorer) -> None:
    for host in ("<script>alert(1)</script>", "a b", "a\u00e9", "x" * 300):
        status, _, body = fetch(explorer, "/", Host=host.encode("latin-1").decode("latin-1"))
        assert status == 400
        assert b"script" not in body
    status, _, body = fetch(explorer, "/", Host="localhost:9471")
    assert status == 403
    assert b"http://localhost:9471/?token=..." in body


@pytest.mark.parametrize("token", ["x" * 32, "x", ""])
def test_no_account_of_the_machine_drives_the_page_without_the_token(explorer: Explorer, token: str) -> None:
    """A program may state any Origin: on a login node that alone kept nobody out."""
    before = set(explorer.state.sessions)
    assert "token" in _refused(explorer, f"http://127.0.0.1:{_port(explorer)}", token=token)
    assert set(explorer.state.sessions) == before


def test_the_address_leaves_a_cookie_and_loses_its_secret(explorer: Explorer) -> None:
    token = token_of_address(explorer.address)
    assert len(token) >= 32
    status, headers, _ = fetch(explorer, f"/?run=a.hpsop&token={token}&design=7")
    assert status == 303
    assert headers["location"] == "./?run=a.hpsop&design=7"
    assert {"HttpOnly", "SameSite=Lax"} <= set(headers["set-cookie"].split("; "))
    cookie = headers["set-cookie"].partition(";")[0]
    status, headers, body = fetch(explorer, "/", Cookie=f"other=1; {cookie}")
    assert status == 200
    assert body.count(b'<head><script src="hpsop-access.js"></script><script src="hpsop-frames.js"></script>') == 1
    for name, kind in (
        ("access.js", "application/javascript"),
        ("frames.js", "application/javascript"),
        ("page.css", "text/css"),
    ):
        assert fetch(explorer, f"/hpsop-{name}", Cookie=cookie)[1]["content-type"] == f"{kind}; charset=utf-8"
    with connect_as(explorer, f"http://127.0.0.1:{_port(explorer)}", token="", cookie=cookie) as socket_:
        assert socket_.recv(timeout=60)


def test_the_page_arrives_zipped_as_well(explorer: Explorer) -> None:
    cookie = _cookie(explorer)
    plain = fetch(explorer, "/", Cookie=cookie)[2]
    status, headers, body = fetch(explorer, "/", **{"Cookie": cookie, "Accept-Encoding": "gzip"})
    assert (status, headers["content-encoding"]) == (200, "gzip")
    assert fetch(explorer, "/", Cookie=cookie)[1]["content-encoding"] == "identity"
    assert int(headers["content-length"]) == len(body)
    assert gzip.decompress(body) == plain


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://evil.example:8590", "https://localhost:8590", "null", "", None]
)
def test_a_foreign_origin_is_refused_and_told_the_remedy(explorer: Explorer, told: Any, origin: str | None) -> None:
    before = set(explorer.state.sessions)
    answer = _refused(explorer, origin)
    lines = [record.getMessage() for record in told.records]
    assert len(lines) == 1
    if origin and origin != "null":
        assert f"--allow-origin {origin}" in answer
        assert f"--allow-origin {origin}" in lines[0]
    assert set(explorer.state.sessions) == before


def test_names_of_this_machine_tunnels_and_allowed_proxies_are_let_in(explorer: Explorer) -> None:
    port = _port(explorer)
    for origin, host in (
        (f"http://localhost:{port}", f"localhost:{port}"),
        (f"http://127.0.0.1:{port}", f"127.0.0.1:{port}"),
        # ssh -L 9471:127.0.0.1:PORT
        ("http://localhost:9471", "localhost:9471"),
        ("http://127.0.0.1:9471", "127.0.0.1:9471"),
        ("http://[::1]:9471", "[::1]:9471"),
        (f"http://login3.cluster:{port}", f"LOGIN3.cluster:{port}"),
        ("http://10.1.2.3", "10.1.2.3:80"),
        # a proxy that names the server by its own address
        (PROXY, f"127.0.0.1:{port}"),
    ):
        with connect_as(explorer, origin, host=host) as socket_:
            assert socket_.recv(timeout=60), origin


def test_a_page_that_will_be_refused_knows_it(explorer: Explorer) -> None:
    """The script of the page compares the browser's own address with those that are let in."""
    cookie = _cookie(explorer)
    status, _, body = fetch(explorer, "/hpsop-access.js", Cookie=cookie, Host="LocalHost:9471")
    assert status == 200
    own = json.loads(body.decode().rstrip().removesuffix(");").rpartition(")(")[2])
    assert own == ["http://localhost:9471", PROXY]


def test_a_link_cannot_turn_the_page_to_another_server(explorer: Explorer) -> None:
    """viser's client obeys ``websocket`` and ``playbackPath`` in the address; a stranger's link must not."""
    cookie = _cookie(explorer)
    for path in (
        "/?websocket=ws://evil.example&darkMode",
        "/index.html?%77ebsocket=ws://evil.example&darkMode",
        "/?darkMode&playbackPath=http://evil.example/x.viser",
    ):
        status, headers, _ = fetch(explorer, path, Cookie=cookie)
        assert (status, headers["location"]) == (303, "./?darkMode="), path
        assert "set-cookie" not in headers


def test_no_page_may_frame_this_one_and_nothing_foreign_is_fetched(explorer: Explorer) -> None:
    for cookie in (_cookie(explorer), ""):
        _, headers, body = fetch(explorer, "/", Cookie=cookie)
        rules = dict(rule.split(" ", 1) for rule in headers["content-security-policy"].split("; "))
        assert rules["frame-ancestors"] == "'none'"
        assert set(rules["connect-src"].split()) == {
            "'self'",
            f"ws://127.0.0.1:{_port(explorer)}",
            f"wss://127.0.0.1:{_port(explorer)}",
            "data:",
            "blob:",
        }
        assert "*" not in headers["content-security-policy"]
        assert headers["referrer-policy"] == "no-referrer"
        assert b"<html" in body.lower()


def test_files_outside_the_client_are_not_served(explorer: Explorer) -> None:
    cookie = _cookie(explorer)
    for path in ("/../pyproject.toml", "/%2e%2e/%2e%2e/etc/passwd", "/..%5c..%5cetc/passwd"):
        assert fetch(explorer, path, Cookie=cookie)[0] == 404


def test_the_token_stays_with_its_folder_as_long_as_it_is_private(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    first = token_of(folder)
    path = folder / "page-token"
    assert path.stat().st_mode & 0o777 == 0o600
    assert token_of(folder) == first
    path.chmod(0o640)
    second = token_of(folder)
    assert second != first
    for text in ("", "short", "x" * 31 + "\u00e9", second + "a"):
        path.write_text(text, encoding="utf-8")
        assert token_of(folder) not in (text, second)
        assert path.stat().st_mode & 0o777 == 0o600
    outside = tmp_path / "outside"
    outside.write_text(second, encoding="utf-8")
    outside.chmod(0o600)
    path.unlink()
    path.symlink_to(outside)
    assert token_of(folder) != second
    assert outside.read_text(encoding="utf-8") == second
    assert token_of(tmp_path / "other") != token_of(folder)
    # where nothing can be kept, each start has its own
    nowhere = tmp_path / "file"
    nowhere.write_text("", encoding="utf-8")
    assert token_of(nowhere / "runs") != token_of(nowhere / "runs")


def test_the_browser_is_started_without_the_secret_on_its_command_line(tmp_path: Path) -> None:
    """Every account reads the command lines of every process."""
    address = "http://127.0.0.1:8080/?token=secret&x=1"
    with door(tmp_path, address) as entrance:
        assert "secret" not in entrance
        path = Path(entrance.removeprefix("file://"))
        assert path.stat().st_mode & 0o777 == 0o600
        assert "url=http://127.0.0.1:8080/?token=secret&amp;x=1" in path.read_text(encoding="utf-8")
    assert not os.listdir(tmp_path)
    with door(tmp_path / "nowhere\0", address) as entrance:
        assert entrance == "http://127.0.0.1:8080/"


def test_addresses_are_valid_for_every_kind_of_host() -> None:
    assert address_of("127.0.0.1", 8080, "t") == "http://127.0.0.1:8080/?token=t"
    assert address_of("::1", 8080, "t") == "http://[::1]:8080/?token=t"
    assert address_of("0.0.0.0", 80, "t") == "http://localhost:80/?token=t"
    assert address_of("::", 80, "t") == "http://localhost:80/?token=t"
    assert address_of("login3", 80, "t") == "http://login3:80/?token=t"


def test_allowed_origins_have_one_spelling() -> None:
    assert origin_of("https://Hub.example.org:443/") == PROXY
    assert origin_of("http://localhost:9471") == "http://localhost:9471"
    for text in ("hub.example.org", "https://hub.example.org/path", "*", "https://*", "", "case.toml", "http://a b"):
        with pytest.raises(InputError, match="--allow-origin"):
            origin_of(text)


def test_the_command_refuses_an_origin_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--no-browser", "--allow-origin", "hub.example.org" * 9000]) == 2
    error = capsys.readouterr().err
    assert "--allow-origin" in error
    assert error.count("\n") == 1
    assert len(error) < 300


def test_a_kind_of_notice_is_told_once_and_then_counted(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING, "hpsop.explorer")
    silent = Notices()
    for _ in range(500):
        silent.tell("frame", "a broken frame")
    assert [record.getMessage() for record in caplog.records] == ["a broken frame"]
    caplog.clear()
    chatty = Notices(quiet=0.0)
    chatty._more["frame"] = 499
    chatty.tell("frame", "a broken frame")
    assert "499 more" in caplog.records[0].getMessage()
