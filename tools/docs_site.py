"""What the documentation's site has beside the files of docs/: a hook of mkdocs (mkdocs.yml names it).

Pages made from the code or from files elsewhere in the tree: the commands' own help, the notebooks, CONTRIBUTING,
CHANGELOG and SECURITY. Flow charts are drawn here: what draws them elsewhere is fetched by the reader's browser.
`make docs` builds the site; tests/regression/test_docs.py holds the links.
"""

from __future__ import annotations

import argparse
import json
import os
import re
from pathlib import Path
from typing import Any

from tools.flow_chart import flow_chart

ROOT = Path(__file__).resolve().parents[1]
FROM_ELSEWHERE = {
    name: ROOT / f"{Path(name).stem.upper()}.md" for name in ("changelog.md", "contributing.md", "security.md")
}
NOTEBOOKS = ROOT / "examples" / "notebooks"


def generated_pages() -> dict[str, str]:
    """Markdown of each page that is not a file of docs/, by its path on the site."""
    pages = {name: from_the_root(path.read_text(encoding="utf-8")) for name, path in FROM_ELSEWHERE.items()}
    pages["commands.md"] = commands_page()
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        pages[f"notebooks/{path.stem}.md"] = notebook_page(path)
    return pages


def from_the_root(text: str) -> str:
    """Text of a file of the root, its links as they are on the site: (docs/page.md) and (CHANGELOG.md)."""
    text = text.replace("](docs/", "](")
    return re.sub(r"\]\(([A-Z]+)\.md\)", lambda found: f"]({found[1].lower()}.md)", text)


def commands_page() -> str:
    """Every command with its own help, as ``--help`` prints it."""
    from hpsop_core.cli.main import build_parser

    # argparse breaks lines at the width of the terminal, wherever the site is built
    before, os.environ["COLUMNS"] = os.environ.get("COLUMNS"), "100"
    try:
        (choices,) = (
            action.choices for action in build_parser()._actions if isinstance(action, argparse._SubParsersAction)
        )
        parts = [
            "# Commands\n\nWhat each prints with `--help`. `hpsop-explore` opens [the page](page.md). Bad input ends "
            "with status 2 and one line that says what, where and what to do; `--json` prints one JSON document on "
            "standard output and everything else on standard error.\n"
        ]
        parts += [
            f"\n## hpsop {name}\n\n```text\n{parser.format_help().strip()}\n```\n" for name, parser in choices.items()
        ]
    finally:
        if before is None:
            del os.environ["COLUMNS"]
        else:
            os.environ["COLUMNS"] = before
    return "".join(parts)


def notebook_page(path: Path) -> str:
    """A notebook's words and code as one page."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
    parts.append(f"*The notebook itself: `{path.relative_to(ROOT).as_posix()}`; a test runs it from top to bottom.*")
    return "\n\n".join(parts) + "\n"


def on_files(files: Any, config: Any) -> Any:
    """mkdocs asks which files there are."""
    from mkdocs.structure.files import File

    for name, text in generated_pages().items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """mkdocs asks what a page says."""
    return re.sub(r"```mermaid\n(.*?)```", lambda found: flow_chart(found[1]), markdown, flags=re.DOTALL)
