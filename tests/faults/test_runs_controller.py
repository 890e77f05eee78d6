"""Start, pause, resume, stop, extend, events: a run in the hands of a person."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest
import quick_physics
from quick_physics import evaluate, physics
from run_files import content, small_case, wait_until

from hpsop_core.case.case import load_case
from hpsop_core.errors import InputError
from hpsop_core.runs import executor
from hpsop_core.runs.controller import RunController, front_designs, optimize, planned_case
from hpsop_core.runs.events import RunEvent
from hpsop_core.runs.reader import open_run
from tests.patience import patience
from tests.two_speeds import TWO_SPEEDS


def test_pause_resume_stop_and_start_again_change_nothing(tmp_path: Path) -> None:
    path, whole = tmp_path / "run.hpsop", tmp_path / "whole.hpsop"
    optimize(small_case(), whole, workers=1, physics=physics())
    with RunController(path, small_case(), workers=2, physics=physics(quick_physics.slow)) as controller:
        assert controller.snapshot().state == "new"
        controller.start()
        wait_until(lambda: controller.snapshot().generation >= 1)
        controller.pause()
        wait_until(lambda: controller.snapshot().state == "paused", 10.0)
        stored = open_run(path).progress()
        assert open_run(path).state() == ("paused", "")
        time.sleep(0.3)
        assert open_run(path).progress() == stored, "nothing is computed during a pause"
        controller.resume()
        wait_until(lambda: controller.snapshot().generation >= 3)
        controller.stop()
        assert controller.wait(patience(10.0))
        assert controller.snapshot().state == "stopped" and open_run(path).state() == ("stopped", "")
        assert content(path)["generations"] == content(whole)["generations"][: open_run(path).progress()[0]]
        controller.start()
        assert controller.wait(patience(60.0))
        assert controller.snapshot().state == "finished"
    assert content(path) == content(whole)


def test_stop_acts_within_one_evaluation_also_during_a_pause_or_a_hang(tmp_path: Path) -> None:
    # An evaluation takes 0.3 s here; under way when Stop comes are at most two of them.
    with RunController(tmp_path / "a.hpsop", small_case(), workers=2, physics=physics(quick_physics.slower)) as run:
        run.start()
        wait_until(lambda: run.snapshot().generation >= 0 and sum(run.snapshot().evaluations) >= 3)
        before = open_run(run.path).progress()[1]
        asked = time.monotonic()
        run.stop()
        assert run.wait(patience(10.0))
        # One evaluation, and the time that a loaded machine needs to end two processes.
        assert time.monotonic() - asked < patience(0.3 + 1.5)
        assert open_run(run.path).progress()[1] <= before + 4
        run.start()
        run.pause()
        wait_until(lambda: run.snapshot().state == "paused", 20.0)
        run.stop()
        assert run.wait(patience(5.0))
    case = small_case(evaluation_time_limit=3000.0)
    with RunController(tmp_path / "b.hpsop", case, workers=2, physics=physics(quick_physics.hanging)) as run:
        run.start()
        wait_until(lambda: run.snapshot().done > 0 and _stands_still(run), 60.0)
        asked = time.monotonic()
        run.stop()
        # Evaluations under way have 3 s; these never come back.
        assert run.wait(patience(8.0)) and time.monotonic() - asked < patience(6.0)


def test_stop_does_not_wait_for_workers_that_still_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executor, "presence_task", quick_physics.never_present)
    monkeypatch.setattr(executor, "_START_LIMIT", 20.0)  # so that a red test ends
    with RunController(tmp_path / "a.hpsop", small_case(), workers=1, physics=physics()) as run:
        run.start()
        wait_until(lambda: run.snapshot().state == "running")
        run.stop()
        assert run.wait(patience(15.0))
        assert run.snapshot().state == "stopped" and open_run(run.path).state() == ("stopped", "")


def _stands_still(run: RunController) -> bool:
    before = run.snapshot()
    time.sleep(1.0)
    return run.snapshot() == before


def test_extend_while_it_runs_and_after_its_end(tmp_path: Path) -> None:
    path, long = tmp_path / "run.hpsop", tmp_path / "long.hpsop"
    with RunController(path, small_case(), workers=1, physics=physics(quick_physics.slow)) as controller:
        controller.start()
        wait_until(lambda: controller.snapshot().generation >= 1)
        controller.extend(1)
        controller.wait(60.0)
        assert controller.snapshot().generations == 7 and controller.snapshot().generation == 7
        controller.extend(2)
        controller.start()
        controller.wait(60.0)
        with pytest.raises(InputError, match="1 or more"):
            controller.extend(0)
    run = open_run(path)
    assert [generation.level for generation in run.generations()] == [1] * 4 + [2] * 5
    optimize(small_case(generations=9), long, workers=1, physics=physics())
    assert content(path) == content(long)


def test_events_tell_what_happened_and_a_broken_listener_harms_nothing(tmp_path: Path) -> None:
    events: list[RunEvent] = []

    def broken(event: RunEvent) -> None:
        raise RuntimeError("a page with a defect")

    faulty = physics(quick_physics.every_fault)
    with RunController(tmp_path / "a.hpsop", small_case(), workers=2, physics=faulty) as run:
        run.subscribe(broken)
        end = run.subscribe(events.append)
        run.start()
        run.wait(60.0)
        end()
        count = len(events)
        run.extend(1)
        run.start()
        run.wait(60.0)
        assert len(events) == count, "an ended subscription is silent"
    generations = [event.generation for event in events if event.kind == "generation"]
    assert tuple(generations) == open_run(run.path).generations()[:6]
    assert [event.generation.number for event in events if event.kind == "handover" and event.generation] == [4]
    failures = {failure.id: f"{failure.stage}: {failure.reason}" for failure in open_run(run.path).failures()}
    told = {event.evaluation_id: event.text for event in events if event.kind == "failure"}
    assert told and told.items() <= failures.items()
    states = [event.snapshot.state for event in events if event.kind == "state"]
    assert states[0] == "running" and states[-1] == "finished"
    last = events[-1].snapshot
    assert last.generation == last.generations == 6 and last.failures == len(told)


def test_designs_made_by_hand_are_kept_and_never_enter_the_search(tmp_path: Path) -> None:
    path, whole = tmp_path / "run.hpsop", tmp_path / "whole.hpsop"
    case = small_case()
    optimize(case, whole, workers=1, physics=physics())
    # Even a design that the search itself will ask for, made by hand before.
    wanted = open_run(whole).members(3)[0].evaluation.variables
    with RunController(path, case, workers=1, physics=physics(quick_physics.slow)) as controller:
        first = controller.add_design(evaluate(case, wanted, 1, None))
        controller.start()
        wait_until(lambda: controller.snapshot().generation >= 2)
        second = controller.add_design(evaluate(case, wanted.replaced({"draft": 14.25}), 1, None))
        controller.wait(60.0)
    assert content(path) == content(whole)
    run = open_run(path)
    assert [record.id for record in run.by_hand()] == [first, second]
    assert run.design(second).evaluation.variables.draft == 14.25
    assert all(first not in generation.members for generation in run.generations())


def test_a_new_run_from_an_old_front_with_other_bounds(tmp_path: Path) -> None:
    old, new = tmp_path / "old.hpsop", tmp_path / "new.hpsop"
    optimize(small_case(), old, workers=1, physics=physics())
    front = front_designs(old)
    case = small_case().with_bounds({"diameter": (8.8, 9.2)})
    run = optimize(case, new, seeds=front, workers=1, physics=physics())
    assert run.seeds == front
    sample = run.designs(run.generations()[0].asked)
    assert {record.origin for record in sample} >= {"seed"}
    assert all(8.8 <= record.evaluation.variables.diameter <= 9.2 for record in sample)


def test_another_total_keeps_the_cases_proportion_of_the_levels() -> None:
    case = load_case(TWO_SPEEDS)
    plans = {
        total: planned_case(case, {"generations": total}).optimization.level1_generations
        for total in (150, 30, 15, 4, 3, 2, 1, 300)
    }
    assert plans == {150: 100, 30: 20, 15: 10, 4: 3, 3: 2, 2: 1, 1: 1, 300: 200}
    assert planned_case(case, {"generations": 12, "level1_generations": 3}).optimization.level1_generations == 3
    with pytest.raises(InputError, match="exceeds"):
        planned_case(case, {"generations": 3, "level1_generations": 4})


def test_errors_are_stated_for_the_whole_front_that_is_shown(tmp_path: Path) -> None:
    case = small_case(population=8, generations=12, level1_generations=2, final_errors=True)
    run = optimize(case, tmp_path / "run.hpsop", workers=2, physics=quick_physics.refining_physics())
    shown, population = run.front(), run.generation()
    assert population is not None and len(shown) > len(population.front)
    assert all(record.evaluation.errors_source == "solved" for record in (*shown, run.initial(2)))


def test_a_reader_follows_a_run_that_is_being_written(tmp_path: Path) -> None:
    case = small_case()
    run = RunController(tmp_path / "run.hpsop", case, workers=1, physics=physics(quick_physics.slow))
    seen: list[tuple[int, int]] = []
    done = threading.Event()

    def follow() -> None:
        reader = open_run(run.path)
        while not done.is_set():
            seen.append(reader.progress())
            for record in reader.front():
                assert record.evaluation.feasible
            reader.archive()
            time.sleep(0.01)

    with run:
        follower = threading.Thread(target=follow)
        follower.start()
        run.start()
        run.wait(60.0)
        done.set()
        follower.join()
    assert seen == sorted(seen)
    assert len(set(seen)) > 10
