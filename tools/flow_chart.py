"""A flow chart of the documentation, written as mermaid's text, as an SVG picture that needs no script."""

from __future__ import annotations

import re
from html import escape


def flow_chart(text: str) -> str:
    """A flow chart from the bottom upwards (mermaid's ``flowchart BT``) as SVG: boxes in rows, arrows between.

    Each row holds what all its arrows reach; labels are the first words of a box and a line of explanation.
    """
    labels: dict[str, list[str]] = {}
    arrows: list[tuple[str, str]] = []
    for line in text.splitlines()[1:]:
        names = re.findall(r"(\w+)(?:\[\"(.*?)\"\])?(?:\s|$)", line)
        for name, label in names:
            if label or name not in labels:
                labels[name] = (label or name).split("<br/>")
        if "-->" in line:
            arrows.append((names[0][0], names[-1][0]))
    rows = dict.fromkeys(labels, 0)
    for _ in labels:
        for below, above in arrows:
            rows[above] = max(rows[above], rows[below] + 1)
    last = max(rows.values())
    width, tall, step = 1000.0, 46.0, 84.0
    centre: dict[str, tuple[float, float]] = {}
    shapes = []
    for row in range(last + 1):
        names_here = [name for name in labels if rows[name] == row]
        room = width / len(names_here)
        for place, name in enumerate(names_here):
            x, y = room * (place + 0.5), step * (last - row) + 0.5 * tall + 2.0
            centre[name] = (x, y)
            lines = labels[name]
            wide = min(room - 16.0, 7.2 * max(len(line) for line in lines) + 20.0)
            shapes.append(
                f'<rect x="{x - 0.5 * wide:.1f}" y="{y - 0.5 * tall:.1f}" width="{wide:.1f}" height="{tall}" rx="6"/>'
            )
            for number, line in enumerate(lines):
                base = y + 5.0 + 17.0 * (number - 0.5 * (len(lines) - 1))
                weight = "bold" if number == 0 else "normal"
                shapes.append(
                    f'<text x="{x:.1f}" y="{base:.1f}" font-weight="{weight}" textLength="{wide - 20.0:.1f}" '
                    f'lengthAdjust="spacingAndGlyphs">{escape(line)}</text>'
                    if 7.2 * len(line) > wide - 20.0
                    else f'<text x="{x:.1f}" y="{base:.1f}" font-weight="{weight}">{escape(line)}</text>'
                )
    lines = [
        f'<line x1="{centre[a][0]:.1f}" y1="{centre[a][1] - 0.5 * tall:.1f}" x2="{centre[b][0]:.1f}" '
        f'y2="{centre[b][1] + 0.5 * tall + 3.0:.1f}" marker-end="url(#tip)"/>'
        for a, b in arrows
    ]
    return (
        # a block of HTML, which Markdown leaves alone
        f'<div><svg viewBox="0 0 {width:g} {step * last + tall + 4.0:g}" role="img" aria-label="flow chart" '
        'style="width:100%;font:13px sans-serif;text-anchor:middle">'
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
        '<path d="M0 0L8 4L0 8z" fill="currentColor"/></marker></defs>'
        f'<g stroke="currentColor" stroke-opacity=".45">{"".join(lines)}</g>'
        f'<g fill="var(--md-default-bg-color)" stroke="currentColor">{"".join(s for s in shapes if s[1] == "r")}</g>'
        f'<g fill="currentColor">{"".join(s for s in shapes if s[1] == "t")}</g></svg></div>'
    )
