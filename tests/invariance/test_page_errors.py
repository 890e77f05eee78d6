"""The page's errors: solved when asked, shown where known, and what normalises until a run has learnt."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import pytest

from explorer.services import answers as page_answers
from explorer.services.answers import Answers
from explorer.services.designs import Designs
from explorer.services.refining import TOPIC, Refining, can_be_refined
from explorer.state.run_picture import GenerationPicture, RunPicture
from explorer.state.shown import Shown
from hpsop_core.case.case import Case, load_case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.evaluation.evaluate import evaluate
from hpsop_core.evaluation.result import Evaluation, Failed, Ok
from tests.two_speeds import stated_case

CASE = stated_case()
OWN = {"f1": 0.004, "f2": 0.001}


@pytest.fixture(scope="module")
def solved() -> Ok:
    """A design as level 2 would give it."""
    result = evaluate(CASE)
    assert result.ok
    return dataclasses.replace(result, level=2)


class Asked:
    """A page's state and its designs, which write down what they are asked."""

    def __init__(self, solved: Ok) -> None:
        self.picture = RunPicture("run", CASE, generations=(GenerationPicture(9, 2, (7, 8), (7, 8), 1.0),))
        self.told: list[str] = []
        self.kept: list[int] = []
        self.refined: list[float] = []
        self._solved = solved

    def tell_all(self, topic: str) -> None:
        self.told.append(topic)

    def initial(self, level: int) -> Shown:
        return Shown("Initial design", self._at(14.0), kind="initial")

    def shown(self, number: int) -> Shown:
        return Shown(f"Design {number}", self._at(14.0 + number / 100.0), number)

    def refine(self, variables: DesignVariables) -> Evaluation:
        self.refined.append(variables.draft)
        if variables.draft == 14.08:
            return Failed("two-speeds", 2, variables, "rankine", "folds")
        return dataclasses.replace(self._at(variables.draft), errors=OWN, comparison_errors=OWN)

    def keep_errors(self, number: int, evaluation: Evaluation) -> None:
        assert evaluation.comparison_errors == OWN
        self.kept.append(number)

    def news(self) -> None:
        self.told.append("news")

    def _at(self, draft: float) -> Ok:
        return dataclasses.replace(self._solved, variables=self._solved.variables.replaced({"draft": draft}))


def ended(refining: Refining) -> None:
    assert refining._worker.wait_until_idle(60.0)


def test_the_front_and_the_initial_design_are_solved_and_kept(solved: Ok) -> None:
    asked: Any = Asked(solved)
    refining = Refining(asked, asked, asked)
    refining.front()
    ended(refining)
    assert sorted(asked.refined) == [14.0, 14.07, 14.08]
    assert asked.kept == [7], "the initial design has no number here, and design 8 failed"
    assert asked.told.count(TOPIC) == 4 and asked.told[-1] == "news"
    assert not refining.busy and "Design 8" in refining.words() and "folds" in refining.words()
    refining.design(asked.shown(7))
    ended(refining)
    assert refining.words() == ""
    refining.close()


def test_what_has_its_errors_or_cannot_have_any_is_left(solved: Ok) -> None:
    assert can_be_refined(Shown("", solved))
    for changed in (
        dataclasses.replace(solved, level=1),
        dataclasses.replace(solved, predicted=True),
        dataclasses.replace(solved, comparison_errors=OWN),
        Failed("two-speeds", 2, solved.variables, "hull", "folds"),
    ):
        assert not can_be_refined(Shown("", changed))


def test_a_design_shows_its_own_errors_where_they_are_known_and_typical_ones_else(solved: Ok) -> None:
    designs = Designs(SimpleNamespace(picture=RunPicture("run", CASE)))  # type: ignore[arg-type]
    typical = designs.with_errors(Shown("", solved)).evaluation
    assert typical.errors_source == "stated" and typical.errors["delivered_power_1"] > 0.0
    own = dataclasses.replace(solved, errors=OWN, comparison_errors=OWN, errors_source="solved")
    designs._answers._refined.get((CASE, solved.variables.key()), lambda: own)
    known = designs.with_errors(Shown("", solved)).evaluation
    assert known.errors == OWN and known.errors_source == "solved"
    assert designs.with_errors(Shown("", evaluate(CASE))).evaluation.errors == {}, "level 1 has none"


def test_settings_that_are_edited_wait_for_no_hulls_and_a_run_brings_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def reference_for(case: Case, level: int) -> str:
        asked.append(case.constants.wave_calibration)
        return case.constants.wave_calibration

    monkeypatch.setattr(page_answers, "reference_for", reference_for)
    answers, case = Answers(), load_case("dtc-p4119")
    assert answers.reference(case, 1) == "learnt", "what it learnt is shipped"
    wider = case.with_bounds({"draft": (12.0, 17.5)})
    assert answers.reference(wider, 1) == "level2"
    answers.take(wider, 1, lambda: None)
    assert answers.reference(wider, 1) == "level2" and asked == ["learnt", "level2"]
    own: Any = "the run's"
    answers.take(wider, 1, lambda: own)
    assert answers.reference(wider, 1) is own
    assert answers.reference(wider, 2) == "learnt", "level 2 knows no calibration"
