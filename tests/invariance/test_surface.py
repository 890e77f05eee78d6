"""A learnt surface against the solvers that it learnt from: level 1's, whose answers cost nothing."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation import surface as learnt_surface
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.levels import WaveAnswer
from hpsop_core.evaluation.propeller_answer import PropellerAnswer
from hpsop_core.evaluation.reference import Reference, learnt, reference_for
from hpsop_core.evaluation.result import Ok
from hpsop_core.evaluation.surface import RESISTANCE_DOUBT, Told
from hpsop_core.evaluation.wave_correction import WaveCorrection
from hpsop_core.hydro.operating_point import PropellerCurve
from hpsop_core.optimization.sampling import latin_hypercube
from tests.two_speeds import TWO_SPEEDS


def designs(case: Case, count: int, seed: int) -> list[DesignVariables]:
    """Designs whose form carries what is asked."""
    sample = latin_hypercube(case.bounds, 3 * count, seed)
    found = [case.bounds.decode(vector) for vector in sample]
    return [v for v in found if 0.60 < _block_coefficient(case, v) < 0.72][:count]


def _block_coefficient(case: Case, variables: DesignVariables) -> float:
    initial = case.initial
    box = variables.length * variables.breadth * variables.draft
    # The parent has 0.661 at the initial dimensions.
    return 0.661 * initial.length * initial.breadth * initial.draft * variables.displacement_ratio / box


@pytest.fixture(scope="module")
def case() -> Case:
    plain = load_case(TWO_SPEEDS)
    bounds = {"buoyancy_centre_shift": (-0.01, 0.01), "expanded_area_ratio": (0.55, 0.9), "draft": (13.5, 14.5)}
    return plain.with_bounds(bounds)


@pytest.fixture(scope="module")
def reference(case: Case) -> Reference:
    return reference_for(case, 1)


@pytest.fixture(scope="module")
def solved(case: Case, reference: Reference) -> list[Ok]:
    found = [evaluate(case, variables, 1, reference) for variables in designs(case, 90, 1)]
    return [result for result in found if isinstance(result, Ok)]


@pytest.fixture(scope="module")
def surface(case: Case, reference: Reference, solved: list[Ok]) -> Reference:
    with_surface, errors = learnt(case, reference, [result.as_dict() for result in solved])
    assert with_surface.surface is not None
    # Half a per cent of doubt in waves that are about a third of the resistance.
    assert 0.0 < errors["resistance"] < 2e-3 and errors["efficiency"] < 1e-3
    return with_surface


def test_fresh_designs_are_predicted(case: Case, reference: Reference, surface: Reference) -> None:
    answered, resistance, efficiency = 0, [], []
    fresh = designs(case, 40, 2)
    for variables in fresh:
        guess, truth = evaluate(case, variables, 1, surface), evaluate(case, variables, 1, reference)
        assert guess.ok and truth.ok
        if not guess.predicted:
            # In doubt it asks the solvers: the same bits.
            assert dataclasses.replace(guess, elapsed=0.0) == dataclasses.replace(truth, elapsed=0.0)
            continue
        answered += 1
        assert guess.hull == truth.hull and guess.propeller == truth.propeller
        for ours, theirs in zip(guess.conditions, truth.conditions, strict=True):
            assert ours.friction_resistance == theirs.friction_resistance
            resistance.append(ours.total_resistance / theirs.total_resistance - 1.0)
            efficiency.append(ours.open_water_efficiency / theirs.open_water_efficiency - 1.0)
    # In six dimensions that many designs leave room between them.
    assert answered >= len(fresh) // 3
    # What is asked of it: half a per cent in resistance and efficiency.
    assert np.max(np.abs(resistance)) < 5e-3
    assert np.max(np.abs(efficiency)) < 5e-3


def test_what_it_learnt_from_it_gives_back(case: Case, surface: Reference, solved: list[Ok]) -> None:
    for result in solved[:10]:
        guess = evaluate(case, result.variables, 1, surface)
        assert guess.ok and guess.predicted
        assert guess.objectives == pytest.approx(result.objectives, rel=1e-5)


@pytest.mark.parametrize(
    "changes",
    [
        {"length_to_breadth": 12.0, "breadth_to_draft": 3.4},  # far outside
        {"displacement_ratio": 1.35},  # clipped
        {"pitch_ratio": 1.4},
        {"buoyancy_centre_shift": 0.045},
    ],
)
def test_beyond_its_knowledge_it_is_silent(case: Case, surface: Reference, changes: dict[str, float]) -> None:
    """Extrapolated waves are wrong by factors: nothing of the kind may come out as an answer."""
    result = evaluate(case, case.initial.variables.replaced(changes), 1, surface)
    assert not result.ok or not result.predicted


def test_few_clipped_or_predicted_designs_teach_nothing(case: Case, reference: Reference, solved: list[Ok]) -> None:
    documents = [result.as_dict() for result in solved]
    assert learnt(case, reference, documents[:15])[0].surface is None
    clipped = [{**data, "hull": {**data["hull"], "clipped": True}} for data in documents]
    assert learnt(case, reference, clipped)[0].surface is None
    assert learnt(case, reference, [{**data, "predicted": True} for data in documents])[0].surface is None


def test_doubt_is_of_the_resistance(solved: list[Ok]) -> None:
    conditions = solved[0].conditions
    shares = [condition.wave_resistance / condition.total_resistance for condition in conditions]
    just = [RESISTANCE_DOUBT / share for share in shares]
    nothing = PropellerAnswer(PropellerCurve(np.array([0.2, 1.0]), np.zeros(2), np.zeros(2)), None)
    waves = (WaveAnswer(1.0),) * len(shares)
    assert Told(waves, tuple(0.99 * value for value in just), nothing).is_sure(conditions)
    for place in range(len(shares)):
        more = [1.01 * value if index == place else 0.0 for index, value in enumerate(just)]
        assert not Told(waves, tuple(more), nothing).is_sure(conditions)


def test_who_doubts_everything_solves_everything(
    case: Case, reference: Reference, surface: Reference, solved: list[Ok], monkeypatch: pytest.MonkeyPatch
) -> None:
    variables = solved[0].variables
    guess = evaluate(case, variables, 1, surface)
    assert guess.ok and guess.predicted
    monkeypatch.setattr(learnt_surface, "RESISTANCE_DOUBT", 0.0)
    asked, truth = evaluate(case, variables, 1, surface), evaluate(case, variables, 1, reference)
    assert dataclasses.replace(asked, elapsed=0.0) == dataclasses.replace(truth, elapsed=0.0)


def _correction(case: Case, solved: list[Ok]) -> WaveCorrection:
    """Of hulls that both levels gave these waves for."""
    inputs, waves = [], []
    for place in range(len(case.conditions.weights)):
        rows = [learnt_surface._solved_inputs(result.as_dict(), place) for result in solved]
        inputs.append(tuple(tuple(map(float, row)) for row in rows))
        own = [c.wave_coefficient / c.wave_calibration for c in (result.conditions[place] for result in solved)]
        waves.append(tuple(map(float, np.log(own))))
    return WaveCorrection(tuple(inputs), tuple((0.0,) * len(solved) for _ in inputs), true_waves=tuple(waves))


def test_the_hulls_that_taught_level_1_are_learnt_from(case: Case, reference: Reference, solved: list[Ok]) -> None:
    few, others = [result.as_dict() for result in solved[:25]], _correction(case, solved[25:])
    fast = dataclasses.replace(reference, basis=dataclasses.replace(reference.basis, correction=others))
    alone, taught = learnt(case, reference, few), learnt(case, reference, few, fast)
    assert alone[1]["designs"] == taught[1]["designs"] == 25, "errors are told of designs that were solved as a whole"
    found = {"alone": 0, "taught": 0}
    for variables in designs(case, 40, 2):
        truth = evaluate(case, variables, 1, reference)
        assert truth.ok
        for name, (who, _) in (("alone", alone), ("taught", taught)):
            guess = evaluate(case, variables, 1, who)
            assert guess.ok
            found[name] += guess.predicted
            for ours, theirs in zip(guess.conditions, truth.conditions, strict=True):
                assert ours.total_resistance == pytest.approx(theirs.total_resistance, rel=5e-3)
    assert found["taught"] >= 2 * max(1, found["alone"])
    # a run file of an earlier version kept none of it
    old = dataclasses.replace(fast.basis, correction=dataclasses.replace(others, true_waves=()))
    assert learnt(case, reference, few, dataclasses.replace(reference, basis=old))[1] == alone[1]


def test_with_a_limit_on_back_cavitation_the_propeller_is_solved(
    case: Case, surface: Reference, solved: list[Ok]
) -> None:
    limited = case.replaced("constraints", back_cavitation_limit=0.1)
    result = evaluate(limited, solved[0].variables, 1, surface)
    exact = evaluate(limited, solved[0].variables, 1, dataclasses.replace(surface, surface=None))
    assert result.ok and exact.ok and result.predicted
    assert result.open_water == exact.open_water


def _share(condition: dict[str, float], variables: DesignVariables) -> float:
    """Cavitation on the back that begins steeply and is counted in panels of 0.25 %."""
    load = condition["thrust_coefficient"] / (condition["advance_coefficient"] * variables.expanded_area_ratio)
    return float(np.round(max(0.0, 0.35 * (load - 0.42)) / 0.0025) * 0.0025)


def test_cavitation_on_the_back_is_predicted_far_from_its_limit_alone(
    case: Case, reference: Reference, solved: list[Ok]
) -> None:
    limit = 0.05
    limited = case.replaced("constraints", back_cavitation_limit=limit, cavitation_conditions="all")
    documents = [result.as_dict() for result in solved]
    for data in documents:
        variables = DesignVariables.from_dict(data["variables"])
        data["conditions"] = [{**c, "blade_cavitating_share": _share(c, variables)} for c in data["conditions"]]
    surface, errors = learnt(limited, reference, documents)
    assert surface.surface is not None and 0.0 < errors["greatest_back_share"] < 0.05
    told = {"kept": 0, "broken": 0, "asked": 0}
    for variables in designs(case, 60, 3):
        truth = evaluate(case, variables, 1, reference)
        assert truth.ok
        shares = [_share(dataclasses.asdict(c), variables) for c in truth.conditions]
        conditions = surface.surface.back_told(limited, variables, truth.conditions)
        if conditions is None:
            told["asked"] += 1
            continue
        guesses = [c.blade_cavitating_share or 0.0 for c in conditions]
        assert guesses == pytest.approx(shares, abs=0.05)
        assert (max(guesses) > limit) == (max(shares) > limit)
        # nothing else of a pressure is made up
        assert all(c.blade_cavitation_margin is None for c in conditions)
        told["broken" if max(guesses) > limit else "kept"] += 1
    # shares lie from nothing to several times the limit
    assert min(told.values()) >= 3
    # where the limit is no limit, and where nothing was learnt
    assert surface.surface.back_told(case, solved[0].variables, solved[0].conditions) is None
    assert learnt(limited, reference, [r.as_dict() for r in solved])[0].surface.back is None  # type: ignore[union-attr]
