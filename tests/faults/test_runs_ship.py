"""A run holds its own ship: moved, edited and deleted tables change nothing, and runs of earlier versions say so."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
import quick_physics
from quick_physics import physics
from run_files import content, forge, old_file

from hpsop_core.assets import read_asset_text
from hpsop_core.case.case import Case, load_case
from hpsop_core.cli.main import main
from hpsop_core.errors import InputError
from hpsop_core.evaluation.shapes import design_hull, design_propeller
from hpsop_core.runs.checksums import DamagedRunError
from hpsop_core.runs.controller import RunController, optimize
from hpsop_core.runs.reader import open_run
from hpsop_core.runs.store import RunStore

_CASE = """
name = "own-hull"
[hull]
offsets = "hull.csv"
length = 120.0
draft = 6.5
[propeller]
geometry = "blade.csv"
geometry_blade_count = 3
[initial]
length = 120.0
breadth = 17.0
draft = 6.5
diameter = 4.2
blade_count = 4
expanded_area_ratio = 0.607
[bounds]
length_to_breadth = [6.7059, 7.4118]
breadth_to_draft = [2.4846, 2.7462]
draft = [6.305, 6.695]
diameter = [3.99, 4.41]
blade_count = [3, 5]
pitch_ratio = [0.9, 1.1]
displacement_ratio = [0.97, 1.03]
[conditions]
froude_numbers = [0.2, 0.25]
weights = [0.65, 0.35]
[optimization]
population = 8
generations = 3
level1_generations = 2
"""


def write_hull(path: Path, fullness: float = 2.4) -> None:
    """A table of a small hull by a formula; a greater exponent is a fuller ship."""
    rows = ["station_x_m,waterline_z_m,half_breadth_m"]
    for station in range(21):
        x = 6.0 * station
        s = x / 60.0 - 1.0
        for z in (0.0, 0.5, 1.0, 1.6, 2.4, 3.2, 4.1, 5.0, 5.8, 6.5, 7.5, 9.0):
            side = (1.0 - abs(s) ** fullness) * (1.0 - 0.25 * s) / 1.03
            rows.append(f"{x:g},{z:g},{8.5 * side * (1.0 - 0.45 * max(0.0, 1.0 - z / 6.5) ** 3):.4f}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case with its files, in a folder that may be moved."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    made = tmp_path / "a"
    made.mkdir()
    write_hull(made / "hull.csv")
    (made / "blade.csv").write_text(read_asset_text("propellers", "p4119.csv"), encoding="utf-8")
    (made / "case.toml").write_text(_CASE, encoding="utf-8")
    return made


def started(folder: Path) -> tuple[Path, Case]:
    case = load_case(folder / "case.toml")
    optimize(case, folder / "r.hpsop", workers=1, physics=physics())
    return folder / "r.hpsop", case


def volume(case: Case) -> float:
    return design_hull(case, case.initial.variables).hydrostatics.displaced_volume


def test_a_moved_run_shows_and_exports_its_geometry(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, case = started(folder)
    before = volume(case)
    moved = folder.parent / "b"
    folder.rename(moved)
    (moved / "hull.csv").unlink()
    (moved / "blade.csv").unlink()
    run = open_run(moved / path.name)
    assert volume(run.case) == before
    assert design_propeller(run.case, run.case.initial.variables).diameter == pytest.approx(4.2)
    assert main(["show", str(run.path)]) == 0
    assert "own-hull, finished" in capsys.readouterr().out
    # And it goes on.
    with RunController(run.path, generations=4, workers=1, physics=physics()) as controller:
        controller.start()
        assert controller.wait(60.0)
    assert open_run(run.path).progress()[0] == 4
    # Nothing of the folder it came from is in it.
    assert str(folder).encode() not in run.path.read_bytes()


def test_the_real_thing_is_exported_from_a_moved_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With the solvers, through the commands."""
    small = ["--population", "4", "--generations", "1", "--level1-generations", "1", "--workers", "1"]
    case, run = folder / "case.toml", folder / "r.hpsop"
    # The paper's calibration needs no second level.
    case.write_text(_CASE + '[constants]\nwave_calibration = "none"\n', encoding="utf-8")
    assert main(["optimize", str(case), "--run", str(run), *small]) == 0
    moved = folder.parent / "b"
    folder.rename(moved)
    (moved / "hull.csv").unlink()
    run, to = moved / "r.hpsop", moved / "out"
    assert main(["export", str(run), "--design", "initial", "--to", str(to), "--formats", "csv,json"]) == 0
    capsys.readouterr()
    assert main(["show", str(run), "--design", "initial", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    exported = json.loads((to / "design.json").read_text(encoding="utf-8"))
    assert exported["hull"] == shown["hull"]
    assert f"{shown['hull']['displaced_volume']:.0f}"[:3] in (to / "hydrostatics.csv").read_text(encoding="utf-8")


def test_an_edited_table_is_not_mixed_in(folder: Path) -> None:
    path, case = started(folder)
    before = volume(case)
    write_hull(folder / "hull.csv", fullness=3.5)
    again = load_case(folder / "case.toml")
    with pytest.raises(InputError, match=r"holds a run of the case 'own-hull' .* with the files that it holds"):
        RunController(path, again, physics=physics())
    run = open_run(path)
    assert volume(run.case) == before
    # The table as it was: the case is the run's again, wherever it stands.
    write_hull(folder / "hull.csv")
    elsewhere = folder.parent / "elsewhere"
    shutil.copytree(folder, elsewhere)
    RunController(path, load_case(elsewhere / "case.toml"), physics=physics()).close()


def test_what_stands_in_the_cache_is_only_a_copy(folder: Path) -> None:
    path, case = started(folder)
    run = open_run(path)
    written = Path(run.case.hull.offsets)
    assert folder.parent / "cache" in written.parents and written.name == "hull.csv"
    os.chmod(written, 0o644)
    written.write_text("edited by somebody", encoding="utf-8")
    assert open_run(path).case == run.case
    assert written.read_bytes() == (folder / "hull.csv").read_bytes()
    shutil.rmtree(folder.parent / "cache")
    assert volume(open_run(path).case) == volume(case)


def test_without_a_cache_folder_it_opens_all_the_same(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from hpsop_core.runs import ship

    path, case = started(folder)
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    ship._cache_folder.cache_clear()
    try:
        assert volume(open_run(path).case) == volume(case)
    finally:
        ship._cache_folder.cache_clear()


@pytest.fixture(autouse=True)
def fresh_cache_folder() -> None:
    from hpsop_core.runs import ship

    ship._cache_folder.cache_clear()


def test_a_table_that_is_gone_or_no_file_is_refused_before_a_run_is_begun(folder: Path, tmp_path: Path) -> None:
    case = load_case(folder / "case.toml")
    (folder / "hull.csv").unlink()
    with pytest.raises(InputError, match="there is no file"):
        RunStore(tmp_path / "new.hpsop", case)
    os.mkfifo(folder / "hull.csv")
    with pytest.raises(InputError, match="there is no file"):
        RunStore(tmp_path / "new.hpsop", case)
    assert not (tmp_path / "new.hpsop").exists()


def test_a_damaged_ship_is_said(folder: Path) -> None:
    path, _ = started(folder)
    forge(path, "UPDATE files SET content = (SELECT content FROM files WHERE section = 'propeller')")
    with pytest.raises(DamagedRunError, match=r"the file hull\.csv that it holds is not the one"):
        open_run(path)


def test_a_run_of_an_earlier_version_says_what_became_of_its_table(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = load_case(folder / "case.toml")
    path = tmp_path / "old.hpsop"
    old_file(path, case, quick_physics.with_shape)
    before = content(path)
    assert open_run(path).case == case
    open_run(path).check_ship()
    write_hull(folder / "hull.csv", fullness=3.5)
    for refused in (
        lambda: RunStore(path),
        lambda: open_run(path).check_ship(),
    ):
        with pytest.raises(InputError, match="does not give the run's initial design any more"):
            refused()
    assert main(["show", str(path)]) == 0
    assert "warning: " in capsys.readouterr().out, "the numbers can be read, with a word about the shape"
    (folder / "hull.csv").unlink()
    for refused in (lambda: RunStore(path), lambda: open_run(path).check_ship()):
        with pytest.raises(InputError, match=r"did not keep .*hull\.csv in the run, and that file is gone"):
            refused()
    write_hull(folder / "hull.csv")
    RunStore(path).close()
    (folder / "hull.csv").unlink()
    run = open_run(path)
    assert [file.name for file in run.files] == ["hull.csv", "blade.csv"]
    run.check_ship()
    assert content(path) == before and volume(run.case) > 0.0
