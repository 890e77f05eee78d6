"""Names and reasons come from files that anyone may have written: on the page they are text, whatever they say."""

from __future__ import annotations

import pytest

from explorer.server.bridge import overlay, tooltip
from explorer.views.chips import box, chip, soft
from hpsop_core.markup import Markup, fill

HOSTILE = "\"><img src=x onerror='alert(1)'>&"
INERT = "&#34;&gt;&lt;img src=x onerror=&#39;alert(1)&#39;&gt;&amp;"


@pytest.mark.parametrize(
    "markup",
    [
        chip("tab", HOSTILE),
        chip("tab", "word", arg=HOSTILE),
        chip("tab", "word", hint=HOSTILE),
        soft(HOSTILE),
        box(fill("<b>{}</b>", HOSTILE)),
        overlay("card", fill("{}", HOSTILE)),
        tooltip(HOSTILE, Markup(""), 1),
    ],
)
def test_text_is_inert_in_every_piece(markup: Markup):
    assert INERT in markup and "<img src" not in markup
