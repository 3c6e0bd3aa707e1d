"""The speech driver when it is stopped, when programs fail, and before the session."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import psutil
import pytest
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings
from woz_drivers.speech.synthesis import SpeechCache, users_folder

from tests.drivers.published_messages import BusJob, until
from tests.drivers.speech_rig import SpeechRig, desk_in, say
from woz_tui.drivers.contract import DeviceLostError, DriverError, Probe, RejectedError, Scope
from woz_tui.protocol.messages import DriverConnected, DriverFaulted, DriverLost


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[SpeechRig]:
    async with desk_in(tmp_path) as speech_rig:
        yield speech_rig


# -- the stop ----------------------------------------------------------------------------------


@pytest.mark.parametrize("during", ["play", "synthesise"])
async def test_the_stop_silences_at_once(rig: SpeechRig, during: str) -> None:
    driver = await rig.open(
        synthesise=rig.command(
            "synthesise", "--wav", "{wav}", "--delay", "1000" if during == "synthesise" else "0"
        ),
        play=rig.command("play", "--wav", "{wav}", "--hang"),
    )
    performing = asyncio.ensure_future(driver.perform(say("A long story")))
    await until(lambda: len(rig.journal_entries(during)) == 1)
    pid = rig.journal_entries(during)[0]["pid"]
    await driver.stop(Scope.DRIVE)
    assert psutil.pid_exists(int(str(pid)))
    assert not performing.done()
    performing.cancel()  # as the bus does at the same moment
    await driver.stop(Scope.ALL)
    assert performing.cancelled()
    assert not psutil.pid_exists(int(str(pid)))


async def test_the_stop_alone_is_enough(rig: SpeechRig) -> None:
    driver = await rig.open(play=rig.command("play", "--wav", "{wav}", "--hang"))
    performing = asyncio.ensure_future(driver.perform(say("A long story")))
    await until(lambda: len(rig.journal_entries("play")) == 1)
    await driver.stop(Scope.ALL)
    assert performing.cancelled()
    await driver.stop(Scope.ALL)
    await driver.rest()


async def test_closing_in_mid_sentence_leaves_nothing_behind(rig: SpeechRig) -> None:
    driver = await rig.open(play=rig.command("play", "--wav", "{wav}", "--hang"))
    performing = asyncio.ensure_future(driver.perform(say("A long story")))
    await until(lambda: len(rig.journal_entries("play")) == 1)
    await driver.close()
    assert performing.cancelled()


# -- trouble -----------------------------------------------------------------------------------


async def test_a_failing_player_says_why_until_it_works_again(rig: SpeechRig) -> None:
    switch = rig.folder / "broken"
    switch.touch()
    play = ("sh", "-c", f"test -e {switch} && echo 'no sound card' >&2 && exit 1; exit 0", "{wav}")
    driver = await rig.open(play=play)
    with pytest.raises(DriverError, match="sh failed: no sound card"):
        await driver.perform(say("Hello"))
    assert (await rig.published.first(DriverFaulted)).detail == "sh failed: no sound card"
    switch.unlink()
    await driver.perform(say("Hello"))
    await rig.published.first(DriverConnected, after=1)


async def test_the_last_line_of_a_player_is_its_reason(rig: SpeechRig) -> None:
    driver = await rig.open(play=rig.command("play", "--wav", "{wav}", "--fail", "device busy"))
    with pytest.raises(DriverError, match="failed: device busy"):
        await driver.perform(say("Hello"))


async def test_a_player_that_ends_long_before_its_sound_has_not_played_it(rig: SpeechRig) -> None:
    driver = await rig.open(play=("sh", "-c", "exit 0", "{wav}"))
    rig.wav("gong.wav", 2.8)
    with pytest.raises(DriverError, match=r"sh ended after 0\.\d s of 2\.8 s of sound") as early:
        await driver.perform(BusJob("sound", {"file": "gong.wav"}))
    assert "as long as the sound" in early.value.remedy
    assert "of 2.8 s of sound" in (await rig.published.first(DriverFaulted)).detail
    await driver.perform(say("Hi"))  # shorter than what a sound card may keep back
    await rig.published.first(DriverConnected, after=1)


async def test_a_player_that_hangs_is_killed(rig: SpeechRig) -> None:
    driver = await rig.open(
        play=rig.command("play", "--wav", "{wav}", "--hang"), margin=0.3, volume=0.5
    )
    with pytest.raises(DriverError, match=r"did not end within 0\.3 s and was killed"):
        await driver.perform(say("Hi"))


async def test_a_synthesiser_that_writes_no_sound(rig: SpeechRig) -> None:
    driver = await rig.open(synthesise=("true", "{wav}"))
    with pytest.raises(DriverError, match="wrote no sound"):
        await driver.perform(say("Hello"))


async def test_a_cache_that_cannot_be_written(rig: SpeechRig) -> None:
    (rig.folder / "file").touch()
    driver = await rig.open(cache=str(rig.folder / "file" / "cache"))
    with pytest.raises(DriverError, match="no room for synthesised speech") as raised:
        await driver.perform(say("Hello"))
    assert "cache:" in raised.value.remedy


async def test_missing_programs(
    rig: SpeechRig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig.wav("hello.wav", 0.05)
    here = tmp_path / "bin"
    here.mkdir()
    settings = SpeechSettings(cache=str(tmp_path / "c"), recordings={"Hello": "hello.wav"})
    driver = Speech("it", settings, rig.published.context)
    rig.drivers.append(driver)
    monkeypatch.setenv("PATH", str(here))
    await driver.open()
    lost = await rig.published.first(DriverLost)
    assert (lost.detail, lost.remedy) == (
        "aplay is not installed on this machine",
        "sudo apt install alsa-utils",
    )
    with pytest.raises(DeviceLostError, match="aplay"):
        await driver.perform(say("Hello"))
    (here / "aplay").write_text("#!/bin/sh\nexit 0\n")
    (here / "aplay").chmod(0o700)
    faulted = await rig.published.first(DriverFaulted)
    assert faulted.remedy == "sudo apt install espeak-ng"
    assert (await driver.perform(say("Hello")))["source"] == "recording"
    with pytest.raises(DriverError, match="espeak-ng is not installed"):
        await driver.perform(say("Something else"))
    with pytest.raises(RejectedError):
        await driver.perform(BusJob("dance"))
    assert (report := await driver.stop(Scope.ALL)) is not None, "it was never whole"
    assert report.confirmed
    assert not report.missing


# -- the cache ---------------------------------------------------------------------------------


def test_the_cache_forgets_what_was_used_longest_ago(tmp_path: Path) -> None:
    cache = SpeechCache(tmp_path / "cache", megabytes=1)
    paths = [cache.path(["espeak-ng", text]) for text in ("a", "b", "c")]
    for age, path in zip((30, 20, 10), paths, strict=True):
        cache.store(path, bytes(400_000))
        os.utime(path, (1000 - age, 1000 - age))
    assert [path.exists() for path in paths] == [False, True, True]
    assert cache.get(paths[1]) == bytes(400_000)  # used now
    cache.store(paths[0], bytes(400_000))
    assert [path.exists() for path in paths] == [True, True, False]
    assert cache.get(paths[2]) is None
    assert list((tmp_path / "cache").glob("*.part")) == []


def test_the_cache_tells_recipes_apart(tmp_path: Path) -> None:
    cache = SpeechCache(tmp_path, 1)
    assert cache.path(["a", "bc"]) != cache.path(["ab", "c"])


def test_the_users_cache_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/var/tmp/x")
    assert users_folder() == Path("/var/tmp/x/woz-tui/speech")
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setenv("HOME", "/home/wizard")
    assert users_folder() == Path("/home/wizard/.cache/woz-tui/speech")


# -- settings and preflight --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wrong", "setting"),
    [
        ({"synthesise": "say {txt}"}, "synthesise"),
        ({"play": "mpv"}, "play"),
        ({"speak": "say 'x"}, "speak"),
        ({"speak": "say", "play": "mpv {wav}"}, "speak"),
    ],
)
def test_settings_that_cannot_work(wrong: dict[str, Any], setting: str) -> None:
    assert [name for name, _ in SpeechSettings(**wrong).problems()] == [setting]


def test_the_programs_by_default() -> None:
    settings = SpeechSettings(device="plughw:1,0")
    assert " ".join(settings.play_words()) == "aplay -q -D {device} {wav}"
    assert settings.synthesise_words()[0] == "espeak-ng"
    assert [verb.name for verb in Speech.offer(settings).verbs] == [
        "say",
        "sound",
        "utter",
        "volume",
    ]
    assert Speech.offer(settings).sensors == ("prepared",)


async def test_examine_tries_a_word_and_looks_at_every_recording(rig: SpeechRig) -> None:
    (rig.folder / "broken.wav").write_bytes(b"no sound")
    settings = rig.settings(recordings={"Bye": "broken.wav"})
    synthesiser, player, recording, *_ = await Speech.examine(Probe("voice", settings, rig.folder))
    assert (synthesiser.level, player.level) == ("ok", "ok")
    assert "0.1 s for 'Hello'" in synthesiser.text
    assert recording.level == "error"
    assert "recording of 'Bye'" in recording.text
    assert rig.journal_entries("play") == []


async def test_examine_tells_that_another_voice_has_no_gibberish_without_espeak_ng(
    rig: SpeechRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(rig.folder))
    *_, last = await Speech.examine(Probe("voice", rig.settings(), rig.folder))
    assert (last.level, last.remedy[:4]) == ("info", "sudo")
    assert "gibberish needs espeak-ng" in last.text


async def test_examine_names_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    settings = SpeechSettings(cache=str(tmp_path))
    findings = await Speech.examine(Probe("voice", settings, tmp_path))
    assert [finding.remedy for finding in findings] == [
        "sudo apt install espeak-ng",
        "sudo apt install alsa-utils",
    ]
    (one,) = await Speech.examine(Probe("voice", SpeechSettings(speak="spd-say {text}"), tmp_path))
    assert one.remedy == "sudo apt install speech-dispatcher"
