"""The OpenFOAM case of `hpsop export`: what is in it, and that OpenFOAM reads it, where it is installed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hpsop_core import evaluate, load_case
from hpsop_core.cli.main import main
from hpsop_core.export.openfoam.flow import ring_shares
from hpsop_core.export.openfoam.mesh import PATCHES, RINGS, SYMMETRY, refinements

CASE = "dtc-p4119-paper"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("export") / "design"
    assert main(["export", CASE, "--to", str(target), "--formats", "openfoam"]) == 0
    return target / "openfoam"


def test_the_whole_case_is_there_and_its_scripts_run(folder: Path) -> None:
    for name in ("Allmesh", "Allrun", "Allrun.driven", "Allclean", "solve"):
        assert os.access(folder / name, os.X_OK)
        subprocess.run(["sh", "-n", str(folder / name)], check=True)
    for place, names in {
        "0.orig": ["U", "alpha.water", "k", "nut", "omega", "p_rgh"],
        "constant": ["fvOptions", "g", "hRef", "transportProperties", "turbulenceProperties"],
        "system": ["blockMeshDict", "controlDict", "fvSchemes", "fvSolution", "snappyHexMeshDict", "setFieldsDict"],
    }.items():
        for name in names:
            text = (folder / place / name).read_text()
            assert text.startswith("FoamFile") and text.count("{") == text.count("}")
            assert text.count("(") == text.count(")")
    assert len(list((folder / "system").glob("topoSetDict.[0-9]"))) == refinements()
    for file in (folder / "0.orig").iterdir():
        assert all(re.search(rf"^    {patch} ", file.read_text(), re.M) for patch in (*PATCHES, *SYMMETRY))


def test_the_hull_stands_in_the_water_in_named_regions(folder: Path) -> None:
    case = load_case(CASE)
    path = folder / "constant" / "triSurface" / "hull.stl"
    regions = re.findall(r"^solid (\w+)", path.read_text(), re.M)
    assert set(regions) <= set(PATCHES) and "hull" in regions
    mesh = trimesh.load(path, force="mesh")
    length = case.initial.variables.as_dict().get("length", mesh.extents[0])
    assert mesh.extents[0] == pytest.approx(length, rel=0.1)
    text = (folder / "system" / "blockMeshDict").read_text()
    corners = np.array(re.findall(r"^\((\S+) (\S+) (\S+)\)$", text, re.M), dtype=np.float64)
    assert np.all(corners[:, [0, 2]].min(axis=0) < mesh.bounds[0, [0, 2]])
    assert np.all(corners.max(axis=0) > mesh.bounds[1])


def test_disc_and_readme_are_the_evaluations(folder: Path) -> None:
    evaluation = evaluate(load_case(CASE), level=2)
    point = max(evaluation.conditions, key=lambda condition: condition.weight)
    text = (folder / "constant" / "fvOptions").read_text()
    pushes = [float(value) for value in re.findall(r"U \(\((\S+) 0 0\) 0\)", text)]
    # Half a ship has half the thrust; the water is pushed aft, which is -x.
    assert len(pushes) == RINGS and sum(pushes) == pytest.approx(-0.5 * point.thrust, rel=1e-6)
    assert text.count("active no;") == RINGS
    readme = (folder / "README.txt").read_text()
    assert f"{point.total_resistance / 1000.0:.1f}" in readme and "./Allrun" in readme
    speed = re.search(r"internalField\s+uniform \((\S+) 0 0\)", (folder / "0.orig" / "U").read_text())
    assert speed is not None and float(speed[1]) == pytest.approx(-point.speed, rel=1e-6)


def test_shares_of_the_rings_are_of_the_circulation() -> None:
    # x sqrt(1 - x) integrates to 4/15; to t it is 4/15 - 2/3 (1-t)^(3/2) + 2/5 (1-t)^(5/2).
    t = np.linspace(0.0, 1.0, RINGS + 1)
    whole = 4.0 / 15.0 - 2.0 / 3.0 * (1.0 - t) ** 1.5 + 2.0 / 5.0 * (1.0 - t) ** 2.5
    # The middle rule over 30 parts a ring; the root at the tip costs a thousandth.
    assert ring_shares(0.2) == pytest.approx(np.diff(whole) / whole[-1], rel=3e-3)


def blocks_of(folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, list[tuple[int, ...]]]]:
    """Corners, corners of each block, its cells and the faces of each patch, read from blockMeshDict."""
    text = (folder / "system" / "blockMeshDict").read_text()
    corners = np.array(re.findall(r"^\((\S+) (\S+) (\S+)\)$", text, re.M), dtype=np.float64)
    found = re.findall(r"^hex \(([\d ]+)\) \((\d+) (\d+) (\d+)\)", text, re.M)
    hexes = np.array([block[0].split() for block in found], dtype=np.int64)
    cells = np.array([block[1:] for block in found], dtype=np.int64)
    patches = {
        name: [tuple(map(int, face.split())) for face in re.findall(r"\(([\d ]+)\)", faces)]
        for name, faces in re.findall(r"^(\w+) \{ type \w+; faces \((.*)\); \}$", text, re.M)
    }
    return corners, hexes, cells, patches


# OpenFOAM's faces of a block: x low and high, y low and high, bottom and top.
SIDES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))


def test_the_blocks_fill_the_water_and_the_patches_close_it(folder: Path) -> None:
    """Read without OpenFOAM: right-handed blocks fill the box, each outer face is in one patch and looks outwards."""
    corners, hexes, cells, patches = blocks_of(folder)
    assert np.all(cells > 0)
    edges = [corners[hexes[:, k]] - corners[hexes[:, 0]] for k in (1, 3, 4)]
    volumes = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2])
    assert np.all(volumes > 0.0) and np.sum(volumes) == pytest.approx(np.prod(np.ptp(corners, axis=0)), rel=1e-9)
    faces = [tuple(int(block[k]) for k in side) for block in hexes for side in SIDES]
    keys = [frozenset(face) for face in faces]
    outer = {key for key in keys if keys.count(key) == 1}
    named = [face for group in patches.values() for face in group]
    assert len(named) == len(outer) and {frozenset(face) for face in named} == outer
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    for face in named:
        points = corners[list(face)]
        normal = np.cross(points[1] - points[0], points[2] - points[0])
        assert normal @ (points.mean(axis=0) - middle) > 0.0
    # the ship is towed to +x: water comes in there
    ends = {name: {round(float(x), 6) for face in patches[name] for x in corners[list(face), 0]} for name in patches}
    assert ends["inlet"] == {round(float(corners[:, 0].max()), 6)}
    assert ends["outlet"] == {round(float(corners[:, 0].min()), 6)}


def test_refined_boxes_lie_in_each_other_and_hold_ship_and_disc(folder: Path) -> None:
    numbers = sorted(int(path.suffix[1:]) for path in (folder / "system").glob("topoSetDict.[0-9]"))
    boxes = []
    for number in numbers:
        text = (folder / "system" / f"topoSetDict.{number}").read_text()
        found = re.search(r"box \((\S+) (\S+) (\S+)\) \((\S+) (\S+) (\S+)\);", text)
        assert found is not None
        boxes.append(np.array(found.groups(), dtype=np.float64).reshape(2, 3))
    ship = trimesh.load(folder / "constant" / "triSurface" / "hull.stl", force="mesh")
    for outer, inner in pairwise(boxes[:-1]):
        assert np.all(inner[0, [0, 2]] > outer[0, [0, 2]]) and np.all(inner[1] < outer[1])
    for box in boxes[:-1]:
        assert np.all(box[0, [0, 2]] < ship.bounds[0, [0, 2]]) and np.all(box[1] > ship.bounds[1])
    disc = (folder / "system" / "topoSetDict.disc").read_text()
    ends = np.array(re.findall(r"p[12] \((\S+) (\S+) (\S+)\)", disc), dtype=np.float64)
    radius = max(float(value) for value in re.findall(r"outerRadius (\S+);", disc))
    low, high = boxes[-1]
    reach = np.array([0.0, radius])
    assert np.all(low[[0, 2]] < ends[:, [0, 2]].min(axis=0) - reach)
    assert np.all(high[[0, 2]] > ends[:, [0, 2]].max(axis=0) + reach)
    # where snappyHexMesh keeps the cells: in the box, outside the ship
    text = (folder / "system" / "snappyHexMeshDict").read_text()
    place = re.search(r"locationInMesh \((\S+) (\S+) (\S+)\);", text)
    assert place is not None
    kept = np.array(place.groups(), dtype=np.float64)
    corners = blocks_of(folder)[0]
    assert np.all(kept > corners.min(axis=0)) and np.all(kept < corners.max(axis=0))
    assert not (np.all(kept > ship.bounds[0]) and np.all(kept < ship.bounds[1]))


@pytest.mark.skipif(shutil.which("blockMesh") is None, reason="OpenFOAM is not installed")
def test_openfoam_makes_the_block_mesh(folder: Path) -> None:
    surroundings = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
    done = subprocess.run(["blockMesh", "-case", str(folder)], capture_output=True, text=True, env=surroundings)
    assert done.returncode == 0, done.stdout[-2000:]
    done = subprocess.run(["checkMesh", "-case", str(folder)], capture_output=True, text=True, env=surroundings)
    assert "Mesh OK." in done.stdout
