"""A session's timeline in a terminal: a row for each lane, a cell for each stretch of time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rich.text import Text

from woz_tui.analysis.text_format import clock
from woz_tui.analysis.timeline_lanes import Interval, TimelineDrawing, TimelineLane
from woz_tui.cli.report_layout import TextSigns

#: State -> how much goes on, a place in `TextSigns.levels`.
LEVELS = {
    "Wait": 0,
    "PersonDetected": 1,
    "EngagedWithUnknown": 2,
    "Handshake": 2,
    "EngagedWithKnown": 2,
    "UserSpeaks": 3,
    "RobotReplies": 3,
    "RobotSpeaks": 3,
    "RobotThinks": 4,
}
_LEVEL_NAMES = ("nobody", "somebody there", "engaged", "somebody speaks", "visitor waits")
_LEVEL_STYLES = ("dim", "blue", "cyan", "green", "bold yellow")
#: Seconds between two ticks.
_STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14_400, 43_200, 86_400)
#: The least room between two times on the axis.
_APART = 9
_NAMES_AT_MOST = 16
#: What is shown where several marks fall into one cell: the first of these. Its sign (or which of
#: the page's) and its style.
_MARKS = {
    "mistake": ("failed", "bold red"),
    "console lost": ("!", "yellow"),
    "marker": ("marker", "yellow"),
    "questionnaire": ("?", "cyan"),
    "note": ("note", ""),
}
#: Marks that the legend names, in its order.
_LEGEND = ("marker", "note", "questionnaire", "console lost")
#: Lanes whose intervals are filled with a sign.
_FILLED = {
    "stop": ("stop", "bold red"),
    "driver": ("lost", "red"),
    "setting": ("lost", "yellow"),
}


class _Cells(list[tuple[str, str]]):
    """A row being drawn: signs and their styles."""

    def put(self, at: int, sign: str, style: str = "") -> None:
        if 0 <= at < len(self):
            self[at] = sign, style


@dataclass(frozen=True, slots=True)
class CellScale:
    """Maps times to cells."""

    duration_us: int
    width: int

    def cell(self, t: int) -> int:
        """The cell of a moment: 0 to `width` - 1."""
        return min(self.width - 1, t * self.width // max(1, self.duration_us))

    def begins(self, cell: int) -> float:
        """The moment at which a cell begins."""
        return cell * self.duration_us / self.width

    def shares(self, interval: Interval) -> Iterator[tuple[int, float]]:
        """Cells that an interval touches, and how much of each it covers (0..1)."""
        long = max(1.0, self.duration_us / self.width)
        for cell in range(self.cell(interval.begin), self.cell(interval.end) + 1):
            begin = max(float(interval.begin), self.begins(cell))
            end = min(float(interval.end), self.begins(cell + 1))
            yield cell, max(0.0, end - begin) / long


def picture(timeline: TimelineDrawing, width: int, signs: TextSigns) -> list[Text]:
    """Draws all lanes with their names, the axis of time, and a legend."""
    names = min(_NAMES_AT_MOST, max((len(lane.name) for lane in timeline.lanes), default=0))
    scale = CellScale(timeline.duration_us, max(10, width - names - 1))
    lines = []
    for lane in timeline.lanes:
        name = lane.name
        if len(name) > names:
            name = name[: names - len(signs.ellipsis)] + signs.ellipsis
        lines.append(Text(f"{name:<{names}} ") + _row(lane, scale, signs))
    return [*lines, *axis(scale, names + 1, signs), *_legend(timeline, width, signs)]


def _row(lane: TimelineLane, scale: CellScale, signs: TextSigns) -> Text:
    cells = _Cells([(" ", "")] * scale.width)
    match lane.sort:
        case "engagement":
            _states(lane, scale, signs, cells)
        case "panel":
            _actions(lane, scale, signs, cells)
        case "speech":
            _covered(lane, scale, signs, cells)
        case "trial" | "phase":
            _trials(lane, scale, signs, cells)
        case "stop" | "driver" | "setting":
            sign, style = _FILLED[lane.sort]
            for interval in lane.intervals:
                for cell, _ in scale.shares(interval):
                    cells.put(cell, getattr(signs, sign), style)
    for sort in reversed(_MARKS):
        for instant in lane.instants:
            if instant.sort == sort:
                cells.put(scale.cell(instant.t), *_mark(sort, signs))
    text = Text.assemble(*cells)
    text.rstrip()
    return text


def _mark(sort: str, signs: TextSigns) -> tuple[str, str]:
    sign, style = _MARKS[sort]
    return getattr(signs, sign, sign), style


def _states(lane: TimelineLane, scale: CellScale, signs: TextSigns, cells: _Cells) -> None:
    """Each cell shows what took most of it."""
    times: list[dict[int, float]] = [{} for _ in range(scale.width)]
    for interval in lane.intervals:
        level = LEVELS.get(interval.label, 0)
        for cell, share in scale.shares(interval):
            times[cell][level] = times[cell].get(level, 0.0) + share
    for cell, levels in enumerate(times):
        if levels:
            most = max(levels, key=lambda level: (levels[level], level))
            cells.put(cell, signs.levels[most], _LEVEL_STYLES[most])


def _actions(lane: TimelineLane, scale: CellScale, signs: TextSigns, cells: _Cells) -> None:
    """Bars of how many began; what failed is crossed, what lasts is drawn through."""
    begun: dict[int, int] = {}
    bad: set[int] = set()
    for interval in lane.intervals:
        for cell, _ in scale.shares(interval):
            cells.put(cell, signs.running, "dim")
        cell = scale.cell(interval.begin)
        begun[cell] = begun.get(cell, 0) + 1
        if interval.outcome not in ("done", ""):
            bad.add(cell)
    for cell, count in begun.items():
        height = min(len(signs.bars) - 1, count * 2)
        cells.put(cell, signs.bars[height], "green")
    for cell in bad:
        cells.put(cell, signs.failed, "bold red")


def _covered(lane: TimelineLane, scale: CellScale, signs: TextSigns, cells: _Cells) -> None:
    """Bars of how much of a cell is covered."""
    covered: dict[int, float] = {}
    for interval in lane.intervals:
        for cell, share in scale.shares(interval):
            covered[cell] = covered.get(cell, 0.0) + share
    for cell, share in covered.items():
        height = 1 + round(min(1.0, share) * (len(signs.bars) - 2))
        cells.put(cell, signs.bars[height], "magenta")


def _trials(lane: TimelineLane, scale: CellScale, signs: TextSigns, cells: _Cells) -> None:
    for interval in lane.intervals:
        first, last = scale.cell(interval.begin), scale.cell(interval.end)
        pause = interval.sort == "break"
        left_out = interval.outcome not in ("done", "") and not pause
        style = "dim" if pause else "red" if left_out else "bold"
        for cell in range(first, last + 1):
            cells.put(cell, signs.dot if pause else signs.line, style)
        words = "" if pause else interval.label.removeprefix("trial ") + " " + interval.detail
        for place, letter in enumerate(words.strip()[: max(0, last - first - 1)]):
            cells.put(first + 1 + place, letter, style)
        if not pause:
            cells.put(first, signs.opens, style)
            if last > first:
                cells.put(last, signs.failed if left_out else signs.closes, style)


def axis(scale: CellScale, left: int, signs: TextSigns) -> list[Text]:
    """A line of ticks at round times and a line of these times."""
    seconds = scale.duration_us / 1e6
    most = max(1, scale.width // _APART)
    step = next((step for step in _STEPS if seconds / step <= most), max(1, round(seconds / most)))
    ruler, labels = [signs.line] * scale.width, [" "] * (scale.width + _APART)
    for count in range(int(seconds // step) + 1):
        place = scale.cell(round(count * step * 1e6))
        label = clock(count * step * 1e6)
        ruler[place] = signs.tick
        start = max(0, min(place - len(label) // 2, scale.width - len(label)))
        labels[start : start + len(label)] = label
    blank = " " * left
    return [Text(blank + "".join(ruler), "dim"), Text(blank + "".join(labels).rstrip(), "dim")]


def _legend(timeline: TimelineDrawing, width: int, signs: TextSigns) -> list[Text]:
    """Explains the signs that occur, in as many lines as it takes."""
    sorts = {lane.sort for lane in timeline.lanes}
    marks = {instant.sort for lane in timeline.lanes for instant in lane.instants}
    words: list[tuple[str, str, str]] = []
    if "engagement" in sorts:
        words += zip(signs.levels, _LEVEL_STYLES, _LEVEL_NAMES, strict=True)
    if "panel" in sorts:
        words += [
            (signs.bars[2] + signs.bars[4] + signs.bars[8], "green", "1, 2, 4 or more actions"),
            (signs.failed, "bold red", "not done, or a mistake"),
            (signs.running, "dim", "going on"),
        ]
    words += [(*_mark(sort, signs), sort) for sort in _LEGEND if sort in marks]
    lines = [Text()]
    for sign, style, meaning in words:
        piece = Text.assemble((sign, style), (f" {meaning}", "dim"))
        if lines[-1] and lines[-1].cell_len + piece.cell_len + 3 > width:
            lines.append(Text())
        lines[-1].append_text(Text("   ") + piece if lines[-1] else piece)
    return [line for line in lines if line]
