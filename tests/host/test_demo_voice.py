"""The voice of `woz demo`: what is heard, and what is said where nothing can be."""

from __future__ import annotations

import asyncio
import importlib.util
from pathlib import Path

import pytest
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings

from tests.drivers.published_messages import until
from tests.drivers.speech_rig import SpeechRig, desk_in
from tests.host.rig import served_session
from woz_tui.client import WozStoppedError, connect
from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.host.demo_voice import DemoVoice, silence, voice_settings


def said(rig: SpeechRig) -> list[object]:
    return [entry["text"] for entry in rig.journal_entries("synthesise")]


@pytest.mark.real_clock
async def test_what_the_robot_says_is_heard_until_the_session_ends(tmp_path: Path) -> None:
    async with desk_in(tmp_path) as rig:
        async with served_session(tmp_path) as host, connect(host.path) as program:
            listener = connect(host.path, name="voice")
            session = await listener.__aenter__()
            following = asyncio.create_task(DemoVoice(await rig.open()).follow(session))
            await program.perform("say", text="Welcome")
            await program.say("^start(animations/Hey_1) And goodbye")  # of a Pepper
        await following
        await listener.__aexit__(None, None, None)
        assert said(rig) == ["Welcome\n", "And goodbye\n"]
        assert len(rig.journal_entries("played")) == 2


@pytest.mark.real_clock
async def test_the_stop_silences_it_and_drivers_that_sound_are_left_to_themselves(
    tmp_path: Path,
) -> None:
    async with (
        desk_in(tmp_path) as rig,
        served_session(tmp_path) as host,
        connect(host.path, name="voice") as session,
        connect(host.path) as program,
    ):
        endless = await rig.open(play=rig.command("play", "--wav", "{wav}", "--hang"))
        following = asyncio.create_task(DemoVoice(endless).follow(session))
        run = await program.begin("say", text="Welcome")
        await until(lambda: bool(rig.journal_entries("play")))
        await program.stop()
        with pytest.raises(WozStoppedError):
            await run
        following.cancel()
        await program.release()
        own = DemoVoice(await rig.open(), frozenset({"robot"}))
        following = asyncio.create_task(own.follow(session))
        await program.say("Heard already")
        following.cancel()
        assert said(rig) == ["Welcome\n"]
        assert rig.journal_entries("played") == []


@pytest.mark.parametrize("installed", [True, False])
async def test_pipers_voice_is_taken_where_it_is_installed_with_a_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, installed: bool
) -> None:
    for name in ("de_DE-a.onnx", "de_DE-a.onnx.json", "en_US-joe.onnx", "en_US-joe.onnx.json"):
        (tmp_path / name).touch()
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object() if installed else None)
    settings = await voice_settings(Speech, tmp_path)
    assert settings.get("resident_voice", "").endswith("--model en_US-joe") is installed
    assert settings_from_texts(SpeechSettings, settings, tmp_path)


def programs(folder: Path, **scripts: str) -> None:
    for name, script in scripts.items():
        path = folder / name.replace("_", "-")
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)


@pytest.mark.parametrize(
    ("scripts", "why", "remedy"),
    [
        ({}, "no voice is installed", "sudo apt install espeak-ng"),
        ({"aplay": "exit 1", "espeak_ng": ""}, "no loudspeaker opens", "aplay -l"),
        ({"aplay": "exit 0", "espeak_ng": ""}, "", ""),
    ],
)
def test_why_nothing_can_be_heard(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    scripts: dict[str, str],
    why: str,
    remedy: str,
) -> None:
    programs(tmp_path, **scripts)
    monkeypatch.setenv("PATH", str(tmp_path))
    what, help_ = silence()
    assert (why in what, remedy in help_, bool(what)) == (True, True, bool(why))
