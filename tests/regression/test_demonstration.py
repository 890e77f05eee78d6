"""The shipped demonstration is a whole run of the recommended case, and today's code finds its numbers again."""

from __future__ import annotations

from importlib.resources import as_file

import pytest

from hpsop_core import evaluate, load_case, open_run
from hpsop_core.assets import asset_path
from hpsop_core.evaluation.reference import Reference, searching
from hpsop_core.runs import reader
from hpsop_core.runs.reader import RunReader
from tools.front_choice import choice_of


@pytest.fixture(scope="module")
def run() -> RunReader:
    with as_file(asset_path("demo", "dtc-p4119.hpsop")) as path:
        return open_run(path)


def test_it_is_the_shipped_case_run_to_its_end(run: RunReader) -> None:
    case = load_case("dtc-p4119")
    assert run.case == case
    assert run.state()[0] == "finished" and not run.failures()
    generations = run.generations()
    assert len(generations) == case.optimization.generations
    assert [g.level for g in generations].count(1) == case.optimization.level1_generations
    # Keller's criterion is handed over with a margin, torque and GM are not: level 2 asks for a little more.
    assert generations[case.optimization.level1_generations].feasible_share >= 0.5
    assert len(run.front()) >= 20
    assert not any(record.evaluation.predicted for record in run.front())


def test_its_front_is_a_choice_and_no_corner_of_the_box(run: RunReader) -> None:
    found = choice_of(run)
    assert found.inside >= 0.8
    # Both objectives differ by more than their errors (about 1 %) at one blade count: nobody pays for blades alone.
    assert min(found.spans) >= 0.05


@pytest.mark.parametrize("design", ["compromise", "knee", "initial", 200])
def test_its_designs_come_out_the_same_today(run: RunReader, design: str | int) -> None:
    stored = run.design(design).evaluation
    reference = run.reference(stored.level)
    assert reference is not None
    today = evaluate(run.case, stored.variables, stored.level, searching(run.case, Reference.from_dict(reference)))
    assert today.propeller_tabulated == stored.propeller_tabulated == (design == 200)
    # The same bits on the platform it was made on; another libm may round differently.
    for name in ("f1", "f2"):
        assert today.objectives[name] == pytest.approx(stored.objectives[name], rel=1e-9)
    # Constraints that came later are not asked by this case.
    assert {name: today.constraints[name] for name in stored.constraints} == pytest.approx(stored.constraints, abs=1e-9)
    assert {today.constraints[name] for name in today.constraints if name not in stored.constraints} <= {None}


def test_the_errors_of_its_front_are_known_without_reading_the_designs(run: RunReader) -> None:
    front = run.front()
    own = {record.id: record.evaluation.comparison_errors for record in front}
    assert all(own.values()) and run.comparison_errors(tuple(own)) == own
    assert run.comparison_errors((1,)) == {}


def test_a_reader_keeps_the_last_designs_that_it_was_asked_for(run: RunReader, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "_KEPT_DESIGNS", 5)
    ids = [point.id for point in run.archive()[:12]]
    whole = run.designs(ids)
    assert [record.id for record in whole] == ids and len(run._designs) == 5
    assert run.designs(ids[:3]) == whole[:3] and run.designs(ids[-2:]) == whole[-2:]
