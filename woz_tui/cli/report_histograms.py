"""Histograms in a terminal: a row for each class, its bar, its count."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from rich.text import Text

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.figures import Reactions
from woz_tui.cli.report_layout import TextSigns

#: Where classes of short times begin, in microseconds: 1, 2, 5 and so on.
_EDGES = [int(digit * 10.0**power) for power in range(2, 8) for digit in (1, 2, 5)]
_WINDOWS = 10


def reaction_bars(reactions: Reactions, window_us: int, width: int, signs: TextSigns) -> list[Text]:
    """Reaction times in ten classes of the window, and what was missed."""
    step = max(1, window_us // _WINDOWS)
    counts = [0] * _WINDOWS
    for value in reactions.times.values:
        counts[min(_WINDOWS - 1, value // step)] += 1
    labels = [
        f"{place * step / 1e6:g}{signs.dash}{(place + 1) * step / 1e6:g} s"
        for place in range(_WINDOWS)
    ]
    return bars([*labels, "missed"], [*counts, reactions.missed], width, signs)


def latency_bars(times: Durations, width: int, signs: TextSigns) -> list[Text]:
    """Short times in classes that grow by 1, 2, 5, ...; empty ones at both ends are left out."""
    counts = [0] * (len(_EDGES) + 1)
    for value in times.values:
        counts[bisect_right(_EDGES, value)] += 1
    labels = [f"< {_ms(_EDGES[0])}"]
    labels += [
        f"{_EDGES[place] / 1000:g}{signs.dash}{_ms(_EDGES[place + 1])}"
        for place in range(len(_EDGES) - 1)
    ]
    labels.append(f"{signs.over} {_ms(_EDGES[-1])}")
    some = [place for place, count in enumerate(counts) if count]
    if not some:
        return []
    shown = slice(some[0], some[-1] + 1)
    return bars(labels[shown], counts[shown], width, signs)


def _ms(us: int) -> str:
    return f"{us / 1000:g} ms"


def bars(labels: Sequence[str], counts: Sequence[int], width: int, signs: TextSigns) -> list[Text]:
    """The longest bar takes all the room that there is."""
    left = max(map(len, labels), default=0)
    most = max(counts, default=0)
    digits = len(str(most))
    room = max(5, width - left - digits - 2)
    fine = len(signs.rows) - 1
    lines = []
    for label, count in zip(labels, counts, strict=True):
        length = count * room * fine // most if most else 0
        if count and not length:
            length = fine  # what is there can be seen
        full, rest = divmod(length, fine)
        bar = signs.rows[-1] * full + (signs.rows[rest] if rest else "")
        lines.append(
            Text.assemble(
                (f"{label:>{left}} ", "dim"), f"{count:>{digits}} ", (bar.rstrip(), "cyan")
            )
        )
    return lines
