"""The commands ``optimize`` and ``show``."""

from __future__ import annotations

import argparse
import dataclasses
import shlex
import sys
from collections.abc import Sequence
from typing import Any

from hpsop_core.case.case import Case, load_case
from hpsop_core.cli.arguments import add_json, print_json, print_table
from hpsop_core.cli.driving import INTERRUPTED, Progress, driven, duration
from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController, front_designs
from hpsop_core.runs.learning import surface_words
from hpsop_core.runs.reader import RunReader, open_run
from hpsop_core.runs.records import DesignRecord, front_families, identifier, with_errors
from hpsop_core.runs.refinement import refine_front


def add_parsers(commands: Any) -> None:
    """Add the two commands to the parser."""
    run = commands.add_parser("optimize", help="run an optimisation, or go on with one")
    run.add_argument("case", metavar="CASE", help="a shipped case's name or a TOML file")
    run.add_argument("--run", metavar="RUN.hpsop", required=True, help="the run file; one that exists is continued")
    run.add_argument("--generations", type=int, metavar="TOTAL", help="of both levels; the case's by default")
    run.add_argument("--level1-generations", type=int, metavar="N", help="of these; the case's proportion by default")
    run.add_argument("--population", type=int, metavar="N", help="designs a generation; the case's by default")
    run.add_argument("--seed", type=int, metavar="N", help="the case's by default")
    run.add_argument("--workers", type=int, metavar="N", help="local processes; one a core by default")
    run.add_argument("--executor", default="local", metavar="local|dask:HOST:PORT", help="where evaluations run")
    run.add_argument("--seeds-from", metavar="OLD.hpsop", help="begin a new run with the front of an old one")
    run.set_defaults(handler=_optimize)

    show = commands.add_parser("show", help="what a run has found, also while it goes on")
    show.add_argument("run", metavar="RUN.hpsop")
    show.add_argument("--front", action="store_true", help="the Pareto front")
    show.add_argument("--design", metavar="ID|initial|compromise", help="everything about one design (also: knee)")
    show.add_argument(
        "--refine", action="store_true", help="solve the last front (or --design) finer first, to state its own errors"
    )
    show.add_argument("--generation", type=int, metavar="N", help="at generation N instead of the last one")
    add_json(show)
    show.set_defaults(handler=_show)


# -- optimize ------------------------------------------------------------------------------------------------------


def _optimize(arguments: argparse.Namespace) -> int:
    case = load_case(arguments.case)
    controller = RunController(
        arguments.run,
        case,
        generations=arguments.generations,
        level1_generations=arguments.level1_generations,
        population=arguments.population,
        seed=arguments.seed,
        workers=arguments.workers,
        executor=arguments.executor,
        seeds=front_designs(arguments.seeds_from) if arguments.seeds_from else (),
    )
    settings = controller.case.optimization
    progress = Progress(sys.stderr)
    with controller:
        total = controller.snapshot().generations
        level1 = total if settings.level1_generations >= settings.generations else settings.level1_generations
        plan = f"{controller.case.name}: {total} generations of {settings.population}, {level1} of them at level 1"
        if arguments.generations is not None and arguments.level1_generations is None and controller.begun:
            plan += " (the case's proportion)"
        progress.line(f"{plan}; seed {settings.seed}; {arguments.run}")
        controller.subscribe(progress)
        finished = driven(controller, progress)
    progress.end()
    if not finished:
        words = ["hpsop", "optimize", arguments.case, "--run", arguments.run]
        if arguments.executor != "local":
            words += ["--executor", arguments.executor]
        snapshot = controller.snapshot()
        print(
            f"paused in generation {min(snapshot.generation + 1, snapshot.generations)} of {snapshot.generations}; "
            f"all that is finished is kept. Go on with: {shlex.join(words)}",
            file=sys.stderr,
        )
        return INTERRUPTED
    print("\n".join(_summary_lines(open_run(arguments.run))))
    return 0


# -- show ----------------------------------------------------------------------------------------------------------


def _show(arguments: argparse.Namespace) -> int:
    run = open_run(arguments.run)
    if arguments.refine:
        progress = Progress(sys.stderr)
        asked = None
        if arguments.design is not None:
            asked = [run.design(identifier(arguments.design), arguments.generation).id]
        refine_front(
            arguments.run, lambda done, wanted: progress.line(f"solved finer: {done} of {wanted}"), designs=asked
        )
    if arguments.front and arguments.design is not None:
        raise InputError("show: --front and --design are two questions; ask one of them")
    if arguments.design is not None:
        _show_design(run, arguments)
    elif arguments.front:
        _show_designs(run, arguments, run.front(arguments.generation))
    elif arguments.generation is not None:
        _show_designs(run, arguments, run.members(arguments.generation))
    elif arguments.json:
        print_json(run.summary())
    else:
        print("\n".join(_summary_lines(run)))
    return 0


def _show_design(run: RunReader, arguments: argparse.Namespace) -> None:
    record = with_errors(run.case, run.design(identifier(arguments.design), arguments.generation))
    if arguments.json:
        print_json(record.as_dict())
        return
    from hpsop_core.cli.physics import print_evaluation

    print(f"design {record.id} ({record.origin}, generation {record.generation})")
    print_evaluation(record.evaluation)


def _show_designs(run: RunReader, arguments: argparse.Namespace, designs: Sequence[DesignRecord]) -> None:
    generation, front = run.generation(arguments.generation), run.known_front(arguments.generation)
    initial = run.initial(1 if generation is None else generation.level)
    bounds = run.case.bounds
    families, narrow = front_families(designs)
    initial, *designs = (with_errors(run.case, record) for record in (initial, *designs))
    if arguments.json:
        document: dict[str, Any] = {
            "generation": 0 if generation is None else generation.number,
            "level": initial.evaluation.level if generation is None else generation.level,
            "designs": [
                {**record.summary(), "active_bounds": bounds.active(record.evaluation.variables), "family": family}
                for record, family in zip(designs, families, strict=True)
            ],
            "compromise": None if front is None else front.compromise,
            "knee": None if front is None else front.knee,
            "initial": {**initial.summary(), "active_bounds": bounds.active(initial.evaluation.variables)},
        }
        if generation is not None:
            document["feasible_share"] = generation.feasible_share
        if generation is not None and not arguments.front:
            document |= dataclasses.asdict(generation) | {"population_front": generation.front}
        if front is not None:
            document |= {"hypervolume": front.hypervolume, "compromise": front.compromise, "knee": front.knee}
            if not arguments.front:
                document |= {"front": front.ids, "spread": front.spread}
        print_json(document)
        return
    if generation is None or front is None:
        print("no generation is finished yet")
        return
    what = f"front of {len(designs)}" if arguments.front else f"population of {len(designs)}"
    print(f"generation {generation.number}, level {generation.level}: {what}, hypervolume {front.hypervolume:.5f}")
    space = run.case.bounds.as_dict()
    free = [name for name, (lower, upper) in space.items() if lower < upper]
    header = ["id", "", run.case.objectives.first, run.case.objectives.second, *free, "feasible", "family"]
    marks = {front.knee: "knee", front.compromise: "compromise"}
    rows = [
        [*_row(run.case, record, marks.get(record.id, ""), free), str(family)]
        for record, family in zip(designs, families, strict=True)
    ]
    print_table(header, [*rows, [*_row(run.case, initial, "initial", free), ""]])
    print("v, ^: on its lower, upper bound; designs of one family cannot be told apart by the error of their numbers")
    if arguments.front and narrow:
        print(narrow)


_SIDES = {"": "", "lower": "v", "upper": "^"}


def _row(case: Case, record: DesignRecord, mark: str, free: Sequence[str]) -> list[str]:
    evaluation = record.evaluation
    active = case.bounds.active(evaluation.variables)
    values = case.bounds.values(evaluation.variables)
    objectives = [evaluation.objectives["f1"], evaluation.objectives["f2"]]
    numbers = ["failed" if value is None else f"{value:.5f}" for value in objectives]
    return [
        str(record.id),
        mark,
        *numbers,
        *(f"{values[name]:.6g}{_SIDES[active.get(name, '')]}" for name in free),
        "yes" if evaluation.feasible else "no",
    ]


def _summary_lines(run: RunReader) -> list[str]:
    summary = run.summary()
    lines = [
        f"{summary['run']}: {summary['case']}, {summary['state']}"
        + (f" ({summary['reason']})" if summary["reason"] else ""),
        f"generation {summary['generation']} of {summary['generations']} (population {summary['population']}, "
        f"seed {summary['seed']}), begun {summary['created']}",
    ]
    if summary["state"] == "interrupted":
        lines.append(f"to go on: the same 'hpsop optimize ... --run {summary['run']}' again, or Continue on the page")
    try:
        run.check_ship()
    except InputError as error:
        lines.append(f"warning: {error}")
    for level, numbers in summary["evaluations"].items():
        wall = summary["wall_seconds"].get(level, 0.0)
        lines.append(
            f"level {level}: {summary['generations_by_level'].get(level, 0)} generations in {duration(wall)}, "
            f"{numbers['count']} evaluations ({numbers['feasible']} feasible, {numbers['failed']} failed), "
            f"{1e3 * numbers['processor_seconds'] / max(1, numbers['count']):.1f} ms each"
        )
    if "surface" in summary:
        lines.append(surface_words(summary))
    if "hypervolume" in summary:
        spread = summary["spread"]
        lines.append(
            f"front: {summary['front_size']} designs, hypervolume {summary['hypervolume']:.5f}, "
            f"spread {'-' if spread is None else format(spread, '.3f')}, "
            f"feasible {100 * summary['feasible_share']:.0f} % of the population"
        )
    for name in ("compromise", "knee"):
        if summary.get(name) is not None:
            record = run.design(summary[name])
            objectives = record.evaluation.objectives
            first, second = summary["objectives"]
            lines.append(f"{name}: design {record.id}, {first} {objectives['f1']:.4f}, {second} {objectives['f2']:.4f}")
    started = summary["journal"][-5:]
    lines.extend(f"{entry['at']}  {entry['text']}" for entry in started)
    return lines
