"""What the keys do on the screen of the model: the robot is played, or the hand is on the model."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.console.cells import Row, clean, cut, length
from woz_tui.console.engagement.engagement_view import EngagementView
from woz_tui.console.engagement.wizard_overrides import OVERRIDES, Override
from woz_tui.console.glyphs import Glyphs

#: Lines of the legend at the most.
HEIGHT = 4


def legend_rows(
    engaged: EngagementView, covered: Mapping[str, str], width: int, glyphs: Glyphs, *, steers: bool
) -> list[Row]:
    """`covered`: keys of the hand that else play an action -> the action's label."""
    if steers:
        rows = _orders(engaged, width)
        rows += [_covered(covered, glyphs)] if covered else []
    else:
        keys = " ".join(order.key for order in OVERRIDES)
        rows = [
            (
                ("Keys play the robot. ", "muted"),
                (" tab ", "key"),
                (" takes the model in hand: ", "plain"),
                (keys, "muted"),
            )
        ]
    return [cut(row, width, glyphs.ellipsis) for row in rows[:HEIGHT]]


def _orders(engaged: EngagementView, width: int) -> list[Row]:
    """The hand's keys on as few lines as they fill; those that would do nothing now are pale."""
    rows: list[Row] = [()]
    for order in OVERRIDES:
        now = _counts(order, engaged)
        piece: Row = (
            (f" {order.key} ", "key" if now else "muted"),
            (f" {order.word}  ", "plain" if now else "faint"),
        )
        if rows[-1] and length(rows[-1]) + length(piece) > width:
            rows.append(())
        rows[-1] += piece
    return rows


def _counts(order: Override, engaged: EngagementView) -> bool:
    shown = engaged.shown
    if shown is None:
        return False
    if order.id == "step":
        return engaged.held
    if order.id in ("greeted", "unknown"):
        return shown.state == "Handshake"
    return True


def _covered(covered: Mapping[str, str], glyphs: Glyphs) -> Row:
    told = ", ".join(f"{key} {clean(label)}" for key, label in covered.items())
    return ((f"{glyphs.warning} not played meanwhile: {told}", "warn"),)
