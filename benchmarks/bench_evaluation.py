"""What a design costs at each level, with two and with six operating conditions.

    python benchmarks/bench_evaluation.py [--repeat N]

Best of N new designs, nothing remembered of them, after one that compiles the kernels. What does not depend on speed is
computed once: six conditions should cost less than twice what two cost.
"""

from __future__ import annotations

import argparse
import time

from hpsop_core import evaluate, load_case
from hpsop_core.case.case import Case
from hpsop_core.evaluation.reference import reference_for

PROFILES = {
    2: ((22.0, 25.0), (0.6, 0.4)),
    6: ((17.0, 19.0, 21.0, 22.0, 23.5, 25.0), (0.1, 0.1, 0.2, 0.2, 0.3, 0.1)),
}


def shortest(case: Case, level: int, repeat: int) -> float:
    """Shortest wall time of an evaluation in s."""
    reference = reference_for(case, level)
    initial = case.initial.variables
    times = []
    for number in range(repeat + 1):
        # Another hull and another propeller each time, so that no answer is remembered.
        step = 1e-3 * number + 0.1 * len(case.speeds)
        changes = {"draft": 13.81 + step, "diameter": 8.51 + step}
        started = time.perf_counter()
        result = evaluate(case, initial.replaced(changes), level, reference)
        times.append(time.perf_counter() - started)
        if not result.ok:
            raise SystemExit(f"the design failed: {result.reason}")
    return min(times[1:])


def main() -> None:
    """Print the times and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5)
    repeat = parser.parse_args().repeat
    base = load_case("dtc-p4119")
    for level in (1, 2):
        times = []
        for speeds, weights in PROFILES.values():
            case = base.replaced("conditions", speeds_knots=speeds, weights=weights)
            times.append(shortest(case, level, repeat))
        words = ", ".join(f"{count} conditions {1e3 * t:.1f} ms" for count, t in zip(PROFILES, times, strict=True))
        print(f"level {level}: {words}, ratio {times[1] / times[0]:.2f}")


if __name__ == "__main__":
    main()
