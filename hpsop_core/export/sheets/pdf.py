"""Sheets as PDF: one page each, lines and words as vectors at true size.

Written plainly (ISO 32000-1): a sheet is polylines and short words, for which no library is needed. Words are set in
Helvetica, which every reader has and no file need hold.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence

from hpsop_core.export.sheets.paper import HEIGHT, LAYERS, WIDTH, Sheet

_POINTS = 72.0 / 25.4  # of a millimetre
_LETTERS = {"narrow": "ijl.,:;'|! ()[]/ftrI", "wide": "mwMW@%", "capital": "ABCDEFGHKLNOPQRSTUVXYZ&+=<>~"}
_WIDTHS = {"narrow": 0.28, "wide": 0.85, "capital": 0.68}
_WIDTH = 0.55  # of all others, digits among them (0.556)


def text_width(text: str, height: float) -> float:
    """About how wide a line of words is in Helvetica of that size (the em), in the same unit; for centring."""
    place = {letter: _WIDTHS[kind] for kind, letters in _LETTERS.items() for letter in letters}
    return height * sum(place.get(letter, _WIDTH) for letter in text)


def sheets_pdf(sheets: Sequence[Sheet], title: str) -> bytes:
    """The sheets as pages of one document at true size; the same bytes for the same sheets.

    Letters that Windows' Latin alphabet lacks become question marks.
    """
    # 1 catalogue, 2 pages, 3 font, 4 information, then a page and its content for every sheet
    kids = " ".join(f"{5 + 2 * number} 0 R" for number in range(len(sheets)))
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        f"<< /Type /Pages /Kids [{kids}] /Count {len(sheets)} >>".encode("ascii"),
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
        b"<< /Title " + _string(title) + b" /Producer (hpsop) >>",
    ]
    box = f"[0 0 {WIDTH * _POINTS:.3f} {HEIGHT * _POINTS:.3f}]"
    for number, sheet in enumerate(sheets):
        content = zlib.compress(_content(sheet), 9)
        objects.append(
            f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents {6 + 2 * number} 0 R "
            "/Resources << /Font << /F 3 0 R >> >> >>".encode("ascii")
        )
        head = f"<< /Length {len(content)} /Filter /FlateDecode >>\nstream\n".encode("ascii")
        objects.append(head + content + b"\nendstream")
    body = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n"
    places = []
    for number, item in enumerate(objects, start=1):
        places.append(len(body))
        body += f"{number} 0 obj\n".encode("ascii") + item + b"\nendobj\n"
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    tail = (
        f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}"
        f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R /Info 4 0 R >>\nstartxref\n{len(body)}\n%%EOF\n"
    )
    return body + tail.encode("ascii")


def _content(sheet: Sheet) -> bytes:
    # millimetres from the left lower corner, as the sheet counts; round caps and joins
    parts = [f"{_POINTS:.8f} 0 0 {_POINTS:.8f} 0 0 cm 1 J 1 j".encode("ascii")]
    layer = ""
    for name, points in sheet.lines:
        if name != layer:
            width, colour, _ = LAYERS[name]
            red, green, blue = (int(colour[place : place + 2], 16) / 255.0 for place in (1, 3, 5))
            parts.append(f"{width:g} w {red:.3f} {green:.3f} {blue:.3f} RG".encode("ascii"))
            layer = name
        line = "".join(f"{x:.3f} {y:.3f} {'m' if n == 0 else 'l'} " for n, (x, y) in enumerate(points.tolist()))
        parts.append(f"{line}S".encode("ascii"))
    for x, y, height, text, place in sheet.words:
        size = 1.35 * height
        left = x - 0.5 * text_width(text, size) if place == "middle" else x
        parts.append(f"BT /F {size:g} Tf {left:.3f} {y:.3f} Td ".encode("ascii") + _string(text) + b" Tj ET")
    return b"\n".join(parts)


def _string(text: str) -> bytes:
    encoded = text.encode("cp1252", errors="replace")
    for sign in (b"\\", b"(", b")"):
        encoded = encoded.replace(sign, b"\\" + sign)
    return b"(" + encoded.replace(b"\n", b" ").replace(b"\r", b" ") + b")"
