"""Hulls of users, as tables through the command: solved at level 2, or refused in one line that says why."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hpsop_core.cli.main import main

LENGTH, BREADTH, DRAFT = 100.0, 10.0, 6.25
STATIONS, WATERLINES = np.linspace(0.0, LENGTH, 41), np.linspace(0.0, DRAFT, 11)


def wigley(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    along = np.clip(1.0 - (2.0 * x / LENGTH - 1.0) ** 2, 0.0, None)
    return 0.5 * BREADTH * along[:, None] * (1.0 - (1.0 - z / DRAFT) ** 2)[None, :]


def with_transom(keel: float, breadth: float = BREADTH) -> np.ndarray:
    """A stern that ends 0.65 of the breadth wide, its keel ``keel`` above the baseline."""
    x, z = STATIONS[:, None], WATERLINES[None, :]
    plan = np.where(x > 50.0, 1.0 - ((x - 50.0) / 50.0) ** 2, 1.0 - 0.35 * ((50.0 - x) / 50.0) ** 2)
    bottom = np.where(x < 30.0, keel * (1.0 - x / 30.0) ** 2, 0.0)
    return np.asarray(0.5 * breadth * plan * np.clip((z - bottom) / (DRAFT - bottom), 0.0, 1.0) ** 0.35)


def table(path: Path, x: np.ndarray, z: np.ndarray, y: np.ndarray) -> str:
    rows = [f"{a:.8g},{b:.8g},{y[i, j]:.8g}" for i, a in enumerate(x) for j, b in enumerate(z)]
    path.write_text("\n".join(["station_x_m,waterline_z_m,half_breadth_m", *rows]), encoding="utf-8")
    return str(path)


Answer = Callable[..., tuple[int, list[dict[str, Any]], str]]


@pytest.fixture
def resistance(capsys: pytest.CaptureFixture[str]) -> Answer:
    def run(file: str, *froude: float, draft: float = DRAFT) -> tuple[int, list[dict[str, Any]], str]:
        words = ["resistance", "--offsets", file, "--length", str(LENGTH), "--draft", str(draft), "--level", "2"]
        code = main([*words, "--froude", ",".join(str(value) for value in froude), "--json"])
        captured = capsys.readouterr()
        return code, json.loads(captured.out)["points"] if captured.out else [], captured.err

    return run


def test_wigley(tmp_path: Path, resistance: Answer) -> None:
    file = table(tmp_path / "wigley.csv", STATIONS, WATERLINES, wigley(STATIONS, WATERLINES))
    code, points, _ = resistance(file, 0.313)
    assert code == 0
    # The range of the experiments that Chen and Noblesse (1983) gathered, by both values, through the command.
    assert 1.4e-3 < points[0]["wave_coefficient"] < 1.9e-3
    assert 1.4e-3 < points[0]["wave_coefficient_pressure"] < 1.9e-3
    assert points[0]["warnings"] == []


def test_bulb(tmp_path: Path, resistance: Answer) -> None:
    x = np.concatenate([np.linspace(0.0, 96.0, 36), np.linspace(97.0, 104.0, 15)])
    z = np.linspace(0.0, DRAFT, 21)
    radius = 1.6 * np.sqrt(np.clip(1.0 - ((x - 99.0) / 5.0) ** 2, 0.0, None)) * (x >= 94.0)
    bulb = 0.7 * np.sqrt(np.clip(radius[:, None] ** 2 - (z[None, :] - 2.2) ** 2, 0.0, None))
    code, points, _ = resistance(table(tmp_path / "bulb.csv", x, z, np.maximum(wigley(x, z), bulb)), 0.25, 0.313)
    assert code == 0
    bare = table(tmp_path / "bare.csv", STATIONS, WATERLINES, wigley(STATIONS, WATERLINES))
    _, without, _ = resistance(bare, 0.25, 0.313)
    # A bulb of 0.5 % of the volume moves the waves, but not by more than a half.
    for point, other in zip(points, without, strict=True):
        assert 0.5 < point["wave_coefficient"] / other["wave_coefficient"] < 1.5
        assert point["wave_coefficient"] != pytest.approx(other["wave_coefficient"], rel=0.01)


def test_transom_is_closed_and_says_so(tmp_path: Path, resistance: Answer) -> None:
    code, points, errors = resistance(table(tmp_path / "t.csv", STATIONS, WATERLINES, with_transom(5.6)), 0.25, 0.313)
    assert code == 0
    for point in points:
        assert any("tail" in line for line in point["warnings"])
        # The tail makes waves that the pressure on the hull does not count: a third is what a shallow transom may add.
        ratio = point["wave_coefficient"] / point["wave_coefficient_pressure"]
        assert 0.67 < ratio < 1.5
    assert "Traceback" not in errors


def test_transom_too_wide_to_be_closed(tmp_path: Path, resistance: Answer) -> None:
    file = table(tmp_path / "wide.csv", STATIONS, WATERLINES, with_transom(3.0, 30.0))
    code, points, errors = resistance(file, 0.25)
    assert (code, points) == (1, [])
    assert errors.count("\n") == 1
    assert "wet transom is 19.5 m wide" in errors
    # Its keel at the transom is 3 m up: at 2.9 m draft it is dry, and solved.
    code, points, errors = resistance(file, 0.25, draft=2.9)
    assert code == 0, errors
    assert points[0]["wave_coefficient"] > 0.0


def test_a_wide_transom_is_solved_where_it_is_dry(tmp_path: Path, resistance: Answer) -> None:
    """By the table 0.625 m deep: V/sqrt(g h) is 2.5 at Froude number 0.198; at 0.3 the water leaves it, at 0.14 not."""
    file = table(tmp_path / "dry.csv", STATIONS, WATERLINES, with_transom(5.9, 26.0))
    code, points, errors = resistance(file, 0.30, 0.35)
    assert code == 0, errors
    for point in points:
        assert any("dry at all these speeds" in line for line in point["warnings"])
        # The closure's own share: momentum and pressure agree as they do on transoms of half the breadth.
        assert 0.67 < point["wave_coefficient"] / point["wave_coefficient_pressure"] < 1.5
    code, points, errors = resistance(file, 0.14, 0.30)
    assert (code, points) == (1, [])
    assert "where they are dry (V/sqrt(g h) of 2.5, here from Froude number 0.198" in errors


def test_barge(tmp_path: Path, resistance: Answer) -> None:
    code, points, errors = resistance(table(tmp_path / "b.csv", STATIONS, WATERLINES, np.full((41, 11), 8.0)), 0.2)
    assert (code, points) == (1, [])
    assert errors.count("\n") == 1
    assert "transom" in errors


def test_few_cells_on_a_wave_are_told(tmp_path: Path, resistance: Answer) -> None:
    file = table(tmp_path / "wigley.csv", STATIONS, WATERLINES, wigley(STATIONS, WATERLINES))
    code, points, _ = resistance(file, 0.17)
    assert code == 0
    assert any("cells on a transverse wave" in line for line in points[0]["warnings"])
