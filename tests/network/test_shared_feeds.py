"""Pictures and live sound of a driver at another computer: as those of a driver here, bounded, and
never late.
"""

from __future__ import annotations

import base64
import zlib
from pathlib import Path
from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.simulated import SimulatedRobot

from tests.fakes.ports import free_port
from tests.host.rig import served_session
from tests.network.other_computer import Arm, OtherComputer, Pair, listens, pair
from woz_tui.config.loading import load
from woz_tui.drivers.contract import DriverContext, Health
from woz_tui.drivers.feeds import Feeds
from woz_tui.drivers.own_voice import ROBOT_SPEECH, RobotSentence, RobotSpeech
from woz_tui.drivers.plugins import installed
from woz_tui.drivers.sound_feeds import (
    LISTENED,
    SOUND,
    VOICE,
    VOICE_STATE,
    LiveSound,
    SoundListened,
    SoundOffer,
    SoundReader,
    SoundWindow,
    VoiceState,
)
from woz_tui.network import driver_messages as dm
from woz_tui.network.driver_line import CAPACITY
from woz_tui.network.shared_feeds import PICTURE_BYTES, ServedFeeds, SessionFeeds, thinned
from woz_tui.network.zenoh_line import FrameInbox
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.system.clock import ManualClock
from woz_tui.testing import until

S = 1_000_000
RATE = 16_000
WORD = b"\1\2" * 320


class SeeingArm(Arm):
    """With a camera, a microphone, and a loudspeaker for a live voice."""

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.pictures, self.watched = context.feed(PICTURE), context.feed(WATCHED)
        self.microphone = SoundOffer(context, RATE)
        self.voice = SoundReader(context.feed(VOICE))
        self.robots = context.feed(ROBOT_SPEECH)
        self.voice_state = context.feed(VOICE_STATE)
        self.voice_state.put(VoiceState(RATE))


def seeing(two: Pair) -> SeeingArm:
    assert isinstance(two.arm, SeeingArm)
    return two.arm


async def test_a_picture_comes_while_somebody_watches_and_no_wider_than_is_wanted(
    tmp_path: Path,
) -> None:
    async with pair(tmp_path, SeeingArm) as two:
        context, arm = two.context, seeing(two)
        now = context.clock.now_us()
        context.feed(WATCHED).put(CameraWatched(now + 60 * S, 4, 10.0))
        await until(lambda: arm.watched.latest().value is not None)
        wish = arm.watched.latest().value
        assert (wish.width, wish.rate) == (4, 10.0)
        assert wish.until_us <= arm.context.clock.now_us() + 5 * S, "it ends by itself"
        taken = arm.context.clock.now_us()
        arm.pictures.put(Picture(taken, 8, 2, bytes(range(48))))
        await until(lambda: context.feed(PICTURE).latest().value is not None)
        picture = context.feed(PICTURE).latest().value
        assert (picture.width, picture.height) == (4, 1)
        assert picture.rgb == bytes([0, 1, 2, 6, 7, 8, 12, 13, 14, 18, 19, 20])
        assert abs(context.clock.now_us() - picture.t_us) < 2 * S


async def test_the_microphone_is_heard_while_somebody_listens(tmp_path: Path) -> None:
    async with pair(tmp_path, SeeingArm) as two:
        context, arm = two.context, seeing(two)
        assert not arm.microphone.wanted
        context.feed(LISTENED).put(SoundListened(context.clock.now_us() + 60 * S))
        await until(lambda: arm.microphone.wanted)
        heard = bytearray()
        reader = SoundReader(context.feed(SOUND))
        said = 0

        def hears() -> bool:
            nonlocal said
            arm.microphone.add(said.to_bytes(2, "little") * 320)
            said += 1
            if (taken := reader.take()) is not None:
                heard.extend(taken[0].pcm)
            return len(heard) >= 5 * 640

        await until(hears)
        order = [int.from_bytes(heard[at : at + 2], "little") for at in range(0, len(heard), 640)]
        assert order == sorted(set(order)), "each piece once, in order"


async def test_a_microphone_there_knows_what_the_robots_say(tmp_path: Path) -> None:
    async with pair(tmp_path, SeeingArm) as two:
        context, arm = two.context, seeing(two)
        await until(lambda: bool(context.feeds.drivers(ROBOT_SPEECH)))
        said = RobotSpeech((RobotSentence("c1", "Hello", 5 * S), RobotSentence("c0", "Hi", 1, 2)))
        context.feed(ROBOT_SPEECH).put(said)
        await until(lambda: arm.robots.latest().value == said)


async def test_a_voice_reaches_the_loudspeaker_there_and_a_lost_line_switches_it_off(
    tmp_path: Path,
) -> None:
    async with pair(tmp_path, SeeingArm) as two:
        context, arm = two.context, seeing(two)
        await until(lambda: context.feed(VOICE_STATE).latest().value == VoiceState(RATE))
        arm.voice_state.put(VoiceState(RATE, on=True))
        await until(lambda: context.feed(VOICE_STATE).latest().value == VoiceState(RATE, on=True))
        window = SoundWindow(context.feed(VOICE), RATE)
        heard = bytearray()

        def hears() -> bool:
            window.add(WORD, context.clock.now_us(), "woz talk", 1.5)
            if (taken := arm.voice.take()) is not None:
                heard.extend(taken[0].pcm)
                assert (taken[1].source, taken[1].lost_s) == ("woz talk", 1.5)
            return len(heard) >= 640

        await until(hears)
        assert heard.startswith(WORD)
        await two.cable.cut()
        await two.healthy(Health.LOST)
        assert context.feed(VOICE_STATE).latest().value == VoiceState(RATE, on=False)


async def test_a_console_sees_the_camera_of_a_robot_at_another_computer(tmp_path: Path) -> None:
    port = free_port()
    file = tmp_path / "e.yaml"
    file.write_text(
        "title: T\nrobot:\n  drivers:\n    robot: {type: simulated, visitor: true, at:"
        f" {{name: arm-pi, listen: 'tcp://127.0.0.1:{port}'}}}}\n"
        "panels: [{title: P, actions: [{key: h, label: Hello, say: Hello}]}]\n"
    )
    experiment = load(file, installed())
    async with served_session(tmp_path, made=experiment, catalogue=installed()) as host:
        await until(lambda: listens(port))
        other = OtherComputer(
            SimulatedRobot, experiment.drivers[0].settings, tmp_path, type="simulated", name="robot"
        )
        await other.start(f"tcp://127.0.0.1:{port}")
        try:
            await until(lambda: "robot" in host.session.feeds.drivers(PICTURE), 20)
            peer = await host.connect()
            await peer.hello("wizard")
            line: dict[str, Any] = {}
            for ref in range(1, 20):
                await peer.say(kind="picture", ref=ref, width=40, height=30, rate=5.0)
                line = await peer.until(lambda line: line["kind"] == "picture")
                if line.get("data"):
                    break
            assert line["cameras"] == ["robot"]
            assert len(zlib.decompress(base64.b64decode(line["data"]))) == (
                3 * line["width"] * line["height"]
            )
        finally:
            await other.end()


# -- bounds ----------------------------------------------------------------------------------------


@given(st.integers(1, 40), st.integers(1, 30), st.integers(1, 60))
def test_a_thinned_picture_is_every_so_many_pixels(width: int, height: int, wanted: int) -> None:
    rgb = bytes(at % 251 for at in range(3 * width * height))
    thin = thinned(Picture(7, width, height, rgb), wanted)
    assert len(thin.rgb) == 3 * thin.width * thin.height
    assert thin.width >= min(width, wanted)
    by = -(-width // thin.width) if thin.width < width else 1
    for y in range(thin.height):
        for x in range(thin.width):
            at = 3 * (y * by * width + x * by)
            if thin.width < width and x * by < width:
                assert thin.rgb[3 * (y * thin.width + x) :][:3] == rgb[at : at + 3]


def test_a_large_picture_is_made_to_fit() -> None:
    large = Picture(0, 1920, 1080, bytes(3 * 1920 * 1080))
    assert len(thinned(large, 1920).rgb) <= PICTURE_BYTES


def test_pictures_that_come_too_fast_are_left_out() -> None:
    clock, feeds = ManualClock(), Feeds()
    clock.advance(1)
    feeds.feed("eye", PICTURE)
    feeds.feed("eye", WATCHED).put(CameraWatched(100 * S, 100, 30.0))
    mine = ServedFeeds(feeds, "eye", clock)
    sent = 0
    for _ in range(1000):
        feeds.feed("eye", PICTURE).put(Picture(clock.now_us(), 100, 100, bytes(30_000)))
        sent += sum(isinstance(body, dm.PictureSent) for body in mine.news(0))
        clock.advance(0.01)
    assert 90 <= sent <= 120, "ten a second, of a hundred"


def test_what_comes_late_or_is_none_is_not_put_into_a_feed() -> None:
    clock, feeds = ManualClock(), Feeds()
    clock.advance(100)
    session = SessionFeeds(lambda topic: feeds.feed("arm", topic), clock)
    ahead = clock.boot_us() - clock.now_us()
    now = clock.now_us() + ahead
    session.take(dm.FeedsNamed((PICTURE, SOUND, "setpoints")))
    assert not feeds.drivers("setpoints")
    for bad in (
        dm.PictureSent(now - 10 * S, 1, 1, b"abc"),
        dm.PictureSent(now, 2, 2, b"abc"),
        dm.PictureSent(now, -1, -1, b"abc"),
        dm.SoundSent(SOUND, RATE, now - 1 * S, WORD),
        dm.SoundSent(SOUND, 0, now, WORD),
        dm.SoundSent(SOUND, RATE, now, b"odd"),
        dm.SoundSent(SOUND, RATE, now, WORD * 1000),
        dm.SoundSent(VOICE, RATE, now, WORD),
        dm.VoiceTaken(7, True),
    ):
        session.take(bad)
    assert not any(feeds.feed("arm", topic).latest().serial for topic in (PICTURE, SOUND, VOICE))
    session.take(dm.SoundSent(SOUND, RATE, now, WORD))
    sound = feeds.feed("arm", SOUND).latest().value
    assert isinstance(sound, LiveSound)
    assert sound.blocks[-1].pcm == WORD


async def test_an_inbox_keeps_so_many_frames_and_drops_the_rest() -> None:
    taken: list[bytes] = []
    inbox = FrameInbox(taken.append)
    for number in range(3 * CAPACITY):
        inbox.put(number.to_bytes(4, "big"))
    inbox.put(bytes(dm.MOST_BYTES + 1))
    await until(lambda: len(taken) == CAPACITY)
    assert taken[-1] == (CAPACITY - 1).to_bytes(4, "big")
    inbox.put(b"next")
    await until(lambda: taken[-1] == b"next")
