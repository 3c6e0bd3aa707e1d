"""How soon cues were answered: the share of all that stayed open, over time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from woz_tui.analysis.html.markup import Markup, short, tag
from woz_tui.analysis.reaction_totals import ReactionTotals
from woz_tui.analysis.text_format import percent

_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 430, 210, 40, 110, 12, 34
#: Of Okabe and Ito; each condition has dashes of its own, too.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
_DASHES = ("", "6 3", "2 2", "8 2 2 2", "1 3", "12 3")
_TEXT = {"fill": "currentColor", "font_family": "sans-serif", "font_size": "11"}
#: From one name to the next.
_ROW = 14


def reaction_curves(found: Mapping[str, ReactionTotals]) -> Markup | None:
    """A line for each condition, from what was answered early to what was missed; None without a
    cue that stayed open.
    """
    shown = {name: each for name, each in sorted(found.items()) if each.stayed_open}
    if not shown:
        return None
    window = max(each.window_us for each in shown.values())
    words = "Share of cues answered within a time, of all that stayed open: " + "; ".join(
        f"{name or 'none'} {percent(each.answered / each.stayed_open)} within the window"
        for name, each in shown.items()
    )
    return tag(
        "svg",
        tag("title", words),
        list(_axes(window)),
        [_curve(each, window, place) for place, each in enumerate(shown.values())],
        list(_names(shown)),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {_WIDTH} {_HEIGHT}",
        width=_WIDTH,
        height=_HEIGHT,
        role="img",
        aria_label=words,
    )


def _x(us: float, window: int) -> float:
    return _LEFT + us / window * (_WIDTH - _LEFT - _RIGHT)


def _y(share: float) -> float:
    return _HEIGHT - _BOTTOM - share * (_HEIGHT - _BOTTOM - _TOP)


def _axes(window: int) -> Iterator[Markup]:
    right = _WIDTH - _RIGHT
    for share in (0.0, 0.5, 1.0):
        y = _y(share)
        yield tag("line", x1=_LEFT, x2=right, y1=y, y2=y, stroke="#8c8c8c", stroke_width="0.4")
        yield tag("text", f"{share * 100:g} %", x=_LEFT - 5, y=y + 4, text_anchor="end", **_TEXT)
    for part in range(5):
        us = window * part / 4
        x, words = _x(us, window), f"{us / 1e6:g} s"
        yield tag("text", words, x=x, y=_HEIGHT - _BOTTOM + 16, text_anchor="middle", **_TEXT)


def _line(path: str, place: int) -> Markup:
    """The line of a condition: its colour, and its dashes."""
    return tag(
        "path",
        d=path,
        fill="none",
        stroke=_COLOURS[place % len(_COLOURS)],
        stroke_width="2",
        stroke_dasharray=_DASHES[place % len(_DASHES)] or None,
    )


def _curve(found: ReactionTotals, window: int, place: int) -> Markup:
    """Steps: at each time at which one more cue was answered."""
    answered, open_ = found.early, found.stayed_open
    path = [f"M{short(_LEFT)} {short(_y(answered / open_))}"]
    for us in found.times.values:
        answered += 1
        path.append(f"H{short(_x(us, window))}V{short(_y(answered / open_))}")
    path.append(f"H{short(_x(found.window_us, window))}")
    return _line("".join(path), place)


def _names(found: Mapping[str, ReactionTotals]) -> Iterator[Markup]:
    """At the ends of the lines, none on another one."""
    ends = [
        (_y(each.answered / each.stayed_open), place, name or "none")
        for place, (name, each) in enumerate(found.items())
    ]
    x, lowest = _WIDTH - _RIGHT + 6, 0.0
    for y, place, name in sorted(ends):
        lowest = max(y + 4, lowest + _ROW)
        yield _line(f"M{x} {short(lowest - 4)}h22", place)
        yield tag("text", name[:13], x=x + 27, y=lowest, **_TEXT)
