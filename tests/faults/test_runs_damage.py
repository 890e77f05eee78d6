"""Damaged run files: whatever happened to the bytes, no wrong number in silence and no traceback.

A run is made, damaged in one place, and asked for everything that pages, commands and scripts ask. Each answer must be
the sound file's or one line for people; ``outcome`` says which, and "lie" is neither.
"""

from __future__ import annotations

import json
import random
import sqlite3
import struct
import zlib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import quick_physics
from quick_physics import evaluate, physics
from run_files import forge, old_file, small_case

from hpsop_core.errors import InputError
from hpsop_core.runs.checksums import DamagedRunError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.packing import essence_of, pack, unpack
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.store import RunStore


def everything(path: Path) -> dict[str, Any]:
    """All that a run is asked, each answer as text, or as the one line that stands for it."""
    answers: dict[str, Any] = {}
    try:
        run = open_run(path)
    except InputError as error:
        return {"open": error}

    def ask(name: str, question: Callable[[], Any]) -> None:
        try:
            answers[name] = repr(question())
        except InputError as error:
            answers[name] = error

    def summary() -> dict[str, Any]:
        return {key: value for key, value in run.summary().items() if key != "run"}

    ask("case", lambda: run.case)
    ask("seeds", lambda: run.seeds)
    ask("state", run.state)
    ask("progress", run.progress)
    ask("asked", run.generations_asked)
    ask("summary", summary)
    ask("generations", run.generation_records)
    ask("archive", run.archive)
    ask("by hand", run.by_hand)
    ask("news", lambda: [evaluation.as_dict() for _, evaluation in run.news(0, ())])
    ask("failures", run.failures)
    ask("front", run.front)
    ask("members", lambda: run.members(3))
    ask("reference", lambda: [run.reference(level) for level in (1, 2)])
    ask("initial", lambda: [run.initial(level) for level in (1, 2)])
    ask("designs", lambda: run.designs([point.id for point in run.archive()]))
    return answers


def write_again(path: Path) -> Any:
    """Opened as a writer does, with all that it reads to go on."""
    try:
        store = RunStore(path)
    except InputError as error:
        return error
    try:
        times = store.generation_times()
        return repr((store.case, store.seeds, store.outcomes(), times, [store.generation(n) for n in (1, 2, 3)]))
    except InputError as error:
        return error
    finally:
        store.close()


def outcome(sound: dict[str, Any], found: dict[str, Any]) -> str:
    """ "same", "told" (something is refused in one line), or "lie"."""
    told = False
    for name, answer in found.items():
        if isinstance(answer, InputError):
            told = True
            assert "\n" not in str(answer) and len(str(answer)) < 700, str(answer)
        elif answer != sound[name]:
            return f"lie: {name}: {answer[:300]} instead of {sound[name][:300]}"
    return "told" if told else "same"


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("damage") / "run.hpsop"
    case = small_case(population=20, generations=6, level1_generations=4)
    with RunController(path, case, workers=1, physics=physics(quick_physics.every_fault)) as controller:
        controller.start()
        assert controller.wait(120.0)
        controller.add_design(evaluate(case, case.initial.variables.replaced({"draft": 14.25}), 1, None))
    return path


@pytest.fixture(scope="module")
def sound(run_file: Path) -> dict[str, Any]:
    answers = everything(run_file)
    assert not any(isinstance(answer, InputError) for answer in answers.values())
    return answers


def flipped(content: bytes, dice: random.Random) -> bytes:
    """One bit somewhere is another one."""
    place = dice.randrange(len(content) * 8)
    changed = bytearray(content)
    changed[place // 8] ^= 1 << place % 8
    return bytes(changed)


def _flips(run_file: Path, sound: dict[str, Any], tmp_path: Path, count: int, seed: int) -> None:
    dice = random.Random(seed)
    content = run_file.read_bytes()
    writable = write_again(_copied(tmp_path, content))
    results: Counter[str] = Counter()
    for _ in range(count):
        path = _copied(tmp_path, flipped(content, dice))
        results[outcome(sound, everything(path))] += 1
        # A writer reads the same records, and may mend nothing.
        again = write_again(path)
        assert isinstance(again, InputError) or again == writable
    assert set(results) <= {"same", "told"}, results
    assert results["told"] > 0.1 * count, "much of so small a file is empty pages, the rest are records"


def _copied(folder: Path, content: bytes) -> Path:
    for name in ("copy.hpsop", "copy.hpsop-wal", "copy.hpsop-shm", "copy.hpsop-journal"):
        (folder / name).unlink(missing_ok=True)
    path = folder / "copy.hpsop"
    path.write_bytes(content)
    return path


def test_single_flipped_bits_are_found(run_file: Path, sound: dict[str, Any], tmp_path: Path) -> None:
    _flips(run_file, sound, tmp_path, 40, seed=1)


@pytest.mark.soak
def test_a_thousand_flipped_bits_are_found(run_file: Path, sound: dict[str, Any], tmp_path: Path) -> None:
    _flips(run_file, sound, tmp_path, 1000, seed=2)


@pytest.mark.parametrize("column", ["level", "origin"])
def test_a_changed_initial_design_is_not_another_ones(
    column: str, run_file: Path, sound: dict[str, Any], tmp_path: Path
) -> None:
    """Whatever its cells say now: asked for by them, its record was passed over and level 2's shown in its place."""
    path = _copied(tmp_path, run_file.read_bytes())
    connection = sqlite3.connect(path)
    (stays,) = connection.execute("SELECT sql FROM sqlite_master WHERE name = 'evaluations_stay'").fetchone()
    connection.execute("DROP TRIGGER evaluations_stay")
    connection.execute(
        f"UPDATE evaluations SET {column} = ? WHERE id = 1", ({"level": 3, "origin": "initiam"}[column],)
    )
    connection.execute(stays)
    connection.commit()
    connection.close()
    found = everything(path)
    assert isinstance(found["initial"], DamagedRunError)
    assert outcome(sound, found) == "told"


def damaged(content: bytes, dice: random.Random) -> bytes:
    """What disks, cables and editors do: cut, filled with zeros, swapped, doubled, strewn with noise."""
    kind = dice.choice(("cut", "zeros", "noise", "swap", "insert", "repeat", "text", "strewn"))
    start = dice.randrange(len(content))
    length = dice.choice((1, 8, 100, 4096, 16384))
    changed = bytearray(content)
    if kind == "cut":
        return content[:start]
    if kind == "zeros":
        changed[start : start + length] = bytes(len(changed[start : start + length]))
    elif kind == "noise":
        changed[start : start + length] = dice.randbytes(len(changed[start : start + length]))
    elif kind == "swap":
        pages = len(content) // 16384
        one, two = dice.randrange(pages) * 16384, dice.randrange(pages) * 16384
        changed[one : one + 16384], changed[two : two + 16384] = content[two : two + 16384], content[one : one + 16384]
    elif kind == "insert":
        changed[start:start] = dice.randbytes(length)
    elif kind == "repeat":
        changed[start:start] = content[start : start + length]
    elif kind == "text":
        return content.replace(b"\n", b"\r\n")
    else:
        for _ in range(100):
            changed[dice.randrange(len(changed))] = dice.randrange(256)
    return bytes(changed)


def _damages(run_file: Path, sound: dict[str, Any], tmp_path: Path, count: int, seed: int) -> None:
    dice = random.Random(seed)
    content = run_file.read_bytes()
    results: Counter[str] = Counter()
    for _ in range(count):
        path = _copied(tmp_path, damaged(content, dice))
        results[outcome(sound, everything(path))] += 1
        write_again(path)
    assert set(results) <= {"same", "told"}, results


def test_damaged_files_are_found(run_file: Path, sound: dict[str, Any], tmp_path: Path) -> None:
    _damages(run_file, sound, tmp_path, 60, seed=3)


@pytest.mark.soak
def test_six_hundred_damaged_files_are_found(run_file: Path, sound: dict[str, Any], tmp_path: Path) -> None:
    _damages(run_file, sound, tmp_path, 600, seed=4)


def test_files_of_earlier_versions_never_end_in_a_traceback(tmp_path: Path) -> None:
    """They have no checksums: a number may have changed, but whatever cannot be read is told in one line."""
    old_file(tmp_path / "old.hpsop")
    content = (tmp_path / "old.hpsop").read_bytes()
    dice = random.Random(5)
    for number in range(40):
        path = _copied(tmp_path, (damaged if number % 2 else flipped)(content, dice))
        everything(path)
        write_again(path)


@pytest.mark.parametrize("table", ["evaluations", "generations", "journal", "reference", "run"])
def test_a_record_that_is_lost_or_doubled_is_missed(run_file: Path, tmp_path: Path, table: str) -> None:
    path = _copied(tmp_path, run_file.read_bytes())
    connection = sqlite3.connect(path)
    triggers = connection.execute("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'").fetchall()
    for name, _ in triggers:
        connection.execute(f"DROP TRIGGER {name}")
    key = connection.execute(f"SELECT name FROM pragma_table_info('{table}') WHERE pk = 1").fetchone()[0]
    if not connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0]:
        pytest.skip("this run has none")
    connection.execute(f"DELETE FROM {table} WHERE {key} = (SELECT max({key}) FROM {table} WHERE {key} <> 'reason')")
    for _, sql in triggers:
        connection.execute(sql)
    connection.commit()
    connection.close()
    assert any(isinstance(answer, DamagedRunError) for answer in everything(path).values())


def test_bombs_and_lies_in_a_record_are_refused(run_file: Path, tmp_path: Path) -> None:
    """Files made on purpose, with good checksums: bounded memory, one line."""
    deep = "[" * 200_000
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    bomb = packer.compress(bytes(300 * 2**20)) + packer.flush()
    attacks = [
        ("evaluations", "result", f"X'{bomb.hex()}'", "id = 20"),
        ("evaluations", "result", "X''", "id = 20"),
        ("evaluations", "variables", "'[1,2]'", "id = 20"),
        ("evaluations", "variables", f"'{deep}'", "id = 20"),
        ("evaluations", "fingerprint", "fingerprint + 1", "id = 20"),
        ("evaluations", "id", "id + 100000", "id = 20"),
        ("generations", "data", "'{}'", "number = 2"),
        ("generations", "data", f"'{deep}'", "number = 2"),
        ("generations", "data", "replace(data, '\"level\":1', '\"level\":2')", "number = 2"),
        ("run", "value", "'[{}]'", "key = 'seeds'"),
        ("run", "value", "'x'", "key = 'generations'"),
        ("run", "value", "'zz'", "key = 'dictionary'"),
        ("run", "value", "'x = ['", "key = 'case'"),
        ("run", "value", "'<script>'", "key = 'state'"),
        ("run", "value", "'[}'", "key = 'versions'"),
    ]
    for table, column, value, where in attacks:
        path = _copied(tmp_path, run_file.read_bytes())
        forge(path, f"UPDATE {table} SET {column} = {value} WHERE {where}")
        answers = everything(path)
        assert any(isinstance(answer, InputError) for answer in answers.values()), (table, column, value[:40])
        write_again(path)


def test_packed_bytes_that_nobody_packed_are_refused() -> None:
    document = {"status": "ok", "elapsed": 0.5, "reason": ""}
    variables = json.dumps([1.0] * 9)
    good = pack(essence_of(document), b"")

    def repacked(content: bytes) -> bytes:
        packer = zlib.compressobj(9, zlib.DEFLATED, -15)
        return packer.compress(content) + packer.flush()

    words = json.dumps({"elapsed": 0.0}).encode() + b"\0"
    for packed in (
        good[:-1],
        good + b"\0",
        repacked(words),
        repacked(words + struct.pack("<2d", 1.0, 2.0)),
        repacked(words + struct.pack("<d", float("nan"))),
        repacked(b"[]\0"),
        repacked(b"\xff\0"),
    ):
        with pytest.raises((ValueError, zlib.error, struct.error)):
            unpack(packed, b"", variables)


def test_a_newer_total_than_any_run_may_have_opens_and_is_not_extended(tmp_path: Path) -> None:
    path = tmp_path / "run.hpsop"
    optimize(small_case(generations=2, level1_generations=2), path, workers=1, physics=physics())
    with RunController(path, physics=physics()) as controller, pytest.raises(InputError, match="more than 100000"):
        controller.extend(99_999)
    with pytest.raises(InputError, match=r"100000|limits"):
        RunController(path, generations=100_005, physics=physics())
    assert open_run(path).generations_asked() == 2
    # What an earlier version let through.
    forge(path, "UPDATE run SET value = '100005' WHERE key = 'generations'")
    assert open_run(path).generations_asked() == 100_000
    with RunController(path, physics=physics()) as controller:
        assert controller.snapshot().generations == 100_000
