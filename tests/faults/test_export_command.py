"""`hpsop export` and its mistakes: one line each, and never half a folder."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from hpsop_core import load_case, load_hull, optimize
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError, SolverFailure
from hpsop_core.evaluation.reference import Reference
from hpsop_core.export import design_files, tables
from hpsop_core.export.panel_files import panels_gdf
from hpsop_core.geometry.hull.panels import hull_panels
from hpsop_core.runs.reader import RunReader


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    file = tmp_path_factory.mktemp("run") / "small.hpsop"
    return optimize(
        load_case("dtc-p4119-paper"), file, generations=1, level1_generations=1, population=4, seed=1, workers=1
    )


def test_the_command_lists_what_it_wrote(run: RunReader, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "a" / "b"
    words = ["export", str(run.path), "--design", "initial", "--to", str(folder), "--formats", "json,csv"]
    assert main(words) == 0
    written = {Path(line.split("  ")[0]).name for line in capsys.readouterr().out.splitlines()}
    assert written == {file.name for file in folder.iterdir()}
    assert {"design.json", "offsets.csv", "README.txt"} <= written and "design.3dm" not in written
    assert [entry.name for entry in folder.parent.iterdir()] == ["b"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--design", "7000"], "has no design 7000"),
        (["--design", "best"], "--design best: give a design's number, initial, compromise or knee"),
        (
            ["--design", "initial", "--formats", "igs"],
            "'igs' is not a format; give any of stl,glb,3dm,step,iges,dxf,csv,json",
        ),
        (["--design", "initial", "--formats", ","], "name at least one of"),
    ],
)
def test_mistakes_are_one_line(
    run: RunReader, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    folder = tmp_path / "out"
    assert main(["export", str(run.path), "--to", str(folder), *words]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not folder.exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["dtc-p4119-paper", "--design", "compromise"], "is a case, and --design compromise is of a run"),
        (["dtc-p4119-paper", "--set", "diameter=none"], "diameter"),
        (["no-such-case"], "no-such-case"),
        (["no-such-run.hpsop"], "--design"),
    ],
)
def test_mistakes_about_case_and_run_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    assert main(["export", *words, "--to", str(tmp_path / "out"), "--formats", "json"]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_run_asks_for_a_design_and_takes_no_changes(
    run: RunReader, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["export", str(run.path), "--to", str(tmp_path / "out")]
    assert main(words) == 2 and "say which design" in capsys.readouterr().err
    assert main([*words, "--design", "initial", "--set", "diameter=9"]) == 2
    assert "--set" in capsys.readouterr().err


def test_a_case_without_level_2_leaves_at_level_1(tmp_path: Path) -> None:
    """As `hpsop hull` sets a ship up at whose speeds level 2 has no numbers."""
    words = [
        "export",
        "dtc-p4119-paper",
        "--to",
        str(tmp_path),
        "--formats",
        "json",
        "--set",
        "optimization.level1_generations=150",
    ]
    assert main(words) == 0
    assert json.loads((tmp_path / "design.json").read_text())["level"] == 1


def test_a_transom_that_level_2_cannot_close_still_leaves_as_panels(tmp_path: Path) -> None:
    """A tug as broad at its end as amidships: its GDF, which leaves the tail out, held up the whole usual export."""
    length, breadth, draft = 28.0, 10.0, 4.0
    rows = ["station_x_m,waterline_z_m,half_breadth_m"]
    for x in np.linspace(0.0, length, 15):
        for z in np.linspace(0.0, 6.0, 10):
            bow = 1.0 - max(0.0, 2.0 * x / length - 1.0) ** 2
            rows.append(f"{x:.6g},{z:.6g},{0.5 * breadth * bow * min(1.0, z / draft) ** 0.5:.6g}")
    file = tmp_path / "tug.csv"
    file.write_text("\n".join(rows) + "\n")
    hull = load_hull(file, length=length, draft=draft)
    with pytest.raises(SolverFailure, match="wet transom"):
        hull_panels(hull, 44, 9, 0.28)
    lines = panels_gdf(hull, "a tug").splitlines()
    quads = np.array([[float(word) for word in line.split()] for line in lines[4:]]).reshape(-1, 4, 3)
    assert len(quads) == int(lines[3])
    # The transom is upright, so the heights over the bottom's projection are the volume.
    area = 0.5 * np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])[:, 2]
    volume = abs(2.0 * np.sum(area * quads[..., 2].mean(axis=1)))
    exact = breadth * draft * length * (0.5 + 1.0 / 3.0) * 2.0 / 3.0
    assert volume == pytest.approx(exact, rel=0.02)  # flat panels of 48 by 12


def test_a_folder_with_something_in_it_is_left_alone(run: RunReader, tmp_path: Path) -> None:
    mine = tmp_path / "design.json"
    mine.write_text("mine")
    with pytest.raises(InputError, match="is not empty; give --force"):
        design_files.export_design(run, "initial", tmp_path, ("json",))
    assert mine.read_text() == "mine"
    (tmp_path / "other.txt").write_text("stays")
    design_files.export_design(run, "initial", tmp_path, ("json",), force=True)
    assert mine.read_text() != "mine" and (tmp_path / "other.txt").read_text() == "stays"


def test_a_file_is_no_folder(run: RunReader, tmp_path: Path) -> None:
    file = tmp_path / "taken"
    file.write_text("")
    with pytest.raises(InputError, match="is a file; --to needs a folder"):
        design_files.export_design(run, "initial", file, force=True)
    with pytest.raises(InputError, match="cannot be written"):
        design_files.export_design(run, "initial", file / "below", ("json",))


def test_an_export_that_breaks_off_leaves_nothing(
    run: RunReader, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_hull: object) -> str:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tables, "hydrostatics_table", full)
    with pytest.raises(InputError, match="No space left on device"):
        design_files.export_design(run, "initial", tmp_path / "out", ("json", "csv"))
    assert not list(tmp_path.iterdir())


def test_the_download_holds_the_same_files(run: RunReader, tmp_path: Path) -> None:
    record = run.design("initial")
    reference = Reference.from_dict(run.reference(1))
    files = design_files.export_design(run, "initial", tmp_path / "out", ("json", "csv", "3dm"))
    formats = ("3dm", "csv", "json")
    content = design_files.zip_design(run.case, record.evaluation, f"design {record.id}", reference, formats)
    archive = zipfile.ZipFile(io.BytesIO(content))
    assert sorted(archive.namelist()) == sorted(file.name for file in files)
    for file in files:
        if file.suffix in (".csv", ".txt"):
            assert archive.read(file.name) == file.read_bytes()


def test_step_without_opencascade_says_what_to_install(
    run: RunReader, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hpsop_core.export.formats.find_spec", lambda _name: None)
    words = ["export", str(run.path), "--design", "initial", "--to", str(tmp_path / "out"), "--formats", "json,step"]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "pip install 'hpsop[cad]'" in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_step_and_iges_by_the_command(run: RunReader, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("OCP", reason="OpenCASCADE is an extra: pip install 'hpsop[cad]'")
    folder = tmp_path / "out"
    words = ["export", str(run.path), "--design", "initial", "--to", str(folder), "--formats", "iges,step"]
    assert main(words) == 0
    # Not a word of OpenCASCADE's own among them, which writes past Python's standard output.
    written = [Path(line.split("  ")[0]).name for line in capfd.readouterr().out.splitlines()]
    assert written == ["design.step", "design.iges", "README.txt"]
    assert {file.name for file in folder.iterdir()} == set(written)
    assert (folder / "design.step").read_text().startswith("ISO-10303-21;")
