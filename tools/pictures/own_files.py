"""The pictures of docs/bring-your-ship.md, as `hpsop hull` and `hpsop propeller` draw them.

python -m tools.pictures.own_files --to docs/pictures
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from hpsop_core.assets import asset_path
from hpsop_core.charts.own_files import hull_sheet, propeller_sheet
from hpsop_core.charts.raster import png_of
from hpsop_core.geometry.hull.input import ReadOptions, read_hull
from hpsop_core.geometry.propeller.input import read_propeller
from tools.pictures.command import write_pictures

DATA = Path(__file__).resolve().parents[2] / "tests" / "data" / "hulls"


def _hull(name: str, options: ReadOptions) -> Callable[[Path], None]:
    return lambda file: _save(hull_sheet(read_hull(DATA / name, options)), file)


def _propeller(file: Path) -> None:
    _save(propeller_sheet(read_propeller(asset_path("propellers", "p4119.csv"), 3)), file)


def _save(svg: str, file: Path) -> None:
    file.write_bytes(png_of(svg, scale=1.2))


PICTURES = {
    "own-hull-series-60.png": _hull("s60_cb060.csv", ReadOptions(length=121.92)),
    "own-hull-kvlcc2.png": _hull("kvlcc2.csv", ReadOptions(length=320.0, draft=20.8)),
    "own-propeller.png": _propeller,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write every picture into a folder."""
    return write_pictures("Write the pictures of own files.", PICTURES, arguments)


if __name__ == "__main__":
    sys.exit(main())
