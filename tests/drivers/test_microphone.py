"""The microphone driver behind real commands: a pipe as the sound source, and what goes wrong."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.programs.child_process import guard
from woz_drivers.sound import pcm_audio

from tests.drivers.microphones import learning, microphone_opener
from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.child_processes import offspring
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import RATE, square
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverError,
    Finding,
    Probe,
    RejectedError,
    Scope,
)
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened
from woz_tui.protocol.messages import DriverConnected, DriverLost, Notice
from woz_tui.system.clock import ManualClock, RealClock

Begin = Callable[..., Any]


@pytest.fixture
def pipe(tmp_path: Path) -> PipedCommand:
    return PipedCommand(tmp_path / "pipe")


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def begin(tmp_path: Path, clock: ManualClock) -> AsyncIterator[Begin]:
    async with microphone_opener(tmp_path) as some:

        async def started(
            command: tuple[str, ...] | str, real: bool = False, **settings: Any
        ) -> tuple[Microphone, PublishedMessages]:
            return await some.open(RealClock() if real else clock, command=command, **settings)

        yield started


async def test_loudness_of_the_loudest_block_ten_times_a_second(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(square(0.45, 0.25) + square(0.05, 0.5) + square(0.5, 0.125))
    await published.until(lambda: len(published.values("loudness")) == 10)
    assert published.values("loudness") == pytest.approx([0.25] * 4 + [0.5] + [0.125] * 5, rel=1e-3)
    assert published.all(DriverConnected)[0].detail == "cat, 16000 Hz, S16_LE, 1 channel"


async def test_rms_over_all_blocks_at_another_rate(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe.command, measure="rms", publish=5)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.6) + square(0.1, 0.0) + square(0.2, 0.3))
    await published.until(lambda: len(published.values("loudness")) == 2)
    assert published.values("loudness") == pytest.approx([0.6 / 2**0.5, 0.3], rel=1e-3)


async def test_a_stream_split_at_odd_bytes_is_the_same(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    data = square(0.1, 0.25) + square(0.1, 0.5)
    for start in range(0, len(data), 611):
        pipe.send(data[start : start + 611])
        await asyncio.sleep(0)
    await published.until(lambda: len(published.values("loudness")) == 2)
    assert published.values("loudness") == pytest.approx([0.25, 0.5], rel=1e-3)


async def test_one_channel_of_two_in_24_bits(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe.command, format="S24_3LE", channels=2, channel=2)
    await until(pipe.connected)
    stereo = np.tile(np.array([[0.9, 0.3], [-0.9, -0.3]], np.float32), (RATE // 20, 1))
    pipe.send(pcm_audio.encode(stereo, "S24_3LE"))
    await published.until(lambda: len(published.values("loudness")) == 1)
    assert published.values("loudness") == pytest.approx([0.3], rel=1e-3)


async def test_speaking_quiet_clipping_and_silent(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe.command, threshold=0.1, hang_over=0.2, silent_after=0.5)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.05) + square(0.2, 0.5) + square(0.3, 0.05))
    await published.until(lambda: published.states("loudness") == ["quiet", "speaking", "quiet"])
    pipe.send(square(0.1, 0.9999) + square(1.2, 0.3))
    await published.until(lambda: published.states("loudness")[3:] == ["clipping", "speaking"])
    pipe.send(square(0.8, 0.0))
    await published.until(lambda: published.states("loudness")[5:] == ["quiet", "silent"])
    assert "muted" in (await published.state("loudness", "silent")).why
    pipe.send(square(0.1, 0.01))
    await published.state("loudness", "quiet")


async def test_a_room_is_learned_and_reported(begin: Begin, pipe: PipedCommand) -> None:
    microphone, published = await begin(pipe.command, hang_over=0.1)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.05))
    await published.state("loudness", "speaking")
    job, performing = await learning(microphone, 0.4)
    assert job.announced == [0.4]
    pipe.send(square(0.2, 0.05) + square(0.2, 0.07))
    sent = await performing
    assert sent == {
        "threshold": pytest.approx(0.06 + 4 * 0.01, rel=1e-3),
        "was": 0.02,
        "mean": pytest.approx(0.06, rel=1e-3),
        "sd": pytest.approx(0.01, rel=1e-2),
        "k": 4.0,
        "loudest": pytest.approx(0.07, rel=1e-3),
        "seconds": pytest.approx(0.4),
    }
    assert "threshold: 0.1000" in published.all(Notice)[0].remedy
    assert published.values("loudness.threshold") == pytest.approx([0.02, 0.1], rel=1e-3)
    pipe.send(square(0.2, 0.07))
    await published.state("loudness", "quiet")
    pipe.send(square(0.2, 0.12))
    await published.state("loudness", "speaking")


async def test_whoever_speaks_while_it_listens_is_told_to_be_quiet(
    begin: Begin, pipe: PipedCommand
) -> None:
    microphone, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.01))
    await published.state("loudness", "quiet")
    _, performing = await learning(microphone, 0.4)
    pipe.send(square(0.3, 0.01) + square(0.1, 0.3))
    sent = await performing
    assert sent["loudest"] == pytest.approx(0.3, rel=1e-3)
    warning = published.all(Notice)[-1]
    assert (warning.level, "not quiet" in warning.text) == ("warning", True)


async def test_a_muted_microphone_teaches_nothing(begin: Begin, pipe: PipedCommand) -> None:
    microphone, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.0))
    await published.state("loudness", "quiet")
    _, performing = await learning(microphone, 0.1)
    pipe.send(square(0.2, 0.0))
    with pytest.raises(DriverError, match="only zeros"):
        await performing


async def test_learning_ends_with_the_command(begin: Begin, pipe: PipedCommand) -> None:
    microphone, published = await begin(pipe.command)
    with pytest.raises(DeviceLostError, match="delivers no sound"):
        await microphone.perform(BusJob("listen_room", {"seconds": 1.0}))
    await until(pipe.connected)
    pipe.send(square(0.1, 0.05))
    await published.state("loudness", "speaking")
    _, performing = await learning(microphone, 1.0)
    pipe.unplug()
    with pytest.raises(DeviceLostError, match="cat ended"):
        await performing


async def test_learning_can_be_cancelled(begin: Begin, pipe: PipedCommand) -> None:
    microphone, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.05))
    await published.state("loudness", "speaking")
    _, performing = await learning(microphone, 1.0)
    performing.cancel()
    with pytest.raises(asyncio.CancelledError):
        await performing
    pipe.send(square(0.3, 0.01))  # more sound after that harms nobody
    await published.until(lambda: len(published.values("loudness")) == 4)


# -- trouble -----------------------------------------------------------------------------------


async def test_a_command_that_dies_is_lost_with_its_last_words_and_started_again(
    begin: Begin, tmp_path: Path
) -> None:
    (tmp_path / "sound.raw").write_bytes(square(0.2, 0.25))
    script = "cat sound.raw; echo hello >&2; echo 'device unplugged' >&2; exit 1"
    _, published = await begin(("sh", "-c", script))
    lost = await published.first(DriverLost)
    assert lost.detail == "sh ended: device unplugged"
    assert lost.remedy
    assert (await published.state("loudness", "stale")).why == "sh ended: device unplugged"
    await published.first(DriverLost, after=1)  # it came back, and died again
    assert len(published.all(DriverConnected)) == 2
    assert published.values("loudness") == pytest.approx([0.25] * 4, rel=1e-3)


async def test_a_missing_program_names_its_package_and_is_found_once_it_is_there(
    begin: Begin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "bin"
    here.mkdir()
    monkeypatch.setenv("PATH", f"{here}")
    _, published = await begin("parec --raw")
    lost = await published.first(DriverLost)
    assert lost.detail == "parec is not installed on this machine"
    assert lost.remedy == "sudo apt install pulseaudio-utils"
    (tmp_path / "sound.raw").write_bytes(square(0.2, 0.25))
    program = here / "parec"
    program.write_text("#!/bin/sh\nexec /bin/cat sound.raw\n")
    program.chmod(0o700)
    await published.first(DriverConnected)


async def test_a_command_that_hangs_is_stale_then_ended_and_started_again(
    begin: Begin, pipe: PipedCommand, clock: ManualClock
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(square(0.1, 0.01))
    await published.state("loudness", "quiet")
    clock.advance(1.5)
    assert "delivers no sound" in (await published.state("loudness", "stale")).why
    pipe.send(square(0.1, 0.01))
    await published.state("loudness", "quiet")
    clock.advance(6)
    assert (await published.first(DriverLost)).detail == "cat ran, but delivered no sound"


async def test_nothing_is_left_behind(begin: Begin, tmp_path: Path) -> None:
    (tmp_path / "sound.raw").write_bytes(square(0.2, 0.25))
    before = {one.pid for one in offspring()}  # of other tests, for the whole run
    microphone, published = await begin(("sh", "-c", "sleep 1000 & cat sound.raw; wait"))
    await published.first(DriverConnected)

    await until(lambda: len(offspring(named="sleep")) == 1)
    children = [one for one in offspring() if one.pid not in {guard.pid, *before}]
    await microphone.close()
    _, left = psutil.wait_procs(children, timeout=10)
    assert left == []


async def test_sound_faster_than_real_time_is_slowed_down(begin: Begin) -> None:
    _, published = await begin(("head", "-c", "64000000", "/dev/zero"))  # 2000 s of it
    await published.until(lambda: len(published.values("loudness")) >= 20)
    for _ in range(200):
        await asyncio.sleep(0.001)
    assert len(published.values("loudness")) < 2000
    assert published.all(DriverLost) == []


async def test_it_knows_no_other_verb(begin: Begin, pipe: PipedCommand) -> None:
    microphone, _ = await begin(pipe.command)
    assert [verb.name for verb in Microphone.offer(MicrophoneSettings()).verbs] == ["listen_room"]
    deaf, hears = MicrophoneSettings(), MicrophoneSettings(transcribe="whisper {file}")
    assert Microphone.offer(deaf).sensors == ("loudness", "loudness.threshold", "speech")
    assert Microphone.offer(hears).sensors == (
        *Microphone.offer(deaf).sensors,
        "speech.text",
        "transcriber",
    )
    with pytest.raises(RejectedError):
        await microphone.perform(BusJob("say", {"text": "x"}))
    await microphone.stop(Scope.ALL)
    await microphone.rest()


# -- settings and preflight --------------------------------------------------------------------


def test_the_command_by_default() -> None:
    words = MicrophoneSettings(device="plughw:1,0", rate=48000, channels=2).words
    assert " ".join(words) == "arecord -q -D plughw:1,0 -t raw -f S16_LE -r 48000 -c 2"


@pytest.mark.parametrize(
    ("wrong", "setting"),
    [
        ({"channel": 2}, "channel"),
        ({"command": "parec", "device": "hw:1"}, "device"),
        ({"command": "parec 'x"}, "command"),
    ],
)
def test_settings_that_contradict_each_other(wrong: dict[str, Any], setting: str) -> None:
    assert [name for name, _ in MicrophoneSettings(**wrong).problems()] == [setting]


async def examined(tmp_path: Path, data: bytes, **settings: Any) -> Finding:
    (tmp_path / "sound.raw").write_bytes(data)
    microphone_settings = MicrophoneSettings(command="cat sound.raw", **settings)
    (finding,) = await Microphone.examine(Probe("ear", microphone_settings, tmp_path))
    return finding


@pytest.mark.parametrize(
    ("level", "expected", "words"),
    [
        (0.01, "ok", "RMS 0.0100 (-40 dB)"),
        (0.0, "error", "only zeros"),
        (0.00004, "warning", "very quiet"),
        (0.2, "warning", "louder than the threshold"),
        (0.9999, "warning", "clipping"),
    ],
)
async def test_examine_measures_a_second(
    tmp_path: Path, level: float, expected: str, words: str
) -> None:
    finding = await examined(tmp_path, square(1.5, level))
    assert (finding.level, finding.subject) == (expected, "ear")
    assert words in finding.text


#: Constant samples of 1200, as an I2S microphone gives them in silence.
OFFSET = (1200).to_bytes(2, "little")
NO_FORMAT = (
    "arecord: set_params:1358: Sample format non available\n"
    "Available formats:\n- FLOAT64_LE\n- S24_3LE\n"
)


async def test_an_offset_is_no_speech_and_the_doctor_names_it(
    begin: Begin, pipe: PipedCommand, tmp_path: Path
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(OFFSET * RATE)
    await published.until(lambda: len(published.values("loudness")) == 10)
    assert published.values("loudness") == pytest.approx([0.0] * 10, abs=1e-6)
    assert published.states("loudness") == ["quiet"]
    finding = await examined(tmp_path, OFFSET * 2 * RATE)
    assert "offset 0.037" in finding.text
    assert "louder than the threshold" not in finding.text


async def test_speech_on_an_offset_is_as_loud_as_without(begin: Begin, pipe: PipedCommand) -> None:
    samples = np.frombuffer(square(0.2, 0.25), dtype="<i2") + 1200
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(samples.astype("<i2").tobytes())
    await published.until(lambda: len(published.values("loudness")) == 2)
    assert published.values("loudness") == pytest.approx([0.25, 0.25], rel=1e-3)
    assert published.states("loudness")[-1] == "speaking"


@pytest.fixture
def alsa(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Puts an arecord in front that says something and ends."""

    def ends_with(said: str) -> None:
        program = tmp_path / "bin" / "arecord"
        program.parent.mkdir()
        program.write_text(f"#!/bin/sh\ncat >&2 <<'END'\n{said}\nEND\nexit 1\n")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", str(program.parent), prepend=":")

    return ends_with


@pytest.mark.parametrize(
    ("said", "device", "told"),
    [
        (NO_FORMAT, "hw:2,0", ("Sample format non available", "`format: S24_3LE` beside")),
        (NO_FORMAT, "hw:2,0", ("formats: FLOAT64_LE, S24_3LE", "`device: plughw:2,0`")),
        (NO_FORMAT.replace("S24_3LE", "DSD_U8"), "usb", ("DSD_U8", "device: plughw:CARD,DEVICE")),
        ("arecord: set_params:1377: Channels count non available", "hw:1", ("non", "`channels`")),
        ("arecord: main:831: audio open error: Device or resource busy", "hw:1", ("", "fuser")),
    ],
)
async def test_doctor_and_session_tell_what_arecord_says_and_what_to_do(
    begin: Begin, alsa: Callable[[str], None], said: str, device: str, told: tuple[str, str]
) -> None:
    alsa(said)
    settings = MicrophoneSettings(device=device)
    (finding,) = await Microphone.examine(Probe("ear", settings))
    _, published = await begin("", device=device)
    lost = await published.first(DriverLost)
    assert (finding.level, finding.text, finding.remedy) == ("error", lost.detail, lost.remedy)
    assert told[0] in lost.detail
    assert told[1] in lost.remedy


async def test_examine_says_why_there_is_no_sound(tmp_path: Path) -> None:
    failing = MicrophoneSettings(command=("sh", "-c", "echo no such device >&2; exit 1"))
    (finding,) = await Microphone.examine(Probe("ear", failing, tmp_path))
    assert (finding.level, finding.text) == ("error", "sh ended: no such device")
    missing = MicrophoneSettings(command="./nothing")
    (finding,) = await Microphone.examine(Probe("ear", missing, tmp_path))
    assert finding.level == "error"
    assert "does not exist" in finding.text


# -- the real arecord --------------------------------------------------------------------------


@pytest.mark.alsa
async def test_arecord_from_a_file_in_the_place_of_a_sound_card(
    begin: Begin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sound.raw").write_bytes(square(0.5, 0.25))
    (tmp_path / "asound.conf").write_text(
        'pcm.fake { type file; slave.pcm null; file /dev/null; format raw; infile "sound.raw" }\n'
    )
    monkeypatch.setenv("ALSA_CONFIG_PATH", f"/usr/share/alsa/alsa.conf:{tmp_path}/asound.conf")
    _, published = await begin("", real=True, device="fake")
    await published.until(lambda: len(published.values("loudness")) >= 4)
    assert published.values("loudness")[:4] == pytest.approx([0.25] * 4, rel=1e-3)
    assert published.all(DriverConnected)[0].detail.startswith("arecord")


@pytest.mark.alsa
async def test_examine_with_arecord_says_what_is_wrong_with_the_device(tmp_path: Path) -> None:
    settings = MicrophoneSettings(device="no-such-device")
    (finding,) = await Microphone.examine(Probe("ear", settings, tmp_path))
    assert finding.level == "error"
    assert finding.text.startswith("arecord ended: ")
    assert finding.remedy


async def test_live_sound_while_somebody_listens(
    begin: Begin, pipe: PipedCommand, clock: ManualClock
) -> None:
    _, published = await begin(pipe.command, format="S24_3LE", channels=2, channel=2)
    await until(pipe.connected)
    feed = published.context.feed(SOUND)
    stereo = np.tile(np.array([[0.9, 0.25]], np.float32), (RATE // 10, 1))
    pipe.send(pcm_audio.encode(stereo, "S24_3LE"))
    await published.until(lambda: len(published.values("loudness")) == 1)
    assert feed.latest().value is None, "nobody listens"
    published.context.feed(LISTENED).put(SoundListened(clock.now_us() + 1_000_000))
    pipe.send(pcm_audio.encode(stereo, "S24_3LE"))
    await published.until(lambda: len(published.values("loudness")) == 2)
    sound = feed.latest().value
    assert isinstance(sound, LiveSound)
    assert (sound.rate, sound.end) == (RATE, RATE // 10)
    assert set(np.frombuffer(sound.blocks[-1].pcm, "<i2")) == {8192}
    clock.advance(1.0)
    pipe.send(pcm_audio.encode(stereo, "S24_3LE"))
    await published.until(lambda: len(published.values("loudness")) == 3)
    assert feed.latest().serial == 5, "nobody listens any more"
