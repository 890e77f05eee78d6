"""A hull as loose triangles in ship axes, however its file called axes and units; appendages set apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hpsop_core.errors import InputError
from hpsop_core.geometry.hull.input.options import UNITS, Axes, ReadOptions
from hpsop_core.typing_aliases import Array, IntArray

# Lengths between perpendiculars that a file without a unit is taken for, m.
USUAL_LENGTHS = (1.5, 500.0)
# Extent over Lpp that a mesh may have: bulb, counter and a bowsprit's worth of deck.
LEAST_EXTENT, GREATEST_EXTENT = 0.75, 1.5
# y_min + y_max over the breadth below which a hull is symmetric; half hulls have 1.
SYMMETRY = 0.02


@dataclass(frozen=True, eq=False)
class TriangleFile:
    """Triangles as a file has them.

    Attributes:
        name, layout: of the file, in words.
        vertices: (n, 3) in the file's unit; faces: (m, 3) indices.
        unit: that the file itself states, or None.
        closed: whether neighbouring faces share vertices, so that open edges can be told (not so of CAD surfaces).
        notes: what was noticed.
    """

    name: str
    layout: str
    vertices: Array
    faces: IntArray
    unit: str | None
    closed: bool
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ShipTriangles:
    """Triangles in ship axes, m: x forward from AP, y to port, z up from the baseline.

    Attributes:
        name, layout, unit, axes: in words.
        vertices, faces: (n, 3) and (m, 3).
        length, draft: m.
        closed: as of ``TriangleFile``.
        half: the file holds one side only; ``vertices`` and ``faces`` hold it mirrored to port.
        notes: one line each.
    """

    name: str
    layout: str
    unit: str
    axes: str
    vertices: Array
    faces: IntArray
    length: float
    draft: float
    closed: bool
    half: bool
    notes: tuple[str, ...]


def _unit(file: TriangleFile, options: ReadOptions, extent: float) -> tuple[str, str | None]:
    """The unit and a note where it was assumed."""
    if options.unit is not None:
        if options.unit == "ft-in-8":
            raise InputError(f"{file.name}: a mesh has no feet-inches-eighths; choose m, mm, cm, ft or in")
        return options.unit, None
    if file.unit is not None:
        size = extent * UNITS[file.unit]
        fits = options.length is None or LEAST_EXTENT < size / options.length < GREATEST_EXTENT
        if fits and (options.length is not None or size >= USUAL_LENGTHS[0]):
            return file.unit, None
    said = "the file carries no unit" if file.unit is None else f"the file says {file.unit}, which cannot be"
    for unit in ("m", "mm", "ft", "cm", "in"):
        size = extent * UNITS[unit]
        if options.length is not None and 0.9 < size / options.length < 1.2:
            return unit, f"{said}: {unit} assumed, which fits the length"
        if options.length is None and USUAL_LENGTHS[0] <= size <= USUAL_LENGTHS[1]:
            return unit, f"{said}: {unit} assumed, {size:.4g} m over all; state it"
    raise InputError(
        f"{file.name}: {said} and it is {extent:g} units long"
        + (f", which fits a length of {options.length:g} m in none" if options.length is not None else "")
        + "; state the unit (m, mm, cm, ft, in)"
    )


_TURNS = {
    "z": np.eye(3),
    "-z": np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "-y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
}


def _upright(vertices: Array, faces: IntArray, axes: Axes) -> tuple[Array, list[str]]:
    """Vertices with x along, y across and z up, and what was turned.

    A file whose z is the symmetric axis (glTF, many modellers) has y up. Of a half hull neither axis is symmetric: the
    one that carries the flat of bottom is upright. A hull is broader at its top than at its bottom.
    """
    notes = []
    size = np.ptp(vertices, axis=0)
    if int(np.argmax(size)) == 1:
        vertices = vertices[:, [1, 0, 2]] * np.array([1.0, -1.0, 1.0])
        notes.append("the ship lies along y in the file: turned along x")
    if axes.up != "auto":
        turned = vertices @ _TURNS[axes.up].T
        counted_down = float(turned[:, 2].max()) <= 0.05 * float(np.ptp(turned[:, 2]))
        if axes.up.startswith("-") and axes.waterline != "z0" and counted_down:
            # Heights were counted from the deck down to the keel: turned over, they begin at the keel.
            turned = turned - np.array([0.0, 0.0, float(turned[:, 2].min())])
            notes.append("turned over: z = 0 at the lowest point")
        return turned, notes
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = np.maximum(high - low, 1e-12)
    skew = np.abs(low + high) / size
    axis = 2
    if skew[2] < SYMMETRY < skew[1]:
        axis = 1
    elif skew[1] > SYMMETRY and abs(skew[1] - 1.0) < SYMMETRY and abs(skew[2] - 1.0) < SYMMETRY:
        axis = 1 if _flat_at_end(vertices, faces, 1) > 3.0 * _flat_at_end(vertices, faces, 2) else 2
    down = high[axis] <= 0.05 * size[axis] and _plane(vertices, axis, False) > 1.05 * _plane(vertices, axis, True)
    up = ("-" if down else "") + ("y" if axis == 1 else "z")
    if up != "z":
        notes.append(f"{up} points up in the file: turned so that z is up (state up=z if it does not)")
    return vertices @ _TURNS[up].T if up != "z" else vertices, notes


def _plane(vertices: Array, axis: int, top: bool) -> float:
    """A measure of the hull's area in plan near the upper or lower end of an axis: its mean half-breadth."""
    part = (vertices[:, axis] - vertices[:, axis].min()) / max(float(np.ptp(vertices[:, axis])), 1e-12)
    end = vertices[part > 0.92] if top else vertices[part < 0.08]
    x = (end[:, 0] - vertices[:, 0].min()) / max(float(np.ptp(vertices[:, 0])), 1e-12)
    widths = np.zeros(41)
    np.maximum.at(widths, (40.0 * x).astype(int), np.abs(end[:, 3 - axis]))
    told = np.flatnonzero(widths > 0.0)
    return float(np.mean(np.interp(np.arange(41), told, widths[told], left=0.0, right=0.0))) if len(told) else 0.0


def _flat_at_end(vertices: Array, faces: IntArray, axis: int) -> float:
    """Area of the faces that lie in the plane at the smaller absolute end of an axis."""
    values = vertices[:, axis]
    end = values.min() if abs(values.min()) < abs(values.max()) else values.max()
    flat = faces[np.all(np.abs(values[faces] - end) < 2e-3 * np.ptp(values), axis=1)]
    corners = vertices[flat]
    return float(np.sum(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)))


def _sides(file: TriangleFile, vertices: Array) -> tuple[Array, bool, str | None]:
    """Vertices about y = 0, whether they are one side only (then to port), and a note."""
    low, high = float(vertices[:, 1].min()), float(vertices[:, 1].max())
    breadth = max(high - low, 1e-12)
    if abs(low + high) <= SYMMETRY * breadth:
        return vertices, False, None
    if abs(low) <= SYMMETRY * breadth or abs(high) <= SYMMETRY * breadth:
        side = "port" if abs(low) <= SYMMETRY * breadth else "starboard"
        mirrored = vertices if side == "port" else vertices * np.array([1.0, -1.0, 1.0])
        return mirrored, True, f"the {side} half only: the other is its mirror image"
    raise InputError(
        f"{file.name}: y runs from {low:g} to {high:g} m; it must be symmetric about y = 0, or one half from y = 0 "
        "(x forward, y to port, z up)"
    )


def _bow(vertices: Array, faces: IntArray, draft: float) -> str | None:
    """The end of x at which the bow is, from the form: a stern is far fuller above than below, a bow hardly."""
    corners = vertices[faces]
    centre = corners.mean(axis=1)
    span = float(np.ptp(vertices[:, 0]))
    # Side areas projected on the centreplane, weighted by half-breadth: volumes of thin horizontal layers.
    area = 0.5 * np.abs(
        (corners[:, 1, 0] - corners[:, 0, 0]) * (corners[:, 2, 2] - corners[:, 0, 2])
        - (corners[:, 2, 0] - corners[:, 0, 0]) * (corners[:, 1, 2] - corners[:, 0, 2])
    )
    weight = area * np.abs(centre[:, 1])
    low = (centre[:, 2] > 0.0) & (centre[:, 2] < 0.5 * draft)
    top = (centre[:, 2] >= 0.8 * draft) & (centre[:, 2] <= draft)
    if weight[low].sum() <= 0.0 or weight[top].sum() <= 0.0:
        return None
    centres = [float(weight[part] @ centre[part, 0] / weight[part].sum()) for part in (low, top)]
    apart = (centres[0] - centres[1]) / span
    return None if abs(apart) < 0.008 else "+x" if apart > 0.0 else "-x"


def in_ship_axes(file: TriangleFile, options: ReadOptions) -> ShipTriangles:
    """The triangles of a file in ship axes.

    Raises:
        InputError: no unit that fits, no symmetry, another size than the length, a draft above the top.
    """
    notes = list(file.notes)
    vertices, turned = _upright(np.asarray(file.vertices, dtype=np.float64), file.faces, options.axes)
    notes += turned
    unit, note = _unit(file, options, float(np.ptp(vertices[:, 0])))
    notes += [note] if note else []
    vertices = vertices * UNITS[unit]
    vertices, half, note = _sides(file, vertices)
    notes += [note] if note else []
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    extent = float(high[0] - low[0])
    length = options.length
    if length is not None and not LEAST_EXTENT * length < extent < GREATEST_EXTENT * length:
        raise InputError(
            f"{file.name}: the mesh is {extent:g} m long in unit '{unit}' but the length is {length:g} m; "
            "state the mesh's own unit, or its length between perpendiculars"
        )
    waterline = options.axes.waterline if options.axes.waterline != "auto" else "draft"
    draft = options.draft
    if draft is None:
        draft = _assumed_draft(waterline, low, high, notes)
    if waterline == "z0":
        vertices = vertices + np.array([0.0, 0.0, draft])
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        if abs(low[2]) > 0.02 * draft:
            notes.append(
                f"warning: the lowest point lies {abs(low[2]):.4g} m {'below' if low[2] < 0.0 else 'above'} the "
                f"baseline that the draft of {draft:g} m gives"
            )
    if draft > high[2]:
        # A file in single precision may end a hair below the draft that was typed.
        if draft > high[2] * (1.0 + 1e-3):
            raise InputError(
                f"{file.name}: the draft {draft:g} m is above the mesh's top at {high[2]:.6g} m; lower the draft to "
                f"{high[2]:.6g}, or is the unit or the waterline (z0) another?"
            )
        notes.append(f"the mesh ends at its waterline: the draft {draft:g} m is taken as {high[2]:.6g} m")
        draft = float(high[2])
    vertices, axes, length, more = _lengthwise(file, options, vertices, length, draft)
    words = f"{axes}, z = 0 at the {'still water' if waterline == 'z0' else 'baseline'}"
    return ShipTriangles(
        file.name, file.layout, unit, words, vertices, file.faces, length, draft, file.closed, half, (*notes, *more)
    )


def _assumed_draft(waterline: str, low: Array, high: Array, notes: list[str]) -> float:
    if waterline == "z0":
        notes.append(f"draft not stated: the lowest point lies {-low[2]:g} m below the still water")
        return float(-low[2])
    draft = min(float(high[2]), float(high[1] - min(low[1], -high[1])) / 2.5)
    notes.append(f"draft not stated: {draft:.4g} m assumed (B/2.5, or the mesh's top); state it")
    return draft


def _lengthwise(
    file: TriangleFile, options: ReadOptions, vertices: Array, length: float | None, draft: float
) -> tuple[Array, str, float, list[str]]:
    """Bow forward and AP at x = 0."""
    notes: list[str] = []
    low, high = float(vertices[:, 0].min()), float(vertices[:, 0].max())
    origin, bow = options.axes.origin, options.axes.bow
    looks = _bow(vertices, file.faces, draft)
    if bow == "auto":
        bow = "+x"
        if origin == "fp":
            bow = "-x" if low + high > 0.0 else "+x"
            notes.append(f"bow at {bow}: x = 0 is at FP")
    if looks is not None and looks != bow and options.axes.bow == "auto":
        notes.append(
            f"warning: the form looks as if the bow were at {looks} (its upper waterlines are finer there); if it is, "
            f"state bow={looks} and the origin"
        )
    if length is None:
        under = vertices[np.abs(vertices[:, 2] - draft) < 0.15 * draft]
        span = under if len(under) else vertices
        first, last = float(span[:, 0].min()), float(span[:, 0].max())
        reach = {"ap": last if bow == "+x" else -first, "fp": last if bow == "-x" else -first}.get(
            "ap" if origin == "auto" else origin, last - first
        )
        length = reach if reach > 0.5 * (last - first) else last - first
        notes.append(f"length not stated: {length:.5g} m assumed, from AP to the fore end of the waterline; state it")
    if origin == "auto":
        origin = "ap"
    forward = vertices if bow == "+x" else vertices * np.array([-1.0, 1.0, 1.0])
    shift = {"ap": 0.0, "midship": 0.5 * length, "fp": length}[origin]
    moved = forward + np.array([shift, 0.0, 0.0]) if shift else forward
    words = f"bow at {bow}, x = 0 at {origin.upper() if origin != 'midship' else 'midship'}"
    return moved, words, length, notes
