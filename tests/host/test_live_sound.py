"""Live sound over the robot process's own socket: who hears, who talks, and what the log has."""

from __future__ import annotations

import asyncio
import base64
import contextlib
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import WAIT_S, experiment
from woz_tui.bus import bus
from woz_tui.config.loading import load
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.drivers.plugins import installed
from woz_tui.drivers.sound_feeds import (
    LISTENED,
    SOUND,
    VOICE,
    VOICE_STATE,
    LiveSound,
    SoundListened,
    SoundReader,
    SoundWindow,
    VoiceState,
)
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.host import sound_service
from woz_tui.protocol import messages as m

RATE = 16_000
WORD = b"\1\2" * 320


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a busy machine holds back is not late: a voice, a word, who talks, a stop's end."""
    for limit in ("LATE_S", "WAIT_S", "SILENT_S"):
        monkeypatch.setattr(sound_service, limit, WAIT_S)
    monkeypatch.setattr(bus, "STOP_WAIT_S", WAIT_S)


@pytest.fixture
async def host(tmp_path: Path) -> AsyncIterator[ServedSession]:
    async with served_session(tmp_path) as place:
        yield place


def microphone(host: ServedSession) -> SoundWindow:
    """The driver `robot` has one."""
    host.session.feeds.feed("robot", LISTENED)
    return SoundWindow(host.session.feeds.feed("robot", SOUND), RATE)


def loudspeaker(host: ServedSession, on: bool = False) -> SoundReader:
    """The driver `robot` takes a live voice; what it gets of it."""
    host.session.feeds.feed("robot", VOICE_STATE).put(VoiceState(RATE, on))
    return SoundReader(host.session.feeds.feed("robot", VOICE))


def now(host: ServedSession) -> int:
    return host.session.clock.now_us()


async def ask_for_sound(peer: Peer, **fields: Any) -> dict[str, Any]:
    """Ask for sound; the answer, whatever it is."""
    ref = len(peer.seen) + 500
    await peer.say(kind="sound", ref=ref, **fields)
    return await peer.until(lambda line: line["kind"] in ("sound", "reply") and line["ref"] == ref)


async def ask_and_speak(
    host: ServedSession, peer: Peer, window: SoundWindow, **fields: Any
) -> dict[str, Any]:
    """Ask, and have a word said when the microphone has been told that somebody listens."""
    before = host.session.feeds.feed("robot", LISTENED).latest().serial
    waiting = asyncio.ensure_future(ask_for_sound(peer, **fields))
    while host.session.feeds.feed("robot", LISTENED).latest().serial == before:  # noqa: ASYNC110
        await asyncio.sleep(0.002)
    window.add(WORD, now(host))
    return await waiting


@pytest.mark.parametrize("role", ["wizard", "watcher"])
async def test_who_sees_the_robot_hears_it(host: ServedSession, role: str) -> None:
    window = microphone(host)
    window.add(b"\7\7" * 320, now(host))
    peer = await host.connect()
    await peer.hello(role)
    asked_us = now(host)
    line = await ask_and_speak(host, peer, window)
    assert (line["driver"], line["microphones"], line["rate"]) == ("robot", ["robot"], RATE)
    assert base64.b64decode(line["data"]) == WORD, "nothing of before somebody listened"
    wish = host.session.feeds.feed("robot", LISTENED).latest().value
    assert isinstance(wish, SoundListened)
    assert asked_us <= wish.until_us - 2_500_000 <= now(host)
    again = await ask_and_speak(host, peer, window, after=line["end"])
    assert (again["end"], again.get("lost", 0)) == (960, 0)


@pytest.mark.parametrize("role", ["participant", "program"])
async def test_nobody_else_does(host: ServedSession, role: str) -> None:
    microphone(host)
    peer = await host.connect()
    await peer.hello(role)
    line = await ask_for_sound(peer)
    assert (line["kind"], line.get("ok")) == ("reply", False)
    assert line["reason"]
    assert host.session.feeds.feed("robot", LISTENED).latest().serial == 0, "no one was woken"


@pytest.mark.parametrize("kept", ["transcript", "loudness", "presence", "identity"])
async def test_what_perception_keeps_is_not_heard(tmp_path: Path, kept: str) -> None:
    made = experiment(tmp_path)
    made = replace(made, study=Study(perception=PerceptionLimits(hide=(kept,))))
    async with served_session(tmp_path, made=made) as host:
        microphone(host)
        peer = await host.connect()
        await peer.hello("wizard")
        line = await ask_for_sound(peer)
        assert (line["kind"], line.get("ok")) == ("reply", False)


@pytest.mark.parametrize("texts", [{}, {"hello": {"warm": "Hi", "cold": "Good day"}}])
async def test_a_blind_wizard_hears_no_words_that_tell_the_condition(
    tmp_path: Path, texts: dict[str, dict[str, str]]
) -> None:
    design = Design(blind={"warm": "A", "cold": "B"})
    made = replace(experiment(tmp_path), sections={DESIGN: design}, by_condition=texts)
    async with served_session(tmp_path, made=made) as host:
        window = microphone(host)
        peer = await host.connect()
        await peer.hello("wizard")
        line = await (ask_for_sound(peer) if texts else ask_and_speak(host, peer, window))
        assert line["kind"] == ("reply" if texts else "sound")


async def test_two_hear_the_same(host: ServedSession) -> None:
    window = microphone(host)
    one, other = await host.connect(), await host.connect()
    await one.hello("wizard")
    await other.hello("watcher")
    waiting = asyncio.gather(ask_for_sound(one), ask_for_sound(other))
    while host.session.feeds.feed("robot", LISTENED).latest().serial < 2:  # noqa: ASYNC110
        await asyncio.sleep(0.002)
    window.add(WORD, now(host))
    assert [base64.b64decode(line["data"]) for line in await waiting] == [WORD, WORD]


async def test_who_asks_late_loses_sound_and_is_told(host: ServedSession) -> None:
    window = microphone(host)
    peer = await host.connect()
    await peer.hello("wizard")
    first = await ask_and_speak(host, peer, window)
    for _ in range(100):
        window.add(WORD, now(host))
    line = await ask_for_sound(peer, after=first["end"])
    assert len(base64.b64decode(line["data"])) == 2 * 640, "the newest 40 ms"
    assert line["lost"] == 98 * 320
    peer.leave()
    left = await host.published(lambda line: isinstance(line, m.ListenerLeft))
    assert isinstance(left, m.ListenerLeft)
    assert left.lost_us == 1_960_000


async def test_no_sound_is_said_after_a_moment(
    host: ServedSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sound_service, "WAIT_S", 0.1)
    microphone(host)
    peer = await host.connect()
    await peer.hello("wizard")
    line = await ask_for_sound(peer)
    assert line["kind"] == "sound"
    assert "data" not in line
    assert line["why"]


async def test_the_log_says_who_listens_from_when_to_when_and_has_no_sound(
    host: ServedSession,
) -> None:
    window = microphone(host)
    peer = await host.connect()
    await peer.hello("watcher")
    line = await ask_and_speak(host, peer, window)
    await ask_and_speak(host, peer, window, after=line["end"])
    joined = host.of(m.ListenerJoined)
    assert [(each.console, each.driver) for each in joined] == [("con1", "robot")]
    peer.leave()
    left = await host.published(lambda line: isinstance(line, m.ListenerLeft))
    assert isinstance(left, m.ListenerLeft)
    assert (left.console, left.driver, left.lost_us) == ("con1", "robot", 0)
    assert 0 < left.duration_us <= left.t
    log = host.session.recorder.path.read_bytes()
    assert line["data"].encode() not in log


@pytest.mark.parametrize(
    ("kind", "fields", "words", "hint"),
    [
        ("sound", {"driver": "robot"}, "no driver of this session has a microphone", "no ears"),
        ("talk", {}, "no driver of this session has a loudspeaker", "no mouth"),
    ],
)
async def test_a_session_without_one(
    host: ServedSession, kind: str, fields: dict[str, Any], words: str, hint: str
) -> None:
    peer = await host.connect()
    await peer.hello("wizard")
    reply = await peer.ask(kind, **fields)
    assert not reply["ok"]
    assert words in reply["reason"]
    assert hint in reply["hint"]


async def test_another_driver_has_none(host: ServedSession) -> None:
    microphone(host)
    peer = await host.connect()
    await peer.hello("wizard")
    reply = await peer.ask("sound", driver="lamp")
    assert not reply["ok"]
    assert "robot" in reply["hint"]


# -- talking -----------------------------------------------------------------------------------


def voice(pcm: bytes = WORD, **more: Any) -> dict[str, Any]:
    return {"rate": RATE, "data": base64.b64encode(pcm).decode(), **more}


@pytest.mark.parametrize("role", ["wizard", "program"])
async def test_a_voice_reaches_the_loudspeaker(host: ServedSession, role: str) -> None:
    reader = loudspeaker(host, on=True)
    peer = await host.connect()
    await peer.hello(role)
    reply = await peer.ask("talk")
    assert reply["data"] == {"driver": "robot", "rate": RATE, "on": True, "late_s": 0}
    assert reader.take() is None
    assert (await peer.ask("talk", **voice(lost_s=0.5, age_us=40_000)))["ok"]
    taken = reader.take()
    assert taken is not None
    piece, sound = taken
    assert (piece.pcm, sound.source, sound.lost_s) == (WORD, "con1", 0.5)
    assert now(host) - piece.t_us >= 40_000
    assert reply["data"]["rate"] == RATE
    assert b'"talk"' not in host.session.recorder.path.read_bytes()


@pytest.mark.parametrize("role", ["watcher", "participant"])
async def test_who_may_not_play_may_not_talk(host: ServedSession, role: str) -> None:
    reader = loudspeaker(host, on=True)
    peer = await host.connect()
    await peer.hello(role)
    assert not (await peer.ask("talk", **voice()))["ok"]
    assert reader.take() is None


async def test_one_talks_at_a_time(host: ServedSession) -> None:
    reader = loudspeaker(host)
    one, other = await host.connect(), await host.connect()
    await one.hello("program")
    await other.hello("program")
    assert (await one.ask("talk", **voice()))["ok"]
    refused = await other.ask("talk", **voice())
    assert not refused["ok"]
    assert "con1" in refused["reason"]
    one.leave()
    await host.published(lambda line: isinstance(line, m.ConsoleLost))
    assert (await other.ask("talk", **voice()))["ok"]
    taken = reader.take()
    assert taken is not None
    assert isinstance(host.session.feeds.feed("robot", VOICE).latest().value, LiveSound)
    assert taken[1].source == "con2"


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (voice() | {"rate": 44_100}, "44100 Hz"),
        (voice(b"\1\2\3"), "whole samples"),
        (voice(WORD * 100), "at most 1 s"),
        (voice() | {"data": "%%%"}, "base64"),
    ],
)
async def test_a_voice_that_cannot_be(
    host: ServedSession, fields: dict[str, Any], words: str
) -> None:
    reader = loudspeaker(host)
    peer = await host.connect()
    await peer.hello("program")
    reply = await peer.ask("talk", **fields)
    assert not reply["ok"]
    assert words in reply["reason"]
    assert reader.take() is None


# -- with a real loudspeaker's driver ----------------------------------------------------------

FILE = """
title: Live
robot:
  drivers:
    voice:
      type: speech
      synthesise: "true {{wav}}"
      play: "true {{wav}}"
      talk: {{play: [sh, -c, "exec cat >> {heard}"]}}
panels:
  - title: Live
    actions:
      - {{key: t, label: Talk, talk: {{}}}}
      - {{key: u, label: Talk off, end_talk: {{}}}}
"""


@contextlib.asynccontextmanager
async def speaking(tmp_path: Path) -> AsyncIterator[tuple[ServedSession, Peer, Path]]:
    """A wizard who plays *Talk*, and where a voice is heard."""
    heard_in, file = tmp_path / "heard", tmp_path / "live.yaml"
    file.write_text(FILE.format(heard=heard_in))
    catalogue = installed()
    async with served_session(tmp_path, made=load(file, catalogue), catalogue=catalogue) as host:
        await host.published(lambda line: isinstance(line, m.DriverConnected))
        wizard = await host.connect()
        await wizard.hello("wizard")
        yield host, wizard, heard_in


async def talk_on(host: ServedSession, wizard: Peer) -> str:
    """*Talk* is played and on; its run."""
    reply = await wizard.ask("action", action="Talk", source="key", key="t")
    assert reply["ok"]
    await host.published(lambda line: isinstance(line, m.SensorChanged) and line.state == "on")
    return str(reply["run"])


async def action_end(host: ServedSession, run: str) -> m.Message:
    return await host.published(lambda line: isinstance(line, m.ActionEnd) and line.run == run)


async def test_a_key_a_voice_and_the_key_again_are_an_action_in_the_log(tmp_path: Path) -> None:
    async with speaking(tmp_path) as (host, wizard, heard_in):
        run = await talk_on(host, wizard)
        talker = await host.connect()
        await talker.hello("program")
        assert (await talker.ask("talk", **voice()))["data"]["on"]
        while not heard_in.exists() or heard_in.read_bytes() != WORD:  # noqa: ASYNC110
            await asyncio.sleep(0.005)
        assert (await wizard.ask("action", action="Talk off", source="key", key="u"))["ok"]
        assert isinstance(await action_end(host, run), m.ActionDone)
        (done,) = [line for line in host.of(m.Done) if "by" in line.sent]
        assert (done.sent["by"], done.sent["played"], done.sent["dropped"]) == ("con2", 0.02, 0.0)


async def test_a_stop_ends_it_and_a_release_does_not_begin_it(tmp_path: Path) -> None:
    async with speaking(tmp_path) as (host, wizard, heard_in):
        run = await talk_on(host, wizard)
        await wizard.ask("stop")
        assert isinstance(await action_end(host, run), m.ActionStopped)
        confirmed = await host.published(lambda line: isinstance(line, m.StopConfirmed))
        assert isinstance(confirmed, m.StopConfirmed)
        assert confirmed.confirmed == ["voice"]
        assert (await wizard.ask("release"))["ok"]
        talker = await host.connect()
        await talker.hello("program")
        assert not (await talker.ask("talk", **voice()))["data"]["on"]
        assert not heard_in.exists() or not heard_in.read_bytes()


async def test_nobody_talks_while_no_wizard_watches(tmp_path: Path) -> None:
    async with speaking(tmp_path) as (host, wizard, _):
        run = await talk_on(host, wizard)
        wizard.leave()
        assert isinstance(await action_end(host, run), m.ActionStopped)
        program = await host.connect()
        await program.hello("program")
        await program.ask("action", action="Talk")
        refused = await host.published(lambda line: isinstance(line, m.Refused))
        assert isinstance(refused, m.Refused)
        assert refused.code == "unwatched"


async def test_a_locked_panel_keeps_it_off(tmp_path: Path) -> None:
    async with speaking(tmp_path) as (host, wizard, _):
        await wizard.ask("lock", panel="Live", locked=True)
        reply = await wizard.ask("action", action="Talk", source="key", key="t")
        assert not reply["ok"]
        assert not any(isinstance(line, m.Dispatched) for line in host.lines)


async def test_who_is_far_away_asks_for_several_pieces_at_once(host: ServedSession) -> None:
    window = microphone(host)
    peer = await host.connect()
    await peer.hello("watcher")
    for ref in range(1, 5):
        await peer.say(kind="sound", ref=ref, after=-1 if ref > 1 else 0)
    ends = []
    for ref in range(1, 5):
        wish = host.session.feeds.feed("robot", LISTENED)
        while not isinstance(wish.latest().value, SoundListened):  # noqa: ASYNC110
            await asyncio.sleep(0.002)
        window.add(WORD, now(host))
        line = await peer.until(lambda line: line["kind"] == "sound")
        assert line["ref"] == ref
        ends.append(line["end"])
    assert ends == [320, 640, 960, 1280]
    for ref in range(10, 50):
        await peer.say(kind="sound", ref=ref, after=-1)
    refused = await peer.until(lambda line: line["kind"] == "reply")
    assert not refused["ok"]
