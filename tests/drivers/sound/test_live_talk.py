"""Somebody talks through the loudspeaker: what is heard, what changes it, and what ends it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
import wave
from collections.abc import AsyncIterator, Mapping
from pathlib import Path
from typing import Any

import psutil
import pytest
from woz_drivers.programs.child_process import guard
from woz_drivers.sound.live_talk import LiveTalk, VoiceTally
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import PlayedTalkSettings, SpeechSettings

from tests.drivers.published_messages import PATIENCE_S, BusJob, PublishedMessages, until
from tests.drivers.speech_rig import SCRIPT
from woz_tui.drivers.contract import DeviceLostError, DriverError, Probe, RejectedError, Scope
from woz_tui.drivers.sound_feeds import VOICE, VOICE_STATE, WIDTH, SoundWindow, VoiceState
from woz_tui.protocol.messages import DriverConnected, Json, Notice, SensorChanged
from woz_tui.system.clock import ManualClock, RealClock

RATE = 16_000
#: 20 ms of a voice, and what the changing program makes of it.
WORD, CHANGED = b"\1\2" * 320, b"\3\4" * 320
#: Reads pieces of 640 bytes and gives back others.
CHANGE = """
import sys
while len(sys.stdin.buffer.read(640)) == 640:
    sys.stdout.buffer.write(bytes([3, 4]) * 320)
    sys.stdout.buffer.flush()
"""
#: Works in blocks of two pieces.
BLOCKS = CHANGE.replace("640", "1280").replace("* 320", "* 640")
#: Loads until a file is there.
LOAD = """
import os, sys, time
while not os.path.exists(sys.argv[1]):
    time.sleep(0.01)
"""
#: Gives each piece back when the next one has come: it holds a word inside. Silence comes first.
#: Silence that comes in, behind what was said, makes an empty file.
HOLD = """
import sys
held = bytes(640)
while piece := sys.stdin.buffer.read(640):
    sys.stdout.buffer.write(held)
    sys.stdout.buffer.flush()
    held = piece
    if not any(piece):
        open(sys.argv[1], "w").close()
"""


class LiveTalkRig:
    """A loudspeaker whose player writes what it gets into a file, and somebody who talks."""

    def __init__(self, folder: Path, clock: RealClock | ManualClock, **talk: Any) -> None:
        self.out = folder / "heard"
        play = talk.pop("play", ("sh", "-c", f"exec cat >> {self.out}"))
        voice = (*SCRIPT, "synthesise", str(folder / "journal"), "--wav", "{wav}")
        settings = SpeechSettings(
            synthesise=voice, play=("true", "{wav}"), talk=PlayedTalkSettings(play=play, **talk)
        )
        assert settings.problems() == []
        self.clock = clock
        self.published = PublishedMessages(folder, clock)
        self.driver = Speech("it", settings, self.published.context)
        self.window = SoundWindow(self.published.context.feed(VOICE), RATE)
        self.talking: asyncio.Task[Mapping[str, Json]] | None = None

    async def open(self) -> None:
        await self.driver.open()
        await self.published.first(DriverConnected)
        await self.published.state("talk", "off")

    @property
    def on(self) -> bool:
        state = self.published.context.feed(VOICE_STATE).latest().value
        assert isinstance(state, VoiceState)
        return state.on

    @property
    def played_sound(self) -> bytes:
        """What the player has got."""
        return self.out.read_bytes() if self.out.exists() else b""

    def say(self, pcm: bytes = WORD, lost_s: float = 0.0) -> None:
        self.window.add(pcm, self.clock.now_us(), "con7", lost_s)

    async def until_changed(self) -> None:
        """Talk until it is heard: what comes before the program is up may be dropped."""

        def heard() -> bool:
            self.say(CHANGED)
            return CHANGED in self.played_sound

        await until(heard)

    async def until_heard(self) -> None:
        """Say a word until anything is heard: what comes before its program may be dropped."""

        def heard() -> bool:
            self.say()
            return bool(self.played_sound)

        await until(heard)

    async def until_silent(self, clock: ManualClock) -> None:
        """Let time pass until the sensor says that no voice comes."""

        def silent() -> bool:
            clock.advance(0.1)
            return self.published.states("talk")[-1] == "silent"

        await until(silent)

    async def begin(self) -> asyncio.Task[Mapping[str, Json]]:
        """`talk` is played, and the loudspeaker is open."""
        self.talking = asyncio.ensure_future(self.driver.perform(BusJob("talk")))
        await until(lambda: self.on or (self.talking is not None and self.talking.done()))
        return self.talking

    async def begin_again(self) -> None:
        """`begin`, as soon as the program that a stop ended is there again."""
        async with asyncio.timeout(PATIENCE_S):
            while (talking := await self.begin()).done():
                assert isinstance(talking.exception(), DeviceLostError)
                await asyncio.sleep(0.005)

    async def end(self) -> Mapping[str, Json]:
        await self.driver.perform(BusJob("end_talk"))
        assert self.talking is not None
        return await self.talking

    async def until_said(self, pcm: bytes) -> None:
        await until(lambda: self.played_sound == pcm)


@pytest.fixture
async def booths(tmp_path: Path) -> AsyncIterator[Any]:
    before = {one.pid for one in psutil.Process().children()}
    made: list[LiveTalkRig] = []

    async def opened(clock: RealClock | ManualClock | None = None, **talk: Any) -> LiveTalkRig:
        rig = LiveTalkRig(tmp_path, clock or RealClock(), **talk)
        made.append(rig)
        await rig.open()
        return rig

    yield opened
    for rig in made:
        await rig.driver.close()
        if rig.talking is not None:
            await asyncio.wait([rig.talking])
    below = [one for one in psutil.Process().children() if one.pid not in {guard.pid, *before}]
    assert [one for one in below if one.status() != "zombie"] == []


def python(program: str, *words: str) -> tuple[str, ...]:
    return (sys.executable, "-S", "-c", program, *words)


async def test_what_is_said_while_it_is_on_is_heard_and_nothing_else(booths: Any) -> None:
    rig = await booths()
    rig.say(b"\7\7" * 320)
    talking = await rig.begin()
    rig.say()
    await rig.until_said(WORD)
    rig.say(lost_s=0.25)
    await rig.until_said(2 * WORD)
    sent = await rig.end()
    assert talking.done()
    assert (sent["played"], sent["dropped"], sent["by"]) == (0.04, 0.25, "con7")
    assert "file" not in sent
    assert not rig.on
    rig.say()
    assert rig.played_sound == 2 * WORD
    assert not rig.published.context.media.exists(), "nothing is kept unless the file says so"


async def test_the_log_has_how_it_ended(booths: Any) -> None:
    rig = await booths(ManualClock())  # a slow player is no silence
    await rig.begin()
    rig.say()
    await rig.until_said(WORD)
    await rig.end()
    states = [one for one in rig.published.all(SensorChanged) if one.sensor == "talk"]
    assert [one.state for one in states] == ["off", "on", "off"]
    assert "0.0 s dropped by con7" in states[-1].why


@pytest.mark.parametrize("scope", list(Scope))
async def test_a_stop_silences_at_once_and_it_needs_the_key_again(
    booths: Any, scope: Scope
) -> None:
    rig = await booths(play=("sleep", "1000"))
    talking = await rig.begin()
    rig.say()
    talking.cancel()  # as the bus does
    await rig.driver.stop(scope)
    await until(talking.done)
    assert talking.cancelled()
    assert not rig.on
    await rig.driver.resume()
    rig.say()
    assert not rig.on
    why = [one for one in rig.published.all(SensorChanged) if one.sensor == "talk"][-1].why
    assert "stopped" in why


async def test_a_player_that_takes_nothing_costs_sound_and_no_time(booths: Any) -> None:
    rig = await booths(play=("sleep", "1000"))
    await rig.begin()
    rig.say(WORD * 100)
    sent = await rig.end()
    assert sent["played"] == pytest.approx(0.1, abs=0.03)
    assert sent["dropped"] == pytest.approx(1.9, abs=0.03)


async def test_a_player_that_ends_is_told(booths: Any) -> None:
    rig = await booths(play=("sh", "-c", "echo no such card >&2; exit 3"))
    talking = await rig.begin()
    with pytest.raises(DriverError, match="no such card"):
        await talking
    assert not rig.on


async def test_a_player_that_is_missing_is_told(booths: Any) -> None:
    rig = await booths(play=("no-such-player",))
    with pytest.raises(DriverError, match="no-such-player"):
        await (await rig.begin())


class EndedOutlet:
    """Takes everything, and has ended as soon as it is silenced."""

    def __init__(self) -> None:
        self._ended = False

    def give(self, pcm: bytes) -> None:
        """Nothing is kept."""

    async def check(self) -> None:
        """It has to run."""
        if self._ended:
            raise DriverError("the player ended")

    async def finish(self) -> None:
        """Nothing is left."""

    def silence(self) -> None:
        """It ends."""
        self._ended = True


async def test_a_robot_that_is_lost_is_told_before_the_player_that_ended_with_it(
    tmp_path: Path,
) -> None:
    @contextlib.asynccontextmanager
    async def loudspeaker(_: VoiceTally) -> AsyncIterator[EndedOutlet]:
        yield EndedOutlet()

    published = PublishedMessages(tmp_path, RealClock())
    talk = LiveTalk(PlayedTalkSettings(), published.context, loudspeaker)
    talk.start()
    talking = asyncio.ensure_future(talk.talk())
    await until(lambda: talk.on)
    talk.fail(DeviceLostError("the robot is gone"))
    with pytest.raises(DeviceLostError, match="the robot is gone"):
        await talking
    await talk.close()


async def test_nobody_who_sends_is_told(booths: Any) -> None:
    clock = ManualClock()
    rig = await booths(clock)
    await rig.begin()
    clock.advance(1.1)
    moved = await rig.published.state("talk", "silent")
    assert "woz talk" in moved.why
    rig.say()
    await rig.published.state("talk", "on")
    await rig.end()


async def test_it_ends_by_itself(booths: Any) -> None:
    clock = ManualClock()
    rig = await booths(clock, longest=30.0)
    talking = await rig.begin()
    clock.advance(29.0)
    await rig.published.state("talk", "silent")
    clock.advance(2.0)
    assert (await talking)["seconds"] == 31.0


async def test_nobody_talks(booths: Any) -> None:
    rig = await booths()
    with pytest.raises(RejectedError, match="nobody talks"):
        await rig.driver.perform(BusJob("end_talk"))


async def test_a_volume_counts(booths: Any) -> None:
    rig = await booths()
    await rig.driver.perform(BusJob("volume", {"level": 0.5}))
    await rig.begin()
    rig.say((1000).to_bytes(2, "little") * 320)
    await rig.until_said((500).to_bytes(2, "little") * 320)
    await rig.end()


# -- a program that changes the voice ----------------------------------------------------------


async def test_a_program_changes_the_voice(booths: Any) -> None:
    rig = await booths(through=python(CHANGE))
    await rig.begin()
    await rig.until_heard()
    await rig.end()
    assert rig.played_sound.replace(CHANGED, b"") == b""


async def test_a_program_that_dies_is_started_again_and_nobody_is_heard_unchanged(
    booths: Any,
) -> None:
    rig = await booths(ManualClock(), through=python(CHANGE))  # a slow start is no silence
    await rig.begin()
    rig.say()
    await rig.until_said(CHANGED)
    below = psutil.Process().children(recursive=True)
    (program,) = [one for one in below if one.is_running() and CHANGE in one.cmdline()]
    program.kill()
    await rig.published.state("talk", "stale")
    rig.say()
    await rig.published.state("talk", "on")
    rig.say()
    await until(lambda: len(rig.played_sound) == 2 * len(CHANGED))
    assert rig.played_sound == 2 * CHANGED
    assert (await rig.end())["dropped"] == 0.02


async def test_without_its_program_nobody_can_talk(tmp_path: Path) -> None:
    rig = LiveTalkRig(tmp_path, RealClock(), through=("no-such-changer",))
    await rig.driver.open()
    try:
        await rig.published.state("talk", "stale")
        with pytest.raises(DeviceLostError, match="no-such-changer"):
            await rig.driver.perform(BusJob("talk"))
    finally:
        await rig.driver.close()


async def test_a_program_that_gives_nothing_back_is_started_again(booths: Any) -> None:
    clock = ManualClock()
    rig = await booths(clock, longest=3600.0, through=("sleep", "1000"))
    talking = await rig.begin()

    def told() -> bool:
        clock.advance(0.5)
        rig.say()
        changes = rig.published.all(SensorChanged)
        return any((one.state, "sleep ran" in one.why) == ("stale", True) for one in changes)

    await until(told)
    await until(lambda: rig.published.states("talk")[-1] != "stale")
    assert not talking.done()
    await rig.end()


# The program's answer to the last half block may come after the clock was moved.
@pytest.mark.real_clock
async def test_who_stops_sending_is_heard_to_the_end_and_the_program_goes_on(booths: Any) -> None:
    clock = ManualClock()
    rig = await booths(clock, through=python(BLOCKS))
    talking = await rig.begin()
    rig.say(2 * WORD)
    await rig.until_said(2 * CHANGED)
    rig.say()  # half a block
    await rig.until_silent(clock)
    await until(lambda: len(rig.played_sound) > len(2 * CHANGED))
    clock.advance(100.0)
    await rig.end()
    assert talking.done()
    assert "stale" not in rig.published.states("talk")


async def test_a_program_that_loads_for_long_is_waited_for(booths: Any, tmp_path: Path) -> None:
    clock, gate = ManualClock(), tmp_path / "gate"
    rig = await booths(clock, through=python(LOAD + CHANGE, str(gate)))
    await rig.begin()
    rig.say()
    await rig.until_silent(clock)
    clock.advance(14.0)
    rig.say()
    await rig.published.state("talk", "on")
    gate.touch()
    await rig.until_changed()
    await rig.end()


async def test_what_a_program_holds_is_not_heard_after_a_stop(booths: Any, tmp_path: Path) -> None:
    rig = await booths(through=python(HOLD, str(tmp_path / "silence")))
    talking = await rig.begin()
    await rig.until_heard()
    talking.cancel()
    await rig.driver.stop(Scope.ALL)
    await until(talking.done)
    await rig.published.until(lambda: rig.published.states("talk")[-1] == "off")
    words = rig.played_sound.count(WORD)
    await rig.begin_again()
    await rig.until_changed()
    assert rig.played_sound.count(WORD) == words
    await rig.end()


async def test_what_a_program_holds_is_not_heard_the_next_time(booths: Any, tmp_path: Path) -> None:
    silence = tmp_path / "silence"
    rig = await booths(through=python(HOLD, str(silence)))
    await rig.begin()
    await rig.until_heard()
    await rig.end()
    await until(silence.exists)
    words = rig.played_sound.count(WORD)
    await rig.begin()
    await rig.until_changed()
    assert rig.played_sound.count(WORD) == words
    await rig.end()


class NarrowOutlet:
    """Plays as fast as time passes, and has room for as little as a real one."""

    def __init__(self, tally: VoiceTally, clock: ManualClock) -> None:
        self.given = 0
        self._tally = tally
        self._clock = clock
        self._played_us = 0

    def give(self, pcm: bytes) -> None:
        """What has no room is dropped."""
        self.given += 1
        now = self._clock.now_us()
        played_us = max(self._played_us, now) + len(pcm) // WIDTH * 1_000_000 // RATE
        if played_us - now > 100_000:
            self._tally.drop(len(pcm))
        else:
            self._played_us = played_us
            self._tally.hear(pcm)

    async def check(self) -> None:
        """It goes on."""

    async def finish(self) -> None:
        """It is heard."""

    def silence(self) -> None:
        """Nothing is kept."""


async def test_who_pauses_loses_no_sound_to_the_silence(tmp_path: Path) -> None:
    clock, outlets = ManualClock(), list[NarrowOutlet]()

    @contextlib.asynccontextmanager
    async def loudspeaker(tally: VoiceTally) -> AsyncIterator[NarrowOutlet]:
        outlets.append(NarrowOutlet(tally, clock))
        yield outlets[0]

    published = PublishedMessages(tmp_path, clock)
    window = SoundWindow(published.context.feed(VOICE), RATE)
    talk = LiveTalk(PlayedTalkSettings(through=python(CHANGE)), published.context, loudspeaker)
    talk.start()
    try:
        await published.state("talk", "off")
        talking = asyncio.ensure_future(talk.talk())
        await until(lambda: talk.on)
        window.add(WORD, clock.now_us(), "con7", 0.0)
        await until(lambda: outlets[0].given == 1)
        clock.advance(1.001)
        for pieces in range(2, 27, 2):  # the word, and half a second of silence
            await until(lambda: outlets[0].given >= pieces)  # noqa: B023
            clock.advance(0.04)
        talk.end()
        assert (await talking)["dropped"] == 0.0
    finally:
        await talk.close()


# -- kept --------------------------------------------------------------------------------------


async def test_what_is_heard_is_kept_where_the_file_says_so(booths: Any) -> None:
    rig = await booths(ManualClock(), keep=True, through=python(CHANGE))  # as above
    await rig.begin()
    rig.say()
    await rig.until_said(CHANGED)
    sent = await rig.end()
    path = rig.published.context.media.parent / str(sent["file"])
    assert path.stat().st_mode & 0o777 == 0o600

    def whole() -> bool:
        with contextlib.suppress(OSError, EOFError, wave.Error), wave.open(str(path)) as file:
            return (file.getframerate(), file.readframes(1 << 20)) == (RATE, CHANGED)
        return False

    await until(whole)


async def test_a_disk_that_takes_nothing_is_told_and_the_voice_is_heard(
    booths: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.open

    def full(name: Any, flags: int, mode: int = 0o777, **more: Any) -> int:
        place = "/dev/full" if str(name).endswith(".wav") else name
        return real(place, flags & ~os.O_EXCL if place != name else flags, mode, **more)

    monkeypatch.setattr(os, "open", full)
    rig = await booths(keep=True)
    await rig.begin()
    rig.say()
    notice = await rig.published.first(Notice)
    assert (notice.level, "not kept" in notice.text) == ("error", True)
    await rig.until_said(WORD)
    rig.say()
    await rig.until_said(2 * WORD)
    assert "file" not in await rig.end()


# -- settings ----------------------------------------------------------------------------------


def test_it_is_offered_only_where_the_file_says_so() -> None:
    names = {verb.name for verb in Speech.offer(SpeechSettings()).verbs}
    assert not names & {"talk", "end_talk"}
    offered = {
        verb.name: verb for verb in Speech.offer(SpeechSettings(talk=PlayedTalkSettings())).verbs
    }
    assert offered["talk"].drives, "it ends when nobody watches"
    assert not offered["talk"].waits, "a second press is no voice that is on later"


def test_what_cannot_be_is_told() -> None:
    def paths(**talk: Any) -> list[str]:
        return [path for path, _ in SpeechSettings(talk=PlayedTalkSettings(**talk)).problems()]

    assert paths() == []
    assert paths(through='sox "') == ["talk.through"]
    assert paths(play="pacat --rate={hz}") == ["talk.play"]


async def test_woz_doctor_looks_for_its_programs(tmp_path: Path) -> None:
    settings = SpeechSettings(
        play=("true", "{wav}"),
        talk=PlayedTalkSettings(through="no-such-changer", play="no-such-player"),
    )
    found = await Speech.examine(Probe("voice", settings, tmp_path))
    wrong = [one.text for one in found if one.level == "error"]
    assert [name for name in ("no-such-changer", "no-such-player") if name in " ".join(wrong)] == [
        "no-such-changer",
        "no-such-player",
    ]
