"""The folder of an OpenFOAM case: files, scripts, and a README that says what to run and what we expect."""

from __future__ import annotations

from pathlib import Path

from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.export.design import LeavingDesign
from hpsop_core.export.meshes import write_hull_stl
from hpsop_core.export.openfoam.flow import DRIVEN_STEPS, TOWED_STEPS, constant_files, field_files, system_files
from hpsop_core.export.openfoam.mesh import mesh_files, refinements

_ALLMESH = """\
#!/bin/sh
# The mesh, and its check. One log a program; stops at the first that fails.
cd "${{0%/*}}" || exit 1
: "${{WM_PROJECT_DIR:=/usr/share/openfoam}}" && export WM_PROJECT_DIR  # where Debian has it
run() {{
    log="log.$1"
    shift
    echo "$1"
    "$@" > "$log" 2>&1 || {{ echo "$1 failed: see $log" >&2; exit 1; }}
}}
run surfaceFeatureExtract surfaceFeatureExtract
run blockMesh blockMesh
for n in {numbers}; do
    run topoSet.$n topoSet -dict system/topoSetDict.$n
    run refineMesh.$n refineMesh -dict system/refineMeshDict -overwrite
done
run snappyHexMesh snappyHexMesh -overwrite
run topoSet.disc topoSet -dict system/topoSetDict.disc
run checkMesh checkMesh
tail -4 log.checkMesh
"""

_ALLRUN = """\
#!/bin/sh
# The towed hull: ./Allrun, or ./Allrun 8 with eight processes.
cd "${0%/*}" || exit 1
: "${WM_PROJECT_DIR:=/usr/share/openfoam}" && export WM_PROJECT_DIR  # where Debian has it
[ -f log.checkMesh ] || ./Allmesh || exit 1
rm -rf 0 && cp -r 0.orig 0
setFields > log.setFields 2>&1 || { echo "setFields failed: see log.setFields" >&2; exit 1; }
./solve "${1:-1}"
"""

_ALLRUN_DRIVEN = """\
#!/bin/sh
# After ./Allrun: the disc on, and on from where it ended. ./Allrun.driven, or ./Allrun.driven 8
cd "${{0%/*}}" || exit 1
sed -i 's/active no;/active yes;/' constant/fvOptions
sed -i 's/^endTime .*/endTime         {steps};/' system/controlDict
./solve "${{1:-1}}"
"""

_SOLVE = """\
#!/bin/sh
# interFoam with so many processes
cd "${0%/*}" || exit 1
: "${WM_PROJECT_DIR:=/usr/share/openfoam}" && export WM_PROJECT_DIR  # where Debian has it
if [ "$1" -gt 1 ]; then
    {
        echo 'FoamFile { version 2.0; format ascii; class dictionary; object decomposeParDict; }'
        echo "numberOfSubdomains $1; method scotch;"
    } > system/decomposeParDict
    decomposePar -force -latestTime > log.decomposePar 2>&1 || exit 1
    mpirun -np "$1" interFoam -parallel >> log.interFoam 2>&1 || exit 1
    reconstructPar -latestTime > log.reconstructPar 2>&1
else
    interFoam >> log.interFoam 2>&1
fi
"""

_ALLCLEAN = """\
#!/bin/sh
# Back to what was exported, but for the disc and endTime after Allrun.driven
cd "${0%/*}" || exit 1
rm -rf 0 [1-9]* processor* postProcessing constant/polyMesh constant/extendedFeatureEdgeMesh
rm -f log.* constant/triSurface/hull.eMesh system/decomposeParDict
"""

_README = """\
{title}

A case for OpenFOAM of openfoam.com (1912, Debian's, and later): port half of the ship, water and air, interFoam with
local time steps and kOmegaSST, full scale, sinkage and trim fixed.

    ./Allrun           mesh (Allmesh) and the towed hull, {towed} steps; ./Allrun 8 with eight processes
    ./Allrun.driven    then with the propeller as an actuator disc, to step {driven}
    ./Allclean

What to look at: postProcessing/forces/*/force.dat; x is forward, so that resistance is -2 times the total x force (half
a ship). The mesh is one for a first look (about 300 000 cells): halve the cells (counts in system/blockMeshDict)
until the resistance stays. Wall functions, smooth wall: y+ of the first cell is to be 30 to 100 000 at this scale.

Expected by hpsop at V = {speed:.4f} m/s (Fn {froude:.4f}), level {level}, in kN, both sides:

    friction (ITTC-57)        {friction:12.1f}
    form                      {form:12.1f}
    waves                     {wave:12.1f}
    towed, bare and smooth    {bare:12.1f}     <- compare this
    correlation allowance     {correlation:12.1f}
    air                       {air:12.1f}
    appendages                {appendages:12.1f}
    total                     {total:12.1f}

Propeller: T {thrust:.1f} kN, J {advance:.4f}, KT {kt:.5f}, 10 KQ {kq:.5f}, {rpm:.2f} rpm, w {wake:.4f},
t {deduction:.4f}. The disc pushes with this thrust, spread by Hough and Ordway over three rings. The torque's swirl is
left out: a half ship has a plane of symmetry, which no swirl crosses. With the disc on, the hull's resistance should
grow to about {driven_force:.1f} kN: towed, bare and smooth over 1 - t.
"""


def write_openfoam(folder: Path, design: LeavingDesign) -> None:
    """Write the case into ``folder``: of the condition with the greatest weight, the first of them.

    Raises:
        OSError: a file cannot be written.
    """
    point = max(design.evaluation.conditions, key=lambda condition: condition.weight)
    parts = {
        "0.orig": field_files(design, point),
        "constant": constant_files(design, point),
        "system": {**system_files(design, point), **mesh_files(design.hull, design.propeller)},
    }
    for place, files in parts.items():
        (folder / place).mkdir(parents=True)
        for name, text in files.items():
            (folder / place / name).write_text(text, encoding="ascii")
    (folder / "constant" / "triSurface").mkdir()
    write_hull_stl(folder / "constant" / "triSurface" / "hull.stl", design.hull)
    scripts = {
        "Allmesh": _ALLMESH.format(numbers=" ".join(str(n + 1) for n in range(refinements()))),
        "Allrun": _ALLRUN,
        "Allrun.driven": _ALLRUN_DRIVEN.format(steps=DRIVEN_STEPS),
        "Allclean": _ALLCLEAN,
        "solve": _SOLVE,
    }
    for name, text in scripts.items():
        (folder / name).write_text(text, encoding="ascii")
        (folder / name).chmod(0o755)
    (folder / "README.txt").write_text(_readme(design, point), encoding="utf-8")


def _readme(design: LeavingDesign, point: ConditionResult) -> str:
    parts = {
        "friction": point.friction_resistance,
        "form": point.form_resistance or 0.0,
        "wave": point.wave_resistance,
        "correlation": point.correlation_resistance or 0.0,
        "air": point.air_resistance or 0.0,
        "appendages": point.appendage_resistance or 0.0,
        "total": point.total_resistance,
        "thrust": point.thrust,
    }
    bare = parts["friction"] + parts["form"] + parts["wave"]
    return _README.format(
        title=design.title,
        towed=TOWED_STEPS,
        driven=DRIVEN_STEPS,
        speed=point.speed,
        froude=point.froude_number,
        level=design.evaluation.level,
        bare=bare / 1000.0,
        advance=point.advance_coefficient,
        kt=point.thrust_coefficient,
        kq=10.0 * point.torque_coefficient,
        rpm=point.rotation_rate_rpm,
        wake=point.wake_fraction,
        deduction=point.thrust_deduction,
        driven_force=bare / (1.0 - point.thrust_deduction) / 1000.0,
        **{name: value / 1000.0 for name, value in parts.items()},
    )
