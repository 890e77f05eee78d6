"""Shipped calibrations hold what the code computes, and serve their own case alone."""

from __future__ import annotations

import dataclasses
import math

import pytest

from hpsop_core.case.case import SHIPPED_CASES, Case, load_case
from hpsop_core.evaluation import physics, shipped_calibration, wave_correction
from hpsop_core.evaluation.wave_correction import WaveCorrection
from tools.calibrations import FOLDER, computed

CALIBRATED = [name for name in SHIPPED_CASES if load_case(name).constants.wave_calibration in ("level2", "learnt")]


@pytest.mark.parametrize("name", CALIBRATED)
def test_level_2_gives_the_waves_that_are_shipped(name: str) -> None:
    case = load_case(name)
    kept = shipped_calibration.shipped(case, shipped_calibration.INITIAL)
    waves = physics.initial_true_waves(case, physics.initial_volume(case))
    # another machine's last digits
    assert kept == pytest.approx(waves, rel=1e-9)


@pytest.mark.soak
@pytest.mark.parametrize("name", CALIBRATED)
def test_all_that_is_shipped_is_what_is_computed(name: str) -> None:
    for kind, content in computed(load_case(name)).items():
        kept = shipped_calibration.shipped(load_case(name), kind)
        if kind == shipped_calibration.INITIAL:
            assert kept == pytest.approx(content, rel=1e-9)
            continue
        for part in ("logarithms", "true_waves"):
            for one, other in zip(kept[part], content[part], strict=True):
                assert one == pytest.approx(other, abs=1e-9)
        for rows, others in zip(kept["inputs"], content["inputs"], strict=True):
            for one, other in zip(rows, others, strict=True):
                assert one == pytest.approx(other, rel=1e-9, abs=1e-12)


def test_the_first_hull_that_is_learnt_from_is_the_initial_one() -> None:
    case = load_case("dtc-p4119")
    learnt = WaveCorrection.from_dict(shipped_calibration.shipped(case, shipped_calibration.LEARNT))
    initial = shipped_calibration.shipped(case, shipped_calibration.INITIAL)
    assert [math.exp(logarithms[0]) for logarithms in learnt.true_waves] == pytest.approx(initial, rel=1e-9)
    assert {len(rows) for part in (learnt.inputs, learnt.logarithms, learnt.true_waves) for rows in part} == {97}


def test_shipped_kernels_are_those_that_are_found() -> None:
    kept = shipped_calibration.shipped(load_case("dtc-p4119"), shipped_calibration.LEARNT)
    shipped = WaveCorrection.from_dict(kept)
    assert shipped.kernels
    found = dataclasses.replace(shipped, kernels=()).with_kernels()
    # The likelihood is flat about its top: another machine's search ends where it is as good.
    for one, other in zip(wave_correction._fitted(shipped), wave_correction._fitted(found), strict=True):
        at = one.lower + 0.37 * one.extent
        assert one.mean_at(at) == pytest.approx(other.mean_at(at), abs=1e-4)
    # On the machine that wrote them they are the very same; a run that was begun before goes on with its own.
    assert WaveCorrection.from_dict(dataclasses.asdict(found)) == found


def test_nothing_is_shipped_for_a_case_that_is_not() -> None:
    kinds = (shipped_calibration.INITIAL, shipped_calibration.LEARNT)
    named = {shipped_calibration.file_name(load_case(name), kind) for name in CALIBRATED for kind in kinds}
    assert {path.name for path in FOLDER.glob("*.json")} <= named


def _level_2_asked(case: Case, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether level 1's basis asks level 2's solver of waves."""
    asked = []
    solve = physics.wave_answers

    def watched(key: object, level: int, froude_numbers: tuple[float, ...]) -> object:
        asked.append(level)
        return solve(key, 1, froude_numbers)  # type: ignore[arg-type]

    monkeypatch.setattr(physics, "wave_answers", watched)
    physics.basis_for(case, 1)
    return 2 in asked


@pytest.mark.parametrize(
    ("section", "changes"),
    [
        ("initial", {"length": 354.0}),
        ("initial", {"displacement_ratio": 1.01}),
        ("hull", {"form": "affine"}),
        ("conditions", {"speeds_knots": [19.0, 22.0, 23.5, 25.0]}),
        ("constants", {"gravity": 9.81}),
    ],
)
def test_a_changed_case_is_computed(section: str, changes: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case("dtc-p4119").replaced("constants", wave_calibration="level2")
    assert _level_2_asked(case.changed({section: changes}), monkeypatch)


def test_limits_and_weights_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case("dtc-p4119").replaced("constants", wave_calibration="level2")
    changed = case.changed(
        {"constraints": {"greatest_length": 400.0}, "conditions": {"weights": [0.25, 0.25, 0.25, 0.25]}}
    )
    assert not _level_2_asked(changed, monkeypatch)


def test_what_was_learnt_serves_the_spaces_within_its_own() -> None:
    case = load_case("dtc-p4119")
    kept = shipped_calibration.shipped(case, shipped_calibration.LEARNT)
    assert kept is not None
    low, high = case.bounds.as_dict()["draft"]
    narrower = case.with_bounds({"draft": (low + 0.2, high - 0.2)})
    wider = case.with_bounds({"draft": (low, high + 1.0)})
    assert shipped_calibration.shipped(narrower, shipped_calibration.LEARNT) == kept
    assert shipped_calibration.shipped(wider, shipped_calibration.LEARNT) is None
    other = case.replaced("constants", wave_calibration_hulls=24)
    assert shipped_calibration.shipped(other, shipped_calibration.LEARNT) is None


def test_a_wider_case_learns_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def learn(case: Case, *_rest: object) -> None:
        asked.append(case)

    monkeypatch.setattr(physics, "learn_correction", learn)
    case = load_case("dtc-p4119")
    physics.basis_for(case, 1)
    assert not asked
    wider = case.with_bounds({"draft": (13.0, 17.5)})
    physics.basis_for(wider, 1)
    assert asked == [wider]
