"""How resistance and power follow L/B at one displacement, at both levels: does the cheap one rank as the dear one?

python examples/sweep_length_to_breadth.py [--points 7]
"""

from __future__ import annotations

import argparse

import numpy as np

from hpsop_core import evaluate, load_case


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=7)
    points = parser.parse_args().points

    case = load_case("dtc-p4119")
    lower, upper = case.bounds.as_dict()["length_to_breadth"]
    print("   L/B    Lpp m  resistance, over the initial design's   power, over the initial design's")
    print("                     level 1   level 2                     level 1   level 2")
    for ratio in np.linspace(lower, upper, points):
        design = case.initial.variables.replaced({"length_to_breadth": float(ratio)}, "sweep")
        results = [evaluate(case, design, level) for level in (1, 2)]
        if not all(result.ok for result in results):
            print(f"{ratio:6.3f}  " + "; ".join(result.reason for result in results if not result.ok))
            continue
        resistance = [result.all_objectives["resistance"] for result in results]
        power = [result.all_objectives["delivered_power"] for result in results]
        print(
            f"{ratio:6.3f}  {design.length:7.2f}     {resistance[0]:.4f}    {resistance[1]:.4f}"
            f"                      {power[0]:.4f}    {power[1]:.4f}"
        )


if __name__ == "__main__":
    main()
