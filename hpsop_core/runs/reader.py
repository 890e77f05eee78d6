"""Reading a run file, also while it is being written."""

from __future__ import annotations

import contextlib
import json
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.result import evaluation_from_dict
from hpsop_core.optimization.decision import compromise
from hpsop_core.optimization.generation import Generation
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.packing import unpack
from hpsop_core.runs.records import (
    ArchivePoint,
    DesignRecord,
    Failure,
    GenerationRecord,
    generation_from_text,
    named_variables,
)
from hpsop_core.runs.schema import HAND_IDS_BEGIN, connect_reader, schema_version

_BEYOND_ANY_ID = 2**63  # SQLite's integers end here


class RunReader:
    """A run as its file tells it. Never writes; every call reads what is there at that moment.

    Finished evaluations and generations never change, so each is read from the disk once.

    Args:
        path: the run file.

    Raises:
        InputError: no such file, not a run file, or from a newer hpsop.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._designs: dict[int, DesignRecord] = {}
        self._generations: dict[int, GenerationRecord] = {}
        with self._reading() as connection:
            if schema_version(connection, self.path) == 0:
                raise InputError(f"{self.path}: holds no run; start one with 'hpsop optimize CASE --run {self.path}'")
            self._values = _values(connection)
        self.case: Case = case_from_toml(self._values["case"], str(self.path))

    @contextlib.contextmanager
    def _reading(self) -> Iterator[sqlite3.Connection]:
        try:
            connection = connect_reader(self.path)
            try:
                yield connection
            finally:
                connection.close()
        except sqlite3.Error as error:
            raise InputError(f"{self.path}: cannot be read as a run file ({error}); choose another file") from error

    # -- the run as a whole ----------------------------------------------------------------------------------------

    @property
    def seeds(self) -> tuple[DesignVariables, ...]:
        """Designs that the run was started from."""
        return tuple(DesignVariables.from_dict(seed) for seed in json.loads(self._values["seeds"]))

    def state(self) -> tuple[str, str]:
        """(state, reason): as ``events.State``, or "interrupted" for a run whose process was killed."""
        with self._reading() as connection:
            values = _values(connection)
        state, reason = values["state"], values["reason"]
        if state in ("new", "running", "paused") and not is_being_written(self.path):
            return "interrupted", "its process ended before it was finished; it can go on from there"
        return state, reason

    def progress(self) -> tuple[int, int]:
        """(generations finished, evaluations finished): a cheap look whether there is news."""
        with self._reading() as connection:
            row = connection.execute(
                "SELECT (SELECT max(number) FROM generations), (SELECT count(*) FROM evaluations)"
            ).fetchone()
        return int(row[0] or 0), int(row[1])

    def generations_asked(self) -> int:
        """Generations asked for in total, extensions included: a cheap look."""
        with self._reading() as connection:
            return int(_values(connection)["generations"])

    def summary(self) -> dict[str, Any]:
        """The run in numbers, ready for JSON."""
        with self._reading() as connection:
            values = _values(connection)
            rows = connection.execute(
                "SELECT level, count(*), sum(status <> 'ok'), sum(feasible), sum(elapsed) FROM evaluations "
                "WHERE origin <> 'hand' GROUP BY level ORDER BY level"
            ).fetchall()
            by_hand = connection.execute("SELECT count(*) FROM evaluations WHERE origin = 'hand'").fetchone()[0]
            wall = connection.execute("SELECT level, count(*), sum(elapsed) FROM generations GROUP BY level").fetchall()
            journal = connection.execute("SELECT at, text FROM journal ORDER BY id").fetchall()
        state, reason = self.state()
        settings = self.case.optimization
        last = self.generation()
        result: dict[str, Any] = {
            "run": str(self.path),
            "case": self.case.name,
            "state": state,
            "reason": reason,
            "generation": 0 if last is None else last.number,
            "generations": int(values["generations"]),
            "level1_generations": settings.level1_generations,
            "level": None if last is None else last.level,
            "population": settings.population,
            "seed": settings.seed,
            "objectives": [self.case.objectives.first, self.case.objectives.second],
            "evaluations": {
                str(level): {"count": count, "failed": failed, "feasible": feasible, "processor_seconds": seconds}
                for level, count, failed, feasible, seconds in rows
            },
            "designs_by_hand": by_hand,
            "wall_seconds": {str(level): seconds for level, _, seconds in wall},
            "generations_by_level": {str(level): count for level, count, _ in wall},
            "versions": json.loads(values["versions"]),
            "created": time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(float(values["created_at"]))),
            "journal": [
                {"at": time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(at)), "text": text} for at, text in journal
            ],
        }
        if last is not None:
            result["hypervolume"] = last.hypervolume
            result["spread"] = last.spread
            result["feasible_share"] = last.feasible_share
            result["front_size"] = len(last.front)
            result["compromise"] = last.compromise
            result["knee"] = last.knee
        return result

    # -- generations -----------------------------------------------------------------------------------------------

    def generation_records(self, after: int = 0) -> tuple[GenerationRecord, ...]:
        """Every generation finished, in order; with ``after`` only later ones."""
        known = 0
        while known + 1 in self._generations:
            known += 1
        with self._reading() as connection:
            rows = connection.execute(
                "SELECT number, data, elapsed, finished_at FROM generations WHERE number > ? ORDER BY number", (known,)
            ).fetchall()
        for number, data, elapsed, finished_at in rows:
            self._generations[number] = GenerationRecord(generation_from_text(data), elapsed, finished_at)
        return tuple(self._generations[number] for number in sorted(self._generations) if number > after)

    def generations(self, after: int = 0) -> tuple[Generation, ...]:
        """Every generation finished, in order; with ``after`` only later ones."""
        return tuple(record.generation for record in self.generation_records(after))

    def generation(self, number: int | None = None) -> Generation | None:
        """A generation; the last one by default, None while there is none.

        Raises:
            InputError: a number that is not there.
        """
        if number is not None and number in self._generations:
            return self._generations[number].generation
        finished = self.generations()
        if number is None:
            return finished[-1] if finished else None
        if not 1 <= number <= len(finished):
            raise InputError(f"--generation {number}: {self.path} has generations 1 to {len(finished)}")
        return finished[number - 1]

    # -- designs ---------------------------------------------------------------------------------------------------

    def designs(self, ids: tuple[int, ...] | list[int]) -> tuple[DesignRecord, ...]:
        """Designs by id, in the order given.

        Raises:
            InputError: an id that is not in the run.
        """
        missing = [number for number in ids if number not in self._designs]
        if missing:
            dictionary = b""
            with self._reading() as connection:
                for number in missing:
                    row = None
                    if abs(number) < _BEYOND_ANY_ID:
                        row = connection.execute(
                            "SELECT origin, generation, variables, result FROM evaluations WHERE id = ?", (number,)
                        ).fetchone()
                    if row is None:
                        raise InputError(f"{self.path}: has no design {number}; see 'hpsop show {self.path} --front'")
                    origin, generation, variables, result = row
                    # Asked after the row: it was written with the first one.
                    dictionary = dictionary or bytes.fromhex(_values(connection)["dictionary"])
                    evaluation = evaluation_from_dict(unpack(result, dictionary, variables))
                    self._designs[number] = DesignRecord(number, origin, generation, evaluation)
        return tuple(self._designs[number] for number in ids)

    def design(self, name: int | str, generation: int | None = None) -> DesignRecord:
        """A design by id, or "initial", "compromise" or "knee" of a generation (the last one by default).

        Raises:
            InputError: there is none.
        """
        if isinstance(name, int):
            return self.designs([name])[0]
        last = self.generation(generation)
        if name == "initial":
            return self.initial(1 if last is None else last.level)
        number = None if last is None else {"compromise": last.compromise, "knee": last.knee}.get(name)
        if number is None:
            raise InputError(f"{self.path}: has no {name} design yet: no feasible design stands on its front")
        return self.designs([number])[0]

    def initial(self, level: int) -> DesignRecord:
        """The initial design at a level (at the other one while that is all there is).

        Raises:
            InputError: it is not evaluated yet.
        """
        with self._reading() as connection:
            row = connection.execute(
                "SELECT id FROM evaluations WHERE origin = 'initial' ORDER BY level <> ? LIMIT 1", (level,)
            ).fetchone()
        if row is None:
            raise InputError(f"{self.path}: its initial design is not evaluated yet; let the run go on")
        return self.designs([int(row[0])])[0]

    def front(self, generation: int | None = None) -> tuple[DesignRecord, ...]:
        """The Pareto front of a generation (the last one by default), ascending in f1; empty while there is none."""
        record = self.generation(generation)
        return () if record is None else self.designs(record.front)

    def members(self, generation: int | None = None) -> tuple[DesignRecord, ...]:
        """The population of a generation (the last one by default), best first."""
        record = self.generation(generation)
        return () if record is None else self.designs(record.members)

    def weighted_choice(self, weights: tuple[float, float], generation: int | None = None) -> DesignRecord | None:
        """The front's design nearest to the utopia point when the objectives count as ``weights`` say.

        Raises:
            InputError: weights that say nothing.
        """
        front = self.front(generation)
        points = [
            (float(r.evaluation.objectives["f1"] or 0.0), float(r.evaluation.objectives["f2"] or 0.0)) for r in front
        ]
        chosen = compromise(points, weights)
        return None if chosen is None else front[chosen]

    def archive(self, level: int | None = None, after: int = 0, by_hand: bool = False) -> tuple[ArchivePoint, ...]:
        """Every design of the search as a point for the chart, without its details.

        Args:
            level: one level only.
            after: only ids above this one. Ids of one generation may finish in any order: ask again from the last id of
                the last finished generation.
            by_hand: designs made by hand instead of the search's.
        """
        kind = "origin = 'hand'" if by_hand else "origin <> 'hand'"
        with self._reading() as connection:
            rows = connection.execute(
                "SELECT id, level, origin, generation, status, first_objective, second_objective, feasible "
                f"FROM evaluations WHERE id > ? AND (? IS NULL OR level = ?) AND {kind} ORDER BY id",
                (after, level, level),
            ).fetchall()
        return tuple(
            ArchivePoint(
                id=row[0],
                level=row[1],
                origin=row[2],
                generation=row[3],
                objectives=(row[5], row[6]) if row[4] == "ok" else None,
                feasible=bool(row[7]),
            )
            for row in rows
        )

    def by_hand(self) -> tuple[DesignRecord, ...]:
        """Designs made by hand, in the order made."""
        return self.designs([point.id for point in self.archive(after=HAND_IDS_BEGIN - 1, by_hand=True)])

    def failures(self) -> tuple[Failure, ...]:
        """Failed evaluations, in the order asked."""
        with self._reading() as connection:
            rows = connection.execute(
                "SELECT id, level, generation, stage, reason, variables, elapsed FROM evaluations "
                "WHERE status <> 'ok' ORDER BY id"
            ).fetchall()
        return tuple(
            Failure(
                id=number,
                level=level,
                generation=generation,
                stage=stage,
                reason=reason,
                variables=DesignVariables.from_dict(named_variables(variables)),
                elapsed=elapsed,
            )
            for number, level, generation, stage, reason, variables, elapsed in rows
        )

    def reference(self, level: int) -> dict[str, Any] | None:
        """What normalises at a level, as ``Reference.as_dict`` gave it; None if it is not there (yet)."""
        with self._reading() as connection:
            row = connection.execute("SELECT data FROM reference WHERE level = ?", (level,)).fetchone()
        if row is None:
            return None
        data: dict[str, Any] | None = json.loads(row[0])
        return data


def _values(connection: sqlite3.Connection) -> dict[str, str]:
    return dict(connection.execute("SELECT key, value FROM run").fetchall())


def open_run(path: str | Path) -> RunReader:
    """A run file for reading, also while it is being written.

    Args:
        path: the run file, finished or not, from this version or an earlier one.

    Returns:
        The run: ``summary()``, ``front()``, ``members()``, ``design()``, ``generations()``, each a frozen value.

    Raises:
        InputError: as ``RunReader``.
    """
    return RunReader(path)
