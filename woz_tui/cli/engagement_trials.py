"""`woz engagement LOG --trials`: how steady and how quick the signs were, printed."""

from __future__ import annotations

import json
from pathlib import Path

from rich.table import Table

from woz_tui.analysis.engagement_rerun import SettingsOverride, message_of
from woz_tui.analysis.engagement_trials import JUDGED, LASTS, NOW, STEADY, Trials, medians, trials
from woz_tui.config.engagement import EngagementSettings
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.log.log_reader import Damage, read
from woz_tui.sensing.model_time import SECOND

#: Columns of a page that goes into a file or a pipe.
_PAGE = 80


def show(
    log: Path, settings: EngagementSettings | None, above: SettingsOverride, *, as_json: bool
) -> None:
    """Print the figures of a log; it must be one (`log.log_reader.read` says what it raises)."""
    lines = (message_of(line) for line in read(log, Damage()))
    found = trials((message for message in lines if message is not None), settings, above)
    if as_json:
        print(json.dumps(found.as_json()))
        return
    console = TextConsole(page=_PAGE)
    if not found.stretches and not found.moments:
        console.print(
            f"no trials: put markers called {STEADY!r} and {NOW!r} into the session's log"
        )
        return
    if found.stretches:
        console.print("Correct throughout", style="bold")
        console.print(_steady(found))
    if found.moments:
        console.print("Seconds until engagement changed", style="bold")
        console.print(_delays(found))
        if unmoved := sum(not row.changes for row in found.delays()):
            console.print(
                "-: engagement was the same before and after,"
                f" {unmoved} of {len(found.moments)} marks"
            )


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for place, column in enumerate(columns):
        table.add_column(column, justify="right" if place else "left")
    return table


def _steady(found: Trials) -> Table:
    table = _table("sign", "s", "stretches", "no filter", "filtered")
    for name in JUDGED:
        for seconds in LASTS:
            count, plain, filtered = found.steady(name, seconds)
            if count:
                shares = (f"{100 * right / count:.0f} %" for right in (plain, filtered))
                table.add_row(name, str(seconds), str(count), *shares)
    return table


def _delays(found: Trials) -> Table:
    table = _table("at", "no filter", "filtered")
    rows = found.delays()
    for row in rows:
        cells = (_seconds(row.plain), _seconds(row.filtered)) if row.changes else ("-", "-")
        table.add_row(f"{row.at / SECOND:.1f} s", *cells)
    middle = medians(rows)
    if middle is not None:
        table.add_row("median", *map(_seconds, middle))
    return table


def _seconds(delay: float | None) -> str:
    return "never" if delay is None else f"{delay:.2f}"
