"""Hull files that cannot be right: refused or warned in one line with place, finding and a way that works."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.ready_case import ready_case
from hpsop_core.case.sections import HullSection
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation import solvable
from hpsop_core.evaluation.reference import Reference, reference_for
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.geometry.clearance import propeller_clearance, propeller_plane_x
from hpsop_core.geometry.foreign import apart
from hpsop_core.geometry.hull.input import Axes, ReadOptions, read_hull, read_table

LENGTH, BREADTH, DRAFT = 120.0, 17.0, 6.5
STATIONS = np.linspace(0.0, LENGTH, 21)
HEIGHTS = np.array([0, 0.5, 1, 1.6, 2.4, 3.2, 4.1, 5, 5.8, 6.5, 7.5, 9])
HEADER = "station_x_m,waterline_z_m,half_breadth_m\n"
OPTIONS = ReadOptions(length=LENGTH, draft=DRAFT)


def half_breadths() -> np.ndarray:
    s = (2.0 * STATIONS / LENGTH - 1.0)[:, None]
    girth = 1.0 - 0.45 * np.maximum(0.0, 1.0 - HEIGHTS / DRAFT) ** 3
    return np.asarray(BREADTH / 2 * (1.0 - np.abs(s) ** 2.4) * (1.0 - 0.25 * s) / 1.03 * girth)


def saved(folder: Path, factor: float = 1.0, least: float = 0.0, comma: bool = False) -> Path:
    rows = []
    for x, line in zip(STATIONS, half_breadths(), strict=True):
        for z, y in zip(HEIGHTS, line, strict=True):
            if z >= least:
                value = f"{factor * y:.4f}"
                rows.append(f"{x:g},{z:g},{value.replace('.', ',') if comma else value}")
    path = folder / "hull.csv"
    path.write_text(HEADER + "\n".join(rows) + "\n")
    return path


def test_more_cells_than_columns(tmp_path: Path) -> None:
    """Decimal commas between commas once cut every half-breadth to whole metres."""
    with pytest.raises(InputError, match=r"row 2: 4 values for 3 columns; use a decimal point"):
        read_hull(saved(tmp_path, comma=True), OPTIONS)


def test_a_bottom_that_is_not_told(tmp_path: Path) -> None:
    """Without its keel row the table would lose up to 450 of 8,073 m3; the remedy named is the one that works."""
    with pytest.raises(
        InputError, match=r"lowest waterline is 0.5 m above the baseline.*up to 4\d\d.*add the row z = 0"
    ):
        read_hull(saved(tmp_path, least=0.4), OPTIONS)
    assert read_hull(saved(tmp_path), OPTIONS).understood.displaced_volume == pytest.approx(8073, rel=1e-3)


@pytest.mark.parametrize(("factor", "refused"), [(2.0, False), (3.2808, True), (0.3048, True)])
def test_proportions_outside_the_field(tmp_path: Path, factor: float, refused: bool) -> None:
    """Full breadths as half-breadths, feet across a hull in metres, and the other way round."""
    path = saved(tmp_path, factor)
    if refused:
        with pytest.raises(
            InputError, match=r"which no ship has; are the half-breadths full breadths, or in another unit"
        ):
            read_hull(path, OPTIONS)
    else:
        warnings = read_hull(path, OPTIONS).understood.warnings
        assert any("outside what ships have" in line and "full breadths" in line for line in warnings)


def test_a_bow_at_the_other_end_is_doubted(tmp_path: Path) -> None:
    """A stern's upper waterlines are fuller: a table of a real ship from FP says so itself."""
    source = Path(__file__).parents[1] / "data" / "hulls" / "kvlcc2.csv"
    right = read_table(source, ReadOptions(length=320.0, draft=20.8))
    assert not [note for note in right.notes if "bow" in note]
    turned = tmp_path / "turned.csv"
    lines = source.read_text().splitlines()
    body = [line.split(",", 1) for line in lines[4:]]
    turned.write_text("\n".join([lines[3], *(f"{320.0 - float(x):.3f},{rest}" for x, rest in reversed(body))]) + "\n")
    table = read_table(turned, ReadOptions(length=320.0, draft=20.8))
    assert any("looks as if the bow were at -x" in note for note in table.notes)


def test_an_own_hull_has_its_own_dimensions(tmp_path: Path) -> None:
    """A case that names a hull and no length, breadth or draft in [initial] is that hull, not the shipped one."""
    saved(tmp_path)
    case = tmp_path / "case.toml"
    case.write_text(
        'name = "own"\n[hull]\noffsets = "hull.csv"\nlength = 120.0\ndraft = 6.5\n[initial]\ndiameter = 4.0\n'
        "blade_count = 4\n[bounds]\nlength_to_breadth = [6.5, 8.5]\nbreadth_to_draft = [2.4, 4.5]\ndraft = [6.0, 7.0]\n"
        "diameter = [3.8, 4.3]\nblade_count = [3, 5]\npitch_ratio = [0.9, 1.1]\n",
        encoding="utf-8-sig",
    )
    initial = load_case(case).initial
    assert (initial.length, initial.draft) == (120.0, 6.5)
    # The formula's greatest breadth is 16.79 m; stations 6 m apart come within a centimetre of it.
    assert initial.breadth == pytest.approx(float(2.0 * half_breadths()[:, :10].max()), rel=1e-3)


def test_the_hull_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(tmp_path)
    target, picture = tmp_path / "own.toml", tmp_path / "own.svg"
    words = ["hull", str(path), "--length", "120", "--draft", "6.5"]
    assert main([*words, "--picture", str(picture), "--case", str(target), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["displaced_volume"] == pytest.approx(8073, rel=1e-3)
    assert told["buoyancy_centre_percent"] == pytest.approx(-2.63, abs=0.02)
    assert told["fit"]["largest_deviation"] < 0.1 and told["fit"]["patches"][0]["patch"] == "main"
    assert picture.read_text(encoding="utf-8").startswith("<?xml")
    # The case is ready: it finds the hull beside itself and its initial design is feasible but for the form's limits.
    assert main(["evaluate", str(target), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["hull"]["displaced_volume"] == pytest.approx(told["displaced_volume"], rel=1e-6)
    assert answer["constraints"]["propeller_clearance"] < 0.0
    assert main([*words, "--case", str(target)]) == 2
    assert "--force" in capsys.readouterr().err
    drawn = picture.read_bytes()
    # A picture is drawn anew over the older one, over nothing else.
    picture.write_bytes(drawn[:-100])
    assert main([*words, "--picture", str(picture)]) == 0 and picture.read_bytes() == drawn
    capsys.readouterr()
    picture.write_text("years of work")
    assert main([*words, "--picture", str(picture)]) == 2
    assert "--force" in capsys.readouterr().err and picture.read_text() == "years of work"
    assert main([*words, "--picture", str(picture), "--force"]) == 0 and picture.read_bytes() == drawn
    assert main([*words, "--picture", str(tmp_path / "own.bmp")]) == 2


def test_a_ship_too_slow_for_level_2_is_set_up_with_level_1_and_that_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_slow(case: Case, level: int) -> Reference:
        if level == 2:
            raise SolverFailure("rankine", "no waves at Froude number 0.14")
        return reference_for(case, level)

    monkeypatch.setattr(solvable, "reference_for", too_slow)
    path, target = saved(tmp_path), tmp_path / "own.toml"
    words = ["hull", str(path), "--length", "120", "--draft", "6.5", "--case", str(target)]
    assert main(words) == 0
    assert "warning: level 2 gives no numbers here (rankine: no waves" in capsys.readouterr().out
    case = load_case(target)
    assert case.constants.wave_calibration == "none"
    assert case.optimization.level1_generations == case.optimization.generations
    assert "level 1 alone" in case.description
    assert main(["evaluate", str(target), "--level", "1"]) == 0
    capsys.readouterr()

    def never(_case: Case, _level: int) -> Reference:
        raise SolverFailure("hull", "no form")

    monkeypatch.setattr(solvable, "reference_for", never)
    assert main([*words, "--force", "--json"]) == 0
    assert "no numbers as it stands" in json.loads(capsys.readouterr().out)["warnings"][-1]


def test_the_resistance_command_takes_any_hull(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(tmp_path)
    base = ["resistance", "--length", "120", "--draft", "6.5", "--froude", "0.25", "--json"]
    answers = []
    for words in (["--offsets", str(path)], ["--hull", str(path), "--unit", "m", "--axes", "bow=+x,origin=ap"]):
        assert main([*base, *words]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1]
    assert main([*base, "--hull", str(path), "--axes", "bow=up"]) == 2
    assert main([*base, "--hull", str(path), "--offsets", str(path)]) == 2
    assert main(["resistance", "dtc-p4119", "--unit", "m", "--froude", "0.2"]) == 2


def test_holes_and_what_crosses_a_section_twice(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=(100.0, 10.0, 8.0))
    box.apply_translation([50.0, 0.0, 4.0])
    side = np.flatnonzero(np.all(box.vertices[box.faces][:, :, 1] > 4.9, axis=1))
    trimesh.Trimesh(box.vertices, np.delete(box.faces, side, axis=0)).export(tmp_path / "open.stl")
    options = ReadOptions(length=100.0, draft=4.0, unit="m")
    with pytest.raises(InputError, match=r"holes under water: \d+ open edges.* from x = 0 to 100 m"):
        read_table(tmp_path / "open.stl", options)
    keel = trimesh.creation.box(extents=(30.0, 0.4, 0.8))
    keel.apply_translation([50.0, 5.6, 1.0])
    other = keel.copy()
    other.apply_scale([1.0, -1.0, 1.0])
    trimesh.util.concatenate([box, keel, other]).export(tmp_path / "keels.stl")
    table = read_table(tmp_path / "keels.stl", options)
    assert any("left out: a bilge keel or rail at x = 50 m" in note for note in table.notes)


def test_cad_without_its_library_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "find_spec", lambda _name: None)
    (tmp_path / "ship.step").write_text("ISO-10303-21;")
    with pytest.raises(InputError, match=r"pip install 'hpsop\[cad\]'"):
        read_table(tmp_path / "ship.step", OPTIONS)


@pytest.mark.parametrize("seed", range(40))
def test_a_spoilt_table_is_read_or_refused(tmp_path: Path, seed: int) -> None:
    """Lines lost, doubled and shuffled, cells of every kind: an answer or one line, nothing else."""
    random = np.random.default_rng(seed)
    lines = saved(tmp_path).read_text().splitlines()
    for _ in range(random.integers(1, 4)):
        k = int(random.integers(len(lines)))
        cells = lines[k].split(",")
        kind = int(random.integers(8))
        if kind == 0:
            del lines[k]
        elif kind == 1:
            lines.insert(k, lines[int(random.integers(len(lines)))])
        elif kind == 2:
            cells[int(random.integers(len(cells)))] = str(
                random.choice(["", "nan", "-1", "1e9", "abc", "12-3-4", '"', "1,5", "½", "1e-12"])
            )
            lines[k] = ",".join(cells)
        elif kind == 3:
            lines = lines[: k + 1]
        elif kind == 4:
            lines[k] = lines[k].replace(",", str(random.choice([";", "\t", " ", ",,"])))
        elif kind == 5:
            lines = [lines[0], *lines[1 :: int(random.integers(2, 5))]]
        elif kind == 6:
            lines[0] = str(random.choice(["", "x,z,y", "z,x,y", "a,b,c", "1,2,3,4,5,6"]))
        else:
            lines = [lines[0], *random.permutation(lines[1:]).tolist()]
    path = tmp_path / "spoilt.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    try:
        volume = read_hull(path, OPTIONS).understood.displaced_volume
    except InputError as refusal:
        assert "\n" not in str(refusal) and str(refusal).startswith("spoilt.csv")
    else:
        # What is still read is this hull, within what a lost row of the keel or every second reading may cost.
        assert volume == pytest.approx(8073, rel=0.05)


def test_station_numbers_of_a_ship_of_26_metres(tmp_path: Path) -> None:
    """Numbers 0 to 20 on 26 m were once taken for metres, and a quarter of the ship was lost; both remedies work."""
    x, z = STATIONS * 26.0 / LENGTH, HEIGHTS * 26.0 / LENGTH
    y = half_breadths() * 26.0 / LENGTH
    options = ReadOptions(length=26.0, draft=float(z[9]))

    def table(first: str, labels: np.ndarray) -> Path:
        path = tmp_path / "tug.csv"
        rows = [f"{label:g}," + ",".join(f"{v:.5f}" for v in row) for label, row in zip(labels, y, strict=True)]
        path.write_text("\n".join([first + "," + ",".join(f"wl_{v:.6g}" for v in z), *rows]) + "\n")
        return path

    numbered = read_table(table("station", np.arange(21)), options)
    assert numbered.x == pytest.approx(x)
    doubts = [note for note in numbered.notes if "may be numbers or metres" in note]
    assert len(doubts) == 1 and doubts[0].endswith("write '# spacing = 1 m' into the file")
    # As it says: with that line they are metres.
    assert read_table(table("# spacing = 1 m\nstation", np.arange(21)), options).x == pytest.approx(np.arange(21))
    # A column that states its unit holds no numbers, and metres that span the length are metres.
    for first in ("station [m]", "station"):
        assert read_table(table(first, x), options).x == pytest.approx(x, abs=1e-5)
    long = "station (mm),wl (mm),half beam (mm)\n" + "".join(
        f"{1e3 * a:.1f},{1e3 * b:.1f},{1e3 * c:.2f}\n"
        for a, row in zip(x, y, strict=True)
        for b, c in zip(z, row, strict=True)
    )
    (tmp_path / "long.csv").write_text(long)
    assert read_table(tmp_path / "long.csv", options).x == pytest.approx(x, abs=1e-4)


def test_which_end_station_0_is_is_asked_where_nothing_tells(tmp_path: Path) -> None:
    """Sections alike at every height have no bow that the form tells; the words of the warning turn the ship."""
    y = half_breadths()[:, 9:10] * np.linspace(0.8, 1.0, 12)
    path = tmp_path / "numbers.csv"
    lines = [f"{k}," + ",".join(f"{v:.4f}" for v in row) for k, row in enumerate(y)]
    path.write_text("\n".join(["station," + ",".join(f"wl_{z:g}" for z in HEIGHTS), *lines]) + "\n")
    table = read_table(path, OPTIONS)
    assert any(note.startswith("warning: neither the file nor its form") for note in table.notes)
    turned = read_table(path, ReadOptions(length=LENGTH, draft=DRAFT, axes=Axes.from_words("bow=-x")))
    assert turned.y == pytest.approx(table.y[::-1])
    assert turned.x == pytest.approx(STATIONS)
    assert not any("neither the file" in note for note in turned.notes)


def test_a_body_that_ends_under_water_behind_its_waterline(tmp_path: Path) -> None:
    """A submarine at the surface: its tail was left out in silence, 4 % of the volume."""
    x, z = np.linspace(0.0, 70.0, 29), np.linspace(0.0, 10.0, 21)
    radius = 5.0 * np.sqrt(1.0 - np.abs((x - 35.0) / 35.0) ** 2.5)
    y = np.sqrt(np.maximum(radius[:, None] ** 2 - (z - 5.0) ** 2, 0.0))
    path = tmp_path / "boat.csv"
    path.write_text(HEADER + "".join(f"{a:g},{b:g},{y[i, k]:.4f}\n" for i, a in enumerate(x) for k, b in enumerate(z)))
    with pytest.raises(InputError, match=r"boat.csv row \d+: station 7.5 m has [\d.]+ m2 under water, of which the"):
        read_hull(path, ReadOptions(length=70.0, draft=8.5))
    # where less is left out it is said
    x = np.linspace(0.0, 70.0, 71)
    radius = 5.0 * np.sqrt(1.0 - np.abs((x - 35.0) / 35.0) ** 2.5)
    y = np.sqrt(np.maximum(radius[:, None] ** 2 - (z - 5.0) ** 2, 0.0))
    path.write_text(HEADER + "".join(f"{a:g},{b:g},{y[i, k]:.4f}\n" for i, a in enumerate(x) for k, b in enumerate(z)))
    warnings = read_hull(path, ReadOptions(length=70.0, draft=6.5)).understood.warnings
    assert any(line.startswith("station 1 m has 5.") and "m2 under water" in line for line in warnings), warnings


def test_a_tug_has_a_case_whose_propeller_has_room(tmp_path: Path) -> None:
    """L/B 2.9 was no case at all, and where the run rises over the shaft every propeller cut the hull."""
    x, z = np.linspace(0.0, 26.0, 27), np.linspace(0.0, 3.4, 13)
    part = np.clip((13.0 - x) / 13.0, 0.0, 1.0)
    half, keel = 4.5 * (1.0 - 0.22 * part**2.6 - np.clip((x - 13.0) / 13.0, 0.0, 1.0) ** 2), 1.9 * part**1.6
    above = np.clip((z - keel[:, None]) / (3.4 - keel[:, None]), 0.0, 1.0)
    y = half[:, None] * above**0.4
    path = tmp_path / "tug.csv"
    path.write_text(
        HEADER + "".join(f"{a:g},{b:.5f},{y[i, k]:.4f}\n" for i, a in enumerate(x) for k, b in enumerate(z))
    )
    options = ReadOptions(length=26.0, draft=3.4)
    file = read_hull(path, options)
    case = ready_case(file, str(path), options)
    variables = case.initial.variables
    assert variables.length_to_breadth == pytest.approx(2.89, abs=0.01)
    hull, propeller = design_hull(case, variables), design_propeller(case, variables)
    assert propeller_clearance(file.hull, propeller) < 0.0
    assert propeller_clearance(hull, propeller) > 0.05 * propeller.diameter
    # Aft of where the profile meets the shaft, and forward of the transom.
    assert 0.0 < propeller_plane_x(hull, propeller) < file.parent.boss_end_x
    assert f"the hub was put {case.hull.boss_x:.4g} m from AP" in case.description


@pytest.mark.parametrize(("field", "value"), [("shaft_height", 39.0), ("boss_x", 500.0)])
def test_a_propeller_in_the_air_or_before_the_ship_is_refused(field: str, value: float) -> None:
    """Both were computed as if nothing were wrong."""
    with pytest.raises(InputError, match=f"hull: {field} .*counted from"):
        HullSection(file="ship.csv", length=150.0, draft=8.0, **{field: value})
