"""What two run files must have in common, and small helpers around runs."""

from __future__ import annotations

import json
import os
import re
import sqlite3
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case, load_case
from hpsop_core.runs.checksums import Tally, checksum
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.schema import APPLICATION_ID, COLUMNS
from tests.patience import patience
from tests.two_speeds import TWO_SPEEDS


def small_case(**settings: object) -> Case:
    """The recommended case with a small plan."""
    defaults: dict[str, object] = {
        "population": 10,
        "generations": 6,
        "level1_generations": 4,
        "evaluation_time_limit": 60.0,
    }
    return load_case(TWO_SPEEDS).replaced("optimization", **{**defaults, **settings})


def content(path: Path, ids: bool = True) -> dict[str, Any]:
    """Everything in a run file that must come out the same, bit for bit; times are left out.

    Args:
        path: the run file.
        ids: whether the numbers of the designs count.
    """
    connection = sqlite3.connect(path)
    rows = connection.execute(
        "SELECT id, level, variables, origin, generation, status, stage, reason, feasible, first_objective, "
        "second_objective FROM evaluations WHERE origin <> 'hand' ORDER BY id"
    ).fetchall()
    generations = connection.execute("SELECT number, level, data FROM generations ORDER BY number").fetchall()
    connection.close()
    evaluations = []
    for row, record in zip(rows, open_run(path).designs([row[0] for row in rows]), strict=True):
        result = record.evaluation.as_dict()
        del result["elapsed"]
        # repr of a float is exact; comparing texts also tells -0.0 from 0.0.
        evaluations.append((*(repr(value) for value in row[0 if ids else 1 :]), json.dumps(result, sort_keys=True)))
    return {"evaluations": evaluations, "generations": generations}


def old_file(path: Path, case: Case | None = None, function: object = None) -> int:
    """A finished run as the schema before the checksums wrote it; returns how many evaluations it has."""
    import quick_physics

    from hpsop_core.runs.controller import optimize

    new = path.with_name("new-" + path.name)
    asked = small_case() if case is None else case
    optimize(asked, new, workers=1, physics=quick_physics.physics(function or quick_physics.evaluate))
    source, target = sqlite3.connect(new), sqlite3.connect(path)
    declared = source.execute("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL").fetchall()
    for (statement,) in sorted(declared, key=lambda row: "TRIGGER" in row[0] or "INDEX" in row[0]):
        if "TABLE files" in statement:
            continue
        # Of the tables alone: the last column of each, with the comma before it.
        old = re.sub(r",\s*checksum INTEGER NOT NULL", "", statement)
        target.execute(re.sub(r"surface INTEGER NOT NULL,[^\n]*\n", "", old))
    for table, columns in COLUMNS.items():
        if table != "files":
            columns = tuple(name for name in columns if name != "surface")
            names, marks = ",".join(columns), ",".join("?" * len(columns))
            keep = "WHERE key NOT IN ('tally', 'open')" if table == "run" else ""
            target.executemany(
                f"INSERT INTO {table} VALUES ({marks})", source.execute(f"SELECT {names} FROM {table} {keep}")
            )
    # It named files where they stood.
    target.execute("UPDATE run SET value = ? WHERE key = 'case'", (asked.to_toml(),))
    target.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    target.execute("PRAGMA user_version = 2")
    target.commit()
    count = int(target.execute("SELECT count(*) FROM evaluations").fetchone()[0])
    source.close()
    target.close()
    return count


def forge(path: Path, *statements: str) -> None:
    """Change a run file behind its back, with checksums as if it had been written so."""
    connection = sqlite3.connect(path)
    triggers = connection.execute("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'").fetchall()
    for name, _ in triggers:
        connection.execute(f"DROP TRIGGER {name}")
    for statement in statements:
        connection.execute(statement)
    tally = Tally()
    for table, columns in COLUMNS.items():
        key = "rowid" if table not in ("run", "files") else columns[0]
        for row in connection.execute(f"SELECT {','.join(columns)}, {key} FROM {table}").fetchall():
            value = checksum(table, row[:-1])
            connection.execute(f"UPDATE {table} SET checksum = ? WHERE {key} = ?", (value, row[-1]))
            if table != "run":
                tally.add(table, value)
    hand = connection.execute("SELECT count(*) FROM evaluations WHERE origin = 'hand'").fetchone()[0]
    if hand:
        tally.counts["hand"] = hand
    connection.execute(
        "UPDATE run SET value = ?, checksum = ? WHERE key = 'tally'",
        (tally.text(), checksum("run", ("tally", tally.text()))),
    )
    for _, sql in triggers:
        connection.execute(sql)
    connection.commit()
    connection.close()


def finished_designs(path: Path) -> set[tuple[int, str]]:
    """(level, variables) of every evaluation in a file, also one that a killed process left behind."""
    if not path.exists() or path.stat().st_size == 0:
        return set()
    connection = sqlite3.connect(path)
    try:
        return set(connection.execute("SELECT level, variables FROM evaluations").fetchall())
    except sqlite3.OperationalError:
        return set()  # killed before the tables were made
    finally:
        connection.close()


def count_finished(path: Path) -> int:
    """How many evaluations are in a file."""
    if not path.exists() or path.stat().st_size == 0:
        return 0
    connection = sqlite3.connect(path)
    try:
        return int(connection.execute("SELECT count(*) FROM evaluations").fetchone()[0])
    except sqlite3.OperationalError:
        return 0
    finally:
        connection.close()


def wait_until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Return when a condition holds; fail after a while (``patience``)."""
    give_up = time.monotonic() + patience(seconds)
    while not condition():
        assert time.monotonic() < give_up, "waited in vain"
        time.sleep(0.02)


def is_alive(process: int) -> bool:
    """Whether a process runs (a zombie does not)."""
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as stream:
            return stream.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def descendants(process: int) -> set[int]:
    """Process ids below a process, by the kernel's own list."""
    found: set[int] = set()
    parents: dict[int, list[int]] = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                with open(f"/proc/{name}/stat", encoding="utf-8") as stream:
                    parent = int(stream.read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            parents.setdefault(parent, []).append(int(name))
    front = [process]
    while front:
        children = parents.get(front.pop(), [])
        found.update(children)
        front.extend(children)
    return found
