"""Everything about one design of a shipped case, at both levels of fidelity, beside the initial design.

python examples/evaluate_a_design.py
"""

from __future__ import annotations

from hpsop_core import evaluate, load_case


def main() -> None:
    case = load_case("dtc-p4119")
    # A larger propeller with four blades and less pitch; every other variable as the initial design has it.
    design = case.initial.variables.replaced({"diameter": 9.6, "blade_count": 4, "pitch_ratio": 0.95}, "my design")
    for level in (1, 2):
        for name, variables in (("initial", case.initial.variables), ("mine", design)):
            result = evaluate(case, variables, level)
            if not result.ok:
                print(f"level {level}, {name}: failed in {result.stage}: {result.reason}")
                continue
            service = result.conditions[0]
            print(
                f"level {level}, {name:>7}: at {service.speed / 0.514444:.1f} kn "
                f"Rt {service.total_resistance / 1e3:.0f} kN, n {service.rotation_rate_rpm:.1f} 1/min, "
                f"eta0 {service.open_water_efficiency:.3f}, "
                f"PD {service.delivered_power / 1e6:.2f} MW; {'feasible' if result.feasible else 'not feasible'}"
            )


if __name__ == "__main__":
    main()
