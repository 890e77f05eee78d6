"""What the reading process is asked, and what it does with it: from a file of a user's own to what was understood."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from hpsop_core.errors import HpsopError
from hpsop_core.geometry.hull.input import HullFile, ReadOptions, read_hull
from hpsop_core.geometry.propeller.input import UnderstoodPropeller, read_propeller


@dataclass(frozen=True)
class HullJob:
    """A hull file to be read.

    Attributes:
        path: where its bytes are.
        name: how people call it.
        options: what they state about it.
        shaft_height, boss_x: see ``read_hull``.
    """

    path: Path
    name: str
    options: ReadOptions
    shaft_height: float | None = None
    boss_x: float | None = None


@dataclass(frozen=True)
class PropellerJob:
    """A propeller's radial table to be read; ``name`` is how people call it."""

    path: Path
    name: str
    blade_count: int


@dataclass(frozen=True)
class Refused:
    """A file that cannot be used: one line that names the place and the remedy."""

    why: str


Job = HullJob | PropellerJob
Answer = HullFile | UnderstoodPropeller | Refused


def answer(job: Job) -> Answer:
    """Read a file; everything that is told names it as people do."""
    try:
        if isinstance(job, HullJob):
            return _told_by_name(read_hull(job.path, job.options, job.shaft_height, job.boss_x), job)
        told = read_propeller(job.path, job.blade_count)
        return dataclasses.replace(
            told,
            table=dataclasses.replace(told.table, name=job.name),
            assumed=_renamed(told.assumed, job),
            warnings=_renamed(told.warnings, job),
        )
    except HpsopError as error:
        return Refused(_renamed((str(error),), job)[0])


def _told_by_name(file: HullFile, job: HullJob) -> HullFile:
    told = file.understood
    return HullFile(
        # a function made on the spot does not travel between processes
        dataclasses.replace(file.table, name=job.name, station_name=str),
        file.parent,
        dataclasses.replace(
            told, name=job.name, assumed=_renamed(told.assumed, job), warnings=_renamed(told.warnings, job)
        ),
    )


def _renamed(lines: tuple[str, ...], job: Job) -> tuple[str, ...]:
    return tuple(line.replace(str(job.path), job.name).replace(job.path.name, job.name) for line in lines)
