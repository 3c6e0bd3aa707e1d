"""Commands that join a session on another machine: `--access`, over a network that is cut, frozen
and slow.
"""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
import sys
import threading
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from tests.cli.test_live_sound import line_with
from tests.host.test_live_sound import WORD, loudspeaker, microphone, now
from tests.remote.network import Machines, machines
from woz_tui.cli.mcp import SessionTools
from woz_tui.cli.remote_start import RemoteLine
from woz_tui.client.sound_receiver import LATE_S
from woz_tui.client.woz_errors import WozConnectionError
from woz_tui.config.experiment import AccessRole
from woz_tui.drivers.sound_feeds import LISTENED, SoundListened
from woz_tui.host import sound_service
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock
from woz_tui.testing import until

#: Networks hold back in real time.
pytestmark = pytest.mark.real_clock

BLOCK = """<bml id="b1" xmlns="http://www.bml-initiative.org/bml/bml-1.0">
<speech id="s1"><text>Hello</text></speech></bml>"""


class RemoteRig:
    """Two machines, and commands on the one without the session."""

    def __init__(self, two: Machines) -> None:
        self.two = two
        self.begun: list[Process] = []

    async def woz(self, command: str, role: AccessRole, *words: str, **more: Any) -> Process:
        """Start it with an access file of its own."""
        access = self.two.access(f"{command}-{role}", role)
        begun = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", command, *words),
            *("--access", str(access.path)),
            **{"stderr": PIPE, "stdout": DEVNULL, "stdin": DEVNULL, **more},
        )
        self.begun.append(begun)
        return begun


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A voice that a busy machine holds back is not late, unless a test is about that."""
    monkeypatch.setattr(sound_service, "LATE_S", 10.0)


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[RemoteRig]:
    async with machines(tmp_path, RealClock()) as two:
        remote_rig = RemoteRig(two)
        yield remote_rig
        two.cable.flowing.set()
        for running in remote_rig.begun:
            with contextlib.suppress(ProcessLookupError):
                running.kill()
            await running.wait()


async def test_the_microphone_is_heard_and_what_the_network_held_back_is_not(
    rig: RemoteRig,
) -> None:
    robot, cable = rig.two.robot, rig.two.cable
    window = microphone(robot)
    running = await rig.woz("listen", "watcher", rig.two.address, stdout=PIPE)
    assert running.stdout is not None
    feed = robot.session.feeds.feed("robot", LISTENED)
    await until(lambda: isinstance(feed.latest().value, SoundListened), 30)
    heard = bytearray()

    async def hears(pcm: bytes) -> None:
        assert running.stdout is not None
        taken = asyncio.ensure_future(running.stdout.read(640))
        while pcm not in heard:
            window.add(pcm, now(robot))  # again and again: a busy machine may hold one back
            if taken.done():
                heard.extend(taken.result())
                taken = asyncio.ensure_future(running.stdout.read(640))
            await asyncio.sleep(0.01)
        taken.cancel()

    async with asyncio.timeout(30):
        await hears(WORD)
    (listening,) = robot.host.handlers._sound._listening.values()
    await until(lambda: listening.waiting > 0 and listening.end == window._blocks[-1].end)
    cable.flowing.clear()
    window.add(b"\7\7" * 320, now(robot))
    await until(lambda: listening.end == window._blocks[-1].end)
    await asyncio.sleep(LATE_S + 0.1)  # the network holds it back for longer than that
    cable.flowing.set()
    await line_with(running, "late")
    async with asyncio.timeout(30):
        await hears(b"\3\4" * 320)
    assert b"\7\7" not in heard


async def test_a_voice_is_heard_and_what_the_network_held_back_is_not(
    rig: RemoteRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, cable = rig.two.robot, rig.two.cable
    reader = loudspeaker(robot, on=True)
    running = await rig.woz("talk", "program", rig.two.address, stdin=PIPE)
    assert running.stdin is not None
    heard = bytearray()

    def hears(pcm: bytes) -> bool:
        if (taken := reader.take()) is not None:
            heard.extend(taken[0].pcm)
        return pcm in heard

    running.stdin.write(WORD)
    await until(lambda: hears(WORD), 30)
    await line_with(running, "the robot says it")  # nothing of it is under way any more
    with monkeypatch.context() as patch:
        patch.setattr(sound_service, "LATE_S", 0.3)
        cable.flowing.clear()
        running.stdin.write(b"\7\7" * 320)
        await until(lambda: cable.held_there > 640, 30)
        await asyncio.sleep(0.4)  # the network holds it back for longer than that
        cable.flowing.set()
        talking = robot.host.handlers._sound._talking["robot"]
        await until(lambda: talking.late_s > 0, 30)
    heard.clear()
    while not hears(WORD):
        running.stdin.write(WORD)
        await asyncio.sleep(0.02)
    assert b"\7\7" not in heard


async def test_a_voice_goes_on_when_a_cut_line_is_back(rig: RemoteRig) -> None:
    robot, cable = rig.two.robot, rig.two.cable
    reader = loudspeaker(robot, on=True)
    running = await rig.woz("talk", "program", rig.two.address, stdin=PIPE)
    assert running.stdin is not None
    running.stdin.write(WORD)
    await until(lambda: reader.take() is not None, 30)
    await cable.cut()
    running.stdin.write(b"\7\7" * 320 + b"\7")  # nobody hears it, and samples stay whole
    await line_with(running, "is looked for")
    running.stdin.write(b"\7")
    await cable.lay()
    await line_with(running, "the line is back")
    heard = bytearray()
    while WORD not in heard:
        running.stdin.write(WORD)
        await asyncio.sleep(0.02)
        if (taken := reader.take()) is not None:
            heard.extend(taken[0].pcm)
    assert heard.startswith(WORD)
    running.terminate()
    assert running.stderr is not None
    assert b"Traceback" not in await asyncio.wait_for(running.stderr.read(), 30)


@pytest.mark.safety
async def test_who_is_revoked_is_told_and_the_command_ends(rig: RemoteRig) -> None:
    loudspeaker(rig.two.robot, on=True)
    running = await rig.woz("talk", "program", rig.two.address, stdin=PIPE)
    assert running.stdin is not None
    running.stdin.write(WORD)
    await line_with(running, "the robot says it")
    rig.two.authority.revoke("talk-program")
    await line_with(running, "revoked")
    assert await asyncio.wait_for(running.wait(), 30) == 1


#: It has ended, and what it has said last is still on its way: until its input ends.
LINE_PROCESS = """
exec 3<&0
(cat <&3; echo '{"trouble": "revoked", "final": true}') &
echo '{"socket": "/nowhere", "name": "talk", "role": "program"}'
"""


def test_the_reason_of_a_line_that_has_ended_is_the_last_one() -> None:
    with subprocess.Popen(["sh", "-c", LINE_PROCESS], stdin=PIPE, stdout=PIPE) as process:
        assert process.stdin is not None
        line = RemoteLine(process, "robot:7000")
        assert line.open() is not None
        assert process.wait(30) == 0
        threading.Timer(0.1, process.stdin.close).start()
        assert (line.final, line.reason) == (True, "revoked")


async def test_blocks_are_played_there(rig: RemoteRig, tmp_path: Path) -> None:
    (tmp_path / "b1.xml").write_text(BLOCK)
    words = (str(tmp_path / "b1.xml"), "--session", rig.two.address)
    running = await rig.woz("bml", "program", *words)
    _, said = await asyncio.wait_for(running.communicate(), 30)
    assert running.returncode == 0, said
    assert ("say", {"text": "Hello"}) in [
        (verb, {"text": args["text"]}) for verb, args in rig.two.robot.driver().calls
    ]


async def test_hands_join_and_are_let_go_with_the_line(rig: RemoteRig) -> None:
    running = await rig.woz("hands", "program", rig.two.address, stdout=PIPE)
    assert running.stdout is not None

    async def says(words: bytes) -> None:
        assert running.stdout is not None
        async with asyncio.timeout(30):
            while words not in await running.stdout.readline():
                pass

    await says(b"no panel for a gamepad")
    await rig.two.cable.cut()
    await says(b"looking for it again")
    await rig.two.robot.published(lambda line: isinstance(line, m.ConsoleLost))
    await rig.two.cable.lay()
    await says(b"no panel for a gamepad")


@pytest.mark.safety
async def test_hands_of_a_role_that_may_not_are_turned_away(rig: RemoteRig) -> None:
    running = await rig.woz("hands", "wizard", rig.two.address, stdout=PIPE)
    said, _ = await asyncio.wait_for(running.communicate(), 30)
    assert running.returncode == 1
    assert b"program" in said


async def test_an_assistants_tools_join_again_when_the_line_is_back(rig: RemoteRig) -> None:
    two = rig.two
    async with two.joined(two.access("assistant", "program")) as remote:
        tools = SessionTools(str(await remote.usable()))
        first = await tools.caller()
        assert (await first.call("say", {"text": "Hi"}))["done"]
        await two.cable.cut()
        with pytest.raises(WozConnectionError):
            while True:
                await (await tools.caller()).call("say", {"text": "nobody"})
        await two.cable.lay()
        done: dict[str, m.Json] = {}
        while not done:
            await remote.usable()
            with contextlib.suppress(WozConnectionError):
                done = await (await tools.caller()).call("say", {"text": "Hi"})
        assert done["sent"] == {"text": "Hi"}
        await tools.close()
