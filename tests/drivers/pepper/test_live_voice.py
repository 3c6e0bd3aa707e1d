"""A voice through the robot's own loudspeaker over the wire."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path

import pytest
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.naoqi_robot.talk import TalkPart
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.sound.live_talk import TalkSettings

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.drivers.pepper.robot_rig import connected_robot
from tests.drivers.published_messages import until
from tests.fakes.libqi import SERVERS
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope
from woz_tui.drivers.sound_feeds import VOICE, VOICE_STATE, SoundWindow, VoiceState
from woz_tui.protocol.messages import Json

RATE = 16_000
#: 20 ms of a voice.
WORD = b"\1\2" * 320


class Talk:
    """`talk` of one part, and somebody who speaks."""

    def __init__(self, rig: PartRig[TalkPart], rate: int = RATE) -> None:
        self.rig = rig
        self.context = rig.published.context
        self.window = SoundWindow(self.context.feed(VOICE), rate)
        self.task: asyncio.Task[Mapping[str, Json]] | None = None

    @property
    def on(self) -> bool:
        state = self.context.feed(VOICE_STATE).latest().value
        return isinstance(state, VoiceState) and state.on

    async def begin(self) -> asyncio.Task[Mapping[str, Json]]:
        self.task = task = asyncio.ensure_future(self.rig.do("talk"))
        await until(lambda: self.on or task.done())
        return task

    def say(self, pcm: bytes = WORD) -> None:
        self.window.add(pcm, self.context.clock.now_us(), "con7")

    async def end(self) -> Mapping[str, Json]:
        await self.rig.do("end_talk")
        assert self.task is not None
        return await self.task

    async def until_played(self, pcm: bytes) -> None:
        async def there() -> bool:
            return bool((await self.rig.robot.get("sound.output"))["played"] == pcm.hex())

        await self.rig.robot.until(there)


@pytest.mark.naoqi("ALAudioDevice.setParameter", "ALAudioDevice.sendRemoteBufferToOutput")
@pytest.mark.parametrize("server", SERVERS)
async def test_a_voice_is_played_by_the_robot_while_it_is_on(tmp_path: Path, server: str) -> None:
    async with (
        stand_in(server) as robot,
        connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig,
    ):
        talk = Talk(rig)
        talk.say(b"\7\7" * 320)
        await talk.begin()
        talk.say()
        await talk.until_played(WORD)
        talk.say()
        await talk.until_played(2 * WORD)
        sent = await talk.end()
        assert (sent["played"], sent["dropped"], sent["by"]) == (0.04, 0.0, "con7")
        assert (await robot.get("sound.output"))["rate"] == RATE
        assert (await robot.get("sound.output"))["flushed"] == 0, "the last words are heard"
        talk.say()
        calls = await robot.trace("ALAudioDevice.sendRemoteBufferToOutput")
        assert sum(call.args[0] for call in calls) == 640


@pytest.mark.naoqi("ALAudioDevice.flushAudioOutputs")
async def test_a_stop_silences_the_robot_and_it_needs_the_key_again(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig:
        assert await rig.part.halt(Scope.ALL) is None, "nobody has talked"
        talk = Talk(rig)
        task = await talk.begin()
        talk.say()
        await talk.until_played(WORD)
        task.cancel()
        assert await rig.part.halt(Scope.ALL) == ()
        await asyncio.wait([task])
        assert not talk.on
        talk.say()
        await robot.called("ALAudioDevice.flushAudioOutputs")
        assert (await robot.get("sound.output"))["played"] == WORD.hex()


@pytest.mark.usefixtures("unhurried_stop")
async def test_the_wizards_line_ends_it(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, talk=TalkSettings()) as rig:
        task = rig.begin("talk")
        feed = rig.published.context.feed(VOICE_STATE)
        await until(lambda: isinstance(s := feed.latest().value, VoiceState) and s.on)
        window = SoundWindow(rig.published.context.feed(VOICE), RATE)
        window.add(WORD, rig.published.clock.now_us(), "con7")
        await rig.robot.called("ALAudioDevice.sendRemoteBufferToOutput")
        report = await rig.stop(Scope.DRIVE)
        assert "live voice" in report.confirmed
        await rig.cancel(task)


async def test_the_wizards_line_leaves_what_the_robot_says_itself(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig:
        talk = Talk(rig)
        task = await talk.begin()
        talk.say()
        await talk.until_played(WORD)
        task.cancel()  # as the bus does in the same turn
        await asyncio.sleep(0)
        assert await rig.part.halt(Scope.DRIVE) == ()
        await asyncio.wait([task])
        await talk.begin()
        talk.say()
        await talk.until_played(2 * WORD)
        await talk.end()
        flushed = (await robot.get("sound.output"))["flushed"]
        assert await rig.part.halt(Scope.DRIVE) is None
        assert (await robot.get("sound.output"))["flushed"] == flushed


async def test_a_robot_that_refuses_the_voice_is_told(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig:
        await robot.fault("refuse:ALAudioDevice.setParameter=no loudspeaker")
        with pytest.raises(DriverError, match="no loudspeaker"):
            await rig.do("talk")
        await robot.clear()
        await robot.fault("refuse:ALAudioDevice.sendRemoteBufferToOutput=busy")
        talk = Talk(rig)
        task = await talk.begin()
        talk.say()
        with pytest.raises(DriverError, match="busy"):
            await task
        assert not talk.on
        await robot.clear()
        await talk.begin()
        talk.say()
        await talk.until_played(WORD)
        await talk.end()


async def test_a_robot_that_goes_ends_it(tmp_path: Path) -> None:
    async with (
        stand_in() as robot,
        connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig,
    ):
        talk = Talk(rig)
        task = await talk.begin()
        robot.kill()
        with pytest.raises(DeviceLostError):
            await task
        assert not talk.on


async def test_a_robot_that_is_slow_costs_sound_and_no_time(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(TalkPart, tmp_path, robot, talk=TalkSettings()) as rig:
        talk = Talk(rig)
        await talk.begin()
        talk.say(WORD * 100)
        await talk.until_played(WORD * 5)
        sent = await talk.end()
        assert (sent["played"], sent["dropped"]) == (0.1, 1.9)


async def test_without_the_setting_nobody_can_talk(tmp_path: Path, robot: StandIn) -> None:
    assert TalkPart.offer(PepperSettings(robots=())).verbs == ()
    async with connected_part(TalkPart, tmp_path, robot) as rig:
        with pytest.raises(RejectedError) as raised:
            await rig.do("talk")
        assert "talk: {}" in raised.value.remedy
        assert await rig.part.halt(Scope.ALL) is None


def test_a_rate_that_no_loudspeaker_plays_is_told() -> None:
    settings = NaoSettings(talk=TalkSettings(rate=8_000, through='sox "'))
    assert [path for path, _ in settings.problems()] == ["talk.through", "talk.rate"]
