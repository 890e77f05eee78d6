"""How an evaluation's JSON is kept in a run file: its numbers as they are in memory, its words once.

A run of 7,500 evaluations holds some 150 numbers each; as plain JSON that is 42 MB, packed it is 11. What is stored is
read back to the last bit. The first evaluation of a run is its dictionary: the words, and the numbers that never
change, cost nothing from then on.
"""

from __future__ import annotations

import json
import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from hpsop_core.runs.records import json_text, named_variables

_RAW_DEFLATE = -15  # without zlib's header and check sum: the record has its own
_BREAK = b"\0"
_LARGEST = 16 * 2**20  # bytes unpacked, a thousand times what an evaluation has: beyond it stands a bomb


def pack(document: Mapping[str, Any], dictionary: bytes) -> bytes:
    """The evaluation's JSON document as bytes.

    Args:
        document: as ``Evaluation.as_dict``; not changed. Its variables are left out: they stand in the design's row.
        dictionary: the run's, as ``dictionary_of`` made it.

    Raises:
        ValueError: a number is not finite.
    """
    packer = zlib.compressobj(9, zlib.DEFLATED, _RAW_DEFLATE, zdict=dictionary)
    return packer.compress(dictionary_of(document)) + packer.flush()


def unpack(packed: bytes, dictionary: bytes, variables: str) -> dict[str, Any]:
    """The document that ``pack`` was given.

    Args:
        packed: its bytes.
        dictionary: the run's.
        variables: the design's, as the text in its row.

    Raises:
        ValueError, LookupError, TypeError, struct.error, zlib.error: bytes that ``pack`` did not make.
    """
    unpacker = zlib.decompressobj(_RAW_DEFLATE, zdict=dictionary)
    content = unpacker.decompress(packed, _LARGEST)
    if not unpacker.eof or unpacker.unused_data:
        raise ValueError("packed data that does not end where it should")
    words, _, binary = content.partition(_BREAK)
    numbers = [number for (number,) in struct.iter_unpack("<d", binary)]
    shape = json.loads(words)
    if not isinstance(shape, dict) or _count(shape) != len(numbers) or not all(map(math.isfinite, numbers)):
        raise ValueError("packed data whose words and numbers do not belong together")
    document: dict[str, Any] = _joined(shape, iter(numbers))
    document["variables"] = named_variables(variables)
    curves = document.get("open_water")
    if curves and "open_water_efficiency" not in curves:
        curves["open_water_efficiency"] = _left_out_before(curves)
    return document


def dictionary_of(document: Mapping[str, Any]) -> bytes:
    """What is deflated, and a run's dictionary if it is made of the first evaluation: words, a break, numbers."""
    essence = {key: value for key, value in document.items() if key != "variables"}
    numbers: list[float] = []
    words = json_text(_split(essence, numbers))
    if not all(map(math.isfinite, numbers)):
        raise ValueError("an evaluation with a number that is not finite")
    return words.encode() + _BREAK + struct.pack(f"<{len(numbers)}d", *numbers)


def _split(value: Any, numbers: list[float]) -> Any:
    """The value with 0.0 for each real number, which goes to ``numbers`` in the order met."""
    if isinstance(value, float):
        numbers.append(value)
        return 0.0
    if isinstance(value, Mapping):
        return {key: _split(item, numbers) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_split(item, numbers) for item in value]
    return value


def _count(value: Any) -> int:
    """How many real numbers stand in a value."""
    if isinstance(value, float):
        return 1
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return sum(map(_count, items))


def _joined(value: Any, numbers: Iterator[float]) -> Any:
    if isinstance(value, float):
        return next(numbers)
    if isinstance(value, dict):
        return {key: _joined(item, numbers) for key, item in value.items()}
    if isinstance(value, list):
        return [_joined(item, numbers) for item in value]
    return value


def _left_out_before(curves: Mapping[str, Sequence[float]]) -> list[float | None]:
    """The efficiencies that files of earlier versions left out: a rule of those files, whatever evaluations do today.

    They left the column out where it had the very bits of J KT/(2 pi KQ), computed in this order.
    """
    names = ("advance_coefficient", "thrust_coefficient", "torque_coefficient")
    return [
        j * kt / (2.0 * math.pi * kq) if kq else None for j, kt, kq in zip(*(curves[n] for n in names), strict=True)
    ]
