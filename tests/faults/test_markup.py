"""Text from outside stays text: it is escaped by its type, wherever it is put in."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest

from hpsop_core.markup import Markup, escape, fill, joined, one_line, symbol_html, symbol_plain, symbol_svg, xml_text

HOSTILE = [
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "' onmouseover='alert(1)",
    "</text></svg><script>",
    "&lt;b&gt;",
    "{0.__class__} {} {name}",
    "R_<b> [kN]",
]


class Reader(HTMLParser):
    """Collects the tags, attributes and words of a document."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.words = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data: str) -> None:
        self.words += data


def read(source: str) -> Reader:
    reader = Reader()
    reader.feed(str(source))
    reader.close()
    return reader


@pytest.mark.parametrize("text", HOSTILE)
def test_text_comes_out_as_it_went_in_and_makes_no_tag(text: str):
    page = read(fill('<p title="{}">{}</p>', text, text))
    assert page.tags == ["p"]
    assert page.attributes == [("title", text)]
    assert page.words == text
    assert read(joined([text, fill("<b>{}</b>", text)], "<br>")).tags == ["br", "b"]
    assert read(symbol_html(text)).tags in ([], ["sub"])
    assert read(symbol_html(text)).words == symbol_plain(text)
    assert set(read(symbol_svg(text)).tags) <= {"tspan"}
    assert read(one_line(text)).words == text


def test_markup_is_not_escaped_twice():
    inner = fill("<b>{}</b>", "a & b")
    assert fill("<p>{}</p>", inner) == "<p><b>a &amp; b</b></p>"
    assert escape(inner) is inner or escape(inner) == inner
    assert isinstance(fill("<p>{}</p>", inner), Markup) and isinstance(joined([inner]), Markup)


def test_an_f_string_is_text_again():
    # the slip that matters: what comes of it is ugly and harmless
    slip = f"<p>{fill('<b>{}</b>', 'x')}</p>"
    assert not isinstance(slip, Markup)
    assert read(fill("<div>{}</div>", slip)).tags == ["div"]


def test_numbers_keep_their_format():
    assert fill('<rect x="{:.1f}" y="{y:g}"/>', 1.26, y=2.5) == '<rect x="1.3" y="2.5"/>'


def test_line_ends_become_blanks():
    assert one_line("a\n  b\r\n<c>") == "a b &lt;c&gt;"


def test_control_characters_do_not_break_xml():
    assert xml_text("a\x1b[31m\x00b\tc\nd") == "a\ufffd[31m\ufffdb\tc\nd"


def test_symbols_are_set_with_their_subscripts():
    assert symbol_html("R_T1 [kN]") == "R<sub>T1</sub> [kN]"
    assert symbol_html("K_T, 10K_Q") == "K<sub>T</sub>, 10K<sub>Q</sub>"
    assert symbol_plain("K_T, 10K_Q") == "KT, 10KQ"
    # after a subscript the pen returns to the line
    assert symbol_svg("C_B [–]") == 'C<tspan class="sub" dy="3">B</tspan><tspan dy="-3"> [–]</tspan>'


@pytest.mark.parametrize(
    ("template", "values"),
    [
        ("<td>{}</td>{:.1f}", ("<a>", 2.55)),
        ("{0}{1}{0}", ("<", Markup("<i>"))),
        ("{{{}}}{:+,d}{:.1%}", (None, 12345, 0.5)),
        ("{:>5}{!r}", ("<", "<")),
        ("{}", (Path("<folder>"),)),
    ],
)
def test_the_quick_way_writes_what_markupsafe_writes(template: str, values: tuple[object, ...]):
    assert fill(template, *values) == Markup(template).format(*values)
    assert isinstance(fill(template, *values), Markup)
