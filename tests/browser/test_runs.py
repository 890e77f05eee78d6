"""Runs in a person's hands: pause, scrub, resume, stop, extend, continue, the library, two browsers."""

from __future__ import annotations

import time

import pytest
from conftest import choose_tab, press, session_of, small_case, wait_until

from explorer.app import Explorer
from explorer.server.security import free_port


@pytest.fixture(scope="module")
def explorer(tmp_path_factory):
    page = Explorer(
        small_case(generations=5000, level1_generations=5000, population=6),
        port=free_port("127.0.0.1", 8260),
        folder=tmp_path_factory.mktemp("runs"),
        workers=1,
    )
    yield page
    page.close()


@pytest.fixture(scope="module")
def page(explorer, open_page):
    return open_page(explorer)


def generations(explorer) -> int:
    return len(explorer.state.picture.generations)


def status(page) -> str:
    return page.locator("[data-run-status]").first.get_attribute("data-run-status")


def test_pause_holds_the_run_and_resume_goes_on(page, explorer):
    press(page, "run_start")
    wait_until(lambda: generations(explorer) >= 2, 90, "two generations")
    press(page, "run_pause")
    wait_until(lambda: explorer.state.picture.status == "paused", 30, "the pause")
    page.wait_for_selector('[data-run-status="paused"]')
    held = generations(explorer)
    time.sleep(1.5)
    assert generations(explorer) <= held + 1  # the generation under way may just have been finished
    press(page, "run_resume")
    wait_until(lambda: generations(explorer) >= held + 2, 60, "more generations")


def test_the_scrubber_and_the_stream_do_not_fight(page, explorer):
    session = session_of(explorer)
    press(page, "step", "-1")
    wait_until(lambda: session.scrubbed is not None, 20, "the scrubber")
    chosen, seen = session.scrubbed, generations(explorer)
    wait_until(lambda: generations(explorer) >= seen + 3, 60, "three more generations")
    assert session.scrubbed == chosen
    # the words and the slider's thumb stay where the person put them, while the total grows
    page.wait_for_function(
        """([chosen, seen]) => {
            const found = document.body.innerText.match(/(\\d+) of (\\d+), level 1, \\d+ on the front/);
            return found && +found[1] === chosen && +found[2] >= seen + 3;
        }""",
        arg=[chosen, seen],
    )
    press(page, "follow")
    wait_until(lambda: session.scrubbed is None, 20, "the newest")


def test_stop_extend_and_continue(page, explorer):
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the stop")
    page.wait_for_selector('[data-run-status="stopped"]')
    done, total = generations(explorer), explorer.state.picture.total_generations
    press(page, "run_continue")
    wait_until(lambda: generations(explorer) >= done + 1, 60, "the continued run")
    press(page, "run_extend", "10")
    wait_until(lambda: explorer.state.picture.total_generations == total + 10, 20, "ten more")
    assert explorer.state.picture.status in ("running", "starting")
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the second stop")
    # generation numbers go on and every one is there once
    assert [item.number for item in explorer.state.picture.generations] == list(range(1, generations(explorer) + 1))


def test_convergence_shows_every_generation(page, explorer):
    choose_tab(page, "Charts")
    press(page, "tab", "convergence")
    page.wait_for_selector('svg[data-chart="convergence"] path.line')


def test_the_library_opens_continues_and_deletes_after_a_question(page, explorer):
    first = explorer.state.picture.name
    press(page, "run_start")
    wait_until(lambda: explorer.state.picture.name != first and generations(explorer) >= 1, 60, "a second run")
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the stop")
    second = explorer.state.picture.name
    choose_tab(page, "Runs")
    page.wait_for_selector(f'[data-act="open_run"][data-arg="{first}"]')
    press(page, "open_run", first)
    wait_until(lambda: explorer.state.picture.name == first, 20, "the first run")
    assert generations(explorer) > 1
    press(page, "continue_run", second)
    wait_until(lambda: explorer.state.picture.name == second and generations(explorer) >= 2, 60, "the second goes on")
    # its generations are told where they are kept up to date
    page.wait_for_selector(f'[data-run="{second}"]:has-text("under way, as is told above")')
    # while it is driven, neither it can be deleted nor another be opened
    press(page, "open_run", first)
    time.sleep(0.5)
    assert explorer.state.picture.name == second
    assert page.locator(f'[data-act="delete_run"][data-arg="{second}"]').get_attribute("aria-disabled") == "true"
    press(page, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the stop")
    page.wait_for_selector(f'[data-act="delete_run"][data-arg="{second}"][aria-disabled="false"]')
    page.wait_for_selector(f'[data-run="{second}"]:has-text("stopped, generation {generations(explorer)} of")')
    press(page, "delete_run", first)
    page.wait_for_selector("text=Delete this run for good?")
    press(page, "delete_no")
    page.wait_for_selector(f'[data-act="delete_run"][data-arg="{first}"]')
    assert (explorer.folder / first).exists()
    press(page, "delete_run", first)
    page.wait_for_selector(f'[data-act="delete_yes"][data-arg="{first}"]')
    press(page, "delete_yes", first)
    wait_until(lambda: not (explorer.folder / first).exists(), 20, "the file to go")
    page.wait_for_selector(f'[data-arg="{first}"]', state="detached")
    assert (explorer.folder / second).exists()


def test_two_browsers_know_of_each_other(page, explorer, open_page):
    other = open_page(explorer, fresh=False)
    mine, theirs = session_of(explorer), session_of(explorer, 1)
    told = []
    mine.notify = lambda title, body, color: told.append((title, body))
    wait_until(lambda: {mine.number, theirs.number} == {1, 2}, 20, "their numbers")
    page.wait_for_function("() => document.body.innerText.includes('2 watching: browser 1, browser 2')")
    # each knows which one it is itself
    you = other.evaluate(
        "() => [...document.querySelectorAll('[data-person]')].filter(e => getComputedStyle(e, '::after').content"
        ".includes('you')).map(e => e.dataset.person)"
    )
    assert you == [str(theirs.number)]
    choose_tab(other, "Design space")
    press(other, "run_continue")
    wait_until(lambda: ("Browser 2", "continued the run") in told, 30, "the news")
    # selection and scrubber are each one's own
    press(other, "step", "-1")
    wait_until(lambda: theirs.scrubbed is not None, 20, "the other's scrubber")
    assert mine.scrubbed is None
    press(other, "run_stop")
    wait_until(lambda: explorer.state.picture.status == "stopped", 30, "the stop")
    page.wait_for_selector('[data-run-status="stopped"]')
    other.close()
    page.wait_for_function("() => !document.body.innerText.includes('2 watching')")
