"""`woz engagement LOG --compare`: the recorded path through the states beside the computed one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.table import Table

from woz_tui.analysis.engagement_comparison import (
    MOVED,
    ONLY_COMPUTED,
    ONLY_RECORDED,
    TransitionPair,
    paired,
    summary,
)
from woz_tui.analysis.engagement_rerun import LogRerun, line_of
from woz_tui.cli.safe_streams import json_text
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.protocol.messages import Json
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.model_time import SECOND

#: Seconds without a model that are worth a sentence: a log begins some milliseconds before it.
_GAP_S = 0.05
#: Columns of a page that goes into a file or a pipe.
_PAGE = 80


def show(recount: LogRerun, *, as_json: bool) -> None:
    pairs = paired(recount.recorded, recount.computed)
    if as_json:
        rows: list[Json] = [
            {
                "sign": pair.sign,
                "recorded": line_of(pair.recorded) if pair.recorded else None,
                "computed": line_of(pair.computed) if pair.computed else None,
            }
            for pair in pairs
        ]
        print(json_text({"rows": rows, "summary": summary(recount, pairs)}))
        return
    console = TextConsole(page=_PAGE)
    console.print(_table(pairs))
    for sentence in _sentences(summary(recount, pairs)):
        console.print(sentence)


def _table(pairs: Sequence[TransitionPair]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("time", justify="right", no_wrap=True)
    table.add_column("recorded", overflow="fold")
    table.add_column("", no_wrap=True)
    table.add_column("computed", overflow="fold")
    for pair in pairs:
        style = {ONLY_RECORDED: "red", ONLY_COMPUTED: "green", MOVED: "yellow"}.get(pair.sign, "")
        computed = _cell(pair.computed)
        if pair.sign == MOVED and pair.recorded is not None and pair.computed is not None:
            later = (pair.computed.t - pair.recorded.t) / SECOND
            computed = f"{pair.computed.now} {later:+.1f} s"
        table.add_row(_clock(pair.t), _cell(pair.recorded), pair.sign, computed, style=style)
    return table


def _clock(t: int) -> str:
    """Minutes and seconds, with tenths."""
    tenths = round(t / (SECOND / 10))
    return f"{tenths // 600}:{tenths // 10 % 60:02d}.{tenths % 10}"


def _cell(change: Transition | None) -> str:
    if change is None:
        return ""
    return f"{change.now} ({change.outcome}{', forced' if change.forced else ''})"


def _sentences(figures: dict[str, Json]) -> Iterator[str]:
    yield ""
    yield (
        f"transitions: {figures['recorded']} recorded, {figures['computed']} computed:"
        f" {figures['alike']} alike (=), {figures['moved']} moved (~)"
    )
    yield (
        f"engaged: {_per_cent(figures['engaged_recorded'])} of the time recorded,"
        f" {_per_cent(figures['engaged_computed'])} computed"
    )
    off = figures["off_recorded"], figures["off_computed"]
    if any(isinstance(each, float) and each >= _GAP_S for each in off):
        yield (
            f"model off or missing: {off[0]:.1f} s recorded, {off[1]:.1f} s computed"
            " (counted in no state)"
        )
    first = figures["first_difference"]
    if isinstance(first, float):
        yield f"first difference: at {_clock(round(first * SECOND))}"
    else:
        yield "no difference"


def _per_cent(share: Json) -> str:
    return f"{share:.1%}" if isinstance(share, float) else "?"
