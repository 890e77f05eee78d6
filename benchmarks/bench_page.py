"""How the page behaves: usable after the command, streaming at full speed, click to curves, what-if, memory.

Run as a script (it needs Playwright's Python client and Chromium, as the browser tests do). The server runs in a
process of its own, the browser in another, two workers beside them; every time is taken inside the browser, from the
mouse's event to the change on the screen. Evaluations of the stream cost 4 ms and carry a real design's full result, so
that generations come faster than real ones do. Graphics are software: on a machine with a GPU the browser's share is
smaller. ``usable`` is measured in two browsers: one that is made to draw the page by SwiftShader's GL as well, as
the browser tests use it; one that was left to find that there is no graphics hardware, as a person's is. The rest is
measured in the first, or with ``--as-found`` in the second. The machine's load is printed because wall times mean
little on a busy one.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import viser

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.result import Evaluation
from tools.chromium import ARGUMENTS, AS_FOUND, chromium_program

_BROWSERS = {"all by SwiftShader": ARGUMENTS, "as found": AS_FOUND}
_BURN_SECONDS = 0.004
_WATCH = """
    window.watch = (test) => {
        window.ended = null;
        const passed = new Function('return ' + test);
        const observer = new MutationObserver(() => {
            if (passed()) { window.ended = performance.now(); observer.disconnect(); }
        });
        observer.observe(document.body, {subtree: true, childList: true, attributes: true, characterData: true});
    };
    document.addEventListener('pointerup', (event) => { window.began = event.timeStamp; }, true);
    document.addEventListener('keydown', (event) => { window.began = event.timeStamp; }, true);
"""


# ---- the server's side -----------------------------------------------------------------------------------------------
def streamed(
    case: Case, variables: DesignVariables, level: int, reference: object, templates: dict[int, Evaluation]
) -> Evaluation:
    """A real design's whole result under these variables, with two conflicting objectives."""
    ends = time.process_time() + _BURN_SECONDS
    while time.process_time() < ends:
        pass
    space = case.bounds
    shares = [
        (value - low) / (high - low) if high > low else 0.0
        for value, low, high in zip(space.values(variables).values(), space.lower, space.upper, strict=True)
    ]
    off = 0.2 * sum((share - 0.5) ** 2 for share in shares[1:])
    first, second = 0.9 + 0.2 * shares[0] + off, 1.1 - 0.2 * max(shares[0], 0.0) ** 0.5 + off
    return dataclasses.replace(
        templates[level],
        variables=variables,
        objectives={"f1": first + 0.02 * (level - 1), "f2": second + 0.02 * (level - 1)},
        constraints={"displacement": -0.01, "diameter_to_draft": -0.1, "cavitation": -0.05},
        feasible=True,
    )


def serve(folder: Path, port: int) -> None:
    """The page on the recommended case, whose Start streams."""
    from explorer.app import Explorer
    from explorer.server.process import serve_from_here
    from explorer.services import run_keeper
    from hpsop_core.evaluation.evaluate import evaluate
    from hpsop_core.evaluation.reference import Reference, reference_for
    from hpsop_core.runs.tasks import Physics

    serve_from_here()
    case = load_case("dtc-p4119")
    templates = {level: evaluate(case, case.initial.variables, level, reference_for(case, level)) for level in (1, 2)}
    physics = Physics(partial(streamed, templates=templates), reference_for, Reference.from_dict)
    run_keeper.RunController = partial(run_keeper.RunController, physics=physics)  # type: ignore[assignment,misc]
    explorer = Explorer(case, port=port, folder=folder, workers=2)
    signal.signal(signal.SIGTERM, lambda *_: explorer._gone.set())
    signal.signal(signal.SIGUSR1, lambda *_: threading.Thread(target=drag, args=(explorer,)).start())
    print(explorer.address, flush=True)
    explorer.wait()
    explorer.close()


def drag(explorer: Any) -> None:
    """Move the first browser's L/B slider as a hand would, and tell how often it was answered."""
    session = next(iter(explorer.state.sessions.values()))
    widgets = explorer.server.get_clients()[session.client_id].gui._gui_input_handle_from_uuid.values()
    slider = next(widget for widget in widgets if isinstance(widget, viser.GuiSliderHandle) and widget.label == "L/B")
    answers: list[object] = []
    geometries: list[object] = []
    select, geometry = session.select, explorer.services.designs.geometry

    def counted_select(shown: Any) -> None:
        answers.append(shown)
        select(shown)

    def counted_geometry(variables: DesignVariables, *options: Any) -> Any:
        geometries.append(variables)
        return geometry(variables, *options)

    session.select, explorer.services.designs.geometry = counted_select, counted_geometry
    busy = time.process_time()
    for step in range(100):
        slider._impl.value = 7.0 + 0.01 * abs((step % 60) - 30) + 1e-4 * step
        for callback in slider._impl.update_cb:
            callback(viser.GuiEvent(None, session.client_id, slider))
        time.sleep(0.05)
    busy = time.process_time() - busy
    session.worker.wait_until_idle(10.0)
    session.select, explorer.services.designs.geometry = select, geometry
    print(
        f"what-if at 20 moves a second: {len(answers) / 5.0:.0f} answers and {len(geometries) / 5.0:.0f} geometries a "
        f"second, {1e3 * busy / max(len(answers), 1):.0f} ms of processor time each",
        flush=True,
    )


# ---- the browser's side ----------------------------------------------------------------------------------------------
class Visitor:
    """One browser page and the trips it makes."""

    def __init__(self, page: Any) -> None:
        self.page = page
        page.evaluate(_WATCH)

    def trip(self, act: Callable[[], None], test: str) -> float:
        """Milliseconds from the event to the change on the screen that makes the JavaScript ``test`` true."""
        self.page.evaluate("test => window.watch(test)", test)
        act()
        self.page.wait_for_function("() => window.ended !== null", timeout=60_000)
        return float(self.page.evaluate("() => window.ended - window.began"))

    def press(self, action: str, argument: str = "") -> None:
        """Press a button of the page with the mouse."""
        extra = f'[data-arg="{argument}"]' if argument else ""
        x, y = self.page.evaluate(
            """s => { const r = [...document.querySelectorAll(s)].map(e => e.getBoundingClientRect())
                .find(r => r.width > 0); return [r.x + r.width / 2, r.y + r.height / 2]; }""",
            f'[data-act="{action}"]{extra}',
        )
        self.page.mouse.click(x, y)

    def tab_trip(self, name: str) -> float:
        """To a chart's tab and back on the screen."""
        return self.trip(lambda: self.press("tab", name), f"document.querySelector('[data-chart-tab=\"{name}\"]')")

    def heap(self) -> float:
        """JavaScript's live memory in MB."""
        session = self.page.context.new_cdp_session(self.page)
        session.send("HeapProfiler.collectGarbage")
        return float(session.send("Runtime.getHeapUsage")["usedSize"]) / 1e6


def percentiles(times: list[float]) -> str:
    """Median, p95 and worst."""
    ordered = sorted(times)
    p95 = ordered[min(int(0.95 * len(ordered)), len(ordered) - 1)]
    return f"median {statistics.median(ordered):.0f} ms, p95 {p95:.0f} ms, worst {ordered[-1]:.0f} ms of {len(ordered)}"


def resident(process: int) -> float:
    """A process's resident memory in MB."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1e3
    raise RuntimeError("no VmRSS")


def loaded() -> str:
    """The machine's load."""
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def launched(playwright: Any, kind: str) -> Any:
    """A browser with one of the two kinds of software graphics; it tells its memory only when asked to."""
    arguments = [*_BROWSERS[kind], "--enable-precise-memory-info"]
    return playwright.chromium.launch(executable_path=chromium_program(), args=arguments)


@contextlib.contextmanager
def opened(browser: Any, address: str) -> Iterator[Any]:
    """A page that stands: chart, table and numbers of the initial design."""
    context = browser.new_context(viewport={"width": 1366, "height": 768})
    context.add_init_script('localStorage.setItem("hpsop-toured", "1")')
    page = context.new_page()
    page.set_default_timeout(120_000)
    page.goto(address)
    page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
    page.wait_for_selector("svg[data-chart=pareto]")
    page.wait_for_selector("[data-selected]", state="attached")
    yield page
    context.close()


def commanded(folder: str, port: int) -> subprocess.Popen[Any]:
    """The command, in a folder of runs that is its own: it shows the demonstration."""
    command = Path(sys.executable).with_name("hpsop-explore")
    return subprocess.Popen(
        [command, "--no-browser", "--port", str(port)],
        env={**os.environ, "HPSOP_RUNS": folder},
        stdout=subprocess.PIPE,
        text=True,
    )


def usable(browser: Any, kind: str) -> None:
    """From the command to numbers on the screen, in an empty folder of runs."""
    from explorer.server.security import free_port

    found = []
    for _ in range(3):
        with tempfile.TemporaryDirectory() as folder:
            port = free_port("127.0.0.1", 8900)
            began = time.perf_counter()
            server = commanded(folder, port)
            assert server.stdout is not None
            address = server.stdout.readline().split()[2]
            printed = time.perf_counter() - began
            with opened(browser, address):
                found.append((time.perf_counter() - began, printed))
            server.terminate()
            server.wait()
    stands, printed = min(found)
    print(
        f"command to usable page, graphics {kind}: {stands:.1f} s (address printed after {printed:.1f} s), best of "
        f"{', '.join(f'{seconds:.1f}' for seconds, _ in found)}; {loaded()}",
        flush=True,
    )


def stream(visitor: Visitor) -> None:
    """150 generations of 50 at full speed: does the page keep answering, and does it show the end at once?"""
    page = visitor.page
    page.get_by_role("tab", name="Charts", exact=True).first.click()
    page.wait_for_selector("[data-chart-tab]")
    idle = [visitor.tab_trip(name) for _ in range(15) for name in ("failures", "open_water")]
    print(f"round trip, nothing running: {percentiles(idle)}; {loaded()}")
    page.evaluate(
        """() => {
            window.shown = new Map();
            new MutationObserver(() => {
                const g = document.querySelector('[data-run-status]').dataset.generation;
                if (!window.shown.has(g)) window.shown.set(g, performance.now());
            }).observe(document.body, {subtree: true, childList: true, attributes: true});
        }"""
    )
    began = time.perf_counter()
    visitor.press("run_start")
    page.wait_for_function("() => +document.querySelector('[data-run-status]').dataset.generation >= 1")
    trips = []
    while page.locator("[data-run-status]").first.get_attribute("data-run-status") in ("starting", "running"):
        for name in ("failures", "open_water"):
            trips.append(visitor.tab_trip(name))
            time.sleep(0.05)
    seconds = time.perf_counter() - began
    page.wait_for_selector('[data-run-status="finished"][data-generation="150"]', state="attached")
    shown = page.evaluate("() => window.shown.size")
    print(f"stream of 150 generations of 50 in {seconds:.0f} s, two workers: {shown} pictures shown; {loaded()}")
    print(f"round trip while it streams: {percentiles(trips)} (budget p95 150 ms)")


def clicks(visitor: Visitor) -> None:
    """A click on the front: its curves and its table on the screen."""
    page = visitor.page
    visitor.press("tab", "open_water")
    marks = page.evaluate(
        """() => [...document.querySelectorAll('svg[data-chart=pareto] path.mark.level2')].map(e => {
            const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })"""
    )
    times = []
    for x, y in marks[:: max(len(marks) // 25, 1)][:25]:
        before = page.evaluate("() => document.querySelector('[data-card]').dataset.card")
        with contextlib.suppress(Exception):
            times.append(
                visitor.trip(
                    lambda x=x, y=y: page.mouse.click(x, y),  # type: ignore[misc]
                    "(() => { const t = document.querySelector('[data-chart-tab=open_water]'), "
                    "c = document.querySelector('[data-card]').dataset.card; "
                    f"return c !== '{before}' && t && t.innerHTML.includes('Design ' + c); }})()",
                )
            )
        time.sleep(0.5)
    print(f"click on the front to its curves and card: {percentiles(times)} (budget 150 ms); {loaded()}")


def clicks_at_rest(browser: Any) -> None:
    """The same on the demonstration, with no run under way."""
    from explorer.server.security import free_port

    with tempfile.TemporaryDirectory() as folder:
        server = commanded(folder, free_port("127.0.0.1", 8970))
        assert server.stdout is not None
        with opened(browser, server.stdout.readline().split()[2]) as page:
            page.wait_for_selector("svg[data-chart=pareto] path.mark.level2", state="attached")
            page.get_by_role("tab", name="Charts", exact=True).first.click()
            page.wait_for_selector("[data-chart-tab]")
            # the imports of a search come nine seconds after the start
            time.sleep(15.0)
            clicks(Visitor(page))
        server.terminate()
        server.wait()


def what_if(server: subprocess.Popen[Any]) -> None:
    """The L/B slider moved 20 times a second (as viser's client sends a drag) for five seconds.

    The server moves it for the browser: software graphics let a real mouse through only a few times a second.
    """
    server.send_signal(signal.SIGUSR1)
    assert server.stdout is not None
    print(f"{server.stdout.readline().strip()} (budget 10); {loaded()}")


def memory(visitor: Visitor, process: int) -> None:
    """500 selections with the arrow keys."""
    page = visitor.page
    page.get_by_role("tab", name="Charts", exact=True).first.click()
    page.evaluate("() => { const s = document.querySelector('svg[data-chart=pareto]'); s.focus(); }")
    x, y = page.evaluate(
        "() => { const r = document.querySelector('svg[data-chart=pareto]').getBoundingClientRect();"
        " return [r.x + r.width - 24, r.y + 14]; }"
    )
    page.mouse.click(x, y)
    readings, seen = [], set()
    for count in range(501):
        if count % 50 == 0:
            seen.add(page.evaluate("() => document.querySelector('[data-card]').dataset.card"))
        if count % 100 == 0:
            time.sleep(4.0)
            readings.append(f"{count}: {resident(process):.0f} + {visitor.heap():.0f}")
        page.keyboard.press("ArrowRight" if (count // 40) % 2 == 0 else "ArrowLeft")
        time.sleep(0.06)
    assert len(seen) > 2, "the keys did not reach the page"
    print(f"memory [MB] of server + browser's JavaScript after selections: {', '.join(readings)}")


def main() -> None:
    """All of it, or (inside) the server."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--serve", type=Path, default=None)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--only", choices=("usable", "stream", "clicks"), default=None)
    parser.add_argument("--as-found", action="store_true", help="the browser's own choice of software graphics")
    arguments = parser.parse_args()
    if arguments.serve is not None:
        serve(arguments.serve, arguments.port)
        return
    from playwright.sync_api import sync_playwright

    from explorer.server.security import free_port

    with sync_playwright() as playwright:
        if arguments.only in (None, "usable"):
            for kind in _BROWSERS:
                browser = launched(playwright, kind)
                usable(browser, kind)
                browser.close()
        browser = launched(playwright, "as found" if arguments.as_found else "all by SwiftShader")
        if arguments.only in (None, "clicks"):
            clicks_at_rest(browser)
        if arguments.only in (None, "stream"):
            with tempfile.TemporaryDirectory() as folder:
                port = free_port("127.0.0.1", 8950)
                server = subprocess.Popen(
                    [sys.executable, __file__, "--serve", folder, "--port", str(port)],
                    stdout=subprocess.PIPE,
                    text=True,
                )
                assert server.stdout is not None
                address = server.stdout.readline().strip()
                with opened(browser, address) as page:
                    # the first mesh stalls software graphics for seconds
                    time.sleep(10.0)
                    visitor = Visitor(page)
                    stream(visitor)
                    clicks(visitor)
                    what_if(server)
                    memory(visitor, server.pid)
                server.terminate()
                server.wait()
        browser.close()


if __name__ == "__main__":
    main()
