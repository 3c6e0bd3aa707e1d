"""A live voice on a Reachy Mini: how it ends."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path

import pytest
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings
from woz_drivers.reachy_mini.settings import LOUDSPEAKER
from woz_drivers.speech.settings import PlayedTalkSettings

from tests.drivers.reachy_mini.conftest import ReachyRig, reachy
from woz_tui.drivers.contract import DeviceLostError, Scope
from woz_tui.drivers.sound_feeds import VOICE as VOICE_SOUND
from woz_tui.drivers.sound_feeds import VOICE_STATE, SoundWindow, VoiceState
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob, until

#: 20 ms of a voice.
WORD = b"\1\2" * 320


def talk_settings(folder: Path) -> PlayedTalkSettings:
    """A player that writes what it gets into a file."""
    return PlayedTalkSettings(play=("sh", "-c", f"exec cat >> {folder / 'heard'}"))


async def talking(rig: ReachyRig) -> asyncio.Task[Mapping[str, Json]]:
    """`talk` is played, and a word was heard."""
    talk = asyncio.ensure_future(rig.driver.perform(PlainJob("talk")))
    state, heard = rig.context.feed(VOICE_STATE), rig.context.folder / "heard"
    await until(lambda: talk.done() or state.latest().value == VoiceState(16_000, on=True))
    SoundWindow(rig.context.feed(VOICE_SOUND), 16_000).add(WORD, rig.context.clock.now_us(), "con7")
    await until(lambda: talk.done() or (heard.exists() and heard.read_bytes() == WORD))
    return talk


async def test_a_live_voice_is_heard_until_it_is_ended(folder: Path) -> None:
    async with reachy(folder, talk=talk_settings(folder)) as rig:
        talk = await talking(rig)
        await rig.driver.perform(PlainJob("end_talk"))
        sent = await talk
        assert (sent["played"], sent["dropped"]) == (0.02, 0.0)


@pytest.mark.parametrize("scope", list(Scope))
async def test_a_stop_ends_a_live_voice(folder: Path, scope: Scope) -> None:
    async with reachy(folder, talk=talk_settings(folder)) as rig:
        talk = await talking(rig)
        await rig.driver.stop(scope)
        talk.cancel()
        await asyncio.wait([talk])
        assert rig.context.feed(VOICE_STATE).latest().value == VoiceState(16_000)


async def test_a_daemon_that_goes_ends_a_live_voice(folder: Path) -> None:
    async with reachy(folder, talk=talk_settings(folder)) as rig:
        talk = await talking(rig)
        await rig.robot.close()
        with pytest.raises(DeviceLostError):
            await talk


def test_a_live_voice_goes_to_the_robots_loudspeaker_where_the_file_says_so() -> None:
    assert "talk" not in {verb.name for verb in ReachyMini.offer(ReachyMiniSettings()).verbs}
    plays = PlayedTalkSettings().play_words(LOUDSPEAKER)
    assert plays[:4] == ("aplay", "-q", "-D", "plug:reachymini_audio_sink")
    wrong = ReachyMiniSettings(talk=PlayedTalkSettings(play='aplay "'))
    assert [path for path, _ in wrong.problems()] == ["talk.play"]
