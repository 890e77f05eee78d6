"""The drawings of `hpsop export`, read again by ezdxf, as XML and by poppler: what is on them has the ship's sizes."""

from __future__ import annotations

import re
import shutil
import subprocess
import zlib
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

from hpsop_core import load_case
from hpsop_core.cli.main import main
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.export.sheets.paper import HEIGHT, MARGIN, WIDTH, Sheet, standard_scale
from hpsop_core.export.sheets.pdf import sheets_pdf, text_width

CASE = "dtc-p4119-paper"


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export") / "design"
    assert main(["export", CASE, "--to", str(folder), "--formats", "dxf,svg,pdf"]) == 0
    return folder


def words_of(layout: object) -> list[str]:
    return [item.dxf.text for item in layout.query("TEXT")]  # type: ignore[attr-defined]


def scale_in(words: list[str], start: str) -> float:
    return next(float(word.split("1 : ")[1]) for word in words if word.startswith(start))


def test_the_dxf_has_both_sheets_within_their_frames(files: Path) -> None:
    drawing = ezdxf.readfile(files / "drawings.dxf")
    assert not drawing.audit().errors
    assert {"lines plan", "propeller"} <= set(drawing.layouts.names())
    for name in ("lines plan", "propeller"):
        points = np.concatenate(
            [np.array(item.get_points("xy")) for item in drawing.layouts.get(name).query("LWPOLYLINE")]
        )
        assert points.min() >= MARGIN
        assert points[:, 0].max() <= WIDTH - MARGIN and points[:, 1].max() <= HEIGHT - MARGIN


def test_the_lines_plan_measures_the_ship(files: Path) -> None:
    case = load_case(CASE)
    hull = design_hull(case, case.initial.variables)
    layout = ezdxf.readfile(files / "drawings.dxf").layouts.get("lines plan")
    words = words_of(layout)
    assert {"0 AP", "5", "10 FP", f"{hull.length:.3f} m", "Block coefficient"} <= set(words)
    scale = scale_in(words, "Half-breadth plan")
    outline = next(np.array(item.get_points("xy")) for item in layout.query('LWPOLYLINE[layer=="OUTLINE"]'))
    # The profile's outline: the whole ship with its overhangs, over the perpendiculars' length.
    assert 1.0 <= np.ptp(outline[:, 0]) * scale / 1000.0 / hull.length < 1.1
    assert np.ptp(outline[:, 1]) * scale / 1000.0 == pytest.approx(hull.depth, rel=0.02)
    places = {item.dxf.text: item.get_placement()[1].x for item in layout.query("TEXT")}
    assert (places["10 FP"] - places["0 AP"]) * scale / 1000.0 == pytest.approx(hull.length, rel=1e-6)


def test_the_propeller_drawing_measures_the_propeller(files: Path) -> None:
    case = load_case(CASE)
    propeller = design_propeller(case, case.initial.variables)
    layout = ezdxf.readfile(files / "drawings.dxf").layouts.get("propeller")
    words = words_of(layout)
    assert {"0.7 R", "Pitch [m]", "Thickness [mm]", "Blades", str(propeller.blade_count)} <= set(words)
    scale = scale_in(words, "Expanded")
    edges = [np.array(item.get_points("xy")) for item in layout.query('LWPOLYLINE[layer=="OUTLINE"]')][:2]
    tall = np.ptp(edges[0][:, 1]) * scale / 1000.0
    assert tall == pytest.approx(0.5 * propeller.diameter * (1.0 - propeller.hub_ratio), rel=1e-6)
    widths = (edges[1][:, 0] - edges[0][:, 0]) * scale / 1000.0
    area = float(np.trapezoid(widths, edges[0][:, 1] * scale / 1000.0))
    disc = 0.25 * np.pi * propeller.diameter**2
    # Trapezia over 121 radii, dense at the tip.
    assert propeller.blade_count * area / disc == pytest.approx(propeller.expanded_area_ratio, rel=2e-3)


def test_the_svg_is_the_same_paper(files: Path) -> None:
    drawing = ezdxf.readfile(files / "drawings.dxf")
    for file, name in (("lines_plan.svg", "lines plan"), ("propeller_drawing.svg", "propeller")):
        root = ElementTree.parse(files / file).getroot()
        assert (root.get("width"), root.get("height")) == (f"{WIDTH:g}mm", f"{HEIGHT:g}mm")
        kinds = [item.tag.rpartition("}")[2] for item in root.iter()]
        layout = drawing.layouts.get(name)
        assert kinds.count("polyline") == len(layout.query("LWPOLYLINE"))
        assert kinds.count("text") == len(layout.query("TEXT"))


def pages(path: Path) -> list[str]:
    """The drawing commands of every page, found through the table of places at the end of the file."""
    data = path.read_bytes()
    start = int(data.rsplit(b"startxref", 1)[1].split()[0])
    count = int(re.match(rb"xref\n0 (\d+)\n", data[start:])[1])  # type: ignore[index]
    found = []
    for number, line in enumerate(data[start:].split(b"\n")[3 : 2 + count], start=1):
        place = int(line.split()[0])
        assert data[place:].startswith(b"%d 0 obj\n" % number)
        stream = re.match(rb"\d+ 0 obj\n<< /Length (\d+) /Filter /FlateDecode >>\nstream\n", data[place:])
        if stream:
            found.append(zlib.decompress(data[place + stream.end() :][: int(stream[1])]).decode("cp1252"))
    return found


def test_the_pdf_is_the_same_paper(files: Path) -> None:
    drawing = ezdxf.readfile(files / "drawings.dxf")
    both = pages(files / "drawings.pdf")
    assert len(both) == 2
    for page, name in zip(both, ("lines plan", "propeller"), strict=True):
        layout = drawing.layouts.get(name)
        outlines = re.findall(r"^((?:[\d.-]+ [\d.-]+ [ml] )+)S$", page, re.MULTILINE)
        assert len(outlines) == len(layout.query("LWPOLYLINE"))
        for outline, line in zip(outlines, layout.query("LWPOLYLINE"), strict=True):
            numbers = np.array(re.findall(r"([\d.-]+) ([\d.-]+) [ml]", outline), dtype=np.float64)
            assert np.allclose(numbers, np.array(line.get_points("xy")), atol=1e-3)
        words = [re.sub(r"\\(.)", r"\1", text) for text in re.findall(r"\((.*)\) Tj ET$", page, re.MULTILINE)]
        assert words == words_of(layout)


def test_poppler_reads_the_pdf(files: Path) -> None:
    if shutil.which("pdftotext") is None:
        pytest.skip("poppler is not installed (the package poppler-utils)")
    done = subprocess.run(["pdfinfo", str(files / "drawings.pdf")], capture_output=True, text=True, check=True)
    # millimetres of A1 in points
    size = re.search(r"Page size:\s+([\d.]+) x ([\d.]+) pts \(A1\)", done.stdout)
    assert size is not None and float(size[1]) == pytest.approx(WIDTH / 25.4 * 72.0, abs=0.01)
    assert re.search(r"Pages:\s+2\n", done.stdout)
    done = subprocess.run(["pdftotext", str(files / "drawings.pdf"), "-"], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    drawing = ezdxf.readfile(files / "drawings.dxf")
    told = re.sub(r"\s+", "", done.stdout)
    for name in ("lines plan", "propeller"):
        assert [word for word in words_of(drawing.layouts.get(name)) if re.sub(r"\s+", "", word) not in told] == []


def test_words_of_a_pdf_stay_words() -> None:
    sheet = Sheet("s", words=[(10.0, 20.0, 2.5, "a (b) \\ c³ ∇", "middle")])
    data = sheets_pdf([sheet], "t\n) /Evil")
    assert b"/Title (t \\) /Evil)" in data
    stream = data.split(b"stream\n", 1)[1].split(b"\nendstream")[0]
    text = zlib.decompress(stream).decode("cp1252")
    assert "(a \\(b\\) \\\\ c³ ?) Tj" in text
    # Helvetica's digits are 0.556 of the size
    assert text_width("12345", 10.0) == pytest.approx(5 * 5.56, rel=0.02)


def test_scales_are_usual_ones() -> None:
    assert [standard_scale(size, 760.0) for size in (0.7, 4.5, 355.0, 100.0)] == [1.0, 10.0, 500.0, 200.0]
