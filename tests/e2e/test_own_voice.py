"""A simulated Pepper that hears itself: over the real wire, from keys to figures."""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.fakes.naoqi import StandIn, stand_in
from tests.session.rig import SessionRig
from woz_tui.analysis.figure_counting import DEFAULTS, figures_of
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log import log_reader
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock
from woz_tui.timeline.episodes import UtteranceEpisode
from woz_tui.timeline.timeline import Timeline, timeline_of

pytestmark = [pytest.mark.real_clock, pytest.mark.timeout(240)]

KEY = RequestOrigin("key", "w")
WORDS = "welcome to the museum"
#: Which voice a file has most of: the robot's is low. It says what that voice says.
TRANSCRIBER = f'''
import sys, wave
import numpy as np

with wave.open(sys.argv[1]) as file:
    samples = np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float)
spectrum = np.abs(np.fft.rfft(samples))
hertz = np.fft.rfftfreq(samples.size, 1 / 16000)

def power(pitch):
    return (spectrum[np.abs(hertz - pitch) < 12] ** 2).sum()

print("{WORDS}" if power(110) > power(160) else "where is the exit")
'''
FILE = """
title: It hears itself
{more}
robot:
  drivers:
    pepper:
      type: pepper
      robots: ["{address}"]
    ears:
      type: microphone
      from: pepper
      hang_over: 0.4
      pre_roll: 0.1
      transcribe: ["{python}", "{program}", "{{file}}"]
panels:
  - title: Speech
    actions:
      - {{key: w, label: Welcome, say: "Welcome to the museum."}}
      - {{key: l, label: Long, say: "Welcome to the museum. Welcome to the museum."}}
"""


@pytest.fixture
async def robot() -> AsyncIterator[StandIn]:
    """Its time passes as ours does: it sends as much sound as that."""
    async with stand_in("own", pace=1.0, options=("--echo", "0.3")) as started:
        await started.person({"distance": 1.0})
        yield started


class Talk:
    """A session in which robot and visitor take turns, or do not."""

    def __init__(self, tmp_path: Path, robot: StandIn, more: str = "") -> None:
        program = tmp_path / "transcriber.py"
        program.write_text(TRANSCRIBER)
        path = tmp_path / "own.yaml"
        path.write_text(
            FILE.format(
                address=robot.address,
                python=sys.executable,
                program=program,
                more=more,
            )
        )
        catalogue = installed()
        self.rig = SessionRig(
            tmp_path, catalogue=catalogue, made=load(path, catalogue), clock=RealClock()
        )
        self._robot = robot
        self._segments = 0

    async def ready(self) -> None:
        """Robot and ears are there."""
        for driver in ("pepper", "ears"):
            await self.rig.until(
                lambda: driver in {line.driver for line in self.rig.of(m.DriverConnected)}  # noqa: B023
            )

    async def heard(self, segments: int = 1) -> None:
        """So many more segments have been understood."""
        self._segments += segments
        await self.rig.until(lambda: len(self.rig.of(m.SpeechText)) >= self._segments)

    def presses(self, action: str = "Welcome") -> None:
        self.rig.session.play(action, KEY)

    async def visitor(self, text: str) -> None:
        await self._robot.set("says", text)

    async def robot_speaks(self) -> None:
        """Its voice is heard."""
        begun = len(self.rig.of(m.SpeechStarted))
        await self.rig.until(lambda: len(self.rig.of(m.SpeechStarted)) > begun)

    def timeline(self) -> Timeline:
        return timeline_of(
            line.message
            for line in log_reader.read(self.rig.recorder.path)
            if line.message is not None
        )


async def play(talk: Talk) -> None:
    """The robot says ten sentences, a visitor five: three answers, a word into a sentence, and one
    that begins in a sentence and goes on.
    """
    await talk.ready()
    for turn in range(8):
        talk.presses()
        await talk.heard()
        if turn < 3:
            await talk.visitor("Where is it?")
            await talk.heard()
    for words in ("Stop, stop.", "Excuse me, I have a question, where can I find the exit?"):
        talk.presses("Long")
        await talk.robot_speaks()
        await talk.visitor(words)
        await talk.heard(1 if words == "Stop, stop." else 2)


async def test_ten_sentences_of_the_robot_and_five_of_a_visitor(
    tmp_path: Path, robot: StandIn
) -> None:
    """Five cues, none of them the robot's, two into its sentences."""
    talk = Talk(tmp_path, robot)
    async with talk.rig:
        await play(talk)
    timeline = talk.timeline()
    spoken = timeline.of(UtteranceEpisode)
    visitors = [each for each in spoken if not each.own]
    assert len(visitors) == 5
    assert [each.overlap for each in visitors] == [False, False, False, True, True]
    assert {each.text.text for each in visitors if each.text} == {"where is the exit"}
    assert {each.text.text for each in spoken if each.own and each.text} == {WORDS}
    whole = figures_of(timeline, DEFAULTS).whole
    assert (whole.reactions["speech"].cues, whole.utterances) == (5, 5)


async def test_it_hears_also_where_the_wizard_may_not(tmp_path: Path, robot: StandIn) -> None:
    """The log has what was said, and nobody listened; without the robot nobody is heard."""
    talk = Talk(tmp_path, robot, "perception: {hide: [transcript, loudness]}")
    async with talk.rig as rig:
        await talk.ready()
        await talk.visitor("Where is it?")
        await talk.heard()
        robot.kill()
        await rig.until(lambda: "ears" in {line.driver for line in rig.of(m.DriverLost)})
    assert [line.text for line in rig.of(m.SpeechText)] == ["where is the exit"]
    assert not rig.of(m.ListenerJoined)
    lost = next(line for line in rig.of(m.DriverLost) if line.driver == "ears")
    assert lost.detail.startswith("pepper: ")
