"""Hull files as people have them: every layout, unit, origin and mesh of one ship gives that ship."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hull_files import (
    BREADTH,
    DRAFT,
    HEIGHTS,
    LENGTH,
    STATIONS,
    changed,
    feet_inches,
    half_breadth,
    long_form,
    matrix,
    parabolic_mesh,
    written,
)

from hpsop_core.case.case import load_case
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.hull.input import Axes, ReadOptions, ShipTable, hull_from_table, read_hull, read_table
from hpsop_core.hydro import michell
from tests.two_speeds import TWO_SPEEDS

Y = half_breadth(STATIONS, HEIGHTS)
COMMA: Callable[[float], str] = lambda value: f"{value:.6g}".replace(".", ",")  # noqa: E731
WL = [f"wl_{z:g}" for z in HEIGHTS]


def _text(name: str) -> tuple[str, str, dict[str, Any]]:
    """Text, encoding and options of a layout."""
    x, z, y = STATIONS, HEIGHTS, Y
    numbers = [f"{k:g}" for k in range(21)]
    foot = 0.3048
    layouts: dict[str, tuple[str, str, dict[str, Any]]] = {
        "as exported": (long_form(x, z, y), "utf-8", {}),
        "byte-order mark": (long_form(x, z, y), "utf-8-sig", {}),
        "UTF-16": (long_form(x, z, y), "utf-16", {}),
        "Latin-1": ("# L\xe4nge 120 m, gr\xf6\xdfte Breite 17 m\n" + long_form(x, z, y), "latin-1", {}),
        "quoted": (long_form(x, z, y, quote='"'), "utf-8", {}),
        "semicolon": (long_form(x, z, y, separator=";", number=COMMA), "utf-8", {}),
        "tab": (long_form(x, z, y, separator="\t", number=COMMA), "utf-8", {}),
        "sep line": ("sep=;\n" + long_form(x, z, y, separator=";", number=COMMA), "utf-8", {}),
        "blanks": (long_form(x, z, y, header=("x", "z", "y"), separator="   "), "utf-8", {}),
        "names with units": (
            long_form(x * 1e3, z * 1e3, y * 1e3, header=("X [mm]", "Z [mm]", "Half-breadth [mm]")), "utf-8", {}
        ),
        "stated cm": (long_form(x * 1e2, z * 1e2, y * 1e2, header=("x", "z", "y")), "utf-8", {"unit": "cm"}),
        "stated feet": (long_form(x / foot, z / foot, y / foot, header=("x", "z", "y")), "utf-8", {"unit": "ft"}),
        "mixed units": (long_form(x, z, y * 1e3, header=("x_m", "z_m", "half_breadth_mm")), "utf-8", {}),
        "full breadths": (long_form(x, z, 2 * y, header=("x", "z", "full breadth")), "utf-8", {}),
        "from the bow aft": (long_form(x[::-1], z, y[::-1]), "utf-8", {}),
        "from the deck down": (long_form(x, z[::-1], y[:, ::-1]), "utf-8", {}),
        "by waterline": (
            "z,x,y\n" + "".join(f"{b:g},{a:g},{y[i, k]:.6g}\n" for k, b in enumerate(z) for i, a in enumerate(x)),
            "utf-8", {},
        ),
        "matrix": (matrix([f"{a:g}" for a in x], WL, y, "x"), "utf-8", {}),
        "matrix, waterlines down": (matrix([f"WL {b:g}" for b in z], [f"{a:g}" for a in x], y.T, "wl"), "utf-8", {}),
        "matrix in mm": (
            matrix([f"{1e3 * a:g}" for a in x], [f"{1e3 * b:g}" for b in z], 1e3 * y, "x_mm"), "utf-8", {}
        ),
        "station numbers": (matrix(numbers, WL, y), "utf-8", {"axes": Axes(bow="+x")}),
        "station numbers, spacing": (
            "# station spacing = 6 m\n" + matrix(numbers, WL, y), "utf-8", {"axes": Axes(bow="+x")}
        ),
        "station numbers from FP": (
            "# stations 0 (FP) to 20 (AP)\n" + matrix(numbers, WL, y[::-1]), "utf-8", {}
        ),
        "fractions": (
            "# L/B 7.0588235, B/T 2.6153846\n"
            + matrix(numbers[::-1], [f"wl_{b / DRAFT:.8g}" for b in z], y / (BREADTH / 2) / _GREATEST), "utf-8",
            {"axes": Axes(origin="fp"), "breadth": BREADTH * _GREATEST},
        ),
        "x from FP": (long_form(LENGTH - x[::-1], z, y[::-1]), "utf-8", {"axes": Axes(origin="fp")}),
        "x from FP, named": (long_form(LENGTH - x[::-1], z, y[::-1], header=("x_from_fp", "z", "y")), "utf-8", {}),
        "x from midship": (long_form(x - 60.0, z, y), "utf-8", {"axes": Axes(origin="midship")}),
        "bow at -x": (
            long_form(60.0 - x[::-1], z, y[::-1]), "utf-8", {"axes": Axes(origin="midship", bow="-x")}
        ),
        "z from the still water": (long_form(x, z - DRAFT, y), "utf-8", {"axes": Axes(waterline="z0")}),
        "feet-inches-eighths": (
            "x_ft,z_ft,half_breadth\n"
            + "".join(
                f"{a / foot:.6f},{b / foot:.6f},{feet_inches(y[i, k])}\n"
                for i, a in enumerate(x) for k, b in enumerate(z)
            ),
            "utf-8", {},
        ),
        "trailing separators": (long_form(x, z, y).replace("\n", ",,\n"), "utf-8", {}),
    }  # fmt: skip
    return layouts[name]


_GREATEST = float(np.max(Y)) / (BREADTH / 2)
LAYOUTS = (
    "as exported", "byte-order mark", "UTF-16", "Latin-1", "quoted", "semicolon", "tab", "sep line", "blanks",
    "names with units", "stated cm", "stated feet", "mixed units", "full breadths", "from the bow aft",
    "from the deck down", "by waterline", "matrix", "matrix, waterlines down", "matrix in mm", "station numbers",
    "station numbers, spacing", "station numbers from FP", "fractions", "x from FP", "x from FP, named",
    "x from midship", "bow at -x", "z from the still water", "feet-inches-eighths", "trailing separators",
)  # fmt: skip


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_is_the_same_table(tmp_path: Path, layout: str) -> None:
    text, encoding, options = _text(layout)
    path = written(tmp_path / "ship.csv", text, encoding)
    table = read_table(path, ReadOptions(length=LENGTH, draft=DRAFT, **options))
    # Six digits are written, of millimetres too; an eighth of an inch is 3.2 mm, half of it the rounding.
    slack = 1.7e-3 if layout == "feet-inches-eighths" else 6e-4 if layout == "fractions" else 6e-5
    assert table.x == pytest.approx(STATIONS, abs=max(slack, 6e-4))
    assert table.z == pytest.approx(HEIGHTS, abs=slack)
    assert np.max(np.abs(table.y - Y)) < slack


def test_the_exported_layout_is_read_to_the_bit(tmp_path: Path) -> None:
    path = written(tmp_path / "ship.csv", long_form(STATIONS, HEIGHTS, Y, number=repr))
    table = read_table(path, ReadOptions(length=LENGTH, draft=DRAFT))
    assert np.array_equal(table.x, STATIONS) and np.array_equal(table.z, HEIGHTS) and np.array_equal(table.y, Y)


def test_from_ap_and_from_fp_are_one_ship(tmp_path: Path) -> None:
    """The formula's centre of buoyancy lies at 56.85 m from AP; counted from FP without a word it would be 63.15 m."""
    forward = written(tmp_path / "ap.csv", long_form(STATIONS, HEIGHTS, Y))
    aft = written(tmp_path / "fp.csv", long_form(LENGTH - STATIONS[::-1], HEIGHTS, Y[::-1]))
    hulls = [
        read_hull(forward, ReadOptions(length=LENGTH, draft=DRAFT)),
        read_hull(aft, ReadOptions(length=LENGTH, draft=DRAFT, axes=Axes(origin="fp"))),
    ]
    for hull in hulls:
        # 0.02 m: what a surface through 21 stations leaves open.
        assert hull.understood.buoyancy_centre == pytest.approx(56.85, abs=0.02)
        assert 8073.0 * 0.9995 < hull.understood.displaced_volume < 8089.0
        assert "2.63 % of L aft of midship" in str(hull.understood)
    assert "bow at -x, x = 0 at FP" in hulls[1].understood.axes


# --- the stern that ends at its post, the bulb below a stem, the boss that one reading tells ---


def _with_post(x: float, z: float) -> float:
    """A cruiser stern over a vertical post; the profile leaves the post at 4.6 m."""
    aft = -2.5 * max(0.0, (z - 4.6) / 1.4)
    s = (x - 50.0) / (50.0 if x >= 50.0 else 50.0 - aft)
    return 7.0 * max(0.0, 1.0 - abs(s) ** 2.2) * (1.0 - 0.9 * (1.0 - min(z / 6.0, 1.0)) ** 4)


def _with_bulb(x: float, z: float) -> float:
    """A bulb below a stem with a waist at 4.3 m between them."""
    form = 1.0 - 0.85 * (1.0 - min(z / 6.0, 1.0)) ** 3
    s = (x - 50.0) / (50.0 if x <= 50.0 else 49.6 + 0.25 * abs(z - 4.3))
    body = 7.0 * max(0.0, 1.0 - abs(s) ** 2.5) * form
    bulb = 1.2 * np.sqrt(max(0.0, 1.0 - ((z - 2.2) / 1.9) ** 2))
    bulb *= np.sqrt(max(0.0, 1.0 - (max(0.0, x - 97.0) / 6.5) ** 2)) * min(1.0, max(0.0, (x - 90.0) / 7.0))
    return float(max(body, bulb))


def _with_dome(x: float, z: float) -> float:
    """A flat bottom on the baseline and a sonar dome below the bow that goes 1.5 m deeper."""
    s = (x - 50.0) / 50.0
    body = 7.0 * max(0.0, 1.0 - abs(s) ** 2.5) * (1.0 - 0.6 * (1.0 - min(z / 6.0, 1.0)) ** 3) if z >= 0.0 else 0.0
    across = max(0.0, 1.0 - ((x - 92.0) / 8.0) ** 2 - (z / 1.5) ** 2)
    return float(max(body, 1.4 * np.sqrt(across)))


def _exact(form: Callable[[float, float], float], last: float, bottom: float) -> tuple[float, float]:
    """Volume and its centre by a fine trapezoidal rule on the formula."""
    x, z = np.linspace(0.0, last, 1036), np.linspace(bottom, 6.0, 376)
    areas = 2.0 * np.trapezoid(np.array([[form(a, b) for b in z] for a in x]), z, axis=1)
    volume = float(np.trapezoid(areas, x))
    return volume, float(np.trapezoid(areas * x, x)) / volume


@pytest.mark.parametrize(
    ("form", "stations", "heights", "last", "centre"),
    [
        (_with_post, [0, 2.5, 5, 7.5, *range(10, 95, 5), 92.5, 95, 97.5, 100],
         [0, 0.5, 1, 2, 3, 4, 4.6, 5.2, 6, 7, 8], 100.0, 0.15),
        (_with_bulb, [0, 1, 2.5, 5, 7.5, *range(10, 90, 5), 90, 92, 94, 96, 97, 98, 99, 99.4, 99.8, 100.2, 100.8, 101.5,
                      102.2, 102.8, 103.2, 103.5],
         [0, 0.3, 0.7, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.3, 4.7, 5, 5.4, 6, 7, 8], 103.5, 0.1),
        (_with_dome, [*range(0, 80, 5), 80, 82, 84, 86, 88, 90, 92, 94, 96, 98, 99, 99.5, 100],
         [-1.5, -1.35, -1.1, -0.8, -0.4, 0, 0.4, 0.8, 1.3, 2, 3, 4, 5, 6, 7, 8], 100.0, 0.1),
    ],
    ids=["table ends at the post", "gap between bulb and stem", "dome below the baseline"],
)  # fmt: skip
def test_ends_as_tables_give_them(
    tmp_path: Path,
    form: Callable[[float, float], float],
    stations: list[float],
    heights: list[float],
    last: float,
    centre: float,
) -> None:
    y = np.array([[form(x, z) for z in heights] for x in stations])
    path = written(tmp_path / "ship.csv", long_form(stations, heights, y))
    told = read_hull(path, ReadOptions(length=100.0, draft=6.0)).understood
    volume, place = _exact(form, last, min(heights))
    # Half a per cent: stations 5 m apart and waterlines 1 m apart say no more of the formula.
    assert told.displaced_volume == pytest.approx(volume, rel=5e-3)
    assert told.buoyancy_centre == pytest.approx(place, abs=centre)


# --- meshes ---

MESH_LENGTH, MESH_DRAFT = 100.0, 6.25


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> ShipTable:
    return read_table(_saved(tmp_path_factory.mktemp("mesh") / "base.stl", parabolic_mesh()), _mesh_options())


def _saved(path: Path, mesh: trimesh.Trimesh) -> Path:
    mesh.export(path)
    return path


def _mesh_options(**changes: Any) -> ReadOptions:
    return ReadOptions(**{"length": MESH_LENGTH, "draft": MESH_DRAFT, "unit": "m", **changes})


def _port(mesh: trimesh.Trimesh, sign: float) -> trimesh.Trimesh:
    """One half of an open mesh, exactly to the centreplane."""
    inside = np.all(sign * mesh.vertices[mesh.faces][:, :, 1] >= -1e-9, axis=1)
    return trimesh.Trimesh(mesh.vertices, mesh.faces[inside], process=False)


def _with_rudder(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    rudder = trimesh.creation.box(extents=(2.0, 0.3, 4.0))
    rudder.apply_translation([-2.0, 0.0, 3.0])
    return trimesh.util.concatenate([mesh, rudder])


def _deck_hole(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    above = np.flatnonzero(mesh.vertices[mesh.faces][:, :, 2].min(axis=1) > 7.0)
    return trimesh.Trimesh(mesh.vertices, np.delete(mesh.faces, above[::7], axis=0), process=False)


MESHES: dict[str, tuple[Callable[[], trimesh.Trimesh], str, dict[str, Any]]] = {
    "obj": (parabolic_mesh, "obj", {}),
    "ply": (parabolic_mesh, "ply", {}),
    "off": (parabolic_mesh, "off", {}),
    "open deck": (lambda: parabolic_mesh(deck=False), "stl", {}),
    "holes above the water": (lambda: _deck_hole(parabolic_mesh()), "stl", {}),
    "edge with four faces": (lambda: parabolic_mesh(fin=True), "stl", {}),
    "faces twice": (
        lambda: trimesh.Trimesh(parabolic_mesh().vertices, np.tile(parabolic_mesh().faces, (2, 1)), process=False),
        "ply", {},
    ),
    "inside out": (lambda: trimesh.Trimesh(parabolic_mesh().vertices, parabolic_mesh().faces[:, ::-1]), "stl", {}),
    "port half": (lambda: _port(parabolic_mesh(deck=False), 1.0), "stl", {}),
    "starboard half": (lambda: _port(parabolic_mesh(deck=False), -1.0), "stl", {}),
    "millimetres": (lambda: changed(parabolic_mesh(), (1e3, 1e3, 1e3)), "stl", {"unit": "mm"}),
    "origin at FP": (
        lambda: changed(parabolic_mesh(), shift=(-100, 0, 0)), "stl", {"axes": Axes(origin="fp", bow="+x")}
    ),
    "origin midship, bow at -x": (
        lambda: changed(parabolic_mesh(), (-1, 1, 1), (50, 0, 0)), "stl", {"axes": Axes(origin="midship", bow="-x")}
    ),
    "still water at z = 0": (
        lambda: changed(parabolic_mesh(), shift=(0, 0, -6.25)), "stl", {"axes": Axes(waterline="z0")}
    ),
    "y up": (
        lambda: trimesh.Trimesh(parabolic_mesh().vertices[:, [0, 2, 1]] * [1, 1, -1], parabolic_mesh().faces), "glb",
        {"unit": None},
    ),
    "a rudder apart": (lambda: _with_rudder(parabolic_mesh()), "stl", {}),
}  # fmt: skip


@pytest.mark.parametrize("kind", MESHES)
def test_every_mesh_is_the_same_hull(tmp_path: Path, base: ShipTable, kind: str) -> None:
    make, suffix, changes = MESHES[kind]
    table = read_table(_saved(tmp_path / f"ship.{suffix}", make()), _mesh_options(**changes))
    # Single precision and another order of the corners: 0.1 mm. The fin's facets run the other way in the last bay.
    assert table.x == pytest.approx(base.x, abs=1e-4)
    assert table.z == pytest.approx(base.z, abs=1e-4)
    wet = base.z <= MESH_DRAFT
    alike = base.x < (97.5 if kind == "edge with four faces" else np.inf)
    assert float(np.max(np.abs(table.y - base.y)[np.ix_(alike, wet)])) < 1e-3
    volumes = [float(np.trapezoid(np.trapezoid(one.y[:, wet], one.z[wet], axis=1), one.x)) for one in (table, base)]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-3)
    if kind == "a rudder apart":
        assert "left out: a rudder at x = -2 m" in table.notes


def test_keel_below_the_baseline(tmp_path: Path, base: ShipTable) -> None:
    """The same body in the water, 0.6 m lower: nothing below z = 0 is lost."""
    path = _saved(tmp_path / "deep.stl", changed(parabolic_mesh(), shift=(0, 0, -0.6)))
    deep = read_hull(path, _mesh_options(draft=5.65))
    told = deep.understood
    # 2777.8 m3 is the formula's; plane facets on 41 stations lose 0.2 % of it.
    assert told.displaced_volume == pytest.approx(2771.8, rel=1e-3)
    assert told.wetted_surface == pytest.approx(1490.2, rel=1e-3)
    # Level 1 sees the same body: its table of half-breadths begins at the keel, not at z = 0.
    waves = [
        michell.wave_coefficients(table.x, table.z, table.y, 100.0, 1490.2, (0.25, 0.3))
        for table in (
            file.parent.transform(100.0, file.parent.breadth, file.table.draft).offset_table()
            for file in (deep, hull_from_table(base))
        )
    ]
    assert waves[0] == pytest.approx(waves[1], rel=1e-3)


def test_a_mesh_that_ends_at_its_waterline(tmp_path: Path) -> None:
    """A model's mesh in single precision: its top is 0.187688 m, the draft was typed as 0.1877 m."""
    path = _saved(tmp_path / "model.stl", changed(parabolic_mesh(freeboard=0.0), (1 / 33.3,) * 3))
    table = read_table(path, _mesh_options(length=3.003, draft=0.1877))
    below = 2.0 * float(np.trapezoid(np.trapezoid(table.y, table.z, axis=1), table.x))
    assert below == pytest.approx(2777.8 / 33.3**3, rel=4e-3)
    assert any("the draft 0.1877 m is taken as" in note for note in table.notes)


def test_own_mesh_formats_come_back(tmp_path: Path) -> None:
    """What the program exports it reads again, with the propeller left out."""
    from hpsop_core.export.meshes import write_glb

    case = load_case(TWO_SPEEDS)
    hull = design_hull(case, case.initial.variables)
    write_glb(tmp_path / "ship.glb", hull, design_propeller(case, case.initial.variables))
    table = read_table(tmp_path / "ship.glb", ReadOptions(length=355.0, draft=14.5))
    assert any("y points up" in note for note in table.notes)
    assert any("left out: a propeller" in note for note in table.notes)
    below = table.z <= 14.5
    volume = 2.0 * float(np.trapezoid(np.trapezoid(table.y[:, below], table.z[below], axis=1), table.x))
    # The trapezoidal rule on 121 x 33 readings.
    assert volume == pytest.approx(hull.hydrostatics.displaced_volume, rel=2e-3)


def _same_volume(table: ShipTable, volume: float) -> None:
    below = table.z <= table.draft
    found = 2.0 * float(np.trapezoid(np.trapezoid(table.y[:, below], table.z[below], axis=1), table.x))
    # The trapezoidal rule on 121 x 33 readings.
    assert found == pytest.approx(volume, rel=2e-3)


@pytest.mark.parametrize("suffix", ["3dm", "step", "iges"])
def test_own_surfaces_come_back(tmp_path: Path, suffix: str) -> None:
    """What the program exports for CAD it reads again."""
    from hpsop_core.export.rhino import write_3dm
    from hpsop_core.export.solids import sewn_solid, write_iges, write_step
    from hpsop_core.export.surfaces import design_surfaces, hull_surfaces

    case = load_case(TWO_SPEEDS)
    hull = design_hull(case, case.initial.variables)
    path = tmp_path / f"ship.{suffix}"
    if suffix == "3dm":
        write_3dm(path, design_surfaces(hull, design_propeller(case, case.initial.variables))[0], "a ship")
    else:
        body = sewn_solid("hull", hull_surfaces(hull)[0])
        {"step": write_step, "iges": write_iges}[suffix](path, [body], "a ship")
    table = read_table(path, ReadOptions(length=355.0, draft=14.5))
    assert any("propeller" in note for note in table.notes) == (suffix == "3dm")
    _same_volume(table, hull.hydrostatics.displaced_volume)
    assert table.unit == ("m" if suffix == "3dm" else "mm")


def test_a_mesh_on_its_head(tmp_path: Path) -> None:
    """Keel up, deck at z = 0: nothing in the axes tells, the form does; the words of the warning put it right."""
    head = changed(parabolic_mesh(), (1, 1, -1), (0, 0, 9.25))
    path = _saved(tmp_path / "head.stl", head)
    doubted = read_hull(path, _mesh_options()).understood
    assert any("as if it stood on its head; if it does, state up=-z" in line for line in doubted.warnings)
    told = read_hull(path, _mesh_options(axes=Axes.from_words("up=-z"))).understood
    # 2777.8 m3 is the formula's; plane facets lose 0.2 % of it.
    assert told.displaced_volume == pytest.approx(2771.8, rel=1e-3)
    assert told.warnings == ()


def test_a_transom_is_read_as_flat_as_it_is(tmp_path: Path) -> None:
    """A mesh cut off at x = 25 m, its transom open: no triangle crosses the plane of the cut itself."""
    mesh = parabolic_mesh(freeboard=0.0)
    cut = trimesh.Trimesh(mesh.vertices, mesh.faces[mesh.vertices[mesh.faces][:, :, 0].min(axis=1) > 24.9])
    table = read_table(
        _saved(tmp_path / "transom.stl", changed(cut, shift=(-25.0, 0.0, 0.0))), _mesh_options(length=75.0)
    )
    # y = B/2 (1 - s^2)(1 + 0.35 s)(1 - t^2) at s = -0.5
    form = 5.0 * 0.75 * 0.825 * (1.0 - ((MESH_DRAFT - table.z) / MESH_DRAFT) ** 2)
    assert table.y[0] == pytest.approx(form, abs=0.02)
    assert any("the transom is open" in note for note in table.notes)
