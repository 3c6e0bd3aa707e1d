"""How many keys it takes to find and play one action of many, and how much must be read for it.

    python benchmarks/finding.py [EXPERIMENT] [--size 80x24] [--quick]

Five ways, each tried for every action on the real console, which must ask the robot process for
just this action:

letter   the wizard knows its key
page     she sees the panels and turns the page (tab) until its button stands there, then its key
phase    the same in the phase to which the action belongs
finder   `:`, as many letters of its name (then of its panel) as put it first, enter
words    `:`, as much of a word of its sentence, enter: she remembers what it says, not its name

Rows are lines of the screen that are read on the way: each page down to the button, the finder's
first line. Seconds are an estimate by the keystroke-level model (S. Card, T. Moran and A. Newell,
The keystroke-level model for user performance time with interactive systems, CACM 23 (1980)
396-410): M 1.35 s once, to know what to press, and K 0.28 s a key; a key with shift or ctrl counts
as one; what fills a slot does not count. Nobody's time was taken.
"""

from __future__ import annotations

import argparse
import asyncio
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations
from pathlib import Path

from benchmarks.figures import machine, percentile, table, verdict
from tests.console.piloting import ConsolePilot, piloted_console
from tools import demo_session
from woz_tui.config.loading import load
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.screens.find import FindDialog
from woz_tui.console.widgets.action_panels import ActionPanels
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.slots.dialog import SlotDialog
from woz_tui.protocol.panels import ActionView
from woz_tui.protocol.requests import AskAction, Welcome
from woz_tui.session.participant_identity import SessionIdentity

#: Seconds: to press a key, to know what to press.
K, M = 0.28, 1.35
#: The wizard knows which action she wants; it plays within so many seconds.
GOAL = 2.0
ROOT = Path(__file__).parent.parent


@dataclass(frozen=True)
class Way:
    """Keys that were pressed and rows that were read until the right action was played."""

    keys: int
    rows: int

    @property
    def seconds(self) -> float:
        """By the keystroke-level model."""
        return M + K * self.keys


def sentence(seat: ConsolePilot, action: ActionView) -> str:
    """What the action says, as the console shows it before it is played."""
    return seat.console.state.sentence(action.name)


async def played(seat: ConsolePilot, keys: Sequence[str]) -> str:
    """Press the keys; the action that was asked for."""
    seat.feed.asked.clear()
    await seat.press(*keys)
    while isinstance(seat.console.dialog, SlotDialog):  # what is said in it is not looked for
        await seat.press("x", "enter")
    last = seat.feed.last(AskAction)
    return last.action if isinstance(last, AskAction) else ""


async def by_letter(seat: ConsolePilot, action: ActionView) -> Way | None:
    """Its key, or the keys of its sequence."""
    cap = seat.console.caps.get(action.name)
    keys = cap.chord.split(" ") if cap is not None and cap.chord else []
    if not keys or await played(seat, keys) != action.name:
        return None
    return Way(len(keys), 0)


async def by_page(seat: ConsolePilot, action: ActionView) -> Way | None:
    """Turn pages until the button is there."""
    panels = seat.console.query_one(ActionPanels)
    panels.board = replace(panels.board, chosen=0)
    seat.console.paint()
    await seat.settle()
    rows = turned = 0
    while (row := _row(seat, panels, action)) is None:
        if turned > len(seat.console.state.front):
            return None
        rows, turned = rows + panels.size.height, turned + 1
        await seat.press("tab")
    letter = await by_letter(seat, action)
    return None if letter is None else Way(turned + letter.keys, rows + row + 1)


def _row(seat: ConsolePilot, panels: ActionPanels, action: ActionView) -> int | None:
    """In which line the button stands, if it is on the page that is shown."""
    frame = PaintFrame(panels.size.width, panels.size.height, 0, seat.console.look.glyphs)
    arranged = panels.arranged(seat.console.state, frame)
    page = arranged.page_of(panels.board.chosen)
    slots = (slot for slot in arranged.slots if slot.page == page)
    return next((slot.row for slot in slots if slot.action == action), None)


async def in_phase(seat: ConsolePilot, action: ActionView, panel: str) -> Way | None:
    """The same, while the first phase that has the action's panel in front holds."""
    phases = seat.console.state.settings.phases
    phase = next((each for each in phases if panel in each.panels), None)
    if phase is None:
        return None
    await seat.tell(PhaseChanged(phase=phase.name))
    found = await by_page(seat, action)
    await seat.tell(PhaseChanged())
    return found


async def by_finder(seat: ConsolePilot, action: ActionView, typed: Iterator[str]) -> Way | None:
    """The shortest of `typed` that puts it on the first line."""
    await seat.press(":")
    dialog = seat.console.dialog
    assert isinstance(dialog, FindDialog)
    found = next((text for text in typed if _first(dialog, text) == action.name), None)
    if found is None:
        await seat.press("ctrl+q")
        return None
    await seat.type(found)
    return Way(len(found) + 2, 1) if await played(seat, ["enter"]) == action.name else None


def _first(dialog: FindDialog, typed: str) -> str:
    """The action that enter would play; empty if it is none."""
    hits = dialog.matching(typed)
    play = hits[0].do if hits and hits[0].acts else None
    asked = play.args[0] if isinstance(play, partial) else ""  # a name: its slots are asked for
    return asked.action if isinstance(asked, AskAction) else str(asked)


def beginnings(text: str) -> Iterator[str]:
    """The first letter, the first two ... in lower case."""
    return (text[:length].lower() for length in range(1, len(text) + 1) if text[length - 1] != " ")


def words(text: str) -> Iterator[str]:
    """The beginnings of all its words, the shortest first; then those of two of them."""
    each = list(dict.fromkeys(word.lower() for word in re.findall(r"\w{2,}", text)))
    begun = {word[:length] for word in each for length in range(2, len(word) + 1)}
    pairs = {
        f"{one[:length]} {two[:length]}" for one, two in combinations(each, 2) for length in (3, 4)
    }
    return iter([*sorted(begun, key=_length), *sorted(pairs, key=_length)])


def _length(text: str) -> tuple[int, str]:
    return len(text), text


def attached(experiment: Path) -> Welcome:
    """What a console hears that attaches a second after the session began."""
    conditions = load(experiment, demo_session.catalogue()).conditions
    who = SessionIdentity(participant="P01", condition=next(iter(conditions), ""))
    return demo_session.demo((), 1.0, str(experiment.with_suffix("")), who=who)


async def measure(first: Welcome, size: tuple[int, int], most: int) -> dict[str, list[Way | None]]:
    """Every way for every action that has a button, or for the first `most`."""
    found: dict[str, list[Way | None]] = {
        name: [] for name in ("letter", "page", "phase", "finder", "words")
    }
    async with piloted_console(first, size=size) as seat:
        panels = seat.console.state.panels
        actions = [(action, panel.title) for panel in panels for action in panel.actions]
        for action, panel in actions[:most]:
            found["letter"].append(await by_letter(seat, action))
            found["page"].append(await by_page(seat, action))
            found["phase"].append(await in_phase(seat, action, panel))
            name = chain(beginnings(action.label), beginnings(f"{action.label} {panel}"))
            found["finder"].append(await by_finder(seat, action, name))
            if sentence(seat, action):
                found["words"].append(await by_finder(seat, action, words(sentence(seat, action))))
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument(
        "experiment", nargs="?", type=Path, default=ROOT / "experiments/interview.yaml"
    )
    parser.add_argument("--size", default="80x24", help="columns x rows of the screen")
    parser.add_argument("--quick", action="store_true", help="three actions only")
    arguments = parser.parse_args()
    width, height = (int(part) for part in arguments.size.split("x"))
    found = asyncio.run(
        measure(
            attached(arguments.experiment.resolve()),
            (width, height),
            3 if arguments.quick else 10_000,
        )
    )
    rows = []
    for name, ways in found.items():
        there = [way for way in ways if way is not None]
        if not there:
            rows.append([name, f"0 of {len(ways)}"])
            continue
        columns: list[str] = []
        for each in ([way.keys for way in there], [way.rows for way in there]):
            columns += [f"{percentile(each, 0.5):.0f}", f"{max(each)}"]
        seconds = [way.seconds for way in there]
        columns += [f"{percentile(seconds, 0.5):.2f}", f"{max(seconds):.2f}"]
        count = f"{len(there)} of {len(ways)}"
        rows.append([name, count, *columns, verdict(max(seconds), GOAL)])
    head = ["way", "found", "keys p50", "most", "rows p50", "most", "s p50", "most", f"{GOAL:g} s"]
    width_of = max(len(row) for row in [head, *rows])
    table(
        f"{arguments.experiment.name} at {arguments.size}",
        head,
        [[*row, *[""] * (width_of - len(row))] for row in rows],
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
