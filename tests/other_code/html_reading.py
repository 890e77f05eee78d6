"""A page read by Python's own HTML parser."""

from __future__ import annotations

from dataclasses import dataclass, field
from html.parser import HTMLParser

VOID = {"meta", "br", "link", "img", "input", "hr", "path", "use", "rect", "image"}


@dataclass
class Page(HTMLParser):
    """Sections, tables, ids, text and what is asked from elsewhere.

    Attributes:
        sections: ids of <section> in order.
        tables: section -> tables -> rows -> cells.
        ids: every id.
        fetched: values of attributes that would fetch something.
        words: the text of every section; "" holds the text before the first.
        figures: ids of <figure> that hold an <svg>.
    """

    sections: list[str] = field(default_factory=list)
    tables: dict[str, list[list[list[str]]]] = field(default_factory=dict)
    ids: list[str] = field(default_factory=list)
    fetched: list[str] = field(default_factory=list)
    words: dict[str, str] = field(default_factory=lambda: {"": ""})
    figures: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()
        self._open: list[str] = []
        self._section, self._figure, self._cell = "", "", False

    def read(self, text: str) -> Page:
        self.feed(text)
        self.close()
        assert not self._open, f"never closed: {self._open}"
        return self

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        assert tag != "script"
        assert not any(name.startswith("on") for name in values)
        if "id" in values:
            self.ids.append(values["id"])
        for name in ("src", "href", "xlink:href", "data", "action"):
            if name in values and not values[name].startswith(("#", "data:image/png;base64,")):
                self.fetched.append(values[name])
        if tag == "section":
            self._section = values["id"]
            self.sections.append(self._section)
            self.words[self._section] = ""
            self.tables[self._section] = []
        if tag == "figure":
            self._figure = values["id"]
        if tag == "svg" and self._figure:
            self.figures.append(self._figure)
        if tag == "table":
            self.tables[self._section].append([])
        if tag == "tr":
            self.tables[self._section][-1].append([])
        if tag in ("td", "th"):
            self.tables[self._section][-1][-1].append("")
            self._cell = True
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self._open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag in VOID:
            return
        assert self._open and self._open.pop() == tag, f"</{tag}> closes something else"
        if tag == "figure":
            self._figure = ""
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data: str) -> None:
        if self._open and self._open[-1] == "style":
            assert "url(" not in data and "@import" not in data
            return
        data = data.replace("\xa0", " ")
        self.words[self._section] += data
        if self._cell:
            row = self.tables[self._section][-1][-1]
            row[-1] += data


def check(page: Page, source: str) -> None:
    """What holds of every page of ours."""
    assert not page.fetched, page.fetched
    assert "http" not in source.lower().replace("http-equiv", "")
    assert len(page.ids) == len(set(page.ids))
    shown = " ".join(page.words.values())
    for wrong in ("NaN", "nan ", "None", "inf ", "Traceback", "<built-in"):
        assert wrong not in shown, wrong
