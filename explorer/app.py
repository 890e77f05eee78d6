"""`hpsop-explore`: the page on a case or a run."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import logging
import multiprocessing
import os
import signal
import sys
import threading
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import as_file
from pathlib import Path
from typing import Any

import viser

from explorer.layout import build_session, build_shared
from explorer.server.access import Access, origin_of
from explorer.server.notices import Notices
from explorer.server.quiet import loud_again, quiet
from explorer.server.security import address_of, free_port, secure_server
from explorer.server.token import door, token_of
from explorer.server.visitors import Visitors
from explorer.server.worker import LatestWorker
from explorer.services.library import RunLibrary, runs_folder
from explorer.services.page_memory import PageMemory, remembered
from explorer.services.reading import HULL_SUFFIXES, hull_file
from explorer.services.services import open_services
from explorer.state.app_state import AppState
from explorer.state.draft import Draft
from explorer.state.hub import Hub
from explorer.state.run_picture import RunPicture
from explorer.state.session import Session
from explorer.views.scene_view import prepare_scene
from hpsop_core.assets import asset_path
from hpsop_core.case.case import DEFAULT_CASE, Case, load_case
from hpsop_core.errors import HpsopError, InputError
from hpsop_core.runs.reader import open_run

_IMPORT_SECONDS = 9.0
# an evaluation under way is waited for, 3 s at most, and workers that still import
_CLOSING_SECONDS = 40.0


class Explorer:
    """The page: a server, the shared state, and a session for each browser.

    Args:
        case: what is set up at first.
        run: a run file to show, or None.
        read_only: of that run.
        host, port: where to listen; the port must be free.
        folder: of the user's runs.
        workers: processes of a run.
        restored: what the settings were when the server last stopped (``remembered``), if they are to come back.
        origins: Origins of pages that may drive this one beside its own (``origin_of``).
        run_asked: whether a person asked for that run; where not, the demonstration stands in for one that is damaged.
        hull: a hull file to bring in: its name for people, and its bytes.
        announce: called with this as soon as a browser can be sent to ``address``; all else is made meanwhile.

    Attributes:
        address: what opens the page, with its token.
        trouble: why another run is shown than the one given, or "".

    Raises:
        InputError: the run file or the address cannot be used.
    """

    def __init__(
        self,
        case: Case,
        run: Path | None = None,
        read_only: bool = False,
        host: str = "127.0.0.1",
        port: int = 8080,
        folder: Path | None = None,
        workers: int | None = None,
        restored: Mapping[str, Any] | None = None,
        origins: Sequence[str] = (),
        run_asked: bool = True,
        hull: tuple[str, bytes] | None = None,
        announce: Callable[[Explorer], None] = lambda explorer: None,
    ) -> None:
        self._gone = threading.Event()
        self.folder = folder or runs_folder()[0]
        token = token_of(self.folder)
        self.address = address_of(host, port, token)
        draft = Draft(case)
        draft.begin(case)
        if restored is not None:
            draft.restore(restored)
            with contextlib.suppress(InputError):
                case = draft.case()
        worker = LatestWorker("shared")
        browsers = remembered(self.folder).browsers
        self.state = AppState(draft, worker, Hub(worker), RunPicture("", case), memory=browsers)
        self.services = open_services(self.state, RunLibrary(self.folder, demonstration()), workers)
        self.services.runs.await_browser()
        self.trouble = ""
        if run is not None and run_asked:
            self._open(run, read_only, run_asked)
        if hull is not None:
            self.services.ships.bring_hull(*hull)
        notices = Notices()
        self.access = Access(token, origins, notices)
        self.server = secure_server(host, port, "hpsop", self.access)
        # nothing can be refused any more, and a browser takes seconds to load the page
        announce(self)
        if run is not None and not run_asked:
            self._open(run, read_only, run_asked)
        self.quiet = quiet(self.server._event_loop, notices)
        self.state.hub.on(("draft",), self.services.runs.draft_changed)
        self.state.on_remember = lambda: worker.latest("memory", self._save_memory)
        # the run on display and the settings come back too
        self.state.hub.on(("draft", "library"), self._save_memory)
        self.settings = build_shared(self.state, self.services, self.server)
        self._visitors = Visitors(self.server, self._visited)
        # the run that was on display before may have been a large one
        self.state.hub.on(("library",), self._visitors.tidy_soon)
        # What is seen first stands ready when the first browser asks.
        worker.latest("initial", self._warm_up)
        # The search's imports hold the interpreter for a second: not while the page loads, nor when Start is pressed.
        early = threading.Timer(_IMPORT_SECONDS, importlib.import_module, ("hpsop_core.runs.replay",))
        early.daemon = True
        early.start()

    def _open(self, run: Path, read_only: bool, asked: bool) -> None:
        try:
            self.services.runs.open(run, read_only)
        except HpsopError as error:
            if asked:
                raise
            self.trouble = str(error)
            shown = demonstration()
            if shown is not None and shown != run:
                with contextlib.suppress(HpsopError):
                    self.services.runs.open(shown, read_only=True)

    def _warm_up(self) -> None:
        try:
            self.services.designs.first()
            prepare_scene(self.services.designs)
        except HpsopError as error:
            logging.getLogger("hpsop.explorer").error("the initial design cannot be computed: %s", error)

    def _visited(self, client: viser.ClientHandle) -> Callable[[], None]:
        """Build a browser's page; returns what takes it down again."""

        def notify(title: str, body: str, color: str) -> None:
            colors = {"red": (201, 42, 42), "yellow": (232, 163, 23), "green": (43, 138, 62), "blue": (25, 113, 194)}
            with contextlib.suppress(RuntimeError):
                client.add_notification(title, body, auto_close_seconds=8.0, color=colors.get(color, (90, 90, 90)))

        session = Session(self.state, client.client_id, notify)

        def take_down() -> None:
            self.state.leave(client.client_id)
            session.close()
            self.state.tell_all("people")

        self.state.join(client.client_id, session)
        try:
            build_session(session, self.services, client)
        except BaseException:
            take_down()
            raise
        self.state.tell_all("people")
        return take_down

    def _save_memory(self) -> None:
        with self.state.lock:
            memory = PageMemory(dict(self.state.memory), self.state.picture.name, self.state.draft.saved())
        memory.save(self.folder)

    def wait(self) -> None:
        """Until ``close`` or Ctrl-C."""
        while not self._gone.wait(0.5):
            pass

    def close(self) -> None:
        """End the run (its file keeps everything) and the server; no process stays behind."""
        self._gone.set()
        self._visitors.close()
        self.services.close()
        # viser says goodbye on standard output, which is ours
        with contextlib.suppress(RuntimeError), contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()
        loud_again(self.quiet)
        self.state.worker.close()


def demonstration() -> Path | None:
    """The shipped finished run, if there is one."""
    folder = asset_path("demo")
    names = sorted(item.name for item in folder.iterdir() if item.name.endswith(".hpsop")) if folder.is_dir() else []
    if not names:
        return None
    with as_file(folder / names[0]) as path:
        # hpsop is installed as plain files; a zipped installation would need a copy that outlives this block
        return path if path.is_file() else None


@dataclass(frozen=True)
class _Opening:
    """What a start of the command shows: the case to set up, a run, and the settings of last time."""

    case: Case
    run: Path | None = None
    read_only: bool = False
    restored: Mapping[str, Any] | None = None
    hull: tuple[str, bytes] | None = None


def _chosen(words: Sequence[str], folder: Path) -> _Opening:
    if len(words) == 2 and words[0].lower() == "hull":
        return _Opening(load_case(DEFAULT_CASE), hull=hull_file(words[1]))
    if len(words) > 1:
        raise InputError(f"hpsop-explore: '{words[1]}' is one too many; give a case, a run, or hull FILE")
    if words:
        what = words[0]
        if Path(what).suffix.lower() in HULL_SUFFIXES:
            return _Opening(load_case(DEFAULT_CASE), hull=hull_file(what))
        if what.endswith(".hpsop"):
            return _Opening(open_run(what).case, Path(what))
        return _Opening(load_case(what))
    # where one was: the run last shown, else the newest of one's own, else the demonstration, else the bare case
    library, memory = RunLibrary(folder), remembered(folder)
    newest = [entry.name for entry in library.entries() if entry.title != "not readable"]
    for name in (memory.run, *newest):
        path = library.path(name)
        if path is not None:
            with contextlib.suppress(HpsopError):
                return _Opening(open_run(path).case, path, restored=memory.draft)
    shown = demonstration()
    return _Opening(load_case(DEFAULT_CASE), shown, shown is not None, memory.draft)


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    class Parser(argparse.ArgumentParser):
        def error(self, message: str) -> None:  # type: ignore[override]
            raise InputError(f"hpsop-explore: {message}; see hpsop-explore --help")

    parser = Parser(
        prog="hpsop-explore", description="The design explorer: optimise a ship and its propeller and watch."
    )
    parser.add_argument(
        "what",
        nargs="*",
        metavar="CASE | RUN.hpsop | hull FILE",
        help="a shipped case, a TOML file, a run, or a hull file of your own; by default your latest run",
    )
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on (default: this machine only)")
    parser.add_argument("--port", type=int, default=8080, help="port (default 8080; the next free one if it is busy)")
    parser.add_argument(
        "--allow-origin",
        nargs="+",
        action="extend",
        default=[],
        metavar="URL",
        help="addresses of a proxy of yours through which the page is opened, as https://host",
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument("--workers", type=int, default=None, help="processes of a run (default: all cores)")
    return parser.parse_intermixed_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    """The command; returns the exit status."""
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s")
    with contextlib.ExitStack() as doors:
        try:
            arguments = _arguments(argv)
            if arguments.workers is not None and arguments.workers < 1:
                raise InputError(f"--workers {arguments.workers}: give 1 or more")
            origins = [origin_of(text) for text in arguments.allow_origin]
            folder, homeless = runs_folder()
            opening = _chosen(arguments.what, folder)
            port = free_port(arguments.host, arguments.port)
            explorer = Explorer(
                opening.case,
                opening.run,
                opening.read_only,
                arguments.host,
                port,
                folder,
                arguments.workers,
                opening.restored,
                origins,
                run_asked=bool(arguments.what),
                hull=opening.hull,
                announce=lambda page: _announce(page, arguments, port, homeless, doors),
            )
        except HpsopError as error:
            sys.stderr.write(f"{error}\n")
            return 2
        if explorer.trouble:
            sys.stderr.write(f"{explorer.trouble}\nthe demonstration is shown instead\n")
        try:
            explorer.wait()
        finally:
            # who presses Ctrl-C again does not want to wait
            signal.signal(signal.SIGINT, lambda *_: _end_now())
            late = threading.Timer(_CLOSING_SECONDS, _end_now)
            late.daemon = True
            late.start()
            try:
                explorer.close()
            finally:
                late.cancel()
    return 0


def _announce(
    explorer: Explorer, arguments: argparse.Namespace, port: int, homeless: str, doors: contextlib.ExitStack
) -> None:
    """Say where the page is, send a browser there, and end it from now on when the terminal says so."""
    if homeless:
        sys.stderr.write(f"{homeless}\n")
    if port != arguments.port:
        sys.stderr.write(f"port {arguments.port} is busy; using {port}\n")
    if arguments.host not in ("127.0.0.1", "localhost", "::1"):
        sys.stderr.write(
            "others on the network can drive the page if they learn its token, which travels unencrypted: "
            "a tunnel (ssh -L) is safer\n"
        )
    # not as an exception, which something that runs in between may swallow
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, lambda *_: explorer._gone.set())
    # The terminal was closed; with nohup it is ignored, and stays so.
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: explorer._gone.set())
    sys.stdout.write(f"hpsop explorer: {explorer.address}   (Ctrl-C ends it)\n")
    sys.stdout.flush()
    if not arguments.no_browser:
        entrance = doors.enter_context(door(explorer.folder, explorer.address))
        # one of the terminal's own returns when it is left
        threading.Thread(target=_send_browser, args=(entrance,), name="browser", daemon=True).start()


def _send_browser(entrance: str) -> None:
    with contextlib.suppress(webbrowser.Error):
        webbrowser.open(entrance)


def _end_now() -> None:
    """End this process and its workers as they are: a run's file needs no goodbye."""
    for child in multiprocessing.active_children():
        child.kill()
    sys.stderr.write("hpsop-explore: ended without waiting; a run's file keeps all that is finished\n")
    sys.stderr.flush()
    os._exit(0)


if __name__ == "__main__":
    sys.exit(main())
