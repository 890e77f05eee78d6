"""How sure the true level's numbers are: a design solved again with one thing done differently at a time.

Six terms, added in quadrature. Four are the solvers': mesh, momentum plane against pressure, size of the water's
domain, panels of the propeller. They are solved for each design and differ between designs. Two are of what is put in:
k and wake fraction. They are one error for all designs of a case, so they count in the interval of a number and not
where two designs are told apart.

Every trial goes through the whole evaluation, the initial design's included: the error of a normalised objective is
what a trial changes of the *ratio*, which is far less than of the resistance.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

from hpsop_core.case.case import Case
from hpsop_core.case.constraints import CONSTRAINTS
from hpsop_core.case.objectives import OBJECTIVES
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import SolverFailure
from hpsop_core.evaluation.evaluate import assessed, evaluate
from hpsop_core.evaluation.input_widths import form_factor_width, wake_fraction_width
from hpsop_core.evaluation.levels import BLADE_REFINEMENT, REFINEMENT, TRUTH
from hpsop_core.evaluation.physics import Basis, Physics, Trial, compute_trial
from hpsop_core.evaluation.reference import Reference, initial_numbers, reference_for
from hpsop_core.evaluation.result import Evaluation, Failed, Ok
from hpsop_core.one_thread import one_blas_thread

MESH, PLANE, DOMAIN, PROPELLER = "mesh", "plane_against_pressure", "domain", "propeller_mesh"
FORM_FACTOR, WAKE_FRACTION = "form_factor", "wake_fraction"
OWN_TERMS = (MESH, PLANE, DOMAIN, PROPELLER)
"""Terms that differ from design to design; the others are shared by all designs of a case."""

# What the working mesh misses, over what the finer one adds. Flat panels converge with the square of their size: 2.8.
# Four forms on meshes of 1, 1.25 and 1.5: 10^4 Cw 3.80, 3.89, 3.99 (parent); 3.94, 4.25, 4.35; 2.52, 2.70, 2.78;
# 3.40, 3.64, 3.72 at Fn 0.22, which second order covers for all but the parent, by a little. The blades likewise.
# What the borders do falls off irregularly with the domain: in the mean over speeds from Fn 0.17 to 0.22 a domain of
# 1.5 moves four forms by 5.0, 1.0, 2.9 and 6.5 %, one of 2 by 5.7, 2.1, 3.4 and 7.7: half as much again covers three.
_LEFT_OVER = {
    MESH: 1.0 / (1.0 - REFINEMENT**-2),
    DOMAIN: 1.5,
    PROPELLER: 1.0 / (1.0 - BLADE_REFINEMENT**-2),
}
# Of ratios to the parent these forms' second step changed up to about a fifth of what the first one had; 1.5 is a
# judgement with room for forms that are less alike.
_LEFT_OVER_OF_RATIO = {MESH: 1.5, DOMAIN: 1.5, PROPELLER: 1.5}
_LEAST_RATIO_ERROR = 2e-4
"""Of a normalised objective: the working mesh's own unevenness from design to design (docs/theory-rankine.md)."""

CONDITION_NAMES = (
    "wave_coefficient",
    "wave_resistance",
    "form_resistance",
    "total_resistance",
    "effective_power",
    "wake_fraction",
    "thrust",
    "torque",
    "advance_coefficient",
    "thrust_coefficient",
    "torque_coefficient",
    "rotation_rate_rpm",
    "open_water_efficiency",
    "hull_efficiency",
    "propulsive_efficiency",
    "delivered_power",
    "brake_power",
    "engine_load",
    "fuel_rate",
    "required_expanded_area_ratio",
)
"""Numbers of a condition whose errors are stated, under their names with _1, _2 ... for the condition."""

SUM_NAMES = ("fuel_per_hour", "carbon_dioxide_per_hour", "attained_eedi_g_per_tonne_mile")
"""Numbers over the operating profile whose errors are stated."""

_TERM_NAMES = ("f1", "f2", "total_resistance", "delivered_power")
"""Quantities whose errors are told term by term."""


@one_blas_thread()
def evaluate_with_errors(case: Case, variables: DesignVariables, level: int, reference: Reference | None) -> Evaluation:
    """A design at the true level with its errors: half widths of 90 % intervals by quantity.

    ``errors`` holds all terms, ``comparison_errors`` the design's own, ``error_terms`` each term of the main numbers.
    Thrust deduction, C_A and the fuel's consumption are taken as stated.

    Args:
        case: what is optimised.
        variables: the design.
        level: the true one's number.
        reference: of this level; computed when it is not given.

    Raises:
        ValueError: another level.
    """
    if level != TRUTH.number:
        raise ValueError(f"errors are stated at level {TRUTH.number} only, not {level}")
    started = time.perf_counter()
    try:
        basis = reference_for(case, level) if reference is None else replace(reference, surface=None)
        plain = evaluate(case, variables, level, basis)
        if not plain.ok:
            return plain
        first = _tried(case, case.initial.variables, basis, Trial())[1]
        changes = {
            term: _Change(plain, first, *_tried(case, variables, basis, trial), term)
            for term, trial in _solver_trials().items()
        }
    except SolverFailure as failure:
        return Failed(case.name, level, variables, failure.stage, failure.reason, time.perf_counter() - started)
    for term, trials in _input_trials(case).items():
        for trial in trials:
            try:
                changes[term] = _Change(plain, first, *_tried(case, variables, basis, trial), term)
                break
            except SolverFailure:
                continue  # a propeller at the end of its curve may have no point to that side
    return replace(
        plain,
        errors=_summed(change.widths() for change in changes.values()),
        comparison_errors=_rounded(_summed(changes[term].comparison() for term in OWN_TERMS)),
        error_terms={term: _rounded(change.main()) for term, change in changes.items()},
        errors_source="solved",
        elapsed=time.perf_counter() - started,
    )


def _solver_trials() -> Mapping[str, Trial]:
    return {
        MESH: Trial(waves="finer"),
        PLANE: Trial(waves="pressure"),
        DOMAIN: Trial(waves="wider"),
        PROPELLER: Trial(finer_blades=True),
    }


def _input_trials(case: Case) -> Mapping[str, tuple[Trial, ...]]:
    """By term the trials of which the first that can be computed counts."""
    trials = {}
    factor, wake = form_factor_width(case.constants), wake_fraction_width(case.constants)
    if factor is not None:
        trials[FORM_FACTOR] = tuple(Trial(form_factor=sign * factor.half_width) for sign in (1.0, -1.0))
    if wake is not None:
        trials[WAKE_FRACTION] = tuple(Trial(wake_fraction=sign * wake.half_width) for sign in (1.0, -1.0))
    return trials


def _tried(case: Case, variables: DesignVariables, basis: Reference, trial: Trial) -> tuple[Ok, Ok]:
    """The design and the initial design with something done differently to both."""
    first = _initial_tried(case, basis.basis, trial)
    reference = replace(basis, initial=initial_numbers(basis.basis.displaced_volume, first.numbers))
    own = first if variables == case.initial.variables else compute_trial(case, variables, basis.basis, trial)
    return (
        assessed(case, own, reference, OBJECTIVES, CONSTRAINTS),
        assessed(case, first, reference, OBJECTIVES, CONSTRAINTS),
    )


@lru_cache(maxsize=16)
def _initial_tried(case: Case, basis: Basis, trial: Trial) -> Physics:
    """The initial design's physics, which every design of a case is held against; a case has seven trials."""
    return compute_trial(case, case.initial.variables, basis, trial)


class _Change:
    """What a trial changes: of a design's numbers, and of their ratios to the initial design's.

    Args:
        plain, first: the design and the initial design as ever.
        tried, tried_first: the same with something done differently.
        term: its name.
    """

    def __init__(self, plain: Ok, first: Ok, tried: Ok, tried_first: Ok, term: str) -> None:
        self._objectives = plain.objectives
        self._tried_objectives = tried.objectives
        self._term = term
        own, now, base, base_now = (_numbers(item) for item in (plain, tried, first, tried_first))
        self._values = own
        self._moved = {name: now[name] - value for name, value in own.items() if name in now}
        self._ratio_moved = {
            name: (now[name] / base_now[name]) / (value / base[name]) - 1.0
            for name, value in own.items()
            if name in now and name in base and name in base_now and value and base[name] and base_now[name]
        }
        self._count = len(plain.conditions)

    def widths(self) -> dict[str, float]:
        """Half widths of the numbers' intervals, objectives among them."""
        factor = _LEFT_OVER.get(self._term, 1.0)
        relative = self._evened({name: moved / self._values[name] for name, moved in self._moved.items() if moved})
        found = {name: factor * abs(relative.get(name, 0.0) * self._values[name]) for name in self._moved}
        return self._objective_widths() | found

    def comparison(self) -> dict[str, float]:
        """Half widths of the ratios to the initial design, as fractions."""
        factor = _LEFT_OVER_OF_RATIO.get(self._term, 1.0)
        found = {name: factor * abs(value) for name, value in self._evened(self._ratio_moved).items()}
        for name, width in self._objective_widths().items():
            found[name] = width / abs(self._objectives[name])
        return found

    def main(self) -> dict[str, float]:
        """``widths`` of the main quantities."""
        return {name: width for name, width in self.widths().items() if name.rpartition("_")[0] in _TERM_NAMES
                or name in _TERM_NAMES}  # fmt: skip

    def _objective_widths(self) -> dict[str, float]:
        factor = _LEFT_OVER_OF_RATIO.get(self._term, 1.0)
        least = _LEAST_RATIO_ERROR if self._term == MESH else 0.0
        return {
            name: max(factor * abs(self._tried_objectives[name] - value), least * abs(value))
            for name, value in self._objectives.items()
        }

    def _evened(self, relative: dict[str, float]) -> dict[str, float]:
        """What the borders reflect meets the hull in a phase that changes with speed: each condition takes the mean."""
        if self._term != DOMAIN:
            return relative
        evened = dict(relative)
        for name in CONDITION_NAMES:
            keys = [key for place in range(1, self._count + 1) if (key := f"{name}_{place}") in relative]
            mean = math.sqrt(sum(relative[key] ** 2 for key in keys) / max(1, len(keys)))
            evened.update(dict.fromkeys(keys, mean))
        return evened


def _numbers(result: Ok) -> dict[str, float]:
    found = {
        f"{name}_{place}": getattr(condition, name)
        for place, condition in enumerate(result.conditions, 1)
        for name in CONDITION_NAMES
    }
    found |= {name: getattr(result, name) for name in SUM_NAMES}
    return {name: float(value) for name, value in found.items() if value is not None}


def _summed(terms: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """In quadrature."""
    squares: dict[str, float] = {}
    for widths in terms:
        for name, width in widths.items():
            squares[name] = squares.get(name, 0.0) + width**2
    return {name: math.sqrt(square) for name, square in squares.items()}


def _rounded(widths: Mapping[str, float]) -> dict[str, float]:
    """In three digits: nobody knows an error better, and a run file holds many."""
    return {name: float(f"{width:.3g}") for name, width in widths.items()}
