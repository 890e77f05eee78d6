"""What level 1 takes from level 2 in the shipped cases, kept as files: a first answer then needs no panel method.

A file's name is the fingerprint of all that its content follows from. A case that differs in any of it, be it by one
``--set``, finds no file and is computed; one that differs in weights, limits or objectives alone finds its own. What
was learnt on hulls of a space serves every case whose bounds lie within, too. The content is what this version of the
code computes, to the last digits (``tools/calibrations.py`` writes the files, a test compares them).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from hpsop_core.assets import asset_path
from hpsop_core.case.case import Case

INITIAL = "initial"
"""The kind of file that holds level 2's wave coefficients of the initial design."""

LEARNT = "learnt"
"""The kind of file that holds what ``wave_correction`` learns from."""


def file_name(case: Case, kind: str) -> str | None:
    """The name of a case's file; None where a user's own hull is among what it follows from.

    Args:
        case: any case.
        kind: ``INITIAL``, or ``LEARNT``, which follows from the number of hulls too.
    """
    if case.hull.own_file:
        return None
    conditions = {key: value for key, value in asdict(case.conditions).items() if key != "weights"}
    parts: list[Any] = [kind, asdict(case.hull), asdict(case.initial), conditions, case.constants.gravity]
    parts.append(len(case.conditions.weights))
    if kind == LEARNT:
        parts.append(case.constants.wave_calibration_hulls)
    digest = hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()
    return f"{kind}-{digest[:16]}.json"


def shipped(case: Case, kind: str) -> Any:
    """The content of a case's file; None where there is none, or what it was learnt on does not cover the case."""
    name = file_name(case, kind)
    if name is None:
        return None
    path = asset_path("calibrations", name)
    if not path.is_file():
        return None
    document = json.loads(path.read_text(encoding="utf-8"))
    if kind == LEARNT and not _covers(document["bounds"], case):
        return None
    return document["content"]


def _covers(bounds: Mapping[str, Sequence[float]], case: Case) -> bool:
    own = case.bounds.as_dict()
    return own.keys() == bounds.keys() and all(
        low <= own[name][0] and own[name][1] <= high for name, (low, high) in bounds.items()
    )
