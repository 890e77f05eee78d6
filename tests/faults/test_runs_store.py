"""The promises in the docstring of ``RunStore``, one by one."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import shutil
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from quick_physics import evaluate
from run_files import content, old_file, small_case

from hpsop_core.case.case import Case
from hpsop_core.errors import InputError
from hpsop_core.optimization.generation import Generation
from hpsop_core.optimization.problem import Candidate
from hpsop_core.runs.checksums import DamagedRunError
from hpsop_core.runs.connections import log_path
from hpsop_core.runs.lock import is_being_written, lock_path
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.results import Result
from hpsop_core.runs.schema import HAND_IDS_BEGIN, SCHEMA_VERSION
from hpsop_core.runs.store import RunStore, StoreUnwritableError

CASE = small_case()
INITIAL = CASE.initial.variables


def candidate(draft: float = 14.5, level: int = 1) -> Candidate:
    return Candidate(level, INITIAL.replaced({"draft": draft}), "sample")


def result(asked: Candidate) -> Result:
    return Result.of(evaluate(CASE, asked.variables, asked.level, None).as_dict())


def generation(number: int, members: tuple[int, ...]) -> Generation:
    return Generation(number, 1, members, members, members, 0.1, None, 1.0, 0, members[0], members[0], "")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.hpsop"


def test_1_what_was_recorded_survives_a_kill_in_the_middle_of_the_next_write(path: Path) -> None:
    script = f"""
import os, sys
sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(Path(__file__).parents[2])!r}]
from pathlib import Path
from test_runs_store import CASE, candidate, result
from hpsop_core.runs.store import RunStore
store = RunStore(Path({str(path)!r}), CASE)
for number in range(1, 31):
    asked = candidate(14.0 + number / 100)
    store.record_evaluation(number, asked, 1, result(asked))
with store._writing() as connection:
    store._insert(connection, "journal", (1, 0.0, "half written"))
    os.kill(os.getpid(), 9)
"""
    ended = subprocess.run([sys.executable, "-c", script], check=False)
    assert ended.returncode == -9
    assert not is_being_written(path), "promise 4: a killed writer's lock blocks nobody"
    run = open_run(path)
    assert run.progress() == (0, 30)
    assert [design.evaluation.variables.draft for design in run.designs(list(range(1, 31)))] == [
        14.0 + number / 100 for number in range(1, 31)
    ]
    assert run.summary()["journal"] == []
    assert run.state()[0] == "interrupted"
    store = RunStore(path)
    assert len(store.outcomes()) == 30
    store.close()
    assert not lock_path(path).exists()


def test_2_finished_evaluations_and_generations_cannot_be_changed(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    store.record_generation(generation(1, (1,)), 0.5)
    for table in ("evaluations", "generations"):
        for statement in (f"UPDATE {table} SET elapsed = 0", f"DELETE FROM {table}"):
            with pytest.raises(sqlite3.IntegrityError, match="is never"):
                store._connection.execute(statement)
    with pytest.raises(sqlite3.IntegrityError):
        store.record_generation(generation(1, (1,)), 0.5)
    store.close()


def test_3_one_record_a_design_and_level_and_hand_made_designs_apart(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    with pytest.raises(sqlite3.IntegrityError):
        store.record_evaluation(2, asked, 1, result(asked))
    other_level = candidate(level=2)
    store.record_evaluation(2, other_level, 1, result(other_level))
    by_hand = evaluate(CASE, asked.variables, 1, None)
    number = store.record_by_hand(by_hand)
    assert number == HAND_IDS_BEGIN
    assert store.record_by_hand(by_hand) == number
    assert store.record_by_hand(evaluate(CASE, candidate(14.2).variables, 1, None)) == number + 1
    assert set(store.outcomes()) == {1, 2}
    assert {outcome.evaluation_id for _, _, outcome in store.outcomes().values()} == {1, 2}
    store.close()
    run = open_run(path)
    assert [record.id for record in run.by_hand()] == [number, number + 1]
    assert [point.id for point in run.archive()] == [1, 2]
    news = [(point.id, evaluation) for point, evaluation in run.news(0, {2})]
    assert news == [(record.id, record.evaluation) for record in (*run.designs([1]), *run.by_hand())]
    assert not list(run.news(0, {1, 2, number, number + 1}))
    assert run.design(number).origin == "hand"


def test_a_write_that_failed_half_way_is_not_counted(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    twice = [(1, asked, result(asked)), (2, asked, result(asked))]
    with pytest.raises(sqlite3.IntegrityError):
        store.record_evaluations(twice, 1)
    other = candidate(14.2)
    store.record_evaluation(1, other, 1, result(other))
    store.close()
    # The file counts its rows: one that was taken back must not be missed.
    again = RunStore(path)
    assert set(again.outcomes()) == {1}
    again.close()
    assert open_run(path).design(1).evaluation.variables.draft == 14.2


def test_a_file_that_was_exchanged_is_not_written_on(path: Path) -> None:
    store = RunStore(path, CASE)
    store.note("ours")
    store.checkpoint()
    kept = path.with_suffix(".kept")
    path.rename(kept)
    shutil.copy(kept, path)
    with pytest.raises(StoreUnwritableError, match="another file stands in its place"):
        store.note("lost")
    path.unlink()
    kept.rename(path)
    store.note("and on")
    store.close()
    assert [entry["text"] for entry in open_run(path).summary()["journal"]] == ["ours", "and on"]


def test_4_a_second_writer_is_refused_and_told_who_writes(path: Path) -> None:
    store = RunStore(path, CASE)
    with pytest.raises(InputError, match=f"written by process {os.getpid()} on .* since"):
        RunStore(path)
    script = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parents[2])!r})
from pathlib import Path
from hpsop_core.runs.store import RunStore
RunStore(Path({str(path)!r}))
"""
    refused = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True)
    assert "InputError" in refused.stderr and f"process {os.getpid()}" in refused.stderr
    store.close()
    RunStore(path).close()
    # A lock file without its owner's lock is litter, not a lock.
    lock_path(path).write_text(json.dumps({"process": 1, "host": "elsewhere"}))
    assert not is_being_written(path)
    RunStore(path).close()


def test_5_readers_read_while_it_is_written_and_see_whole_generations(path: Path) -> None:
    store = RunStore(path, CASE)
    stop = threading.Event()
    seen: list[int] = []
    faults: list[str] = []

    def read() -> None:
        run = open_run(path)
        while not stop.is_set():
            last = run.generation()
            if last is not None:
                seen.append(last.number)
                # All of a generation's designs are there when it is.
                if len(run.designs(last.members)) != 4:
                    faults.append(f"generation {last.number} misses designs")

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    number = 0
    for step in range(1, 41):
        members = []
        for _ in range(4):
            number += 1
            asked = candidate(14.0 + number / 1000)
            store.record_evaluation(number, asked, step, result(asked))
            members.append(number)
        store.record_generation(generation(step, tuple(members)), 0.0)
    stop.set()
    for reader in readers:
        reader.join()
    store.close()
    assert not faults
    assert len(set(seen)) > 1, "the readers saw the run grow"
    assert open_run(path).generation().number == 40


def test_6_a_full_disk_refuses_the_write_and_leaves_the_file_as_it_was(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
    store._connection.execute(f"PRAGMA max_page_count = {pages}")
    number = 1
    with pytest.raises(StoreUnwritableError, match="full"):
        for number in range(2, 2000):
            asked = candidate(14.0 + number / 10000)
            store.record_evaluation(number, asked, 1, result(asked))
    assert open_run(path).progress()[1] == number - 1
    store._connection.execute("PRAGMA max_page_count = 1000000")
    store.record_evaluation(number, asked, 1, result(asked))
    assert open_run(path).progress()[1] == number
    store.close()


@contextlib.contextmanager
def full_disk() -> Iterator[None]:
    """No file of this process may grow beyond 20 kB: as on a disk without room for what SQLite needs first."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20480, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_6_reopening_on_a_full_disk_says_so_and_leaves_the_run_readable(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    store.close()
    before = sorted(file.name for file in path.parent.iterdir())
    with full_disk():
        with pytest.raises(InputError, match=r"cannot be written: its disk is full \(.+\); make room there"):
            RunStore(path)
        assert open_run(path).progress()[1] == 1
    assert sorted(file.name for file in path.parent.iterdir()) == before
    # what an earlier version left there: an empty log, and no room to read beside it
    log_path(path).touch()
    with full_disk():
        assert open_run(path).progress()[1] == 1
        # a log with something in it cannot be passed over
        log_path(path).write_bytes(b"x" * 4096)
        with pytest.raises(InputError, match="cannot be read as a run file: its disk is full"):
            open_run(path)
    log_path(path).unlink()
    RunStore(path).close()


def test_6_a_file_that_lost_its_name_is_noticed(path: Path, tmp_path: Path) -> None:
    store = RunStore(path, CASE)
    path.rename(tmp_path / "moved.hpsop")
    with pytest.raises(StoreUnwritableError, match="gone"):
        store.note("lost?")
    path.write_bytes(b"")
    with pytest.raises(StoreUnwritableError, match="another file"):
        store.note("lost?")
    path.unlink()
    (tmp_path / "moved.hpsop").rename(path)
    store.note("back")
    store.close()


def test_7_other_files_are_refused_with_the_reason_and_left_alone(path: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such run file"):
        open_run(path)
    with pytest.raises(InputError, match="holds no run"):
        RunStore(path)
    assert not path.exists()
    foreign = tmp_path / "foreign.hpsop"
    connection = sqlite3.connect(foreign)
    connection.execute("CREATE TABLE run (key, value)")
    connection.commit()
    connection.close()
    text = tmp_path / "text.hpsop"
    text.write_text("not a database, but long enough to look like one at first sight" * 20)
    for file, words in ((foreign, "another program"), (text, "not a database"), (tmp_path, "folder|no such run")):
        before = file.read_bytes() if file.is_file() else b""
        for opened in (lambda file=file: open_run(file), lambda file=file: RunStore(file, CASE)):
            with pytest.raises(InputError, match=words):
                opened()
        assert not file.is_file() or file.read_bytes() == before
    with pytest.raises(InputError, match="cannot be written"):
        RunStore(tmp_path / "nowhere" / "run.hpsop", CASE)


def test_7_a_newer_schema_is_refused_and_an_unknown_older_one_too(path: Path) -> None:
    RunStore(path, CASE).close()
    for version, words in ((SCHEMA_VERSION + 1, "newer hpsop"), (-1, "no longer reads")):
        connection = sqlite3.connect(path)
        connection.execute(f"PRAGMA user_version = {version}")
        connection.close()
        for opened in (lambda: open_run(path), lambda: RunStore(path)):
            with pytest.raises(InputError, match=words):
                opened()


def test_7_an_older_schema_is_lifted_with_every_bit(path: Path) -> None:
    before = old_file(path)
    old = content(path)
    assert open_run(path).progress() == (6, before)
    store = RunStore(path)
    assert len(store.outcomes()) == before
    assert store._connection.execute("PRAGMA user_version").fetchone()[0] == SCHEMA_VERSION
    store.close()
    assert content(path) == old
    assert open_run(path).progress() == (6, before)
    assert open_run(path).summary()["evaluations"]["1"]["count"] > 0


def test_7_an_older_file_that_contradicts_itself_is_not_lifted(path: Path) -> None:
    old_file(path)
    connection = sqlite3.connect(path)
    connection.execute("DROP TRIGGER evaluations_stay")
    connection.execute("UPDATE evaluations SET first_objective = first_objective + 1e-9 WHERE id = 5")
    connection.commit()
    connection.close()
    for opened in (lambda: open_run(path).designs([5]), lambda: RunStore(path)):
        with pytest.raises(DamagedRunError, match="design 5 contradicts itself"):
            opened()
    assert open_run(path).design(4).id == 4, "what is sound can still be read"


def test_9_a_kill_while_the_file_is_being_made_leaves_nothing_or_a_run(path: Path) -> None:
    script = f"""
import os, sys
sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(Path(__file__).parents[2])!r}]
from pathlib import Path
from test_runs_store import CASE
from hpsop_core.runs import store
store.create_tables = lambda connection: os.kill(os.getpid(), 9)
store.RunStore(Path({str(path)!r}), CASE)
"""
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -9
    store = RunStore(path, CASE)
    assert store.created
    store.close()


def test_9_a_lost_log_is_noticed_and_nothing_begins_anew(path: Path, tmp_path: Path) -> None:
    store = RunStore(path, CASE)
    for number in range(1, 5):
        asked = candidate(14.0 + number / 100)
        store.record_evaluation(number, asked, 1, result(asked))
    store.record_generation(generation(1, (1, 2, 3, 4)), 0.5)
    asked = candidate(14.4)
    store.record_evaluation(5, asked, 2, result(asked))
    assert (tmp_path / "run.hpsop-wal").stat().st_size < 200_000, "one evaluation, and no more"
    # The file alone, as a person copies it while it is written.
    copy = tmp_path / "copy.hpsop"
    copy.write_bytes(path.read_bytes())
    run = open_run(copy)
    assert run.progress() == (1, 4) and run.generation().members == (1, 2, 3, 4)
    assert run.state()[0] == "interrupted" and "copy.hpsop-wal is lost" in run.state()[1]
    assert open_run(path).progress() == (1, 5)
    again = RunStore(copy)
    again.close()
    assert "opened without its copy.hpsop-wal" in open_run(copy).summary()["journal"][0]["text"]
    assert open_run(copy).state()[0] == "interrupted" and "lost" not in open_run(copy).state()[1]
    # The log alone, as a person leaves it who deletes the file; and the log of a file that was emptied.
    log = tmp_path / "other.hpsop-wal"
    log.write_bytes((tmp_path / "run.hpsop-wal").read_bytes())
    other = tmp_path / "other.hpsop"
    for make in (lambda: None, lambda: other.write_bytes(b"")):
        make()
        with pytest.raises(InputError, match=r"other.hpsop: is gone or empty, but other.hpsop-wal still holds"):
            RunStore(other, CASE)
        assert log.exists()
    store.close()
    # What an earlier version left of a running file that was copied alone: a database in WAL mode without content.
    connection = sqlite3.connect(tmp_path / "empty.hpsop")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.close()
    with pytest.raises(InputError, match=r"copy its empty\.hpsop-wal too"):
        open_run(tmp_path / "empty.hpsop")
    with pytest.raises(InputError, match="a database without content"):
        RunStore(tmp_path / "empty.hpsop", CASE)


def test_4_a_link_is_the_same_file(path: Path, tmp_path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    soft, hard = tmp_path / "soft.hpsop", tmp_path / "sub" / "hard.hpsop"
    hard.parent.mkdir()
    soft.symlink_to(path)
    with pytest.raises(InputError, match=f"written by process {os.getpid()}"):
        RunStore(soft)
    assert is_being_written(soft) and open_run(soft).progress() == (0, 1), "a reader by the link sees the log too"
    os.link(path, hard)
    with pytest.raises(InputError, match=r"has 2 names \(hard links\)"):
        RunStore(hard)
    store.close()
    with pytest.raises(InputError, match="hard links"):
        RunStore(path)
    hard.unlink()
    RunStore(soft).close()


def test_6_a_file_that_was_cut_short_is_noticed(path: Path, tmp_path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 1, result(asked))
    store.record_generation(generation(1, (1,)), 0.5)
    run = open_run(path)
    assert run.progress() == (1, 1)
    os.truncate(path, 4096)
    with pytest.raises(StoreUnwritableError, match="cut short by another program"):
        store.note("lost?")
    store.close()
    with pytest.raises(InputError, match="cut short by another program"):
        run.progress()


def test_readers_notice_a_file_that_is_gone_or_another(path: Path, tmp_path: Path) -> None:
    RunStore(path, CASE).close()
    run = open_run(path)
    path.rename(tmp_path / "moved.hpsop")
    with pytest.raises(InputError, match=r"is gone .*deleted or renamed"):
        run.state()
    RunStore(path, CASE).close()
    with pytest.raises(InputError, match="another file stands in its place"):
        run.progress()
    path.unlink()
    (tmp_path / "moved.hpsop").rename(path)
    assert run.progress() == (0, 0)


def test_a_case_that_could_not_be_read_again_is_refused_before_it_is_stored(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    awkward = replace(CASE, title='bell \a, escape \x1b, return \r, nul \0, line \n, \u2028, """ and \\')
    RunStore(path, awkward).close()
    assert open_run(path).case == awkward
    path.unlink()
    other = CASE.to_toml()
    monkeypatch.setattr(Case, "to_toml", lambda case: other)
    with pytest.raises(InputError, match="would not be the same when it is read again"):
        RunStore(path, awkward)
    assert not path.exists()


def test_the_case_comes_back_to_the_last_digit(path: Path) -> None:
    case = CASE.with_bounds({"draft": (14.0 + 1e-15, 14.5)})
    RunStore(path, case, (INITIAL,)).close()
    run = open_run(path)
    assert run.case == case
    assert run.seeds == (INITIAL,)
    store = RunStore(path, CASE)
    assert not store.created and store.case == case, "a file that holds a run is opened as it is"
    store.close()


def test_a_finished_file_opens_where_nothing_can_be_written_and_leaves_no_litter(path: Path) -> None:
    store = RunStore(path, CASE)
    asked = candidate()
    store.record_evaluation(1, asked, 0, result(asked))
    store.close()
    folder = path.parent
    folder.chmod(0o555)
    try:
        assert open_run(path).progress() == (0, 1)
    finally:
        folder.chmod(0o755)
    assert [file.name for file in folder.iterdir()] == ["run.hpsop"]


def test_results_that_came_in_together_are_stored_together_or_not_at_all(tmp_path: Path) -> None:
    store = RunStore(tmp_path / "run.hpsop", CASE)
    asked = [candidate(14.0 + 0.1 * row) for row in range(3)]
    store.record_evaluations([(row + 1, asked[row], result(asked[row])) for row in range(2)], 1)
    with pytest.raises(sqlite3.IntegrityError):
        # the last one's number is taken
        store.record_evaluations([(3, asked[2], result(asked[2])), (1, asked[2], result(asked[2]))], 1)
    assert sorted(store.outcomes()) == [1, 2]
    store.record_evaluations([(3, asked[2], result(asked[2]))], 1)
    assert sorted(store.outcomes()) == [1, 2, 3]
    store.close()
