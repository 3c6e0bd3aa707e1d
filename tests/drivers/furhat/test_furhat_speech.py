"""What it says and plays, word by word and to its end; voice and volume."""

from __future__ import annotations

import asyncio
import base64
import functools
import struct
import wave
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from aiohttp import web
from furhat_realtime_api import AsyncFurhatClient
from robot_simulators.furhat import CHARACTERS_PER_S, VOICES
from woz_drivers.furhat import Furhat, FurhatSettings, speech
from woz_drivers.furhat.settings import FurhatTalkSettings, FurhatVoiceSettings
from woz_drivers.sound import live_talk
from woz_drivers.sound.emotion_sound import emotion_sound

from tests.drivers.furhat.furhat_rig import FurhatRig, brisk, connected_furhat
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope
from woz_tui.drivers.sound_feeds import VOICE, VOICE_STATE, SoundWindow, VoiceState
from woz_tui.protocol.messages import Json
from woz_tui.testing import until

SENTENCE = "Good morning to everybody in this room"


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[FurhatRig]:
    async with connected_furhat(tmp_path) as furhat_rig:
        yield furhat_rig


def sound(path: Path, seconds: float, rate: int = 8000, channels: int = 1) -> Path:
    with wave.open(str(path), "wb") as made:
        made.setnchannels(channels)
        made.setsampwidth(2)
        made.setframerate(rate)
        frames = round(seconds * rate) * channels
        made.writeframes(struct.pack(f"<{frames}h", *([8000] * frames)))
    return path


async def test_an_utterance_ends_when_the_robot_has_said_it(rig: FurhatRig) -> None:
    saying = rig.begin("say", text=SENTENCE)
    await until(lambda: rig.robot.speaking == SENTENCE)
    await rig.passes(0.5)
    assert not saying.done()
    sent = await rig.ended(saying)
    assert sent["text"] == SENTENCE
    assert not rig.robot.speaking


async def test_each_word_is_noted_with_its_time(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path, brisk()) as furhat_rig:
        words = (await furhat_rig.do("say", text=SENTENCE))["words"]
    assert isinstance(words, list)
    times = [float(str(one)) for one in words]
    assert len(times) == len(SENTENCE.split())
    assert times == sorted(times) and times[0] < times[-1]


async def test_the_countdown_follows_the_words_of_a_slow_voice(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robot_simulators.furhat.CHARACTERS_PER_S", CHARACTERS_PER_S / 4)
    monkeypatch.setattr(speech, "_WRONG_BY_S", 0.0)
    await rig.do("say", text=SENTENCE)
    announced = rig.jobs[-1].expected
    assert announced[0] == pytest.approx(len(SENTENCE) / 14, abs=0.1)
    assert len(announced) > 3


async def test_a_pause_is_one_between_two_utterances(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path, brisk()) as furhat_rig:
        sent = await furhat_rig.do("say", text="Hello \\pau=20\\ there")
        spoken = [each["text"] for each in furhat_rig.robot.requests("request.speak.text")]
    assert spoken == ["Hello", "there"]
    assert sent["text"] == "Hello there"
    assert isinstance(sent["words"], list)
    times = [float(str(one)) for one in sent["words"]]
    assert times == sorted(times)


async def test_nothing_is_said_of_an_empty_text(rig: FurhatRig) -> None:
    with pytest.raises(RejectedError):
        await rig.do("say", text="  ")
    assert not rig.robot.requests("request.speak.text")


async def test_a_cancelled_utterance_ends_on_the_robot_and_the_next_one_is_heard(
    rig: FurhatRig,
) -> None:
    saying = rig.begin("say", text=SENTENCE)
    await until(lambda: rig.robot.speaking == SENTENCE)
    saying.cancel()
    await until(lambda: not rig.robot.speaking)
    assert (await rig.do("say", text="Hello"))["text"] == "Hello"


@asynccontextmanager
async def vendors_client(furhat_rig: FurhatRig) -> AsyncIterator[AsyncFurhatClient]:
    other = AsyncFurhatClient("other")
    other.ws_url = f"ws://{furhat_rig.robot.address}/v1/events"
    await other.connect()
    try:
        yield other
    finally:
        await other.disconnect()


async def test_another_program_that_cuts_it_short_is_told(rig: FurhatRig) -> None:
    saying = rig.begin("say", text=SENTENCE)
    await until(lambda: rig.robot.speaking == SENTENCE)
    async with vendors_client(rig) as other:
        await other.request_speak_text("Now I speak", abort=True)
        with pytest.raises(DriverError, match="cut short"):
            await saying
        await until(lambda: rig.robot.speaking == "Now I speak")


async def test_an_utterance_that_does_not_begin_is_given_up_and_does_not_begin_later(
    rig: FurhatRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(speech, "_BEGINS_WITHIN_S", 0.1)
    rig.robot.ignored.add("request.speak.text")
    with pytest.raises(DriverError, match="did not begin"):
        await rig.begin("say", text=SENTENCE)
    await until(lambda: rig.robot.calls[-1][0] == "request.speak.stop")


async def test_a_refused_utterance_gives_the_robots_own_words(rig: FurhatRig) -> None:
    rig.robot.faults.refused["request.speak.text"] = "no voice is installed"
    with pytest.raises(DriverError, match="no voice is installed"):
        await rig.do("say", text=SENTENCE)


# -- sounds ----------------------------------------------------------------------------------------


async def test_a_file_of_this_machine_is_sent_as_it_is_played(
    rig: FurhatRig, tmp_path: Path
) -> None:
    sound(tmp_path / "gong.wav", 1.5, channels=2)
    sent = await rig.do("sound", file="gong.wav")
    assert sent == {"file": "gong.wav", "volume": 1.0}
    [started] = rig.robot.requests("request.speak.audio.start")
    assert started["sample_rate"] == 8000
    pieces = rig.robot.requests("request.speak.audio.data")
    assert len(pieces) > 3
    samples = sum(len(piece["audio"]) * 3 // 4 for piece in pieces) // 2
    assert samples == pytest.approx(1.5 * 8000, abs=2 * len(pieces))  # base64 is padded
    assert len(rig.robot.requests("request.speak.audio.end")) == 1
    assert rig.jobs[-1].expected[0] == pytest.approx(1.5)


async def test_a_sound_of_a_mood_is_sent_as_it_is_made_and_the_lips_move(rig: FurhatRig) -> None:
    """Twice the same by the same seed, as a re-run has it."""
    args = {"emotion": "sad", "valence": -0.87, "arousal": -0.5, "seed": 3, "seconds": 0.6}
    heard = []
    for _ in range(2):
        before = len(rig.robot.requests("request.speak.audio.data"))
        assert await rig.do("utter", **args) == {**args, "voice": "notes"}
        pieces = rig.robot.requests("request.speak.audio.data")[before:]
        heard.append(b"".join(base64.b64decode(piece["audio"]) for piece in pieces))
    assert heard[0] == heard[1] == emotion_sound(-0.87, -0.5, 0.6, 3).data
    starts = rig.robot.requests("request.speak.audio.start")
    assert {(one["sample_rate"], one["lipsync"]) for one in starts} == {(16_000, True)}


async def test_a_sound_of_a_mood_ends_with_its_command(rig: FurhatRig) -> None:
    playing = rig.begin("utter", emotion="happy", seconds=10, seed=1)
    await until(lambda: bool(rig.robot.speaking))
    playing.cancel()
    await until(lambda: not rig.robot.speaking)


async def test_a_cancelled_sound_ends_on_the_robot(rig: FurhatRig, tmp_path: Path) -> None:
    sound(tmp_path / "long.wav", 30)
    playing = rig.begin("sound", file="long.wav")
    await until(lambda: bool(rig.robot.speaking))
    playing.cancel()
    await until(lambda: not rig.robot.speaking)
    sent = len(rig.robot.requests("request.speak.audio.data"))
    await rig.passes(1.0)
    assert len(rig.robot.requests("request.speak.audio.data")) == sent


async def test_what_is_no_sound_is_refused(rig: FurhatRig, tmp_path: Path) -> None:
    (tmp_path / "note.wav").write_text("no sound")
    for name in ("note.wav", "nothing.wav"):
        with pytest.raises(RejectedError):
            await rig.do("sound", file=name)
    with pytest.raises(RejectedError, match="cannot be played") as raised:
        await rig.do("sound", file="note.wav")
    assert "ffmpeg" in raised.value.remedy
    assert not rig.robot.requests("request.speak.audio.start")


async def test_an_address_is_fetched_by_the_robot(rig: FurhatRig, tmp_path: Path) -> None:
    app = web.Application()
    app.router.add_static("/", sound(tmp_path / "far.wav", 0.5).parent)
    runner = web.AppRunner(app, shutdown_timeout=0.1)
    await runner.setup()
    site = web.TCPSite(runner, "127.0.0.1", 0)
    await site.start()
    place = f"http://127.0.0.1:{runner.addresses[0][1]}"
    try:
        assert await rig.do("sound", file=f"{place}/far.wav") == {"file": f"{place}/far.wav"}
        with pytest.raises(DriverError, match="could not"):
            await rig.do("sound", file=f"{place}/nothing.wav")
    finally:
        await runner.cleanup()


# -- voice and volume ------------------------------------------------------------------------------


async def test_voice_and_volume_of_the_robot_file_are_taken_on_connect(tmp_path: Path) -> None:
    voice = FurhatVoiceSettings(name="Amy", volume=0.35)
    async with connected_furhat(tmp_path, voice=voice) as furhat_rig:
        assert furhat_rig.robot.voice == VOICES[1]
        assert furhat_rig.robot.volume == 35
        assert (furhat_rig.settings_shown["voice"], furhat_rig.settings_shown["volume"]) == (
            VOICES[1]["voice_id"],
            0.35,
        )


async def test_a_voice_that_the_robot_does_not_have_is_told(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path, voice=FurhatVoiceSettings(name="Nobody")) as furhat_rig:
        assert "Nobody" in furhat_rig.notices
        assert (await furhat_rig.do("voice", name="Vicki"))["voice"] == VOICES[2]["voice_id"]
        with pytest.raises(RejectedError):
            await furhat_rig.do("voice")


@pytest.mark.parametrize("wish", [{"language": "sv-SE"}, {"name": "Amy", "language": "fr-FR"}])
async def test_a_voice_of_another_language_is_told(tmp_path: Path, wish: dict[str, str]) -> None:
    async with connected_furhat(tmp_path, voice=FurhatVoiceSettings(name="Vicki")) as furhat_rig:
        with pytest.raises(DriverError, match="Vicki"):
            await furhat_rig.do("voice", **wish)
        taken = await furhat_rig.do("voice", language="de", gender="female")
        assert str(taken["voice"]).startswith("Vicki")


async def test_the_volume_is_set_in_per_cent(rig: FurhatRig) -> None:
    assert await rig.do("volume", level=0.5) == {"level": 0.5}
    await until(lambda: rig.robot.volume == 50)


# -- a live voice ----------------------------------------------------------------------------------

#: 20 ms of a voice.
WORD = b"\1\2" * 320


class Talk:
    """Somebody who talks through the robot."""

    def __init__(self, furhat_rig: FurhatRig) -> None:
        self.rig = furhat_rig
        self.window = SoundWindow(furhat_rig.context.feed(VOICE), 16_000)

    @property
    def on(self) -> bool:
        state = self.rig.context.feed(VOICE_STATE).latest().value
        return isinstance(state, VoiceState) and state.on

    async def begin(self) -> asyncio.Task[Mapping[str, Json]]:
        task = self.rig.begin("talk")
        await until(lambda: self.on or task.done())
        return task

    def say(self, pcm: bytes = WORD) -> None:
        self.window.add(pcm, self.rig.context.clock.now_us(), "con7")

    def has(self, size: int) -> bool:
        """Whether the robot has so many bytes of it."""
        return len(self.sent) == size

    @property
    def sent(self) -> bytes:
        """What the robot has got of it."""
        pieces = self.rig.robot.requests("request.speak.audio.data")
        return b"".join(base64.b64decode(piece["audio"]) for piece in pieces)


@pytest.fixture
async def talk(tmp_path: Path) -> AsyncIterator[Talk]:
    async with connected_furhat(tmp_path, talk=FurhatTalkSettings()) as furhat_rig:
        yield Talk(furhat_rig)


async def test_a_live_voice_is_played_by_the_robot_while_it_is_on(talk: Talk) -> None:
    talk.say(b"\7\7" * 320)
    talking = await talk.begin()
    talk.say()
    await until(lambda: talk.sent == WORD)
    talk.say()
    await until(lambda: talk.sent == 2 * WORD)
    assert talk.rig.robot.requests("request.speak.audio.start") == [
        {"sample_rate": 16_000, "lipsync": True}
    ]
    await talk.rig.do("end_talk")
    sent = await talk.rig.ended(talking)
    assert (sent["played"], sent["dropped"], sent["by"]) == (0.04, 0.0, "con7")
    assert not talk.rig.robot.speaking
    assert not talk.rig.robot.requests("request.speak.stop")[1:], "its last words are heard"
    talk.say()
    await talk.rig.arrived()
    assert talk.sent == 2 * WORD


@pytest.mark.usefixtures("unhurried_stop")
async def test_a_stop_ends_a_live_voice_and_it_needs_the_key_again(talk: Talk) -> None:
    await talk.begin()
    talk.say()
    await until(lambda: talk.sent == WORD)
    report = await talk.rig.stop()
    assert "speech" in report.confirmed
    assert not talk.on and not talk.rig.robot.speaking
    talk.say()
    await talk.rig.arrived()
    assert talk.sent == WORD


async def test_the_wizards_line_ends_a_live_voice(talk: Talk) -> None:
    talking = await talk.begin()
    talk.say()
    await until(lambda: talk.sent == WORD)
    stopping = asyncio.ensure_future(talk.rig.driver.stop(Scope.DRIVE))
    talking.cancel()
    report = await stopping
    assert report is not None and (report.confirmed, report.missing) == (("speech",), ())
    assert not talk.rig.robot.speaking, "it is silent when it says so"
    assert await talk.rig.driver.stop(Scope.DRIVE) is None, "nobody talks any more"


async def test_what_the_robot_has_too_much_of_is_dropped(talk: Talk) -> None:
    talking = await talk.begin()
    talk.say()
    await until(lambda: talk.sent == WORD)
    await talk.rig.robot.send_raw('{"type": "response.speak.audio.buffer", "played": 0}')
    for count in range(2, 40):  # 20 ms each, and the robot plays nothing
        talk.say()
        await until(functools.partial(talk.has, min(count, 31) * len(WORD)))
    await talk.rig.do("end_talk")
    sent = await talk.rig.ended(talking)
    assert float(str(sent["dropped"])) > 0.0


async def test_one_who_talks_is_not_talked_over_by_the_robot(talk: Talk) -> None:
    saying = talk.rig.begin("say", text=SENTENCE)
    await until(lambda: bool(talk.rig.robot.speaking))
    with pytest.raises(RejectedError, match="speaking"):
        await (await talk.begin())
    await talk.rig.ended(saying)
    await talk.begin()
    with pytest.raises(RejectedError, match="talks"):
        await talk.rig.begin("say", text=SENTENCE)


async def test_a_voice_that_is_cut_short_at_the_robot_is_told(talk: Talk) -> None:
    talking = await talk.begin()
    talk.say()
    await until(lambda: bool(talk.rig.robot.speaking))
    async with vendors_client(talk.rig) as other:
        await other.request_speak_stop()
        with pytest.raises(DriverError, match="cut short"):
            await talking


async def test_a_robot_that_goes_ends_a_live_voice(talk: Talk) -> None:
    talking = await talk.begin()
    talk.say()
    await until(lambda: talk.sent == WORD)
    await talk.rig.robot.close()
    with pytest.raises(DeviceLostError):
        await talking
    assert not talk.on


def test_a_live_voice_is_offered_only_where_the_file_says_so() -> None:
    names = {verb.name for verb in Furhat.offer(FurhatSettings()).verbs}
    assert not names & live_talk.NAMES
    told = FurhatSettings(talk=FurhatTalkSettings(through='sox "')).problems()
    assert [path for path, _ in told] == ["talk.through"]
