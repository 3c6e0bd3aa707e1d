"""The simulated robot learns a room: `listen_room` as a microphone has it, in simulated ticks."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.simulated import SimulatedSettings
from woz_drivers.simulated.senses import ROOM_NOISE, ROOM_SPREAD, THRESHOLD
from woz_drivers.simulated.verbs import offered
from woz_drivers.simulated.visitor import SimulatedVisitor
from woz_drivers.sound import room_threshold
from woz_drivers.sound.pcm_audio import decode, rms

from tests.fakes.simulated_rig import Rig, rig
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened
from woz_tui.protocol.messages import Json, Reading, SpeechEnded, SpeechStarted

VISITED = SimulatedSettings(visitor=True, seed=7)
#: What a microphone's answer holds, and the simulated one's.
TOLD = {"threshold", "was", "mean", "sd", "k", "loudest", "seconds"}


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[Rig]:
    async with rig(tmp_path, VISITED) as simulated_rig:
        yield simulated_rig


def levels(simulated_rig: Rig) -> list[Reading]:
    return simulated_rig.context.of("loudness")


def thresholds(simulated_rig: Rig) -> list[float | None]:
    return [reading.value for reading in simulated_rig.context.of(room_threshold.THRESHOLD)]


def number(sent: Json) -> float:
    assert isinstance(sent, int | float)
    return float(sent)


def test_it_is_the_microphones_verb() -> None:
    assert [verb for verb in offered(VISITED) if verb.lane == "listen"] == [
        *Microphone.offer(MicrophoneSettings()).verbs
    ]
    assert room_threshold.NAME not in {verb.name for verb in offered(SimulatedSettings())}
    assert room_threshold.NAME in {
        verb.name for verb in offered(SimulatedSettings(visitor=True, voice_only=True))
    }


async def test_live_sound_is_as_loud_as_the_loudness_says(robot: Rig) -> None:
    feed = robot.context.feed(SOUND)
    await robot.pace.advance(0.3)
    assert feed.latest().value is None, "nobody listens"
    robot.context.feed(LISTENED).put(SoundListened(robot.context.clock.now_us() + 3_600_000_000))
    before = len(levels(robot))
    await robot.pace.advance(0.3)
    sound = feed.latest().value
    assert isinstance(sound, LiveSound)
    heard = [rms(decode(block.pcm, "S16_LE", 1)) for block in sound.blocks]
    told = [number(reading.value) for reading in levels(robot)[before:]]
    assert heard == pytest.approx(told[-len(heard) :], rel=0.05, abs=1e-4)
    assert sound.rate * 0.1 == len(sound.blocks[-1].pcm) / 2


async def test_a_quiet_room_is_learnt_from_its_own_loudness(robot: Rig) -> None:
    """Two seconds are twenty ticks: just those that were published meanwhile count."""
    await robot.pace.advance(0.25)
    before = len(levels(robot))
    sent = await robot.do(room_threshold.NAME, seconds=2.0)
    heard = [number(reading.value) for reading in levels(robot)[before : before + 20]]
    assert sent.keys() == TOLD
    assert (sent["was"], sent["seconds"], sent["k"]) == (THRESHOLD, 2.0, 5.0)
    assert sent["mean"] == pytest.approx(sum(heard) / 20)
    assert sent["loudest"] == max(heard)
    assert abs(number(sent["mean"]) - ROOM_NOISE) < ROOM_SPREAD
    assert thresholds(robot) == [THRESHOLD, sent["threshold"]]
    assert [level for level, _, _ in robot.context.notices] == ["info"]


async def test_the_same_seed_teaches_the_same(tmp_path: Path) -> None:
    """Whatever the pace of the world, and whenever the robot looks at its clock."""
    found = []
    for speed, early in ((1.0, 0.31), (1.0, 0.39), (4.0, 0.39 / 4)):
        async with rig(
            tmp_path, SimulatedSettings(visitor=True, seed=7, speed=speed)
        ) as simulated_rig:
            await simulated_rig.pace.advance(early)
            found.append((await simulated_rig.do(room_threshold.NAME, seconds=1.5))["threshold"])
    assert found[0] == found[1] == found[2]


async def test_ten_seconds_are_usual(robot: Rig) -> None:
    sent = robot.begin(room_threshold.NAME, seconds=10.0)
    await robot.pace.advance(10.3)
    assert sent.done()
    assert (await sent)["seconds"] == 10.0


async def test_whoever_speaks_meanwhile_is_told_to_be_quiet(robot: Rig) -> None:
    while not robot.context.told:
        await robot.pace.advance(0.1)
    sent = await robot.do(room_threshold.NAME, seconds=3.0)
    level, text, remedy = robot.context.notices[-1]
    assert (level, "not quiet" in text) == ("warning", True)
    assert "once more" in remedy
    assert number(sent["threshold"]) > 3 * THRESHOLD


async def test_what_was_learnt_decides_what_is_speech(robot: Rig) -> None:
    """Learnt from a voice the threshold lies above every voice; learnt anew it is as it was."""
    while not robot.context.told:
        await robot.pace.advance(0.1)
    await robot.do(room_threshold.NAME, seconds=3.0)
    await robot.pace.advance(60.0)
    assert [type(one) for one in robot.context.told[:2]] == [SpeechStarted, SpeechEnded]
    few = sum(isinstance(one, SpeechStarted) for one in robot.context.told)
    as_usual = SimulatedVisitor(7)
    as_usual.step(robot.pace.now())
    assert few < sum(one.what == "started" for one in as_usual.speech())


def test_visits_do_not_hang_on_what_is_taken_for_speech() -> None:
    deaf, usual = SimulatedVisitor(3), SimulatedVisitor(3)
    deaf.hearing.ends.threshold = 0.9
    assert deaf.step(120.0) == usual.step(120.0)


# -- trouble -----------------------------------------------------------------------------------


async def test_a_muted_microphone_teaches_nothing(robot: Rig) -> None:
    await robot.do("fault", kind="silent", part="loudness", seconds=30.0)
    with pytest.raises(DeviceLostError, match="delivers no sound"):
        await robot.do(room_threshold.NAME, seconds=1.0)
    assert thresholds(robot) == [THRESHOLD]


async def test_samples_that_are_no_numbers_do_not_count(robot: Rig) -> None:
    await robot.do("fault", kind="nan", part="loudness", seconds=0.5)
    with pytest.raises(DeviceLostError, match="delivers no sound"):
        await robot.do(room_threshold.NAME, seconds=1.0)


async def test_a_cable_pulled_meanwhile_ends_it(robot: Rig) -> None:
    learning = robot.begin(room_threshold.NAME, seconds=5.0)
    await robot.pace.advance(1.0)
    await robot.do("fault", kind="disconnect", seconds=3.0)
    await robot.pace.advance(0.2)
    with pytest.raises(DeviceLostError, match="unplugged"):
        await learning
    assert thresholds(robot) == [THRESHOLD]


async def test_the_stop_ends_it_and_it_can_be_done_again(robot: Rig) -> None:
    learning = robot.begin(room_threshold.NAME, seconds=5.0)
    await robot.pace.advance(1.0)
    await robot.robot.stop(Scope.ALL)
    await robot.pace.advance(0.2)
    with pytest.raises(DriverError, match="stop"):
        await learning
    assert (await robot.do(room_threshold.NAME, seconds=0.5))["seconds"] == 0.5


async def test_without_a_visitor_there_is_no_microphone(tmp_path: Path) -> None:
    async with rig(tmp_path) as alone:
        with pytest.raises(RejectedError, match="cannot listen_room"):
            await alone.do(room_threshold.NAME, seconds=10.0)
