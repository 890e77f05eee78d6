"""What a run file keeps of an evaluation is the whole of it, to the last bit, in a fifth of the room."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from hpsop_core import evaluate, load_case
from hpsop_core.evaluation.result import Failed, evaluation_from_dict
from hpsop_core.runs.packing import essence_of, pack, unpack
from hpsop_core.runs.records import json_text, variables_text
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)


def document(level: int = 1, **changes: float) -> dict[str, Any]:
    variables = CASE.initial.variables.replaced(changes)
    return json.loads(json_text(evaluate(CASE, variables, level).as_dict()))


def there_and_back(data: dict[str, Any], dictionary: bytes) -> dict[str, Any]:
    variables = evaluation_from_dict(data).variables
    return unpack(pack(essence_of(data), dictionary), dictionary, variables_text(variables))


def exact(data: dict[str, Any]) -> str:
    # Python's JSON writes the shortest text that reads back to the same double, and -0.0 as such.
    return json.dumps(data, sort_keys=True)


def test_real_evaluations_of_both_levels_come_back_to_the_last_bit() -> None:
    dictionary = essence_of(document())
    for level, changes in ((1, {"diameter": 9.3}), (2, {"draft": 14.2, "blade_count": 5}), (1, {"diameter": 0.02})):
        data = document(level, **changes)
        before = exact(data)
        assert exact(there_and_back(data, dictionary)) == before
        assert exact(data) == before, "what was given is not changed"


def test_any_document_comes_back_whatever_the_dictionary_was() -> None:
    plain = document()
    awkward = {
        **plain,
        "warnings": ["a zero \0 byte, an umlaut ü, a number 0.0", ""],
        "constraints": {"displacement": -0.0, "diameter_to_draft": 0.0, "cavitation": None, "form": 5e-324},
        "all_objectives": {"whole": 3, "flag": True, "large": 1.7976931348623157e308},
        "open_water": {
            "advance_coefficient": [0.2, 0.4, 0.6],
            "thrust_coefficient": [0.1, 0.2, -0.0],
            "torque_coefficient": [0.0, 0.03, 0.02],
            # Not what J KT/(2 pi KQ) gives, and one that it cannot give.
            "open_water_efficiency": [None, 0.5, 0.0],
        },
    }
    failed = Failed("c", 2, CASE.initial.variables, "rankine", "the system is singular", 0.1).as_dict()
    for data in (plain, awkward, failed):
        for dictionary in (essence_of(plain), essence_of(failed), b"something else"):
            assert exact(there_and_back(data, dictionary)) == exact(data)


def test_documents_of_one_form_share_nothing_but_their_words() -> None:
    plain = document()
    dictionary = essence_of(plain)
    lines = [[], ["level 1: 0.5 % off", 'a line with "warnings":[] in it'], ["ends with a ]"], []]
    given = [{**plain, "elapsed": 0.1 + place, "warnings": line} for place, line in enumerate(lines)]
    back = [there_and_back(data, dictionary) for data in given]
    back[0]["conditions"][0].clear()
    back[0]["open_water"]["advance_coefficient"].append(9.0)
    back[0]["warnings"].append("mine")
    assert [exact(data) for data in back[1:]] == [exact(data) for data in given[1:]]
    assert list(back[1]) == [*(key for key in plain if key != "variables"), "variables"]


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_what_is_no_number_is_refused(number: float) -> None:
    with pytest.raises(ValueError, match="not finite"):
        essence_of({**document(), "elapsed": number})


def test_it_takes_a_fifth_of_the_room() -> None:
    dictionary = essence_of(document())
    data = document(diameter=9.3, draft=14.2, length_to_breadth=7.2, displacement_ratio=1.01)
    # About 120 numbers are its own, at 8 bytes, the 19 efficiencies among them; the JSON has 4.7 kB.
    assert len(pack(essence_of(data), dictionary)) < 0.21 * len(json_text(data))


def test_a_file_of_an_earlier_version_without_its_efficiencies_reads_the_same() -> None:
    data = document()
    curves = data["open_water"]
    columns = (curves["advance_coefficient"], curves["thrust_coefficient"], curves["torque_coefficient"])
    # Earlier versions left the column out where it had the bits of this quotient, also beyond zero thrust.
    curves["open_water_efficiency"] = [j * kt / (2.0 * math.pi * kq) for j, kt, kq in zip(*columns, strict=True)]
    without = {**data, "open_water": {k: v for k, v in curves.items() if k != "open_water_efficiency"}}
    variables = variables_text(evaluation_from_dict(data).variables)
    dictionary = essence_of(without)
    assert exact(unpack(pack(essence_of(without), dictionary), dictionary, variables)) == exact(data)


def test_numbers_of_numpy_are_numbers() -> None:
    given = {
        **document(),
        "warnings": np.array(["said"]),
        "objectives": {"f1": np.float64(0.1), "f2": np.float32(0.5)},
        "all_objectives": {"count": np.int64(3), "flag": np.bool_(True), "list": np.array([0.1, 2.0])},
    }
    plain = json.loads(json_text(given))
    assert exact(there_and_back(given, essence_of(document()))) == exact(plain)
    with pytest.raises(ValueError, match="not JSON compliant"):
        essence_of({**given, "elapsed": np.array([float("nan")])})
