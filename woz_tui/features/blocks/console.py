"""Blocks of BML on the wizard's screen."""

from __future__ import annotations

import re
from collections.abc import Mapping

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean, cut, length
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.command_text import command_words, spoken_text
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import FeatureConsole
from woz_tui.features.blocks.kinds import BML
from woz_tui.protocol.envelope import Json

#: The id of a block.
_ID = re.compile(r"""<(?:\w+:)?bml\b[^>]*?\sid\s*=\s*["']([^"'<>]{1,100})["']""")
#: Cells that drivers keep beside a planner's block, and cells that this has at least.
DRIVERS, LEAST = 18, 40


def block_words(args: Mapping[str, Json]) -> str:
    """`block greeting`, or by its file; what it does, where that is told."""
    name, does = _block_name(args), str(args.get("does", ""))
    block = say("blocks.named", "block {name}", name=name).rstrip()
    return f"{block}: {does}" if does else block


def _block_name(args: Mapping[str, Json]) -> str:
    found = _ID.search(str(args.get("block", "")))
    return str(args.get("file", "")) or (found[1] if found is not None else "")


def _under_way(state: ConsoleState, frame: PaintFrame, key: str, width: int) -> Row:
    """The newest block that a planner has begun: its id, who it is, what is done now, how long it
    still takes, and the key that cuts it where that is what began last.
    """
    runs, glyphs = state.runs, frame.glyphs
    if not (blocks := runs.composed) or (run := runs.get(blocks[-1].request.command)) is None:
        return ()
    block = blocks[-1]
    who = state.session.consoles.get(block.request.console)
    args = block.request.args
    does = str(args.get("does", ""))
    name = f"{_block_name(args)}: {does}" if does else _block_name(args)
    more = f" +{len(blocks) - 1}" if len(blocks) > 1 else ""
    left = run.timing(frame.now)[0]
    waits = "" if run.running else f" {say('blocks.waits', 'waits')} "
    time = seconds(left) if left is not None else ""
    still = f" {say('blocks.left', '{time} left', time=time)} " if time else waits
    back: Row = ((still, "run"),)
    if key and runs.active[-1] == run.id:
        back += ((f" {key} ", "key"), (f" {say('blocks.cuts', 'cuts')} ", "muted"))
    front: Row = (
        (f"  {glyphs.running} {clean(name)}{more}", "run"),
        (f" {glyphs.middle} {clean(who.name)}" if who is not None and who.name else "", "muted"),
    )
    parts = sorted(runs.parts(block), key=lambda each: not spoken_text(each.request))
    words = ", ".join(command_words(each.request) for each in parts)
    room = max(LEAST, width - DRIVERS) - length(back)
    body = (*front, (f"  {glyphs.plain(clean(words))}" if words else "", "plain"))
    return (*cut(body, max(1, room), glyphs.ellipsis), *back)


WORDS = {BML: block_words}

CONSOLE = FeatureConsole(under_way=_under_way)
