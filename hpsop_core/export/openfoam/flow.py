"""Fields, properties, schemes and the actuator disc of the OpenFOAM case."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hpsop_core.case.design_numbers import ConditionResult
from hpsop_core.export.design import LeavingDesign
from hpsop_core.export.openfoam.dictionary import foam_file, vector
from hpsop_core.export.openfoam.mesh import PATCHES, RINGS, SYMMETRY, ring_radii

TOWED_STEPS, DRIVEN_STEPS = 4000, 6000
_INTENSITY, _VISCOSITY_RATIO = 0.01, 100.0
_AIR_VISCOSITY, _AIR_DENSITY = 1.48e-5, 1.2


def ring_shares(hub_ratio: float) -> np.ndarray:
    """Shares of the thrust on the disc's rings, hub to tip, (RINGS,): the circulation x sqrt(1 - x), x from hub to tip.

    Hough and Ordway's distribution (1965), which real propellers follow closely.
    """
    x = np.linspace(0.0, 1.0, 30 * RINGS + 1)
    middle = 0.5 * (x[1:] + x[:-1])
    parts = (middle * np.sqrt(1.0 - middle)).reshape(RINGS, -1).sum(axis=1)
    return np.asarray(parts / parts.sum())


def field_files(design: LeavingDesign, point: ConditionResult) -> Mapping[str, str]:
    """Files of 0.orig/ by name."""
    speed, viscosity = point.speed, design.case.constants.viscosity
    energy = 1.5 * (_INTENSITY * speed) ** 2
    nut = _VISCOSITY_RATIO * viscosity
    stream = f"uniform ({-speed:.9g} 0 0)"
    wall, open_side = "fixedFluxPressure", "inletOutlet"
    return {
        "U": _field("U", "volVectorField", "[0 1 -1 0 0 0 0]", stream, {
            "inlet": f"type fixedValue; value {stream};",
            "outlet": f"type outletPhaseMeanVelocity; alpha alpha.water; Umean {speed:.9g}; value {stream};",
            "atmosphere": "type pressureInletOutletVelocity; value uniform (0 0 0);",
            "wall": "type noSlip;",
        }),
        "alpha.water": _field("alpha.water", "volScalarField", "[0 0 0 0 0 0 0]", "uniform 0", {
            "inlet": "type fixedValue; value uniform 0;",
            "outlet": "type variableHeightFlowRate; lowerBound 0; upperBound 1; value uniform 0;",
            "atmosphere": f"type {open_side}; inletValue uniform 0; value uniform 0;",
            "wall": "type zeroGradient;",
        }),
        "p_rgh": _field("p_rgh", "volScalarField", "[1 -1 -2 0 0 0 0]", "uniform 0", {
            "inlet": f"type {wall}; value uniform 0;",
            "outlet": "type zeroGradient;",
            "atmosphere": "type totalPressure; p0 uniform 0;",
            "wall": f"type {wall}; value uniform 0;",
        }),
        "k": _turbulent("k", "[0 2 -2 0 0 0 0]", energy, "kqRWallFunction"),
        "omega": _turbulent("omega", "[0 0 -1 0 0 0 0]", energy / nut, "omegaWallFunction"),
        "nut": _field("nut", "volScalarField", "[0 2 -1 0 0 0 0]", f"uniform {nut:.6g}", {
            "inlet": f"type calculated; value uniform {nut:.6g};",
            "outlet": f"type calculated; value uniform {nut:.6g};",
            "atmosphere": f"type calculated; value uniform {nut:.6g};",
            "wall": f"type nutkWallFunction; value uniform {nut:.6g};",
        }),
    }  # fmt: skip


def _turbulent(name: str, dimensions: str, value: float, wall: str) -> str:
    same = f"uniform {value:.6g}"
    open_side = f"type inletOutlet; inletValue {same}; value {same};"
    return _field(name, "volScalarField", dimensions, same, {
        "inlet": f"type fixedValue; value {same};",
        "outlet": open_side,
        "atmosphere": open_side,
        "wall": f"type {wall}; value {same};",
    })  # fmt: skip


def _field(name: str, kind: str, dimensions: str, inside: str, patches: Mapping[str, str]) -> str:
    lines = [f"    {patch} {{ {patches[patch]} }}" for patch in ("inlet", "outlet", "atmosphere")]
    lines += [f"    {patch} {{ {patches['wall']} }}" for patch in PATCHES]
    lines += [f"    {patch} {{ type symmetryPlane; }}" for patch in SYMMETRY]
    border = "\n".join(lines)
    body = f"dimensions      {dimensions};\ninternalField   {inside};\nboundaryField\n{{\n{border}\n}}\n"
    return foam_file(name, body, kind)


def constant_files(design: LeavingDesign, point: ConditionResult) -> Mapping[str, str]:
    """Files of constant/ by name."""
    constants = design.case.constants
    phases = (
        "phases (water air);\n"
        f"water {{ transportModel Newtonian; nu {constants.viscosity:.6g}; rho {constants.density:.6g}; }}\n"
        f"air {{ transportModel Newtonian; nu {_AIR_VISCOSITY:g}; rho {_AIR_DENSITY:g}; }}\nsigma 0;\n"
    )
    weight = f"dimensions [0 1 -2 0 0 0 0];\nvalue (0 0 {-constants.gravity:.6g});\n"
    height = f"dimensions [0 1 0 0 0 0 0];\nvalue {design.hull.draft:.9g};\n"
    model = "simulationType RAS;\nRAS { RASModel kOmegaSST; turbulence on; printCoeffs on; }\n"
    return {
        "transportProperties": foam_file("transportProperties", phases),
        "turbulenceProperties": foam_file("turbulenceProperties", model),
        "g": foam_file("g", weight, "uniformDimensionedVectorField"),
        "hRef": foam_file("hRef", height, "uniformDimensionedScalarField"),
        "fvOptions": foam_file("fvOptions", _disc(design, point)),
    }


def _disc(design: LeavingDesign, point: ConditionResult) -> str:
    shares = ring_shares(design.propeller.hub_ratio)
    edges = ring_radii(design.propeller)
    lines = [
        "// The propeller as a thrust on three rings, half of it each: this is the port half of the ship.",
        f"// T {point.thrust:.6g} N at {point.rotation_rate_rpm:.4g} rpm: KT {point.thrust_coefficient:.5f}, "
        f"10 KQ {10.0 * point.torque_coefficient:.5f} at J {point.advance_coefficient:.4f}",
    ]
    for n in range(RINGS):
        thrust = -0.5 * point.thrust * shares[n]
        lines.append(
            f"ring{n + 1}  // from r = {edges[n]:.4g} m to {edges[n + 1]:.4g} m\n"
            f"{{\n    type vectorSemiImplicitSource;\n    active no;\n    selectionMode cellSet;\n"
            f"    cellSet ring{n + 1};\n    volumeMode absolute;\n"
            f"    injectionRateSuSp {{ U (({thrust:.9g} 0 0) 0); }}\n}}\n"
        )
    return "\n".join(lines)


def system_files(design: LeavingDesign, point: ConditionResult) -> Mapping[str, str]:
    """Files of system/ by name, those of the mesh not among them."""
    hull = design.hull
    patches = " ".join(PATCHES)
    centre = vector((hull.hydrostatics.longitudinal_centre_of_buoyancy, 0.0, hull.draft))
    control = f"""
application     interFoam;
startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         {TOWED_STEPS};
deltaT          1;
writeControl    timeStep;
writeInterval   500;
purgeWrite      2;
writeFormat     binary;
writePrecision  8;
timeFormat      general;
timePrecision   6;
runTimeModifiable yes;

functions
{{
    forces
    {{
        type            forces;
        libs            (forces);
        patches         ({patches});
        rhoInf          {design.case.constants.density:.6g};
        log             on;
        writeControl    timeStep;
        writeInterval   1;
        CofR            {centre};
    }}
}}
"""
    below = f"box (-1e6 -1e6 -1e6) (1e6 1e6 {hull.draft:.9g}); fieldValues ( volScalarFieldValue alpha.water 1 );"
    water = (
        "defaultFieldValues ( volScalarFieldValue alpha.water 0 );\n"
        f"regions\n(\n    boxToCell {{ {below} }}\n    boxToFace {{ {below} }}\n);\n"
    )
    return {
        "controlDict": foam_file("controlDict", control),
        "setFieldsDict": foam_file("setFieldsDict", water),
        "fvSchemes": foam_file("fvSchemes", _SCHEMES),
        "fvSolution": foam_file("fvSolution", _SOLUTION % (0.28 * hull.length / point.speed)),
    }


_SCHEMES = """
ddtSchemes { default localEuler; }
gradSchemes { default Gauss linear; limitedGrad cellLimited Gauss linear 1; }
divSchemes
{
    div(rhoPhi,U)   Gauss linearUpwind grad(U);
    div(phi,alpha)  Gauss vanLeer;
    div(phirb,alpha) Gauss linear;
    div(phi,k)      Gauss linearUpwind limitedGrad;
    div(phi,omega)  Gauss linearUpwind limitedGrad;
    div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
wallDist { method meshWave; }
"""

_SOLUTION = """
solvers
{
    "alpha.water.*"
    {
        nAlphaCorr 2;
        nAlphaSubCycles 1;
        cAlpha 1;
        icAlpha 0;
        MULESCorr yes;
        nLimiterIter 10;
        alphaApplyPrevCorr yes;
        solver smoothSolver;
        smoother symGaussSeidel;
        tolerance 1e-8;
        relTol 0;
        minIter 1;
    }
    "pcorr.*"
    {
        solver PCG;
        preconditioner { preconditioner GAMG; smoother GaussSeidel; tolerance 1e-5; relTol 0; }
        tolerance 1e-5;
        relTol 0;
    }
    p_rgh { solver GAMG; smoother DIC; tolerance 1e-7; relTol 0.01; }
    p_rghFinal { $p_rgh; relTol 0; }
    "(U|k|omega).*"
    {
        solver smoothSolver;
        smoother symGaussSeidel;
        nSweeps 1;
        tolerance 1e-7;
        relTol 0.1;
        minIter 1;
    }
}
PIMPLE
{
    momentumPredictor no;
    nOuterCorrectors 1;
    nCorrectors 2;
    nNonOrthogonalCorrectors 0;
    maxCo 10;
    maxAlphaCo 5;
    rDeltaTSmoothingCoeff 0.05;
    rDeltaTDampingCoeff 0.5;
    nAlphaSpreadIter 0;
    nAlphaSweepIter 0;
    maxDeltaT %.4g;
}
relaxationFactors { equations { ".*" 1; } }
cache { grad(U); }
"""
