"""A run in a process of its own, to be killed: PATH PHYSICS MARKS WORKERS POPULATION GENERATIONS LEVEL1."""

from __future__ import annotations

import sys
from pathlib import Path

import quick_physics
from run_files import small_case

from hpsop_core.runs.controller import optimize


def main() -> None:
    path, name, marks, *numbers = sys.argv[1:]
    workers, population, generations, level1 = (int(number) for number in numbers)
    physics = None
    if marks:
        physics = quick_physics.marking(getattr(quick_physics, name), Path(marks))
    elif "learning" in name:
        physics = quick_physics.learning_physics(getattr(quick_physics, name))
    elif name != "real":
        physics = quick_physics.physics(getattr(quick_physics, name))
    case = small_case(population=population, generations=generations, level1_generations=level1)
    if "learning" in name:
        case = quick_physics.surface_case(case)
    optimize(case, path, workers=workers, physics=physics)


if __name__ == "__main__":
    main()
