"""A visitor whom no camera sees and whom a microphone hears: from the file to the log."""

from __future__ import annotations

import asyncio
import wave
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.microphone import speech_segments
from woz_drivers.microphone.driver import Microphone

from tests.drivers.published_messages import until
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import square
from tests.session.engagement_rig import WIZARD, GuideDriver
from tests.session.rig import SessionRig
from woz_tui.analysis.engagement_rerun import rerun
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, DriverContext, Job, Offer
from woz_tui.log import log_reader
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.system.clock import RealClock

STEM = "2026-03-01T10-00-00_P07_S01"
FILE = """
title: Heard, not seen
robot:
  drivers:
    robot: {{type: guide}}
    ears:
      type: microphone
      command: [cat, "{pipe}"]
      threshold: 0.1
      hang_over: 0.1
      segments: true
      transcribe: [sh, -c, 'test -s "$0" && echo Where are the whales', "{{file}}"]
engagement:
  signs: [presence, gaze]
panels:
  - title: Visitor
    actions:
      - {{key: p, label: There, toggle: presence}}
      - {{key: g, label: Looks, toggle: gaze}}
      - {{key: "1", label: It is V7, visitor: V7}}
      - {{key: a, label: Answer, say: "Behind you, {{visitor}}."}}
"""


class MicrophoneHostDriver(GuideDriver):
    """A robot that senses nothing, and speaks until it is told that it has."""

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.said = asyncio.Event()

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return replace(super().offer(settings), sensors=())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        if job.verb == "say":
            await self.said.wait()
        return dict(job.args)


CATALOGUE: dict[str, type[Driver]] = {"guide": MicrophoneHostDriver, "microphone": Microphone}


class MicrophoneRig(SessionRig):
    """A session in real time: a program and a disk take part."""

    def __init__(self, tmp_path: Path) -> None:
        self.pipe = PipedCommand(tmp_path / "pipe")
        path = tmp_path / "heard.yaml"
        path.write_text(FILE.format(pipe=self.pipe.path), encoding="utf-8")
        made = load(path, CATALOGUE)
        super().__init__(tmp_path, catalogue=CATALOGUE, made=made, clock=RealClock(), stem=STEM)

    async def press(self, action: str, then: str) -> None:
        """The wizard's key, and the state that it leads to."""
        self.session.play(action, WIZARD)
        await self.comes(then)

    async def comes(self, state: str) -> None:
        await self.until(
            lambda: [line.now for line in self.of(m.EngagementChanged)][-1:] == [state]
        )


async def play(rig: MicrophoneRig) -> None:
    """Seen by the wizard, heard by the microphone, answered by the wizard."""
    await until(rig.pipe.connected)
    rig.pipe.send(square(0.2, 0.01))
    rig.session.play("It is V7", WIZARD)
    await rig.press("There", "PersonDetected")
    await rig.press("Looks", "EngagedWithKnown")
    rig.pipe.send(square(0.4, 0.5))
    await rig.comes("UserSpeaks")
    rig.pipe.send(square(0.2, 0.01))
    await rig.comes("RobotThinks")
    await rig.until(lambda: rig.of(m.SpeechText))
    await rig.press("Answer", "RobotReplies")
    host = rig.session.drivers["robot"]
    assert isinstance(host, MicrophoneHostDriver)
    host.said.set()
    await rig.comes("EngagedWithKnown")


async def test_a_conversation_by_keys_and_ears(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """E4, E5, E6, E7: verdicts by hand where no camera is; speech moves the machine, beeps once,
    and leaves a file and a text in the log.
    """
    monkeypatch.setattr(speech_segments, "_FILE_S", 40.0)  # a busy machine is slow to write
    rig = MicrophoneRig(tmp_path)
    async with rig:
        await play(rig)
    log = rig.recorder.path
    written = [line.message for line in log_reader.read(log)]

    def of(kind: type[Any]) -> list[Any]:
        return [line for line in written if isinstance(line, kind)]

    changes = of(m.EngagementChanged)
    assert [change.now for change in changes] == [
        *("PersonDetected", "EngagedWithKnown", "UserSpeaks"),
        *("RobotThinks", "RobotReplies", "EngagedWithKnown"),
    ]
    assert [change.forced for change in changes] == [True, True, False, False, False, False]
    assert {change.visitor for change in changes[1:]} == {"V7"}

    (ended,), (text,) = of(m.SpeechEnded), of(m.SpeechText)
    assert ended.file == f"{STEM}.media/ears-0001.wav"
    with wave.open(str(log.parent / ended.file)) as file:
        seconds = file.getnframes() / file.getframerate()
    assert seconds == (ended.ended - ended.began) / 1e6 == 0.7, "0.2 s before, and 0.1 s after"
    assert (text.text, text.segment) == ("Where are the whales", ended.segment)

    sounds = [line for line in of(m.Command) if line.verb == "sound"]
    assert [(beep.source, beep.args["file"]) for beep in sounds] == [("engagement", "woz:beep.wav")]
    thinks = next(change for change in changes if change.now == "RobotThinks")
    assert ended.seq < thinks.seq < sounds[0].seq
    (said,) = [line for line in of(m.Command) if line.verb == "say"]
    assert said.args == {"text": "Behind you, V7."}

    assert rig.experiment.engagement is not None
    again = rerun(log, rig.experiment.engagement.settings, log_reader.Damage())
    assert len(again.computed) == len(changes)
    for computed, recorded in zip(again.computed, again.recorded, strict=True):
        assert replace(computed, t=recorded.t) == recorded, "the log tells it all once more"
