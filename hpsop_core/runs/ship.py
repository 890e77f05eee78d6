"""The files of a case's own hull and propeller, kept in the run: it needs them nowhere else.

A run file holds their bytes as they were when it was begun. Who reads the run finds them written out under a name made
of their content, in the user's cache folder, and the case names them there: readers of hulls and propellers see files
as ever, and the same content has the same name whichever run it comes from.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.errors import InputError
from hpsop_core.scratch import lasting_scratch_folder, scratch_folder

FILE_FIELDS = (("hull", "file"), ("hull", "offsets"), ("hull", "stl"), ("propeller", "geometry"))
"""Where a case names a file: section and field. A field that this version's cases do not have is passed over."""

LARGEST_FILE = 200 * 2**20
"""Bytes of the largest hull file that a run takes aboard; a mesh of a million triangles has 50 MB."""

_HASH_LETTERS = 32
_SAME_SHIP = 1e-5  # relative: other libraries round the fit differently, another ship differs in the third digit


@dataclass(frozen=True)
class ShipFile:
    """A file of a case.

    Attributes:
        section, field: where the case names it.
        name: its own name, without folder.
        content: its bytes, as they were read.
    """

    section: str
    field: str
    name: str
    content: bytes

    @property
    def sha256(self) -> str:
        """Of the content, in hexadecimal."""
        return hashlib.sha256(self.content).hexdigest()


def named_files(case: Case) -> tuple[tuple[str, str, str], ...]:
    """(section, field, path) of each file that a case names."""
    found = []
    for section, field in FILE_FIELDS:
        path = getattr(getattr(case, section), field, "")
        if path:
            found.append((section, field, str(path)))
    return tuple(found)


def read_files(case: Case) -> tuple[ShipFile, ...]:
    """The files that a case names, with their content.

    Raises:
        InputError: one that is gone, is no file, or is too large.
    """
    files = []
    for section, field, text in named_files(case):
        path = Path(text)
        try:
            if not path.is_file():
                raise InputError(f"{section}: {field}: there is no file {path} (any more); put it back or name another")
            with open(path, "rb") as stream:
                content = stream.read(LARGEST_FILE + 1)
        except OSError as error:
            raise InputError(f"{section}: {field}: {path} cannot be read ({error.strerror})") from error
        if len(content) > LARGEST_FILE:
            raise InputError(
                f"{section}: {field}: {path} is larger than {LARGEST_FILE // 2**20} MB; save a coarser mesh"
            )
        files.append(ShipFile(section, field, path.name, content))
    return tuple(files)


def with_names(case: Case, files: Sequence[ShipFile]) -> Case:
    """The case with the bare names of its files: what stands in the run file."""
    return _with_paths(case, {(file.section, file.field): file.name for file in files})


def with_files(case: Case, files: Sequence[ShipFile]) -> Case:
    """The case with its files written out where this process finds them.

    Raises:
        InputError: there is no folder that can be written.
    """
    return _with_paths(case, {(file.section, file.field): str(_written(file)) for file in files})


def refuse_changed_ship(path: Path, case: Case, initial: Mapping[str, Any]) -> None:
    """For a run of an earlier version, which only names its files: are they what it was computed with?

    Args:
        path: of the run file.
        case: its case.
        initial: its initial design's evaluation, as JSON.

    Raises:
        InputError: a file is gone, or gives another initial design.
    """
    from hpsop_core.evaluation.shapes import design_hull, design_propeller  # solvers' imports take a second

    names = " and ".join(text for _, _, text in named_files(case))
    for _, _, text in named_files(case):
        if not Path(text).is_file():
            raise InputError(
                f"{path}: was begun by an earlier hpsop, which did not keep {text} in the run, and that file is gone; "
                "put it back there; the run's numbers can be read without it"
            )
    # By their content: hulls are remembered by the names of their files, and this one may have been edited since.
    now_there = with_files(case, read_files(case))
    hull = design_hull(now_there, case.initial.variables).hydrostatics
    blades = design_propeller(now_there, case.initial.variables)
    pairs = (
        (initial["hull"]["displaced_volume"], hull.displaced_volume),
        (initial["hull"]["wetted_surface"], hull.wetted_surface),
        (initial["propeller"]["pitch_diameter_ratio_07R"], blades.pitch_diameter_ratio_07R),
        (initial["propeller"]["expanded_area_ratio"], blades.expanded_area_ratio),
    )
    for was, now in pairs:
        if abs(was - now) > _SAME_SHIP * abs(was):
            raise InputError(
                f"{path}: {names} does not give the run's initial design any more (a figure was {was:.6g}, is now "
                f"{now:.6g}): put the file back as it was, or start a new run; the numbers can be read as they are"
            )


def is_same_ship(case: Case, other: Case) -> bool:
    """Whether two cases are equal when their files are compared by content."""
    return _by_content(case) == _by_content(other)


def _by_content(case: Case) -> Case:
    paths = {}
    for section, field, text in named_files(case):
        path = Path(text)
        with contextlib.suppress(OSError):
            text = hashlib.sha256(path.read_bytes()).hexdigest()
        paths[section, field] = text
    return _with_paths(case, paths)


def _with_paths(case: Case, paths: dict[tuple[str, str], str]) -> Case:
    for (section, field), path in paths.items():
        changed: Any = dataclasses.replace(getattr(case, section), **{field: path})
        case = dataclasses.replace(case, **{section: changed})
    return case


def _written(file: ShipFile) -> Path:
    """Where the file stands on this machine, with exactly its content."""
    folder = _cache_folder() / file.sha256[:_HASH_LETTERS]
    # The name is the user's, and chooses the reader by its ending; a folder in it would lead out of ours.
    name = Path(file.name).name
    path = folder / (name if name not in ("", ".", "..") else "file")
    with contextlib.suppress(OSError):
        if path.read_bytes() == file.content:
            return path
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        with scratch_folder("ship", beside=folder) as workshop:
            whole = workshop / path.name
            whole.write_bytes(file.content)
            os.chmod(whole, 0o444)
            os.replace(whole, path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{file.name}: cannot be written to {folder} ({reason}); set XDG_CACHE_HOME") from error
    return path


@lru_cache(maxsize=1)
def _cache_folder() -> Path:
    """Of this user, or of this process where the user has none that can be written."""
    stated = os.environ.get("XDG_CACHE_HOME")
    with contextlib.suppress(OSError, RuntimeError):
        base = Path(stated) if stated else Path.home() / ".cache"
        folder = base / "hpsop" / "ships"
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    return lasting_scratch_folder("ships")
