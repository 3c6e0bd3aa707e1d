"""What things look like in a timeline: each sort has a colour (page.css) and mostly a symbol.

Colours are those of Okabe and Ito (Color Universal Design, 2008), which people with all common
kinds of colour vision tell apart; no meaning rests on colour alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from woz_tui.analysis.html.markup import Markup, joined, tag


@dataclass(frozen=True, slots=True)
class ItemStyle:
    """`title` stands in the legend; `path` is a symbol in a field from -6 to 6, empty: none."""

    title: str
    path: str = ""


_CROSS = "M-4-5L0-1L4-5L5-4L1 0L5 4L4 5L0 1L-4 5L-5 4L-1 0L-5-4Z"

#: In the order of the legend.
SORTS: dict[str, ItemStyle] = {
    "done": ItemStyle("done"),
    "failed": ItemStyle("failed", _CROSS),
    "stopped": ItemStyle("stopped or replaced", "M-4-4H4V4H-4Z"),
    "refused": ItemStyle("refused", "M0-5A5 5 0 1 0 0 5A5 5 0 1 0 0-5ZM-3.5-1H3.5V1H-3.5Z"),
    "open": ItemStyle(
        "no end in the log", "M-5-1.2H-2.6V1.2H-5ZM-1.2-1.2H1.2V1.2H-1.2ZM2.6-1.2H5V1.2H2.6Z"
    ),
    "trial": ItemStyle("trial"),
    "left-out": ItemStyle("left out: not counted", "M-5-1.2H5V1.2H-5Z"),
    "phase": ItemStyle("phase"),
    "break": ItemStyle("break"),
    "engaged": ItemStyle("visitor engaged"),
    "state": ItemStyle("other state"),
    "speech": ItemStyle("visitor speaks"),
    "stop": ItemStyle("stop", "M-2.4-5.6H2.4L5.6-2.4V2.4L2.4 5.6H-2.4L-5.6 2.4V-2.4Z"),
    "lost": ItemStyle("driver lost", "M1-6L-4 1H-0.5L-1 6L4-1.4H0.5Z"),
    "differing": ItemStyle("setting differs", "M-5-3.5H5V-1H-5ZM-5 1H5V3.5H-5Z"),
    "marker": ItemStyle("marker", "M-5-5H5L0 5Z"),
    "note": ItemStyle("note", "M-5-5H5V3H0L-3 6V3H-5Z"),
    "mistake": ItemStyle("mistake", f"M-6-6H6V6H-6Z{_CROSS}"),
    "questionnaire": ItemStyle("questionnaire", "M0-5.5L5.5 0L0 5.5L-5.5 0Z"),
    "console-lost": ItemStyle("console lost", "M-6-5H6V4H1.5V6H-1.5V4H-6ZM-4-3V2H4V-3Z"),
    "other": ItemStyle("other", "M-3-3H3V3H-3Z"),
}


def symbols() -> Markup:
    """All symbols, to be referred to as `#g-<sort>` from anywhere in the page."""
    drawn = [
        tag(
            "symbol",
            tag("path", d=style.path, fill_rule="evenodd"),
            id=f"g-{name}",
            viewBox="-6 -6 12 12",
        )
        for name, style in SORTS.items()
        if style.path
    ]
    return tag("svg", tag("defs", joined(drawn)), class_="unseen", aria_hidden="true")


@cache
def swatch(sort: str) -> Markup:
    """A small picture of the sort, for tables and legends."""
    if SORTS[sort].path:
        shape = tag(
            "use", href=f"#g-{sort}", x=-5.5, y=-5.5, width=11, height=11, class_=f"glyph s-{sort}"
        )
    else:
        shape = tag("rect", x=-7, y=-5, width=14, height=10, rx=2, class_=f"bar s-{sort}")
    return tag("svg", shape, class_="swatch", viewBox="-8 -7 16 14", aria_hidden="true")
