"""The documentation says what is there: links lead somewhere, commands parse, Python compiles and finds its names.

`make docs` builds the site of it, strictly; the soak test builds it too and runs the tutorial.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import itertools
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from explorer.app import main as open_page
from hpsop_core.case.case import load_case
from hpsop_core.cli.main import build_parser
from tools.docs_site import generated_pages
from tools.flow_chart import flow_chart

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = {path.relative_to(DOCS).as_posix(): path.read_text(encoding="utf-8") for path in sorted(DOCS.rglob("*.md"))}
GENERATED = generated_pages()
SITE = PAGES | GENERATED
OF_THE_ROOT = {path.name: path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("*.md"))}
FENCED = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def prose(text: str) -> str:
    """Without code, in which brackets are no links and signs no lists."""
    return re.sub(r"`[^`\n]+`", "code", FENCED.sub("", text))


def anchors(text: str) -> set[str]:
    """As both a repository's view and the site make them of headings."""
    titles = re.findall(r"^#+ +(.+)$", FENCED.sub("", text), re.MULTILINE)
    return {re.sub(r"[\s]+", "-", re.sub(r"[^\w\s-]", "", title.lower()).strip()) for title in titles}


def broken(pages: dict[str, str], folder: Path) -> list[str]:
    found = []
    for name, text in pages.items():
        for target in re.findall(r"\]\(([^)\s]+)\)", prose(text)):
            path, _, anchor = target.partition("#")
            if path.startswith(("http://", "https://", "mailto:")):
                continue
            here = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            there = here in pages or (folder / here).exists()
            if not there or (anchor and anchor not in anchors(pages.get(here, ""))):
                found.append(f"{name}: {target}")
    return found


def test_links_lead_somewhere() -> None:
    assert broken(SITE, DOCS) == []
    assert broken(OF_THE_ROOT, ROOT) == []
    # what is not on the site must not be needed by a page that is read in the repository
    assert broken(PAGES, DOCS) == []


def test_a_link_that_leads_nowhere_is_found() -> None:
    pages = {"a.md": "[b](b.md) [c](b.md#here) [d](b.md#there) [e](#top) `[f](no.md)`\n", "b.md": "# Here\n"}
    assert broken(pages, DOCS) == ["a.md: b.md#there", "a.md: #top"]


def test_every_page_has_a_place_on_the_site_and_a_title() -> None:
    listed = re.findall(r": ([\w/-]+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(listed) == sorted(SITE)
    assert [name for name, text in SITE.items() if not text.startswith("# ")] == []


def test_lists_are_lists_on_the_site_too() -> None:
    """The site's Markdown wants an empty line before a list that follows a paragraph."""
    found = []
    for name, text in SITE.items():
        lines = prose(text).splitlines()
        for before, line in itertools.pairwise(lines):
            if (
                re.match(r"(?:[*+-]|\d+\.) ", line)
                and before.strip()
                and not re.match(r"\s|(?:[*+-]|\d+\.) |#", before)
            ):
                found.append(f"{name}: {line[:60]}")
    assert found == []


def commands() -> list[tuple[str, str]]:
    return [
        (name, line.split("  #")[0].strip())
        for name, text in {**PAGES, "README.md": OF_THE_ROOT["README.md"]}.items()
        for _, block in FENCED.findall(text)
        for line in block.splitlines()
        if re.match(r"(?:hpsop|hpsop-explore)(?: |$)", line)
    ]


def test_commands_parse() -> None:
    found = commands()
    assert len(found) > 30
    parser = build_parser()
    for _, line in found:
        words = shlex.split(line)
        if words[0] == "hpsop":
            assert callable(parser.parse_args(words[1:]).handler), line


def test_options_that_the_docs_name_are_options(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        open_page(["--help"])
    known = set(re.findall(r"--[a-z][a-z-]+", GENERATED["commands.md"] + capsys.readouterr().out))
    for name, text in PAGES.items():
        for line in re.findall(r"`hpsop[^`\n]*`", text):
            assert set(re.findall(r"--[a-z][a-z-]+", line)) <= known | {"--version"}, (name, line)


def test_targets_of_make_are_there() -> None:
    targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = {word for text in (SITE | OF_THE_ROOT).values() for word in re.findall(r"`make ([a-z-]+)(?=[ `])", text)}
    assert len(named) > 5 and named <= targets


def test_python_of_the_docs_compiles_and_finds_its_names() -> None:
    blocks = [(name, code) for name, text in SITE.items() for kind, code in FENCED.findall(text) if kind == "python"]
    assert len(blocks) > 10
    for name, code in blocks:
        for node in ast.walk(ast.parse(code, name)):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("hpsop_core"):
                module = importlib.import_module(node.module)
                assert all(hasattr(module, entry.name) for entry in node.names), (name, ast.unparse(node))


def test_modules_that_the_reference_describes_are_there() -> None:
    named = re.findall(r"^::: ([\w.]+)$", PAGES["python.md"], re.MULTILINE)
    assert len(named) > 20
    for path in named:
        try:
            importlib.import_module(path)
        except ModuleNotFoundError:
            module, _, thing = path.rpartition(".")
            assert hasattr(importlib.import_module(module), thing), path


def test_the_reference_describes_the_whole_interface() -> None:
    import hpsop_core

    homes = {getattr(hpsop_core, name) for name in hpsop_core.__all__ if not name.startswith("__")}
    text = PAGES["python.md"]
    other = {"export": "export_design", "report": "write_report"}
    for name in hpsop_core.__all__:
        if not name.startswith("__"):
            assert re.search(rf"^::: hpsop_core\.[\w.]+\.{other.get(name, name)}$", text, re.MULTILINE), name
    assert len(homes) > 10


def test_toml_of_the_docs_is_toml_of_a_case() -> None:
    known = tomllib.loads(load_case("dtc-p4119").to_toml())
    for name, text in PAGES.items():
        for kind, block in FENCED.findall(text):
            if kind == "toml":
                assert set(tomllib.loads(block)) <= {*known, "bounds"}, name


def test_the_paper_cites_what_it_lists_and_nothing_else() -> None:
    text = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    listed = re.findall(r"^@\w+\{(\w+),", (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE)
    cited = set(re.findall(r"@(\w+)", text))
    assert len(listed) == len(set(listed)) > 10 and cited == set(listed)
    # what the journal asks for
    titles = re.findall(r"^# (.+)$", text, re.MULTILINE)
    assert {"Summary", "Statement of need", "State of the field", "Software design", "References"} <= set(titles)
    assert 750 < len(text.split("---", 2)[2].split()) < 1750


def test_a_flow_chart_has_its_boxes_and_arrows_in_rows() -> None:
    drawn = flow_chart('flowchart BT\n  a["one<br/>first"] --> b\n  a --> c["<&>"]\n  b["two"] --> c\n')
    assert drawn.count("<rect") == 3 and drawn.count("<line") == 3
    assert ">one</text>" in drawn and ">first</text>" in drawn and "&lt;&amp;&gt;" in drawn
    heights = dict(zip(("a", "b", "c"), re.findall(r'<rect x="[\d.]+" y="([\d.]+)"', drawn)[::-1], strict=True))
    assert len(set(heights.values())) == 3


@pytest.mark.soak
def test_the_site_is_built_and_asks_nobody(tmp_path: Path) -> None:
    if importlib.util.find_spec("mkdocs") is None:
        pytest.skip("mkdocs is not installed: make docs")
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")]
    subprocess.run(words, cwd=ROOT, check=True, capture_output=True)
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > len(SITE)
    for page in pages:
        text = page.read_text(encoding="utf-8")
        fetched = re.findall(r'<(?:script|link|img|iframe)[^>]*(?:src|href)="?(https?:[^"\s>]+)', text)
        assert [url for url in fetched if 'rel="canonical"' not in url] == [], page
        assert "mermaid" not in text, page


@pytest.mark.soak
def test_the_tutorial_works(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry)}
    ours = [line for name, line in commands() if name == "tutorial.md" and line.startswith("hpsop ")]
    assert len(ours) >= 7
    for line in ours:
        words = shlex.split(line)[1:]
        done = subprocess.run(
            [sys.executable, "-m", "hpsop_core.cli", *words],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            env=environment,
        )
        assert done.returncode == 0, (line, done.stderr)
        if "blade_count=6" in line:
            assert "NOT feasible" in done.stdout and "engine +0.07" in done.stdout
    assert (tmp_path / "report.html").is_file() and (tmp_path / "folder" / "design.3dm").is_file()
