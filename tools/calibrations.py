"""The shipped cases' calibrations of level 1, computed anew.

``python -m tools.calibrations`` writes assets/calibrations/, and takes away what no shipped case uses any more. To be
run when a shipped case, a parent hull or a solver of waves has changed: a test says so.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from hpsop_core.case.case import SHIPPED_CASES, Case, load_case
from hpsop_core.evaluation import shipped_calibration
from hpsop_core.evaluation.physics import initial_true_waves
from hpsop_core.evaluation.shapes import initial_volume
from hpsop_core.evaluation.wave_correction import learn_correction

FOLDER = Path(__file__).resolve().parents[1] / "assets" / "calibrations"


def computed(case: Case) -> dict[str, Any]:
    """What is shipped for a case, by kind."""
    volume = initial_volume(case)
    if case.constants.wave_calibration == "level2":
        return {shipped_calibration.INITIAL: list(initial_true_waves(case, volume))}
    if case.constants.wave_calibration == "learnt":
        return {
            # Also a learnt case is asked for one factor, by --set and on the page.
            shipped_calibration.INITIAL: list(initial_true_waves(case, volume)),
            shipped_calibration.LEARNT: asdict(learn_correction(case, volume, case.speeds).with_kernels()),
        }
    return {}


def main() -> None:
    """Write them."""
    argparse.ArgumentParser(prog="python -m tools.calibrations", description=__doc__).parse_args()
    FOLDER.mkdir(exist_ok=True)
    kept = set()
    for name in SHIPPED_CASES:
        case = load_case(name)
        for kind, content in computed(case).items():
            file = shipped_calibration.file_name(case, kind)
            assert file is not None, "a shipped case has a shipped hull"
            kept.add(file)
            document = {"kind": kind, "first_case": name, "bounds": case.bounds.as_dict(), "content": content}
            text = json.dumps(document) + "\n"
            if not (FOLDER / file).exists() or (FOLDER / file).read_text(encoding="utf-8") != text:
                (FOLDER / file).write_text(text, encoding="utf-8")
            print(f"{name}: {file}")
    for path in FOLDER.glob("*.json"):
        if path.name not in kept:
            path.unlink()


if __name__ == "__main__":
    main()
