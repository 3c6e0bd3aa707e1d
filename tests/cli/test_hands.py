"""`woz hands` as the wizard starts it: the program, a gamepad's bytes, a line by ssh, a session."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
from asyncio.subprocess import PIPE, STDOUT, Process
from collections.abc import AsyncIterator, Collection
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.drivers.published_messages import PATIENCE_S
from tests.fakes.joystick import Joystick
from tests.fakes.spacenavd import FakeSpacenavd
from tests.host.rig import ServedSession
from tests.host.test_controls import FILE, session
from woz_tui.cli import hands, main
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import DriverError, PassiveDriver
from woz_tui.protocol import messages as m
from woz_tui.system.session_sockets import bind
from woz_tui.testing import until

#: Runs the command here instead of somewhere else.
SSH = '#!/bin/sh\nfor last; do :; done\nexec sh -c "$last"\n'


class HandsProgram:
    """`woz hands` under way."""

    def __init__(self, process: Process) -> None:
        self.process = process

    async def says(self, words: str) -> str:
        """The first line with these words."""
        assert self.process.stdout is not None
        seen = b""
        async with asyncio.timeout(PATIENCE_S):
            while line := await self.process.stdout.readline():
                if words.encode() in line:
                    return line.decode()
                seen += line
        raise AssertionError(seen.decode())


@asynccontextmanager
async def program(folder: Path, *arguments: str) -> AsyncIterator[HandsProgram]:
    """Start it; it is ended afterwards."""
    (folder / "bin").mkdir(exist_ok=True)
    ssh = folder / "bin" / "ssh"
    ssh.write_text(SSH)
    ssh.chmod(0o755)
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "woz_tui", "hands", *arguments),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=PIPE,
        stderr=STDOUT,
        env={**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"},
        # A suite in the background of a shell ignores ctrl+c, and so would its programs.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield HandsProgram(process)
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGINT)
        assert process.stdout is not None
        async with asyncio.timeout(PATIENCE_S):
            await process.stdout.read()  # to its end: nothing that was started goes on
            await process.wait()


def by_ssh(place: ServedSession) -> tuple[str, ...]:
    """Arguments for a session on another computer."""
    return ("--to", "robot", "--woz", f"{sys.executable} -m woz_tui", str(place.path))


@pytest.mark.parametrize("far", [False, True])
async def test_a_gamepad_plays_and_drives_until_its_program_is_killed(
    tmp_path: Path, far: bool
) -> None:
    pad = Joystick(tmp_path / "js0")
    async with session(tmp_path) as (place, reader):
        reader.leave()
        words = by_ssh(place) if far else (str(place.path),)
        async with program(tmp_path, *words, "--device", str(pad.port)) as hands_program:
            await hands_program.says("south Hello")
            pad.press("south")
            asked = await place.published(lambda line: isinstance(line, m.ActionRequested))
            assert isinstance(asked, m.ActionRequested)
            assert (asked.action, asked.source) == ("Hello", "gamepad")
            pad.let_go("south")
            pad.press("west")
            assert "locked" in await hands_program.says("Locked: ")
            pad.push("left-stick-y", -1)
            pad.press("left-bumper")
            await place.published(lambda line: isinstance(line, m.Command) and line.verb == "drive")
            hands_program.process.kill()
            halted = await place.published(lambda line: isinstance(line, m.StopPressed))
            assert isinstance(halted, m.StopPressed)
            assert halted.scope == "drive"
    pad.unplug()


SIX_AXES = FILE.replace(
    "    pad:\n      type: hands\n",
    """    mouse:
      type: hands
      device: spacemouse
      hold: {hold}
      controls:
        button-2: {action: Hello}
        turn-y: {verb: gaze, argument: yaw, range: [-60, 60], rate: 400, hold: button-1}
        push-z: {verb: drive, argument: x, range: [-2, 2], hold: button-1, every: 1}
    pad:
      type: hands
""",
)


def drives(line: m.Message) -> bool:
    return isinstance(line, m.Command) and line.verb == "drive"


def looks(line: m.Message) -> bool:
    return isinstance(line, m.Command) and line.verb == "gaze"


async def test_a_6_d_mouse_looks_and_drives_while_its_button_is_held(tmp_path: Path) -> None:
    daemon = FakeSpacenavd(tmp_path / "spnav.sock")
    async with session(tmp_path, text=SIX_AXES) as (place, reader):
        reader.leave()
        words = (str(place.path), "--device", str(daemon.path))
        async with program(tmp_path, *words) as hands_program:
            await hands_program.says("button-2 Hello")
            daemon.push(0, 0, 500, 0, 500)
            daemon.button(1, down=True)
            asked = await place.published(lambda line: isinstance(line, m.ActionRequested))
            assert isinstance(asked, m.ActionRequested)
            assert (asked.action, asked.source) == ("Hello", "spacemouse")
            daemon.button(0, down=True)
            for asks in (drives, looks):
                command = await place.published(asks)
                assert isinstance(command, m.Command)
                assert command.source == "spacemouse"
            daemon.close()
            halted = await place.published(lambda line: isinstance(line, m.StopPressed))
            assert isinstance(halted, m.StopPressed)
            assert halted.scope == "drive"


async def test_a_frozen_program_holds_nothing(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    async with session(tmp_path, hold=2.0) as (place, reader):
        reader.leave()
        async with program(tmp_path, *by_ssh(place), "--device", str(pad.port)) as hands_program:
            await hands_program.says("south Hello")
            pad.push("left-stick-y", -1)
            pad.press("left-bumper")
            await place.published(lambda line: isinstance(line, m.Command) and line.verb == "drive")
            hands_program.process.send_signal(signal.SIGSTOP)
            halted = await place.published(lambda line: isinstance(line, m.StopPressed))
            assert isinstance(halted, m.StopPressed)
            assert "nothing was heard" in halted.source
            hands_program.process.send_signal(signal.SIGCONT)
    pad.unplug()


async def test_the_end_of_the_session_is_its_end(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    async with session(tmp_path) as (place, reader):
        reader.leave()
        async with program(tmp_path, *by_ssh(place), "--device", str(pad.port)) as hands_program:
            await hands_program.says("south Hello")
            await place.session.close("test", rest=False)
            await place.host.close()
            await hands_program.says("the session has ended")
            assert await hands_program.process.wait() == 0
    pad.unplug()


async def test_a_lost_session_of_this_computer_is_found_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    connect, tries = asyncio.open_unix_connection, 0

    async def counted(path: Path, limit: int) -> Any:
        nonlocal tries
        tries += 1
        return await connect(path, limit=limit)

    def attached(line: m.Message) -> bool:
        return isinstance(line, m.ConsoleAttached) and line.name == "hands"

    async with session(tmp_path) as (place, reader):
        reader.leave()
        monkeypatch.setattr(hands, "AGAIN_S", 0.0)
        monkeypatch.setattr(asyncio, "open_unix_connection", counted)
        words = ["hands", str(place.path), "--device", str(tmp_path / "none")]
        running = asyncio.create_task(asyncio.to_thread(main, words))
        await place.published(attached)
        await place.host.close()
        await until(lambda: tries >= 3 or running.done(), PATIENCE_S)
        place.lines.clear()
        place.host.listen(bind(place.path))
        await place.published(attached)
        await place.session.close("test", rest=False)
        await place.host.close()
        assert await asyncio.wait_for(running, PATIENCE_S) == 0


async def test_devices_that_cannot_be_read_any_more_end_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class BrokenDevices(PassiveDriver):
        @classmethod
        def watch(cls, wanted: list[str]) -> type[BrokenDevices]:
            return cls

        @staticmethod
        async def run(kinds: Collection[str]) -> None:
            raise DriverError("the kernel's list of devices cannot be read", "restart udev")

    async with session(tmp_path) as (place, reader):
        reader.leave()
        monkeypatch.setattr(plugins, "installed", lambda: {"hands": BrokenDevices})
        words = ["hands", str(place.path)]
        assert await asyncio.wait_for(asyncio.to_thread(main, words), PATIENCE_S) == 1
    assert "cannot be read (restart udev)" in capsys.readouterr().err


async def test_without_a_session_it_says_so_and_ends(tmp_path: Path) -> None:
    async with program(tmp_path, str(tmp_path / "nobody")) as hands_program:
        await hands_program.says("no session is running")
        assert await hands_program.process.wait() == 1
    far = ("--to", "robot", "--woz", f"{sys.executable} -m woz_tui", str(tmp_path / "nobody"))
    async with program(tmp_path, *far) as hands_program:
        await hands_program.says("no session is running")
        await hands_program.says("no session answered")
        assert await hands_program.process.wait() == 1


async def test_it_shows_the_names_of_controls(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    async with program(tmp_path, "--show", "--device", str(pad.port)) as hands_program:
        await hands_program.says("gamepad")
        pad.press("north")
        await hands_program.says("north 1")
        pad.push("left-stick-y", -1)
        await hands_program.says("left-stick-y 1")
        pad.unplug()
        await hands_program.says("gone")
