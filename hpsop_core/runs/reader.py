"""Reading a run file, also while it is being written."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import time
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case, case_from_toml
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.levels import FAST, TRUTH
from hpsop_core.evaluation.result import Evaluation, evaluation_from_dict
from hpsop_core.optimization.decision import compromise
from hpsop_core.optimization.generation import Generation
from hpsop_core.runs.checksums import DamagedRunError, damage_told
from hpsop_core.runs.connections import connect_reader, log_path, real_path
from hpsop_core.runs.content import RunContent
from hpsop_core.runs.fronts import FrontHistory, KnownFront
from hpsop_core.runs.lock import is_being_written
from hpsop_core.runs.records import (
    ERRORS_KEY,
    ArchivePoint,
    DesignRecord,
    Failure,
    GenerationRecord,
    generation_from_text,
    generations_asked,
    known_errors,
    named_variables,
)
from hpsop_core.runs.schema import COLUMNS, FIRST_SEARCH_ID, HAND_IDS_BEGIN, schema_version
from hpsop_core.runs.ship import ShipFile, named_files, refuse_changed_ship, with_files

# designs whose numbers stay in memory, 12 to 25 kB each
_KEPT_DESIGNS = 1000
_BEYOND_ANY_ID = 2**63  # SQLite's integers end here
_LEVEL, _ORIGIN = (COLUMNS["evaluations"].index(name) for name in ("level", "origin"))


class NotEvaluatedError(InputError):
    """A design that a run will have is not there yet."""


class RunReader:
    """A run as its file tells it. Never writes; every call reads what is there at that moment.

    Finished evaluations and generations never change, so each is read from the disk once. Every record is held against
    its checksum before any of it is given away; questions about all of them also against the file's tally.

    Args:
        path: the run file.

    Attributes:
        case: the run's exact case; its own hull and propeller files stand in the run, and it names them where they
            have been written out on this machine.
        sealed: whether each record has a checksum, as in all but files of earlier versions.
        files: of the own hull and propeller; empty for shipped ones, and in files of earlier versions.

    Raises:
        InputError: no such file, not a run file, or from a newer hpsop. Every method raises it too when the file is
            gone, was replaced or was cut short since.
        DamagedRunError: what stands in it is not what was written; every method may raise it.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._real = real_path(self.path)
        self._designs: dict[int, DesignRecord] = {}
        self._generations: dict[int, GenerationRecord] = {}
        self._points: dict[int, ArchivePoint] = {}
        self._fronts = FrontHistory(self._points)
        self._status: os.stat_result | None = None
        self._known_errors: dict[str, dict[str, float]] = {}
        self._errors_text = ""
        self._errors_of: tuple[int, int] | None = None
        with self._reading() as content:
            self._values = content.values()
            self.sealed = content.sealed
            self.files: tuple[ShipFile, ...] = content.files()
            self.case: Case = with_files(case_from_toml(self._values["case"], str(self.path)), self.files)

    @contextlib.contextmanager
    def _reading(self) -> Iterator[RunContent]:
        shrunk = self._check_file()
        try:
            with damage_told(self.path):
                connection = connect_reader(self._real)
                try:
                    version = schema_version(connection, self.path)
                    if version == 0:
                        raise InputError(f"{self.path}: holds no run; {self._remedy()}")
                    # One picture for all that is asked together.
                    connection.execute("BEGIN")
                    yield RunContent(connection, self.path, version)
                finally:
                    connection.close()
        except InputError as error:
            if shrunk:
                raise InputError(shrunk) from error
            raise

    def _remedy(self) -> str:
        if self._real.stat().st_size > 0:
            return f"if it is a copy of a run, copy its {self._real.name}-wal too"
        return f"start one with 'hpsop optimize CASE --run {self.path}'"

    def _check_file(self) -> str:
        """Refuses another file than the one that was opened; returns what to say if one that shrank cannot be read."""
        try:
            there = os.stat(self._real)
        except OSError as error:
            if self._status is None:
                return ""  # it never was there: said by whoever opens it
            raise InputError(
                f"{self.path}: is gone ({error.strerror}): deleted or renamed since it was opened"
            ) from error
        was = self._status = self._status or there
        if (was.st_ino, was.st_dev) != (there.st_ino, there.st_dev):
            raise InputError(f"{self.path}: another file stands in its place since it was opened; open it again")
        if there.st_size < was.st_size:
            return f"{self.path}: was cut short by another program (from {was.st_size} to {there.st_size} bytes)"
        self._status = there
        return ""

    # -- the run as a whole ----------------------------------------------------------------------------------------

    @property
    def seeds(self) -> tuple[DesignVariables, ...]:
        """Designs that the run was started from."""
        with damage_told(self.path):
            return tuple(DesignVariables.from_dict(seed) for seed in json.loads(self._values["seeds"]))

    def check_ship(self) -> None:
        """Whether the files of an own hull and propeller still give the run's designs: only a question of runs that
        earlier versions began, which name files elsewhere; a run of this version holds its own.

        Raises:
            InputError: one is gone, or gives another initial design; the run's numbers can be read all the same.
        """
        if self.files or not named_files(self.case):
            return
        with contextlib.suppress(NotEvaluatedError):
            record = self.initial(FAST.number)
            if record.evaluation.ok:
                refuse_changed_ship(self.path, self.case, record.evaluation.as_dict())

    def state(self) -> tuple[str, str]:
        """(state, reason): as ``events.State``, or "interrupted" for a run whose process was killed."""
        with self._reading() as content:
            values = content.values()
        return self._state(values)

    def _state(self, values: Mapping[str, str]) -> tuple[str, str]:
        state, reason = values["state"], values["reason"]
        if state not in ("new", "running", "paused", "stopped", "finished", "failed"):
            raise DamagedRunError(self.path, f"its state is '{state[:20]}'")
        if state in ("new", "running", "paused") and not is_being_written(self.path):
            if values.get("open") and not log_path(self._real).exists():
                # Closed in good order it would not say that it is open; killed it would have its log beside it.
                return "interrupted", (
                    f"a copy that was made while the run was being written, or its {self._real.name}-wal is lost: "
                    "what came after its last generation is not in it; it can go on from there"
                )
            return "interrupted", "its process ended before it was finished; it can go on from there"
        return state, reason

    def progress(self) -> tuple[int, int]:
        """(generations finished, evaluations finished): a cheap look whether there is news."""
        with self._reading() as content:
            counts = content.tally.counts
        return counts.get("generations", 0), counts.get("evaluations", 0)

    def generations_asked(self) -> int:
        """Generations asked for in total, extensions included: a cheap look."""
        with self._reading() as content:
            return generations_asked(content.values())

    def summary(self) -> dict[str, Any]:
        """The run in numbers, ready for JSON."""
        with self._reading() as content:
            values = content.values()
            rows = [_record("evaluations", row) for row in content.all_rows("evaluations")]
            generations = [_record("generations", row) for row in content.all_rows("generations")]
            journal = [_record("journal", row) for row in content.all_rows("journal")]
            return self._summary(values, rows, generations, journal)

    def _summary(
        self,
        values: Mapping[str, str],
        rows: Sequence[Mapping[str, Any]],
        generations: Sequence[Mapping[str, Any]],
        journal: Sequence[Mapping[str, Any]],
    ) -> dict[str, Any]:
        searched = [row for row in rows if row["origin"] != "hand"]
        levels = sorted({row["level"] for row in searched})
        state, reason = self._state(values)
        settings = self.case.optimization
        last = self.generation()
        result: dict[str, Any] = {
            "run": str(self.path),
            "case": self.case.name,
            "state": state,
            "reason": reason,
            "generation": 0 if last is None else last.number,
            "generations": generations_asked(values),
            "level1_generations": settings.level1_generations,
            "level": None if last is None else last.level,
            "population": settings.population,
            "seed": settings.seed,
            "objectives": [self.case.objectives.first, self.case.objectives.second],
            "evaluations": {
                str(level): {
                    "count": len(at_level),
                    "predicted": sum(row["surface"] > 0 for row in at_level),
                    "failed": sum(row["status"] != "ok" for row in at_level),
                    "feasible": sum(row["feasible"] for row in at_level),
                    "processor_seconds": sum(row["elapsed"] for row in at_level),
                }
                for level in levels
                for at_level in ([row for row in searched if row["level"] == level],)
            },
            "designs_by_hand": len(rows) - len(searched),
            "wall_seconds": {
                str(level): sum(row["elapsed"] for row in generations if row["level"] == level)
                for level in sorted({row["level"] for row in generations})
            },
            "generations_by_level": {
                str(level): sum(row["level"] == level for row in generations)
                for level in sorted({row["level"] for row in generations})
            },
            "versions": json.loads(values["versions"]),
            "created": time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(float(values["created_at"]))),
            "journal": [
                {"at": time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(row["at"])), "text": row["text"]}
                for row in journal
            ],
        }
        if settings.surface:
            result["surface"] = _surface_summary(values, searched)
        front = self.known_front()
        if last is not None and front is not None:
            result["hypervolume"] = front.hypervolume
            result["spread"] = front.spread
            result["feasible_share"] = last.feasible_share
            result["front_size"] = len(front.ids)
            result["compromise"] = front.compromise
            result["knee"] = front.knee
        return result

    # -- generations -----------------------------------------------------------------------------------------------

    def generation_records(self, after: int = 0) -> tuple[GenerationRecord, ...]:
        """Every generation finished, in order; with ``after`` only later ones."""
        known = 0
        while known + 1 in self._generations:
            known += 1
        with self._reading() as content:
            for row in content.sorted_rows("generations", "WHERE number > ?", (known,)):
                number, level, data, elapsed, finished_at = row
                generation = generation_from_text(data)
                if (generation.number, generation.level) != (number, level):
                    raise DamagedRunError(self.path, f"generation {number} contradicts itself")
                self._generations[number] = GenerationRecord(generation, elapsed, finished_at)
            if set(self._generations) != set(range(1, content.tally.counts.get("generations", 0) + 1)):
                raise DamagedRunError(self.path, "a generation is missing")
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
        # what another thread forgets meanwhile is still at hand here
        found = {number: known for number in ids if (known := self._designs.get(number)) is not None}
        missing = [number for number in ids if number not in found]
        if missing:
            with self._reading() as content:
                # as the file is now: the errors of designs are in it too, and need not be looked for again
                values = content.values()
                for number in missing:
                    row = None
                    if abs(number) < _BEYOND_ANY_ID:
                        row = next(content.rows("evaluations", "WHERE id = ?", (number,)), None)
                    if row is None:
                        raise InputError(f"{self.path}: has no design {number}; see 'hpsop show {self.path} --front'")
                    record = _record("evaluations", row)
                    evaluation = self._placed(content.document(row))
                    found[number] = DesignRecord(number, record["origin"], record["generation"], evaluation)
            self._take_errors(values)
            self._designs.update(found)
            # a page that is open for days may look at every design of a run
            for number in list(self._designs)[:-_KEPT_DESIGNS]:
                self._designs.pop(number, None)
        errors = self._known_errors if missing else self._errors()
        return tuple(_refined(found[number], errors.get(str(number))) for number in ids)

    def comparison_errors(self, ids: Sequence[int]) -> dict[int, Mapping[str, float]]:
        """The errors in a comparison of those designs that were solved finer, by id; nothing else of them is read."""
        errors = self._errors()
        found = {number: errors.get(str(number), {}).get("comparison_errors", {}) for number in ids}
        return {number: widths for number, widths in found.items() if widths}

    def _errors(self) -> dict[str, dict[str, Any]]:
        """The error fields by the design's id, of designs that were solved finer.

        They come when the designs have long been read: looked for again whenever the file was changed.
        """
        try:
            status = os.stat(self._real)
        except OSError:
            return self._known_errors  # what has been read is still known when the file is gone
        changed = (status.st_mtime_ns, status.st_size)
        if changed != self._errors_of:
            with self._reading() as content:
                self._take_errors(content.values())
            self._errors_of = changed
        return self._known_errors

    def _take_errors(self, values: Mapping[str, str]) -> None:
        text = values.get(ERRORS_KEY, "")
        # a hundred designs' are 100 kB, and seldom others
        if text != self._errors_text:
            self._known_errors, self._errors_text = known_errors(values), text

    def _placed(self, document: Mapping[str, Any]) -> Evaluation:
        """An evaluation with the bounds that it stands on, which files of earlier versions do not tell."""
        return evaluation_from_dict(document, self.case.bounds)

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
        front = self.known_front(generation)
        number = None if front is None else {"compromise": front.compromise, "knee": front.knee}.get(name)
        if number is None:
            raise InputError(f"{self.path}: has no {name} design yet: no feasible design stands on its front")
        return self.designs([number])[0]

    def initial(self, level: int) -> DesignRecord:
        """The initial design at a level (at the other one while that is all there is).

        Raises:
            NotEvaluatedError: it is not evaluated yet.
        """
        with self._reading() as content:
            # An initial design has an id below the search's: no look at thousands of others. Which it is is asked of
            # records that match their checksums: SQL would pass over one whose origin or level was changed.
            rows = content.sorted_rows("evaluations", "WHERE id < ?", (FIRST_SEARCH_ID,))
            found = {row[_LEVEL]: int(row[0]) for row in rows if row[_ORIGIN] == "initial"}
            if level not in found:
                content.all_rows("evaluations")  # not there, rather than lost
        if not found:
            raise NotEvaluatedError(f"{self.path}: its initial design is not evaluated yet; let the run go on")
        return self.designs([found.get(level, min(found.values()))])[0]

    def known_fronts(self) -> tuple[KnownFront, ...]:
        """The front of every generation finished, in order; see ``fronts``."""
        finished = self.generations(after=len(self._fronts.fronts))
        if finished:
            news = self.archive(after=max(self._points, default=0))
            self._points.update((point.id, point) for point in news if point.generation <= finished[-1].number)
            for generation in finished:
                if any(number not in self._points for number in (*generation.asked, *generation.members)):
                    raise DamagedRunError(self.path, f"generation {generation.number} asked a design that is missing")
                self._fronts.add(generation)
        return self._fronts.fronts

    def known_front(self, generation: int | None = None) -> KnownFront | None:
        """The front of a generation; of the last one by default, None while there is none.

        Raises:
            InputError: a number that is not there.
        """
        record = self.generation(generation)
        return None if record is None else self.known_fronts()[record.number - 1]

    def front(self, generation: int | None = None) -> tuple[DesignRecord, ...]:
        """The Pareto front of a generation (the last one by default), ascending in f1; empty while there is none.

        It holds the best of everything that the generation's level has solved up to it (see ``fronts``);
        ``generation().front`` is that of the population alone.
        """
        known = self.known_front(generation)
        return () if known is None else self.designs(known.ids)

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
            after: only ids above this one, and the initial designs, which are evaluated when their level first needs
                them. Ids of one generation may finish in any order: ask again from the last id of the last finished
                generation.
            by_hand: designs made by hand instead of the search's.
        """
        with self._reading() as content:
            rows = self._hand_rows(content, after) if by_hand else self._search_rows(content, after)
            points = map(_point, rows)
            return tuple(point for point in points if level in (None, point.level))

    def news(
        self, after: int, known: Container[int], between: Callable[[], None] | None = None
    ) -> Iterator[tuple[ArchivePoint, Evaluation]]:
        """Designs of the search and by hand that are not known yet, each with all its numbers, which are not kept here:
        those of a whole run are some 200 MB.

        Args:
            after: as in ``archive``, of the search's.
            known: ids that are passed over.
            between: called again and again until the first of them is there, by whom something may be more urgent.
        """
        with self._reading() as content:
            errors = known_errors(content.values())
            for row in (*self._search_rows(content, after, between), *self._hand_rows(content)):
                if row[0] not in known:
                    evaluation = self._placed(content.document(row))
                    yield _point(row), _with_errors(evaluation, errors.get(str(row[0])))

    def _hand_rows(self, content: RunContent, after: int = 0) -> list[tuple[Any, ...]]:
        rows = content.sorted_rows("evaluations", "WHERE id > ?", (max(after, HAND_IDS_BEGIN - 1),))
        if after < HAND_IDS_BEGIN and len(rows) != content.tally.counts.get("hand", 0):
            raise DamagedRunError(self.path, "a design made by hand is missing")
        return [row for row in rows if row[_ORIGIN] == "hand"]

    def _search_rows(
        self, content: RunContent, after: int, between: Callable[[], None] | None = None
    ) -> list[tuple[Any, ...]]:
        if after:
            which = "WHERE (id > ? OR id < ?) AND id < ?"
            rows = content.sorted_rows("evaluations", which, (after, FIRST_SEARCH_ID, HAND_IDS_BEGIN))
        else:
            rows = content.all_rows("evaluations", between)
        self._check_none_missing(after, [row[0] for row in rows])
        return [row for row in rows if row[_ORIGIN] != "hand"]

    def _check_none_missing(self, after: int, ids: Sequence[int]) -> None:
        """The designs of finished generations are all there: ids of the search leave no gap."""
        last = max((max(record.generation.asked) for record in self._generations.values()), default=0)
        first = max(after + 1, FIRST_SEARCH_ID)
        if sum(first <= number <= last for number in ids) != max(0, last + 1 - first):
            raise DamagedRunError(self.path, "a design of a finished generation is missing")

    def by_hand(self) -> tuple[DesignRecord, ...]:
        """Designs made by hand, in the order made."""
        return self.designs([point.id for point in self.archive(after=HAND_IDS_BEGIN - 1, by_hand=True)])

    def failures(self) -> tuple[Failure, ...]:
        """Failed evaluations, in the order asked."""
        with self._reading() as content:
            records = [_record("evaluations", row) for row in content.all_rows("evaluations")]
            return tuple(
                Failure(
                    id=record["id"],
                    level=record["level"],
                    generation=record["generation"],
                    stage=record["stage"],
                    reason=record["reason"],
                    variables=DesignVariables.from_dict(named_variables(record["variables"])),
                    elapsed=record["elapsed"],
                )
                for record in records
                if record["status"] != "ok"
            )

    def reference(self, level: int) -> dict[str, Any] | None:
        """What normalises at a level, as ``Reference.as_dict`` gave it; None if it is not there (yet)."""
        with self._reading() as content:
            found: dict[int, dict[str, Any]] = {
                known: json.loads(text) for known, text in content.all_rows("reference")
            }
        return found.get(level)


def _with_errors(evaluation: Evaluation, fields: Mapping[str, Any] | None) -> Evaluation:
    if fields is None or not evaluation.ok:
        return evaluation
    return dataclasses.replace(evaluation, **fields, errors_source="solved")


def _refined(record: DesignRecord, fields: Mapping[str, Any] | None) -> DesignRecord:
    evaluation = _with_errors(record.evaluation, fields)
    return record if evaluation is record.evaluation else dataclasses.replace(record, evaluation=evaluation)


def _point(row: Sequence[Any]) -> ArchivePoint:
    record = _record("evaluations", row)
    return ArchivePoint(
        id=record["id"],
        level=record["level"],
        origin=record["origin"],
        generation=record["generation"],
        objectives=(record["first_objective"], record["second_objective"]) if record["status"] == "ok" else None,
        feasible=bool(record["feasible"]),
        predicted=record["surface"] > 0,
    )


def _surface_summary(values: Mapping[str, str], searched: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The learnt surfaces of a run: their own errors, and how far designs that were solved in the end lay from the
    last prediction of each."""
    predicted = {row["variables"]: row for row in sorted(searched, key=lambda row: row["id"]) if row["surface"]}
    pairs = [
        (predicted[row["variables"]], row)
        for row in searched
        if row["level"] == TRUTH.number
        and not row["surface"]
        and row["status"] == "ok"
        and row["variables"] in predicted
    ]
    pairs = [(guess, solved) for guess, solved in pairs if guess["id"] < solved["id"]]
    differences = {
        name: max((abs(guess[column] / solved[column] - 1.0) for guess, solved in pairs), default=None)
        for name, column in (("f1", "first_objective"), ("f2", "second_objective"))
    }
    return {
        "surfaces": json.loads(values.get("surfaces", "{}")),
        "solved_after_prediction": len(pairs),
        "greatest_difference": differences,
    }


def _record(table: str, row: Sequence[Any]) -> dict[str, Any]:
    return dict(zip(COLUMNS[table], row, strict=True))


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
