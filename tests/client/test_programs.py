"""The documented programs, word for word, at a real session."""

from __future__ import annotations

import asyncio
import csv
import os
import re
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.host.rig import ServedSession, served_session
from tools import ROOT
from woz_tui.protocol import messages as m

PAGE = ROOT / "docs" / "how-to" / "programs.md"
PROGRAMS = ROOT / "experiments" / "programs"
PATIENCE_S = 60.0


def test_the_page_has_every_program_word_for_word() -> None:
    shown = dict(re.findall(r"<!-- (\w+\.py) -->\n```python\n(.*?)```", PAGE.read_text(), re.S))
    assert shown == {path.name: path.read_text() for path in PROGRAMS.glob("*.py")}


@asynccontextmanager
async def running(host: ServedSession, name: str) -> AsyncIterator[asyncio.subprocess.Process]:
    """A program that has connected."""
    program = await asyncio.create_subprocess_exec(
        sys.executable,
        str(PROGRAMS / name),
        env={**os.environ, "WOZ_SOCKET": str(host.path), "PYTHONPATH": str(ROOT)},
        stdout=asyncio.subprocess.PIPE,
    )
    try:
        called = name.removesuffix(".py")
        await host.published(
            lambda line: isinstance(line, m.ConsoleAttached) and line.name == called
        )
        yield program
    finally:
        if program.returncode is None:
            program.kill()
        await program.wait()


async def output(program: asyncio.subprocess.Process) -> str:
    """Everything that it writes, until it ends well."""
    text, _ = await asyncio.wait_for(program.communicate(), PATIENCE_S)
    assert program.returncode == 0
    return text.decode()


def engagement_changed(was: str, now: str) -> m.EngagementChanged:
    return m.EngagementChanged(was=was, now=now, outcome="x", why="x", verdicts={})


async def test_the_greeter_greets_whoever_engages(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, running(host, "greeter.py"):
        # It may be connected and not follow yet: somebody engages until it has seen it.
        times = 0
        while not any(isinstance(line, m.Done) for line in host.lines):
            host.session.hub.publish(engagement_changed("Wait", "PersonDetected"))
            host.session.hub.publish(engagement_changed("PersonDetected", "EngagedWithUnknown"))
            for _ in range(3):  # after its own sentences
                host.session.hub.publish(engagement_changed("RobotSpeaks", "EngagedWithKnown"))
            times += 1
            await asyncio.sleep(0.5)
        [said, *more] = [args for verb, args in host.driver().calls if verb == "say"]
        assert len(more) < times
        assert "whale" in str(said["text"])
        [command, *_] = host.of(m.Command)
        [program] = host.of(m.ConsoleAttached)
        assert (command.source, command.console) == ("program", program.console)


async def test_the_logger_writes_until_the_session_ends(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, running(host, "logger.py") as program:
        assert program.stdout is not None
        peer = await host.connect()
        await peer.hello()
        head = asyncio.create_task(program.stdout.readuntil(b"ready,program\r\n"))
        while not head.done():  # it may be connected and not follow yet
            await peer.ask("marker", text="ready")
            await asyncio.sleep(0.05)
        await peer.ask("verb", verb="say", args={"text": "Hello"})
        await peer.ask("marker", text="smile")
        host.host.end("test")
        await host.session.close("test", rest=False)
        await host.host.close()
        rows = [*csv.reader((await output(program)).splitlines())]
        assert (await head).startswith(b"seconds,what,text,source\r\n")
        assert [row[1:] for row in rows[-2:]] == [
            ["said", "Hello", "program"],
            ["marker", "smile", "program"],
        ]


@pytest.mark.real_clock
async def test_the_stimuli_are_marked_and_commented_in_their_time(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, running(host, "stimulus.py") as program:
        text = await output(program)
        words = ("whale", "boat", "lighthouse")
        assert [line for line in text.splitlines() if line in words] == [*words]
        marks = host.of(m.Marker)
        assert [mark.text for mark in marks] == [f"onset {word}" for word in words]
        begun = [line.t for line in host.of(m.Dispatched)]
        for mark, t in zip(marks, begun, strict=True):
            assert 0 <= mark.at <= mark.t
            assert t >= mark.at + 1_500_000, "never before its moment"
