"""`hpsop-explore RUN.hpsop` on a run that another process writes; a restarted server brings the page back."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import PATIENCE, choose_tab, new_context, press, small_case, wait_until

from explorer.server.security import free_port
from hpsop_core.runs.reader import open_run

BIN = Path(sys.executable).parent


class Command:
    """The real command on one port; started again as often as wanted."""

    def __init__(self, folder: Path, port: int) -> None:
        self._folder = folder
        self.port = port
        self.address = ""
        self.process: subprocess.Popen[str] | None = None

    def start(self, *arguments: str) -> str:
        """Start it and wait for the line that names the address."""
        self.process = subprocess.Popen(
            [BIN / "hpsop-explore", *arguments, "--no-browser", "--port", str(self.port)],
            env={**os.environ, "HPSOP_RUNS": str(self._folder)},
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        self.address = line.split()[2]
        return line

    def kill(self) -> None:
        """As a crash would."""
        assert self.process is not None
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def writer(folder):
    """Another process that writes a run, slowly enough to be watched."""
    case = folder / "small.toml"
    case.write_text(small_case(generations=5000, level1_generations=5000, population=6).to_toml(), encoding="utf-8")
    run = folder / "watched.hpsop"
    process = subprocess.Popen(
        [BIN / "hpsop", "optimize", case, "--run", run, "--workers", "1"],
        stderr=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    process.run = run
    wait_until(lambda: run.exists() and _generations(run) >= 1, 90, "the first generation")
    yield process
    process.kill()
    process.wait()


def _generations(run: Path) -> int:
    try:
        return open_run(run).progress()[0]
    except Exception:  # noqa: BLE001 - not there yet
        return 0


@pytest.fixture(scope="module")
def command(folder):
    found = Command(folder, free_port("127.0.0.1", 8160))
    yield found
    if found.process is not None and found.process.poll() is None:
        found.kill()


def generation(page) -> int:
    return int(page.locator("[data-run-status]").first.get_attribute("data-generation"))


@pytest.fixture(scope="module")
def page(chromium, command, writer):
    line = command.start(str(writer.run))
    assert line.startswith(f"hpsop explorer: http://127.0.0.1:{command.port}/?token=")
    context = new_context(chromium, 1366, 768)
    opened = context.new_page()
    opened.set_default_timeout(PATIENCE)
    opened.goto(command.address)
    opened.add_style_tag(content=".mantine-Notifications-root{display:none!important}")
    opened.wait_for_selector("[data-selected]", state="attached")
    yield opened
    context.close()


def test_a_run_that_another_process_writes_is_followed(page, command, writer):
    page.wait_for_selector('[data-run-status="running"]:has-text("Running elsewhere")')
    seen = generation(page)
    page.wait_for_function(f"() => +document.querySelector('[data-run-status]').dataset.generation >= {seen + 2}")
    # it is not ours to drive: neither continued, extended nor stopped from here
    for action in ("run_continue", "run_extend", "run_stop", "run_pause"):
        assert page.locator(f'[data-act="{action}"]:visible').count() == 0
    choose_tab(page, "What-if")
    assert page.get_by_role("button", name="Add to the run's archive as a hand-made design").is_disabled()
    choose_tab(page, "Design")
    press(page, "choose", "compromise")
    page.wait_for_function("() => document.querySelector('[data-selected]').dataset.selected !== 'initial'")
    # the writer is never disturbed by the reader
    assert writer.poll() is None


def test_after_a_crash_of_the_server_the_page_comes_back(page, command, writer):
    """Selection, pin, tab and scrubber stand there again without a reload, once the server is started again."""
    press(page, "pin")
    choose_tab(page, "Charts")
    press(page, "tab", "convergence")
    page.wait_for_selector('[data-chart-tab="convergence"]')
    press(page, "step", "-1")
    page.wait_for_selector('[data-act="follow"][aria-pressed="false"]')
    chosen = page.locator("[data-card]").get_attribute("data-card")
    assert chosen.isdecimal()
    command.kill()
    command.start(str(writer.run))
    page.wait_for_selector(f'[data-card="{chosen}"]')
    page.wait_for_selector('[data-chart-tab="convergence"]')
    page.wait_for_selector('[data-act="follow"][aria-pressed="false"]')
    choose_tab(page, "Compare")
    page.wait_for_selector('[data-act="unpin"]')


def test_when_the_writer_is_killed_the_run_can_go_on_here(page, command, writer):
    writer.send_signal(signal.SIGKILL)
    writer.wait()
    page.wait_for_selector('[data-run-status="stopped"]')
    done = generation(page)
    press(page, "run_continue")
    page.wait_for_function(f"() => +document.querySelector('[data-run-status]').dataset.generation >= {done + 2}")
    press(page, "run_stop")
    page.wait_for_selector('[data-run-status="stopped"]')


def test_settings_and_run_come_back_where_no_case_is_named(page, command, writer):
    """The command without an argument continues where one was: same run, same changed settings."""
    choose_tab(page, "Design space")
    element = page.locator('label:has-text("Seed")').locator("xpath=ancestor::*[.//input][1]//input")
    element.click()
    page.keyboard.press("Control+a")
    page.keyboard.type("77", delay=90)
    page.wait_for_selector('label:has-text("Seed ●")')
    done = generation(page)
    page.wait_for_timeout(500)
    command.kill()
    command.start()
    page.wait_for_selector('label:has-text("Seed ●")')
    wait_until(lambda: element.input_value() == "77", 30, "the changed seed")
    page.wait_for_selector(f'[data-run-status="stopped"][data-generation="{done}"]')
    page.wait_for_selector('[title="watched.hpsop"]')


def test_ctrl_c_leaves_no_process_behind(page, command):
    choose_tab(page, "Runs")
    press(page, "run_continue")
    page.wait_for_selector('[data-run-status="running"]')
    assert command.process is not None
    children = Path(f"/proc/{command.process.pid}/task/{command.process.pid}/children").read_text().split()
    command.process.send_signal(signal.SIGINT)
    # the run was only just begun: workers that still import on a loaded machine are waited for
    assert command.process.wait(timeout=120) == 0
    wait_until(lambda: not [child for child in children if _alive(child)], 20, "the workers to end")
    assert command.process.stdout is not None
    assert "Traceback" not in command.process.stdout.read()


def _alive(process: str) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False
