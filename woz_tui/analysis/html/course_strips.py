"""The courses of sessions, each on a strip; all strips of a page have one scale."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_tui.analysis.html.markup import Markup, short, tag
from woz_tui.analysis.html.session_section import SessionEntry
from woz_tui.analysis.html.timeline_items import TimelineRow
from woz_tui.analysis.html.timeline_picture import PictureScale
from woz_tui.analysis.timeline_lanes import LANES

_WIDTH, _BAND = 1000, 6
#: Bands of a strip, from the top: which sorts of lanes they show.
_BANDS = (("trial", "stop", "driver"), ("engagement",), ("speech",), ("panel",))
_ABOVE = {"stop", "lost", "failed"}
#: A piece that is narrower than this, in pixels, is not drawn.
_LEAST = 0.3

assert {lane for band in _BANDS for lane in band} <= set(LANES)


@dataclass(frozen=True, slots=True)
class Course:
    """What a strip shows of a session: of each band, by the sort of what happened, begin and end of
    each piece one after the other. A pixel is kept once, however much happened in it.
    """

    duration_us: int
    bands: Sequence[Mapping[str, array[int]]]

    @classmethod
    def of_entry(cls, entry: SessionEntry) -> Course:
        """The course of a session on a page."""
        return cls.of(entry.lanes, entry.timeline.duration_us)

    @classmethod
    def of(cls, lanes: Sequence[TimelineRow], duration_us: int) -> Course:
        """The course of a session that lasted so long."""
        scale = PictureScale(duration_us, 0, _WIDTH)
        return cls(duration_us, [_band(lanes, sorts, scale) for sorts in _BANDS])

    def strip(self, longest_us: int, title: str) -> Markup:
        """The picture; `longest_us` is the length of the longest session on the page."""
        scale = PictureScale(longest_us, 0, _WIDTH)
        height = len(_BANDS) * _BAND
        back = tag("rect", x=0, y=0, width=scale.x(self.duration_us), height=height, class_="back")
        # What went wrong is drawn last, on top of what did not.
        paths = [
            tag("path", d=_path(band[sort], place * _BAND, scale), class_=f"bar s-{sort}")
            for place, band in enumerate(self.bands)
            for sort in sorted(band, key=lambda sort: sort in _ABOVE)
        ]
        return tag(
            "svg",
            back,
            paths,
            class_="strip",
            viewBox=f"0 0 {_WIDTH} {height}",
            role="img",
            aria_label=f"Course of {title}",
        )


def _band(
    lanes: Sequence[TimelineRow], sorts: Sequence[str], scale: PictureScale
) -> dict[str, array[int]]:
    found: dict[str, array[int]] = {}
    reached: dict[str, float] = {}
    for item in (item for row in lanes if row.sort in sorts for item in row.items):
        end = item.begin if item.end is None else item.end
        x1 = max(scale.x(end), scale.x(item.begin) + 1)
        if x1 - max(scale.x(item.begin), reached.get(item.sort, 0)) < _LEAST:
            continue
        reached[item.sort] = x1
        found.setdefault(item.sort, array("q")).extend((item.begin, end))
    return found


def _path(pieces: array[int], y: float, scale: PictureScale) -> str:
    """Boxes, as few as can be told apart on this scale."""
    boxes, reached = [], 0.0
    for begin, end in zip(pieces[::2], pieces[1::2], strict=True):
        x0 = max(scale.x(begin), reached)
        x1 = max(scale.x(end), scale.x(begin) + 1)
        if x1 - x0 >= _LEAST:
            reached = x1
            boxes.append(f"M{short(x0)} {short(y + 0.5)}h{short(x1 - x0)}v{_BAND - 1}H{short(x0)}z")
    return "".join(boxes)


def ruler(longest_us: int) -> Markup:
    """The scale above the strips."""
    scale = PictureScale(longest_us, 0, _WIDTH)
    ticks = [
        tag("text", text, x=x, y=8, class_="tick" if x else "tick first")
        for x, text in scale.ticks()
        if x < _WIDTH - 20
    ]
    return tag("svg", ticks, class_="strip", viewBox=f"0 0 {_WIDTH} 14", aria_hidden="true")
