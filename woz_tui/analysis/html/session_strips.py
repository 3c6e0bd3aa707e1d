"""All sessions of a page one above the other, on one scale of time: who did how much, when."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.analysis.html.markup import Markup, joined, short, tag
from woz_tui.analysis.html.timeline_items import TimelineRow
from woz_tui.analysis.html.timeline_picture import PictureScale
from woz_tui.analysis.timeline_lanes import LANES

_WIDTH, _BAND = 1000, 6
#: Bands of a strip, from the top: which sorts of lanes they show.
_BANDS = (("trial", "stop", "driver"), ("engagement",), ("speech",), ("panel",))
_ABOVE = {"stop", "lost", "failed"}

assert {lane for band in _BANDS for lane in band} <= set(LANES)


def strip(lanes: Sequence[TimelineRow], duration_us: int, longest_us: int, title: str) -> Markup:
    """One session; `longest_us` is how long the longest on the page lasts."""
    scale = PictureScale(longest_us, 0, _WIDTH)
    height = len(_BANDS) * _BAND
    back = tag("rect", x=0, y=0, width=scale.x(duration_us), height=height, class_="back")
    bands = [_band(lanes, sorts, place * _BAND, scale) for place, sorts in enumerate(_BANDS)]
    return tag(
        "svg",
        back,
        bands,
        class_="strip",
        viewBox=f"0 0 {_WIDTH} {height}",
        role="img",
        aria_label=f"Course of {title}",
    )


def ruler(longest_us: int) -> Markup:
    """The scale above the strips."""
    scale = PictureScale(longest_us, 0, _WIDTH)
    ticks = [
        tag("text", text, x=x, y=8, class_="tick" if x else "tick first")
        for x, text in scale.ticks()
        if x < _WIDTH - 20
    ]
    return tag("svg", ticks, class_="strip", viewBox=f"0 0 {_WIDTH} 14", aria_hidden="true")


def _band(
    lanes: Sequence[TimelineRow], sorts: Sequence[str], y: float, scale: PictureScale
) -> Markup:
    """One path for each look; a pixel is drawn once, however much happened in it."""
    paths: dict[str, list[str]] = {}
    reached: dict[str, float] = {}
    for item in (item for row in lanes if row.sort in sorts for item in row.items):
        x0 = max(scale.x(item.begin), reached.get(item.sort, 0))
        x1 = max(scale.x(item.begin if item.end is None else item.end), scale.x(item.begin) + 1)
        if x1 - x0 < 0.3:
            continue
        reached[item.sort] = x1
        box = f"M{short(x0)} {short(y + 0.5)}H{short(x1)}v{_BAND - 1}H{short(x0)}z"
        paths.setdefault(item.sort, []).append(box)
    # What went wrong is drawn last, on top of what did not.
    order = sorted(paths, key=lambda sort: sort in _ABOVE)
    return joined(tag("path", d="".join(paths[sort]), class_=f"bar s-{sort}") for sort in order)
