"""A case as text: whatever its title holds it comes back, in a run file too; older texts and other encodings open."""

from __future__ import annotations

import dataclasses
import random
import shutil
from pathlib import Path

import pytest

from hpsop_core.assets import asset_path
from hpsop_core.case.case import Case, case_from_toml, load_case
from hpsop_core.errors import InputError
from hpsop_core.runs.controller import RunController
from hpsop_core.runs.reader import open_run
from tests.two_speeds import TWO_SPEEDS

CASE = load_case(TWO_SPEEDS)
# Every control character, what TOML itself means something by, and letters beyond ASCII and beyond 16 bits.
NASTY = [
    *map(chr, range(32)),
    "\x7f",
    "\x85",
    "\u2028",
    '"',
    "'",
    "\\",
    "[",
    "]",
    "#",
    "=",
    ",",
    '"""',
    "\r\n",
    "\\u001b",
]
NASTY += ["[\n", "[\n    1,\n]", "    ,\n", "é", "∇", "船", "\ufeff", "\U0001f6a2", "\U0010ffff", " ", "a"]


def titled(title: str) -> Case:
    return dataclasses.replace(CASE, title=title, description=title + "\n" + title, name=title)


@pytest.mark.parametrize("character", NASTY)
def test_a_title_of_one_nasty_thing_comes_back(character: str) -> None:
    for title in (character, f"a{character}", f"{character}b", character * 3):
        assert case_from_toml(titled(title).to_toml(), "again.toml") == titled(title)


def test_titles_of_any_mixture_come_back() -> None:
    rng = random.Random(11)
    for _ in range(300):
        case = titled("".join(rng.choices(NASTY, k=rng.randint(0, 12))))
        assert case_from_toml(case.to_toml(), "again.toml") == case


def test_a_saved_case_comes_back_from_a_file(tmp_path: Path) -> None:
    case = titled("\x1b[1mbold\x1b[0m\r\nsecond\rthird\b")
    (tmp_path / "saved.toml").write_bytes(case.to_toml().encode())
    assert load_case(tmp_path / "saved.toml") == case


def test_a_run_with_a_nasty_title_opens_and_continues(tmp_path: Path) -> None:
    case = titled("\x1b[1mbold\x1b[0m\r\b")
    path = tmp_path / "run.hpsop"
    RunController(path, case, workers=1).close()
    assert open_run(path).case == case
    with RunController(path, case, workers=1) as controller:
        assert controller.case == case


def test_every_field_stands_in_its_declared_order_and_lists_on_one_line() -> None:
    lines = CASE.to_toml().splitlines()
    heads = [line for line in lines if line.startswith("[")]
    assert heads == [
        *("[hull]", "[propeller]", "[initial]", "[bounds]", "[conditions]", "[objectives]", "[constraints]"),
        *("[constants]", "[loading]", "[engine]", "[optimization]"),
    ]
    assert lines[0].startswith("name = ")
    assert "length_to_breadth = [6.5, 8.5]" in lines
    assert "stated_wave_coefficients = []" in lines


def test_floats_keep_all_their_digits() -> None:
    value = 0.1 + 0.2
    case = CASE.replaced("constants", viscosity=1.0 / 3.0 * 3e-6, form_factor=value).with_bounds(
        {"draft": (0.1, value)}
    )
    again = case_from_toml(case.to_toml(), "again.toml")
    assert again == case
    assert again.bounds.as_dict()["draft"] == (0.1, value)


def test_a_case_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    # Windows' Notepad saves UTF-8 with such a mark
    path = tmp_path / "marked.toml"
    path.write_bytes(b"\xef\xbb\xbf" + CASE.to_toml().encode())
    assert load_case(path) == CASE


def test_a_text_that_no_file_can_hold_is_refused_in_one_line() -> None:
    with pytest.raises(InputError, match=r"^case: 'title = .*rename the file or mend the text$"):
        dataclasses.replace(CASE, title="lone \udce4").to_toml()


def test_a_run_of_an_earlier_version_is_still_its_case_s_run(tmp_path: Path) -> None:
    """The shipped run's text was written by other code: cases are compared, never texts."""
    path = tmp_path / "run.hpsop"
    shutil.copy(asset_path("demo", "dtc-p4119.hpsop"), path)
    case = open_run(path).case
    with RunController(path, case_from_toml(case.to_toml(), "again.toml"), workers=1) as controller:
        assert controller.case == case
    with pytest.raises(InputError, match="holds a run of the case"):
        RunController(path, case.with_bounds({"draft": (14.1, 14.4)}), workers=1)
