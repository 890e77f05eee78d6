"""How an evaluation's JSON is kept in a run file: its numbers as they are in memory, its words once.

A run of 7,500 evaluations holds some 150 numbers each; as plain JSON that is 42 MB, packed it is 11. What is stored is
read back to the last bit. The first evaluation of a run is its dictionary: the words, and the numbers that never
change, cost nothing from then on.
"""

from __future__ import annotations

import json
import marshal
import math
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from hpsop_core.runs.records import json_text, named_variables

_RAW_DEFLATE = -15  # without zlib's header and check sum: the record has its own
_MEMORY = 6  # of zlib's levels: the same bytes as of 8 for an evaluation, and a quarter of the tables to be cleared
_BREAK = b"\0"
_LARGEST = 16 * 2**20  # bytes unpacked, a thousand times what an evaluation has: beyond it stands a bomb
_LARGEST_KEPT = 2**16  # bytes of words whose form is kept
_NUMBER = struct.calcsize("<d")
_WARNINGS = b'"warnings":['
_CONTAINERS = (dict, list, tuple)
_PLAIN = frozenset((str, int, bool, type(None)))
_DECODER = json.JSONDecoder()


def pack(essence: bytes, dictionary: bytes) -> bytes:
    """What ``essence_of`` made of an evaluation's document, deflated.

    Args:
        essence: of the evaluation.
        dictionary: the run's, the essence of its first evaluation.
    """
    packer = zlib.compressobj(9, zlib.DEFLATED, _RAW_DEFLATE, _MEMORY, zdict=dictionary)
    return packer.compress(essence) + packer.flush()


def unpack(packed: bytes, dictionary: bytes, variables: str) -> dict[str, Any]:
    """The document whose essence ``pack`` was given.

    Args:
        packed: its bytes.
        dictionary: the run's.
        variables: the design's, as the text in its row.

    Raises:
        ValueError, LookupError, TypeError, struct.error, zlib.error: bytes that ``pack`` did not make.
    """
    unpacker = zlib.decompressobj(_RAW_DEFLATE, zdict=dictionary)
    essence = unpacker.decompress(packed, _LARGEST)
    if not unpacker.eof or unpacker.unused_data:
        raise ValueError("packed data that does not end where it should")
    return document_of(essence, variables)


def document_of(essence: bytes, variables: str) -> dict[str, Any]:
    """The document that ``essence_of`` was given, with these variables.

    Raises:
        ValueError, LookupError, TypeError, struct.error: bytes that ``essence_of`` did not make.
    """
    words, _, binary = essence.partition(_BREAK)
    numbers = struct.unpack(f"<{len(binary) // _NUMBER}d", binary)
    words, warnings = _without_warnings(words)
    form = _form(words) if len(words) <= _LARGEST_KEPT else _Form(words)
    if form.count != len(numbers) or not all(map(math.isfinite, numbers)):
        raise ValueError("packed data whose words and numbers do not belong together")
    document = form.document(numbers)
    if warnings is not None:
        if document.get("warnings") != []:
            raise ValueError("packed data with its warnings in another place")
        document["warnings"] = warnings
    document["variables"] = named_variables(variables)
    curves = document.get("open_water")
    if curves and "open_water_efficiency" not in curves:
        curves["open_water_efficiency"] = _left_out_before(curves)
    return document


def essence_of(document: Mapping[str, Any]) -> bytes:
    """The evaluation's JSON document as bytes, its words, a break, its numbers.

    Args:
        document: as ``Evaluation.as_dict``; not changed. Its variables are left out: they stand in the design's row.

    Raises:
        ValueError: a number is not finite.
        TypeError: something has no JSON form.
    """
    numbers: list[float] = []
    shape = _split({key: value for key, value in document.items() if key != "variables"}, numbers)
    if not all(map(math.isfinite, numbers)):
        raise ValueError("an evaluation with a number that is not finite")
    # In the second version equal objects are equal bytes, whatever else refers to them.
    words = _words(marshal.dumps(shape, 2))
    return words + _BREAK + struct.pack(f"<{len(numbers)}d", *numbers)


def _split(value: Any, numbers: list[float]) -> Any:
    """An object or an array with 0.0 for each real number, which goes to ``numbers`` in the order met."""
    # A loop in place of a call a leaf: of the 300 that an evaluation has, nine in ten are numbers.
    if isinstance(value, dict):
        named: dict[str, Any] = {}
        for key, item in value.items():
            if isinstance(item, float):
                numbers.append(item)
                named[key] = 0.0
            else:
                named[key] = item if type(item) in _PLAIN else _split_other(item, numbers)
        return named
    listed: list[Any] = []
    for item in value:
        if isinstance(item, float):
            numbers.append(item)
            listed.append(0.0)
        else:
            listed.append(item if type(item) in _PLAIN else _split_other(item, numbers))
    return listed


def _split_other(value: Any, numbers: list[float]) -> Any:
    if isinstance(value, _CONTAINERS):
        return _split(value, numbers)
    # numpy's scalars and arrays, among which may be real numbers
    return _split([json.loads(json_text(value))], numbers)[0]


@lru_cache(maxsize=64)
def _words(shape: bytes) -> bytes:
    """The JSON of a document without numbers, from its marshalled form: five in six of a run have it from before."""
    return json_text(marshal.loads(shape)).encode()


class _Form:
    """What evaluations that differ in their numbers alone have in common: read once, filled for each.

    Args:
        words: their JSON, with 0.0 for each real number.

    Attributes:
        count: of real numbers.
    """

    def __init__(self, words: bytes) -> None:
        shape = json.loads(words)
        if not isinstance(shape, dict):
            raise ValueError("packed data that is no document")
        self.count = 0
        self._fill: Callable[[Sequence[float]], dict[str, Any]] = self._filled_object(shape)

    def document(self, numbers: Sequence[float]) -> dict[str, Any]:
        """A document of its own, with these numbers in the order met."""
        return self._fill(numbers)

    def _filled(self, value: Any) -> Callable[[Sequence[float]], Any]:
        return self._filled_object(value) if isinstance(value, dict) else self._filled_list(value)

    def _filled_object(self, shape: dict[str, Any]) -> Callable[[Sequence[float]], dict[str, Any]]:
        names: list[str] = []
        places: list[int] = []
        inner: list[tuple[str, Callable[[Sequence[float]], Any]]] = []
        for name, value in shape.items():
            if isinstance(value, float):
                names.append(name)
                places.append(self.count)
                self.count += 1
            elif isinstance(value, (dict, list)):
                inner.append((name, self._filled(value)))
        pick = _picked(places)

        def fill(numbers: Sequence[float]) -> dict[str, Any]:
            # A copy keeps the order of the keys.
            found = shape.copy()
            found.update(zip(names, pick(numbers), strict=True))
            for name, filled in inner:
                found[name] = filled(numbers)
            return found

        return fill

    def _filled_list(self, shape: list[Any]) -> Callable[[Sequence[float]], list[Any]]:
        indices: list[int] = []
        places: list[int] = []
        inner: list[tuple[int, Callable[[Sequence[float]], Any]]] = []
        for index, value in enumerate(shape):
            if isinstance(value, float):
                indices.append(index)
                places.append(self.count)
                self.count += 1
            elif isinstance(value, (dict, list)):
                inner.append((index, self._filled(value)))
        pick = _picked(places)
        if len(indices) == len(shape):
            return lambda numbers: list(pick(numbers))

        def fill(numbers: Sequence[float]) -> list[Any]:
            found = shape.copy()
            for index, number in zip(indices, pick(numbers), strict=True):
                found[index] = number
            for index, filled in inner:
                found[index] = filled(numbers)
            return found

        return fill


def _picked(places: Sequence[int]) -> Callable[[Sequence[float]], Sequence[float]]:
    """A function that takes the numbers at these places, ascending, out of all."""
    if not places:
        return lambda numbers: ()
    first, last = places[0], places[-1] + 1
    if last - first == len(places):
        return lambda numbers: numbers[first:last]
    return lambda numbers: [numbers[place] for place in places]


_form = lru_cache(maxsize=128)(_Form)
"""A run has a few dozen forms: levels, blade counts, bounds that designs stand on."""


def _without_warnings(words: bytes) -> tuple[bytes, list[str] | None]:
    """The words of a document without those for people, and these; None where they stay: they alone differ from
    design to design, with numbers in their midst."""
    start = words.find(_WARNINGS)
    if start < 0 or words.find(_WARNINGS, start + 1) >= 0:
        return words, None
    start += len(_WARNINGS) - 1
    text = words[start:].decode()
    warnings, end = _DECODER.raw_decode(text)
    if not warnings or not all(isinstance(line, str) for line in warnings):
        return words, None
    return words[:start] + b"[]" + text[end:].encode(), warnings


def _left_out_before(curves: Mapping[str, Sequence[float]]) -> list[float | None]:
    """The efficiencies that files of earlier versions left out: a rule of those files, whatever evaluations do today.

    They left the column out where it had the very bits of J KT/(2 pi KQ), computed in this order.
    """
    names = ("advance_coefficient", "thrust_coefficient", "torque_coefficient")
    return [
        j * kt / (2.0 * math.pi * kq) if kq else None for j, kt, kq in zip(*(curves[n] for n in names), strict=True)
    ]
