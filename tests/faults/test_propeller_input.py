"""Bad radial tables and bad propellers: one line that names the place and the remedy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hpsop_core import load_case
from hpsop_core.assets import read_asset_text
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError
from hpsop_core.evaluation.propeller_answer import propeller_warnings
from hpsop_core.geometry.propeller.input import read_propeller
from hpsop_core.geometry.propeller.propeller import load_propeller, propeller_family, radial_table_from_csv
from hpsop_core.geometry.propeller.radial_table import RadialTable
from hpsop_core.hydro.section_drag import SectionDrag

HEADER = "r_R,c_D,P_D,skew_deg,rake_D,t_c,f_c"
ROWS = [
    "0.2,0.32,1.105,0,0,0.2,0.014",
    "0.4,0.40,1.098,0,0,0.118,0.023",
    "0.6,0.46,1.088,0,0,0.07,0.021",
    "0.8,0.43,1.081,0,0,0.042,0.02",
    "0.95,0.28,1.077,0,0,0.032,0.016",
    "1.0,0.0,1.075,0,0,0.032,0.012",
]


def write(folder: Path, lines: list[str]) -> Path:
    file = folder / "blade.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def changed(row: int, text: str) -> list[str]:
    return ["# a blade", HEADER, *[text if i == row else line for i, line in enumerate(ROWS)]]


BAD = {
    "thickness in percent": (changed(2, "0.6,0.46,1.088,0,0,7.0,0.021"), ("line 5", "t_c 7", "percent")),
    "chord in percent": (changed(2, "0.6,46,1.088,0,0,0.07,0.021"), ("line 5", "c_D 46", "fractions of the diameter")),
    "camber in percent": (changed(2, "0.6,0.46,1.088,0,0,0.07,2.1"), ("line 5", "f_c 2.1", "percent")),
    "pitch in millimetres": (changed(1, "0.4,0.40,330,0,0,0.118,0.023"), ("line 4", "P_D 330")),
    "negative chord": (changed(3, "0.8,-0.43,1.081,0,0,0.042,0.02"), ("line 6", "c_D -0.43")),
    "no chord inside": (changed(3, "0.8,0,1.081,0,0,0.042,0.02"), ("line 6", "c_D is zero", "only the tip")),
    "unsorted": (changed(3, "0.5,0.43,1.081,0,0,0.042,0.02"), ("line 6", "does not ascend", "sort")),
    "repeated radius": (changed(3, "0.6,0.43,1.081,0,0,0.042,0.02"), ("line 6", "does not ascend")),
    "nan": (changed(4, "0.95,nan,1.077,0,0,0.032,0.016"), ("line 7", "c_D is nan", "finite")),
    "inf": (changed(4, "0.95,0.28,inf,0,0,0.032,0.016"), ("line 7", "P_D is inf", "finite")),
    "a word": (changed(4, "0.95,wide,1.077,0,0,0.032,0.016"), ("line 7", "c_D 'wide'", "not a number")),
    "decimal comma": (changed(4, "0,95,0.28,1.077,0,0,0.032,0.016"), ("line 7", "8 values for 7 columns")),
    "radius in percent": (changed(4, "95,0.28,1.077,0,0,0.032,0.016"), ("line 7", "r_R 95", "0 to 1")),
    "short row": (changed(4, "0.95,0.28,1.077,0,0"), ("line 7", "5 values for 7 columns")),
    "no tip": (["# a blade", HEADER, *ROWS[:-1]], ("line 7", "r_R = 1")),
    "hub too small": (changed(0, "0.0,0.32,1.105,0,0,0.2,0.014"), ("line 3", "hub ratio")),
    "too few rows": ([HEADER, *ROWS[2:]], ("4 rows", "at least 5")),
    "missing column": (["r_R,c_D,P_D,skew_deg,rake_D,t_c", *ROWS], ("line 1", "f_c is missing")),
    "no header": (ROWS, ("line 1", "is missing", HEADER)),
    "repeated column": ([HEADER + ",r_R", *ROWS], ("r_R stands there twice",)),
    "empty": (["# nothing"], ("holds no rows",)),
}


@pytest.mark.parametrize("name", sorted(BAD))
def test_bad_table_names_line_and_remedy(name: str, tmp_path: Path) -> None:
    lines, words = BAD[name]
    file = write(tmp_path, lines)
    with pytest.raises(InputError) as error:
        radial_table_from_csv(file, 3)
    message = str(error.value)
    assert "\n" not in message and str(file) in message
    for word in words:
        assert word in message, message


def test_missing_and_binary_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        radial_table_from_csv(tmp_path / "none.csv")
    with pytest.raises(InputError, match="cannot be read"):
        radial_table_from_csv(tmp_path)
    binary = tmp_path / "blade.csv"
    binary.write_bytes(bytes(range(128, 256)))
    with pytest.raises(InputError, match="not a text file"):
        radial_table_from_csv(binary)


def test_good_tables_are_read(tmp_path: Path) -> None:
    """Comments, blank lines, other order of columns, a byte-order mark, a tip with and without chord."""
    table = radial_table_from_csv(write(tmp_path, ["# a blade", "", HEADER, "# hub", *ROWS]), 4)
    assert table.blade_count == 4 and table.name == "blade" and table.hub_ratio == 0.2
    finite = radial_table_from_csv(write(tmp_path, [HEADER, *ROWS[:-1], "1.0,0.1,1.075,0,0,0.032,0.012"]))
    assert finite.chord_ratio[-1] == 0.1
    order = [6, 5, 4, 3, 2, 1, 0]
    lines = [",".join(line.split(",")[i] for i in order) for line in (HEADER, *ROWS)]
    other = tmp_path / "other.csv"
    other.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(lines).encode())
    assert np.array_equal(radial_table_from_csv(other).chord_ratio, table.chord_ratio)
    shipped = tmp_path / "p4119.csv"
    shipped.write_text(read_asset_text("propellers", "p4119.csv"), encoding="utf-8")
    assert np.array_equal(radial_table_from_csv(shipped).thickness_ratio, load_propeller().thickness_ratio)


def _openprop() -> str:
    """The geometry table that OpenProp writes: a title, columns apart by several tabs, a legend."""
    head = "\t\t\t OpenProp_Geometry.txt\n\nPropeller Diameter \t= 0.3048 m\nNumber of Blades \t= 3\n\n"
    names = "r/R\t  P/D\t\tSkew\tXs/D\t\tc/D\t\tf0/c\t\tt0/c\n"
    order = [0, 2, 3, 4, 1, 6, 5]
    rows = "".join("\t\t".join(row.split(",")[i] for i in order) + "\n" for row in ROWS)
    return head + names + rows + "\nr/R  \t [ ], radial position.\nSkew [deg], skew.\n"


def _over_diameter() -> str:
    """t/D for t/c, no skew, no rake, semicolons and decimal commas."""
    lines = ["r/R;c/D;P/D;t/D;f/c"]
    for row in ROWS:
        r, c, pitch, _, _, thickness, camber = row.split(",")
        lines.append(";".join([r, c, pitch, f"{float(thickness) * float(c):.6f}", camber]).replace(".", ","))
    return "\n".join(lines) + "\n"


LAYOUTS = {
    "quoted": "\n".join(",".join(f'"{cell}"' for cell in line.split(",")) for line in (HEADER, *ROWS)) + "\n",
    "OpenProp": _openprop(),
    "t/D, decimal commas": _over_diameter(),
    "sep line": "sep=;\n" + "\n".join((HEADER, *ROWS)).replace(",", ";") + "\n",
    "other names": "\n".join(["radius,chord/D,pitch/D,skew [deg],rake/D,t/c,camber", *ROWS]) + "\n",
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_is_the_same_blade(tmp_path: Path, layout: str) -> None:
    base = radial_table_from_csv(write(tmp_path, [HEADER, *ROWS]), 3)
    file = tmp_path / "other.txt"
    file.write_text(LAYOUTS[layout], encoding="utf-8-sig")
    told = read_propeller(file, 3)
    for name in ("radius_ratio", "chord_ratio", "pitch_ratio", "skew", "rake_ratio", "camber_ratio"):
        assert np.array_equal(getattr(told.table, name), getattr(base, name)), name
    # t/D is written with six digits.
    assert told.table.thickness_ratio == pytest.approx(base.thickness_ratio, rel=1e-4)
    if layout.startswith("t/D"):
        assert "no column of skew: 0" in told.assumed and "no column of rake: 0" in told.assumed
        assert any("t/c from column 't/D'" in line for line in told.assumed)


def test_the_propeller_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = write(tmp_path, [HEADER, *ROWS])
    picture = tmp_path / "blade.png"
    assert main(["propeller", str(file), "--blades", "4", "--picture", str(picture), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["blade_count"] == 4 and told["hub_ratio"] == 0.2
    assert told["expanded_area_ratio"] == pytest.approx(4.0 * radial_table_from_csv(file).expanded_area_ratio_per_blade)
    assert picture.read_bytes().startswith(b"\x89PNG")
    drawn = picture.read_bytes()
    # Over an older picture, and over nothing else.
    for content, words, status in ((drawn[:-99], [], 0), (b"other", [], 2), (b"other", ["--force"], 0)):
        picture.write_bytes(content)
        assert main(["propeller", str(file), "--blades", "4", "--picture", str(picture), *words]) == status
        assert picture.read_bytes() == (drawn if status == 0 else content)
    assert main(["propeller", str(file), "--blades", "9"]) == 2


@pytest.mark.parametrize(
    ("diameter", "blades", "pitch", "area", "word"),
    [
        (-9.0, 3, 1.0, None, "diameter"),
        (float("nan"), 3, 1.0, None, "diameter"),
        (9.0, 3.5, 1.0, None, "blade_count"),
        (9.0, 1, 1.0, None, "blade_count"),
        (9.0, float("nan"), 1.0, None, "blade_count"),
        (9.0, 3, float("inf"), None, "pitch_ratio"),
        (9.0, 3, 10.0, None, "pitch_ratio"),
        (9.0, 3, 1.0, 60.0, "expanded_area_ratio"),
    ],
)
def test_bad_family_members(diameter: float, blades: float, pitch: float, area: float | None, word: str) -> None:
    with pytest.raises(InputError, match=word):
        propeller_family(load_propeller(), diameter, blades, pitch, area)  # type: ignore[arg-type]


def test_other_bad_values() -> None:
    with pytest.raises(InputError, match="not shipped"):
        load_propeller("p9999")
    with pytest.raises(InputError, match="viscosity"):
        SectionDrag.model_scale(10.0, 0.0)
    with pytest.raises(InputError, match="roughness"):
        SectionDrag.full_scale(float("nan"))
    five = np.linspace(0.2, 1.0, 5)
    with pytest.raises(InputError, match="chord_ratio"):
        RadialTable("x", five, five[:4], five, five, five, five, five)


@pytest.mark.parametrize(
    ("column", "title", "scale", "remedy"),
    [
        (2, "pitch [m]", 1.5, "divide the pitch by the diameter"),
        (2, "pitch (deg)", 20.0, "pi r_R tan"),
        (1, "chord [mm]", 3000.0, "divide the chords by the diameter"),
        (5, "t/c [%]", 100.0, "divide the thickness by the chord"),
    ],
)
def test_a_title_with_the_unit_of_a_length_is_no_ratio(
    column: int, title: str, scale: float, remedy: str, tmp_path: Path
) -> None:
    """A pitch in metres lies within the limits of P/D and was read as that in silence."""
    names = HEADER.split(",")
    names[column] = title
    rows = [line.split(",") for line in ROWS]
    for row in rows:
        row[column] = f"{scale * float(row[column]):.6g}"
    with pytest.raises(InputError) as caught:
        read_propeller(write(tmp_path, [",".join(line) for line in (names, *rows)]), 4)
    assert title in str(caught.value) and remedy in str(caught.value) and "\n" not in str(caught.value)


def test_a_blade_of_a_duct_and_skew_in_radians_are_doubted(tmp_path: Path) -> None:
    assert read_propeller(write(tmp_path, [HEADER, *ROWS]), 4).warnings == ()
    broad = [*ROWS[:-1], "1.0,0.45,1.075,0,0,0.032,0.012"]
    assert any(
        "ducts are not computed" in line for line in read_propeller(write(tmp_path, [HEADER, *broad]), 4).warnings
    )
    skewed = [f"{line.split(',')[0]},{','.join(line.split(',')[1:3])},{k / 10},{','.join(line.split(',')[4:])}"
              for k, line in enumerate(ROWS)]  # fmt: skip
    doubted = read_propeller(write(tmp_path, [HEADER.replace("skew_deg", "skew"), *skewed]), 4)
    assert any("call it skew_rad" in line for line in doubted.warnings)
    # As it says.
    radians = read_propeller(write(tmp_path, [HEADER.replace("skew_deg", "skew_rad"), *skewed]), 4)
    assert radians.tip_skew_degrees == pytest.approx(np.degrees(0.5))
    assert radians.warnings == ()
    assert read_propeller(write(tmp_path, [HEADER, *skewed]), 4).warnings == ()


@pytest.mark.parametrize("tip", ["1.0,0,1.075,0,0,,", "1.0,0,,,,-,0.016", "1.0,0,1.075,0,0,0,0.016"])
def test_a_tip_without_chord_needs_no_thickness(tip: str, tmp_path: Path) -> None:
    """Thickness over a chord of nothing is blank or 0 in published tables; elsewhere a blank is told as one."""
    told = read_propeller(write(tmp_path, [HEADER, *ROWS[:-1], tip]), 4)
    assert told.table.thickness_ratio[-1] == 0.032 and told.table.camber_ratio[-1] == 0.016
    assert any(line.startswith("at the tip, which has no chord, as in the row before: ") for line in told.assumed)
    assert told.expanded_area_ratio == read_propeller(write(tmp_path, [HEADER, *ROWS]), 4).expanded_area_ratio
    for row, words in (("1.0,0.1,1.075,0,0,,0.016", "t_c is blank"), ("1.0,0.1,1.075,0,0,0,0.016", "at least 0.001")):
        with pytest.raises(InputError, match=words):
            read_propeller(write(tmp_path, [HEADER, *ROWS[:-1], row]), 4)


def test_rows_from_the_tip_to_the_hub_are_the_same_blade(tmp_path: Path) -> None:
    base = radial_table_from_csv(write(tmp_path, [HEADER, *ROWS]))
    told = read_propeller(write(tmp_path, [HEADER, *ROWS[::-1]]), 3)
    assert "rows from the tip to the hub turned round" in told.assumed
    assert np.array_equal(told.table.chord_ratio, base.chord_ratio)
    assert np.array_equal(told.table.thickness_ratio, base.thickness_ratio)


def test_the_hand_of_a_propeller(tmp_path: Path) -> None:
    """Minus signs of a left-handed table: of the pitch refused with what to write, of the skew doubted."""
    left = [",".join([*cells[:2], f"-{cells[2]}", *cells[3:]]) for cells in (line.split(",") for line in ROWS)]
    with pytest.raises(InputError, match="right-handed mirror image: pitch without the minus"):
        read_propeller(write(tmp_path, [HEADER, *left]), 3)
    for sign, doubted in ((1, False), (-1, True)):
        skewed = [
            ",".join([*cells[:3], str(sign * 8 * k), *cells[4:]])
            for k, cells in enumerate(line.split(",") for line in ROWS)
        ]
        told = read_propeller(write(tmp_path, [HEADER, *skewed]), 3)
        assert any("40 degrees ahead of the hub section" in line for line in told.warnings) == doubted


def test_what_is_doubted_of_a_blade_is_told_where_it_is_computed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before, ``hpsop propeller`` alone said that a blade is a duct's or its skew forward."""
    broad = write(tmp_path, [HEADER, *ROWS[:-1], "1.0,0.45,1.075,0,0,0.032,0.012"])
    assert main(["open-water", "--geometry", str(broad), "--blades", "3", "--advance", "0.8", "--json"]) == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["points"] and "ducts are not computed" in printed.err
    case = load_case("dtc-p4119-power").replaced("propeller", geometry=str(broad), geometry_blade_count=3)
    assert any("ducts are not computed" in line for line in propeller_warnings(case.propeller))
    assert propeller_warnings(load_case("dtc-p4119-power").propeller) == ()
