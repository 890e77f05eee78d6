"""Damaged files of CAD systems crash and hang the libraries that read them: here they are refused like any other."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_hostile_input import SOAK, command, mutated, refused

from hpsop_core import load_hull
from hpsop_core.errors import InputError
from hpsop_core.geometry.foreign import apart


def a_box(folder: Path, suffix: str) -> bytes:
    """A small file of surfaces."""
    path = folder / f"good.{suffix}"
    if suffix == "3dm":
        import rhino3dm

        file = rhino3dm.File3dm()
        file.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(50.0, 0.0, 0.0), 20.0))
        assert file.Write(str(path), 7)
        return path.read_bytes()
    pytest.importorskip("OCP", reason="the extra hpsop[cad] is not installed")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    from hpsop_core.export.solids import NamedSolid, write_iges, write_step

    box = NamedSolid("box", BRepPrimAPI_MakeBox(100000.0, 16000.0, 8000.0).Solid(), ())
    (write_step if suffix == "step" else write_iges)(path, [box], "a box")
    return path.read_bytes()


def test_a_step_file_that_crashes_its_reader_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = a_box(tmp_path, "step")
    # an entity of an unknown name: Open CASCADE follows the reference to it into nothing
    path = tmp_path / "my.step"
    path.write_bytes(content.replace(b"= DIRECTION(", b"= DIRCTION("))
    said = command(["hull", str(path), "--length", "100", "--draft", "6"], capsys)
    assert "my.step" in said and "save it again" in said


@pytest.mark.parametrize(
    ("does", "said"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "broke down"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGXCPU)", "did not end"),
        ("print('no answer')", "broke down"),
        ("raise SystemExit(1)", "broke down"),
    ],
)
def test_whatever_becomes_of_the_reader_is_said(
    does: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(apart, "own_python", lambda _module: ([sys.executable, "-S", "-c", does], None))
    path = tmp_path / "my.3dm"
    path.write_bytes(b"3D Geometry File Format")
    with pytest.raises(InputError, match=said):
        apart.read_apart(path)


def test_a_reader_that_hangs_over_a_small_file_is_ended_soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hangs = (
        "import itertools, sys; from pathlib import Path; from hpsop_core.geometry.foreign import child;"
        "child._reader = lambda suffix: lambda path: [0 for _ in itertools.count() if False];"
        "child.main(Path(sys.argv[1]), float(sys.argv[2]))"
    )
    environment = apart.own_python("any")[1]
    monkeypatch.setattr(apart, "own_python", lambda _module: ([sys.executable, "-c", hangs], environment))
    path = tmp_path / "my.3dm"
    path.write_bytes(b"3D Geometry File Format")
    with pytest.raises(InputError, match=r"did not end within 1\.2 s of work"):
        apart.read_apart(path)


@pytest.mark.soak
@pytest.mark.parametrize("suffix", ["3dm", "step", "iges"])
def test_fuzz_surfaces_at_length(suffix: str, tmp_path: Path) -> None:
    """A process each: some hundred examples."""

    @settings(SOAK, max_examples=400, suppress_health_check=list(HealthCheck))
    @given(mutated(a_box(tmp_path, suffix)) | st.binary(max_size=300))
    def run(content: bytes) -> None:
        path = tmp_path / f"my.{suffix}"
        path.write_bytes(content)
        refused(lambda: load_hull(path, length=100.0, draft=6.0, unit="m"))

    run()
