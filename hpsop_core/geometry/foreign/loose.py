"""Loose triangles of a file, and how they travel from the process that read them."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.typing_aliases import Array, IntArray


@dataclass(frozen=True, eq=False)
class LooseTriangles:
    """What a file of surfaces holds.

    Attributes:
        layout: of the file, in words.
        vertices: (n, 3) in the file's unit; faces: (m, 3) indices.
        unit: that the file itself states, or None.
        notes: what was noticed.
    """

    layout: str
    vertices: Array
    faces: IntArray
    unit: str | None
    notes: tuple[str, ...] = ()


def packed(answer: LooseTriangles | InputError) -> bytes:
    """An answer as bytes: arrays and JSON, nothing that is executed where it is read."""
    words: dict[str, object]
    if isinstance(answer, InputError):
        words, vertices, faces = {"refused": str(answer)}, np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    else:
        words = {"layout": answer.layout, "unit": answer.unit, "notes": list(answer.notes)}
        vertices, faces = answer.vertices, answer.faces
    file = io.BytesIO()
    text = np.frombuffer(json.dumps(words).encode(), dtype=np.uint8)
    np.savez(file, words=text, vertices=np.asarray(vertices, dtype=np.float64), faces=np.asarray(faces, dtype=np.int64))
    return file.getvalue()


def unpacked(content: bytes) -> LooseTriangles:
    """The triangles that ``packed`` made bytes of.

    Raises:
        InputError: what the reader refused, in its own words.
    """
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        words = json.loads(arrays["words"].tobytes())
        vertices, faces = np.array(arrays["vertices"]), np.array(arrays["faces"])
    if "refused" in words:
        raise InputError(words["refused"])
    return LooseTriangles(words["layout"], vertices, faces, words["unit"], tuple(words["notes"]))
