"""The mesh of the water and air round the port half of a ship, in proportion to it.

A block mesh, fine in height about the waterline, is refined five times in length and breadth towards the ship (so that
waves keep flat cells) and once more round the propeller, then fitted to the hull with layers by snappyHexMesh. About
300 000 cells: for a first look.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hpsop_core.export.openfoam.dictionary import foam_file, vector
from hpsop_core.geometry.clearance import propeller_plane_x
from hpsop_core.geometry.hull.hull import Hull
from hpsop_core.geometry.propeller.propeller import Propeller

PATCHES = ("hull", "deck", "transom")
SYMMETRY = ("bottom", "side", "midPlane")
RINGS = 3
_CELLS_A_LENGTH = 8
# Half a cell at the ship, which is refined five times: perpendiculars stand in the middle of a cell. A stem that all
# but touches a plane of the grid would leave skewed faces between the two.
_ASIDE = 0.5 / (_CELLS_A_LENGTH * 2**5)
# Extent of the water in lengths: aft of AP, forward of AP, abeam, below and above the waterline.
_AFT, _FORE, _SIDE, _BELOW, _ABOVE = -3.0 + _ASIDE, 2.5 + _ASIDE, 1.75, -1.5, 0.5
# Boxes of refinement in lengths: x from, x to, y, below and above the waterline, for a ship that the last one holds;
# for others all grow with the ship. Each ends a layer of cells or more within the one before it: snappyHexMesh
# would refine a cell with much finer neighbours, which it cannot with cells that were refined in two directions only.
_BOXES = (
    (-0.9, 1.6, 0.8, -0.5, 0.5),
    (-0.45, 1.3, 0.4, -0.25, 0.3),
    (-0.25, 1.18, 0.25, -0.15, 0.2),
    (-0.12, 1.09, 0.15, -0.09, 0.13),
    (-0.05, 1.05, 0.09, -0.06, 0.08),
)
# Half height of the band of flat cells about the waterline, in lengths; waves of a ship are no higher.
_BAND = 0.012
_DISC_THICKNESS = 0.2  # of the diameter: two cells or more of the refined region


def mesh_files(hull: Hull, propeller: Propeller) -> Mapping[str, str]:
    """Files of system/ by name."""
    files = {f"topoSetDict.{n}": _box(hull, n) for n in range(1, len(_BOXES) + 1)}
    files[f"topoSetDict.{refinements()}"] = _box_round_the_disc(hull, propeller)
    return {
        **files,
        "blockMeshDict": _block_mesh(hull),
        "refineMeshDict": _refine(),
        "surfaceFeatureExtractDict": _features(),
        "snappyHexMeshDict": _snappy(hull),
        "topoSetDict.disc": _disc(hull, propeller),
    }


def refinements() -> int:
    """How many boxes are refined: those round the ship, and one round the disc."""
    return len(_BOXES) + 1


def _block_mesh(hull: Hull) -> str:
    length, water = hull.length, hull.draft
    _, growth, _ = _growth(hull)
    deep, top = 1.1 * growth * _BOXES[-1][3] * length, hull.depth - hull.draft + 0.012 * hull.length
    heights = np.array([_BELOW * length, deep, -_BAND * length, _BAND * length, max(top, 2 * _BAND * length)])
    heights = np.append(heights, _ABOVE * length) + water
    steps = np.diff(heights) / length
    below, band, above = (max(int(np.ceil(steps[n] * k)), 4) for n, k in ((1, 200.0), (2, 400.0), (3, 170.0)))
    counts = (16, below, band, above, 12)
    grading = (0.03, 1.0, 1.0, 1.0, 30.0)
    nx, ny = round((_FORE - _AFT) * _CELLS_A_LENGTH), round(_SIDE * _CELLS_A_LENGTH)
    vertices, blocks = [], []
    for z in heights:
        for x, y in ((_AFT, 0.0), (_FORE, 0.0), (_FORE, _SIDE), (_AFT, _SIDE)):
            vertices.append(vector((x * length, y * length, z)))
    for layer, (count, grade) in enumerate(zip(counts, grading, strict=True)):
        corners = " ".join(str(4 * layer + k) for k in range(8))
        blocks.append(f"hex ({corners}) ({nx} {ny} {count}) simpleGrading (1 1 {grade:g})")
    last = 4 * len(counts)
    faces = {
        "atmosphere": ("patch", [(last, last + 1, last + 2, last + 3)]),
        "bottom": ("symmetryPlane", [(0, 3, 2, 1)]),
        "inlet": ("patch", _walls(1, 2, len(counts))),
        "outlet": ("patch", _walls(3, 0, len(counts))),
        "side": ("symmetryPlane", _walls(2, 3, len(counts))),
        "midPlane": ("symmetryPlane", _walls(0, 1, len(counts))),
    }
    patches = "\n".join(
        f"{name} {{ type {kind}; faces ( {' '.join('(' + ' '.join(map(str, face)) + ')' for face in parts)} ); }}"
        for name, (kind, parts) in faces.items()
    )
    body = (
        f"scale 1;\nvertices\n(\n{chr(10).join(vertices)}\n);\nblocks\n(\n{chr(10).join(blocks)}\n);\nedges ();\n"
        f"boundary\n(\n{patches}\n);\nmergePatchPairs ();\n"
    )
    return foam_file("blockMeshDict", body)


def _walls(a: int, b: int, layers: int) -> list[tuple[int, int, int, int]]:
    return [(4 * n + a, 4 * n + b, 4 * n + 4 + b, 4 * n + 4 + a) for n in range(layers)]


def _box(hull: Hull, number: int) -> str:
    aft, fore, side, below, above = (hull.length * value for value in _BOXES[number - 1])
    wide, deep, high = _growth(hull)
    side, below, above = side * wide, below * deep, above * high
    return _chosen(vector((aft, -1.0, hull.draft + below)), vector((fore, side, hull.draft + above)))


def _growth(hull: Hull) -> tuple[float, float, float]:
    """How much more than the last box a ship needs abeam, below and above the waterline, each 1 or more."""
    _, _, side, below, above = (hull.length * value for value in _BOXES[-1])
    return (
        max(1.0, (0.5 * hull.breadth + 0.02 * hull.length) / side),
        max(1.0, -1.3 * hull.draft / below),
        max(1.0, (hull.depth - hull.draft + 0.01 * hull.length) / above),
    )


def _box_round_the_disc(hull: Hull, propeller: Propeller) -> str:
    # In length and breadth as the others: snappyHexMesh cannot refine cells that were refined like that.
    plane, reach = propeller_plane_x(hull, propeller), 0.6 * propeller.diameter
    low, high = (plane - reach, -1.0, hull.shaft_height - reach), (plane + reach, reach, hull.shaft_height + reach)
    return _chosen(vector(low), vector(high))


def _chosen(low: str, high: str) -> str:
    action = f"{{ name c0; type cellSet; action new; source boxToCell; box {low} {high}; }}"
    return foam_file("topoSetDict", f"actions\n(\n    {action}\n);\n")


def _refine() -> str:
    body = """
set             c0;
coordinateSystem global;
globalCoeffs { tan1 (1 0 0); tan2 (0 1 0); }
directions      ( tan1 tan2 );
useHexTopology  no;
geometricCut    yes;
writeMesh       no;
"""
    return foam_file("refineMeshDict", body)


def _features() -> str:
    body = "hull.stl\n{\n    extractionMethod extractFromSurface;\n    includedAngle 140;\n    writeObj no;\n}\n"
    return foam_file("surfaceFeatureExtractDict", body)


def _snappy(hull: Hull) -> str:
    length, water = hull.length, hull.draft
    regions = "\n            ".join(f"{name} {{ name {name}; }}" for name in PATCHES)
    inside = vector((1.618 * length, 0.6123 * length, water - 0.7071 * length))
    body = f"""
castellatedMesh true;
snap            true;
addLayers       true;

geometry
{{
    hull.stl
    {{
        type triSurfaceMesh;
        name ship;
        regions
        {{
            {regions}
        }}
    }}
}}

castellatedMeshControls
{{
    maxLocalCells 1000000;
    maxGlobalCells 4000000;
    minRefinementCells 0;
    nCellsBetweenLevels 2;
    features ( {{ file "hull.eMesh"; level 0; }} );
    refinementSurfaces {{ ship {{ level (0 0); patchInfo {{ type wall; }} }} }}
    resolveFeatureAngle 45;
    refinementRegions {{ }}
    locationInMesh {inside};
    allowFreeStandingZoneFaces true;
}}

snapControls
{{
    nSmoothPatch 3;
    tolerance 1.0;
    nSolveIter 50;
    nRelaxIter 5;
    nFeatureSnapIter 10;
}}

addLayersControls
{{
    relativeSizes true;
    layers {{ hull {{ nSurfaceLayers 4; }} transom {{ nSurfaceLayers 4; }} }}
    expansionRatio 1.4;
    finalLayerThickness 0.5;
    minThickness 0.05;
    nGrow 0;
    featureAngle 60;
    nRelaxIter 5;
    nSmoothSurfaceNormals 1;
    nSmoothNormals 3;
    nSmoothThickness 10;
    maxFaceThicknessRatio 0.5;
    maxThicknessToMedialRatio 0.3;
    minMedialAxisAngle 90;
    nBufferCellsNoExtrude 0;
    nLayerIter 50;
    nRelaxedIter 20;
}}

meshQualityControls
{{
    maxNonOrtho 65;
    maxBoundarySkewness 4;
    maxInternalSkewness 3.5;
    maxConcave 80;
    minVol 1e-13;
    minTetQuality 1e-30;
    minArea -1;
    minTwist 0.05;
    minDeterminant 0.001;
    minFaceWeight 0.05;
    minVolRatio 0.01;
    minTriangleTwist -1;
    nSmoothScale 4;
    errorReduction 0.75;
    relaxed {{ maxNonOrtho 69; }}
}}

debug 0;
mergeTolerance 1e-6;
"""
    return foam_file("snappyHexMeshDict", body)


def ring_radii(propeller: Propeller) -> np.ndarray:
    """The edges of the disc's rings from hub to tip, (RINGS + 1,) in m."""
    return 0.5 * propeller.diameter * np.linspace(propeller.hub_ratio, 1.0, RINGS + 1)


def _disc(hull: Hull, propeller: Propeller) -> str:
    plane, half = propeller_plane_x(hull, propeller), 0.5 * _DISC_THICKNESS * propeller.diameter
    ends = f"p1 ({plane - half:.6g} 0 {hull.shaft_height:.6g}); p2 ({plane + half:.6g} 0 {hull.shaft_height:.6g});"
    edges = ring_radii(propeller)
    actions = [
        f"    {{ name ring{n + 1}; type cellSet; action new; source cylinderAnnulusToCell; {ends} "
        f"innerRadius {edges[n]:.6g}; outerRadius {edges[n + 1]:.6g}; }}"
        for n in range(RINGS)
    ]
    return foam_file("topoSetDict", "actions\n(\n" + "\n".join(actions) + "\n);\n")
