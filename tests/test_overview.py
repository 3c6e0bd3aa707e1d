"""docs/explanation/overview.md: a key press really takes the hops that the page names, and what it
says to read can be read in an afternoon.
"""

from __future__ import annotations

import ast
import asyncio
import re
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import pytest

from tests.host.rig import served_session
from tools import DOCS, ROOT
from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link import host_connection
from woz_tui.console.link.host_connection import HostConnection
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import Welcome

PAGE = (DOCS / "explanation" / "overview.md").read_text(encoding="utf-8")
#: What needs a terminal, a screen or a loudspeaker; the test is about everything between them.
OUTSIDE = {"WizardDriver", "Speech", "LaneJob", "Console", "ConsoleState", "SessionState"}
OUTSIDE |= {"MainScreen"}
#: Named where they are explained, not at their turn: every message goes through them.
ALWAYS = {"Hub.publish", "Recorder.record", "Subscription.offer"}
#: Rooms of the core. Features and drivers are walked through as examples.
CORE = {"bus", "console", "gate", "host", "log", "protocol", "session", "timeline"}
#: Of these rooms, what the walks show of the engagement model, and a part of the screen.
EXAMPLES = {
    "session/engagement_control.py",
    "session/state_effects.py",
    "console/widgets/meters.py",
}
#: Lines that are read in an afternoon.
AFTERNOON = 6_000


def to_read() -> dict[str, list[str]]:
    """Files of woz_tui in the page's order, each with what is to be read of it; nothing: all."""
    section = PAGE.partition("## An afternoon")[2].partition("## One key press")[0]
    rows = re.findall(r"^\| \[([\w/.]+)\]\(\S+\) \| (.*?) \|", section, re.MULTILINE)
    return {file: re.findall(r"`([\w.]+)`", read) for file, read in rows}


def lines_of(file: str, names: list[str]) -> int:
    """How many lines these functions, methods and classes have; without names the whole file."""
    source = (ROOT / "woz_tui" / file).read_text(encoding="utf-8")
    if not names:
        return len(source.splitlines())
    found: dict[str, int] = {}
    for node in ast.parse(source).body:
        inner = node.body if isinstance(node, ast.ClassDef) else []
        for each in (node, *inner):
            if isinstance(each, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                name = each.name if each is node else f"{getattr(node, 'name', '')}.{each.name}"
                found[name] = (each.end_lineno or 0) - each.lineno + 1
    missing = [name for name in names if name not in found]
    assert not missing, f"{file} has no {missing} any more: say on the page what to read instead"
    return sum(found[name] for name in names)


def test_what_is_to_be_read_takes_an_afternoon() -> None:
    lines = {file: lines_of(file, names) for file, names in to_read().items()}
    assert len(lines) > 20
    assert sum(lines.values()) <= AFTERNOON, lines


def test_every_file_of_the_core_on_the_way_is_to_be_read() -> None:
    walks = PAGE.partition("## One key press")[2].partition("## Five rules")[0]
    named = set(re.findall(r"\(\.\./\.\./woz_tui/([\w/]+\.py)", walks))
    of_core = {file for file in named if file.split("/")[0] in CORE} - EXAMPLES
    assert of_core <= set(to_read())


def hops() -> list[str]:
    """Functions and methods that the page names for a key press, in its order."""
    section = PAGE.partition("## One key press")[2].partition("**If the wizard presses escape**")[0]
    names = re.findall(r"`([\w.]+)` in \[", section)
    called = [name for name in names if "." in name or name.islower()]
    return [name for name in dict.fromkeys(called) if name.split(".")[0] not in OUTSIDE]


@contextmanager
def watched_calls(called: list[str]) -> Iterator[None]:
    """Note each function of woz_tui when it is first called in this thread."""

    def note(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if event == "call" and "/woz_tui/" in code.co_filename:
            name = code.co_qualname
            if name not in called:
                called.append(name)

    sys.setprofile(note)
    try:
        yield
    finally:
        sys.setprofile(None)


def press(connection: HostConnection, called: list[str]) -> None:
    keyboard = Keyboard(connection)
    keyboard.bind({"h": "Hello"})
    with watched_calls(called):
        (token,) = Scanner().feed(b"h")
        assert isinstance(token, Key)
        assert keyboard.arrive(token.chord)


async def test_a_key_press_takes_the_hops_that_the_page_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(host_connection, "BEAT_S", 60.0)  # a beat takes the same way
    assert len(hops()) > 10
    called: list[str] = []
    welcomed = threading.Event()
    async with served_session(tmp_path) as place:
        connection = HostConnection(place.path)
        connection.start(
            lambda batch: welcomed.set() if isinstance(batch[0], Welcome) else None,
            lambda reason: None,
        )
        await asyncio.to_thread(welcomed.wait, 20)
        with watched_calls(called):
            await asyncio.to_thread(press, connection, called)
            await place.published(lambda line: isinstance(line, m.Dispatched))
        connection.close()
    assert [name for name in hops() if name not in called] == []
    in_turn = [name for name in hops() if name not in ALWAYS]
    assert in_turn == sorted(in_turn, key=called.index)
