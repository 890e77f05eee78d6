"""Text and markup told apart by type: a ``str`` is text and is escaped, a ``Markup`` is markup and is not.

Names of cases, runs and designs, descriptions, paths and reasons of failures come from files that anyone may have
written. Whatever builds HTML or SVG therefore returns ``Markup`` and puts text in through this module:

    >>> fill("<b>{}</b>", "<script>")
    Markup('<b>&lt;script&gt;</b>')
    >>> joined([fill("<td>{}</td>", value) for value in ("a & b", fill("<i>{}</i>", "c"))])
    Markup('<td>a &amp; b</td><td><i>c</i></td>')

An f-string of markup is a ``str`` again, so forgetting this shows as escaped tags on the page and never as a script
that runs.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from string import Formatter

from markupsafe import Markup, escape

__all__ = ["Markup", "escape", "fill", "joined", "one_line", "symbol_html", "symbol_plain", "symbol_svg", "xml_text"]

# What XML 1.0 does not allow in a document, not even escaped (section 2.2, "Char").
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")

# Their text has nothing to escape; a number's format refuses text in either way.
_HARMLESS = frozenset({Markup, int, float, bool})
_NUMBER = re.compile(r"|[+,]*(?:\.\d+)?[defg%]")


def fill(template: str, *values: object, **named: object) -> Markup:
    """Values put into the places ``{}`` or ``{name}`` of a template: each is escaped unless it is markup.

    Args:
        template: markup as the programmer wrote it, never text from outside. It is Python's format text: a brace of the
            markup itself is doubled.
        values, named: what goes in; a format like ``{:.1f}`` works for numbers.
    """
    if named or not _is_plain(template):
        return Markup(template).format(*values, **named)
    prepared: list[object] = []
    for value in values:
        kind = type(value)
        if kind is str:
            prepared.append(escape(value))
        elif kind in _HARMLESS:
            prepared.append(value)
        else:
            return Markup(template).format(*values)
    # To the same text as markupsafe's own, which parses the template anew each time: most of what drawing a page costs.
    return Markup(template.format(*prepared))


@lru_cache(maxsize=4096)
def _is_plain(template: str) -> bool:
    """Whether a template's places ask for a value as it is or as a number, and for nothing else of it."""
    return all(
        name is None or ((name.isdecimal() or not name) and not conversion and _NUMBER.fullmatch(form or ""))
        for _, name, form, conversion in Formatter().parse(template)
    )


def joined(parts: Iterable[object], separator: str = "") -> Markup:
    """Parts in a row: each is escaped unless it is markup.

    Args:
        parts: text or markup.
        separator: markup as the programmer wrote it, for example "<br>".
    """
    return Markup(separator.join([escape(part) for part in parts]))


def one_line(value: object) -> Markup:
    """Text whose line ends and runs of blanks are single blanks, escaped."""
    return escape(" ".join(str(value).split()))


def xml_text(document: str) -> str:
    """A document without the characters that XML forbids (most control characters): U+FFFD stands in their place."""
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", document)


def _symbol_parts(text: str) -> list[tuple[str, str]]:
    """("R", "T1"), (" [kN]", "") from "R_T1 [kN]": an underscore makes a subscript of what follows, up to a blank."""
    pieces = re.split(r"_([^\s,;:)\]]+)", text)
    return list(zip(pieces[::2], [*pieces[1::2], ""], strict=True))


def symbol_html(text: str) -> Markup:
    """A quantity's symbol with its subscripts, for HTML: R_T1 as R with T1 below."""
    return joined(escape(base) + (fill("<sub>{}</sub>", below) if below else "") for base, below in _symbol_parts(text))


def symbol_svg(text: str) -> Markup:
    """The same inside an SVG text; after a subscript the pen returns to the line."""
    drawn: list[Markup] = []
    lowered = False
    for base, below in _symbol_parts(text):
        if base:
            drawn.append(fill('<tspan dy="-3">{}</tspan>', base) if lowered else escape(base))
            lowered = False
        if below:
            drawn.append(fill('<tspan class="sub" dy="3">{}</tspan>', below))
            lowered = True
    return joined(drawn)


def symbol_plain(text: str) -> str:
    """The same as plain text, for tooltips and file headers, which know no subscripts."""
    return "".join(base + below for base, below in _symbol_parts(text))
