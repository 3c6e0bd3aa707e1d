"""A session with a real microphone driver on a pipe: what is said lies beside its log."""

from __future__ import annotations

import wave
from pathlib import Path

import pytest
from woz_drivers.microphone import speech_segments
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings

from tests.drivers.published_messages import until
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import square
from tests.session.rig import HERE, SessionRig
from woz_tui.config.experiment import DriverSpec, Experiment
from woz_tui.drivers.contract import SPEECH
from woz_tui.log import log_reader
from woz_tui.protocol import messages as m
from woz_tui.session.preflight import preflight
from woz_tui.system.clock import RealClock


def experiment(folder: Path, command: tuple[str, ...]) -> Experiment:
    settings = MicrophoneSettings(
        command=command,
        threshold=0.1,
        hang_over=0.1,
        segments=True,
        transcribe=("sh", "-c", 'echo "{file}" | sed "s/.*ears/heard/"'),
    )
    ears = DriverSpec(
        "ears",
        "microphone",
        settings,
        Microphone.offer(settings),
        HERE,
    )
    return Experiment("Listening", folder / "made.yaml", "0" * 64, (ears,), ())


async def test_the_log_names_the_file_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(speech_segments, "_FILE_S", 40.0)  # a busy machine is slow to write
    pipe = PipedCommand(tmp_path / "pipe")
    rig = SessionRig(
        tmp_path,
        catalogue={"microphone": Microphone},
        made=experiment(tmp_path, pipe.command),
        clock=RealClock(),
        stem="2026-03-01T10-00-00_P07_S01",
    )
    async with rig:
        await until(pipe.connected)
        pipe.send(square(0.2, 0.01) + square(0.2, 0.5) + square(0.2, 0.01))
        await rig.until(lambda: rig.of(m.SpeechText))
        assert SPEECH not in {finding.subject for finding in await preflight(rig.session)}
    log = rig.recorder.path
    written = [line.message for line in log_reader.read(log)]
    (started,) = [one for one in written if isinstance(one, m.SpeechStarted)]
    (speech_ended,) = [one for one in written if isinstance(one, m.SpeechEnded)]
    (text,) = [one for one in written if isinstance(one, m.SpeechText)]
    assert (started.driver, speech_ended.driver, text.driver) == ("ears", "ears", "ears")
    assert speech_ended.file == "2026-03-01T10-00-00_P07_S01.media/ears-0001.wav"
    assert text.text == "heard-0001.wav"
    with wave.open(str(log.parent / speech_ended.file)) as file:
        assert (
            file.getnframes() / file.getframerate()
            == (speech_ended.ended - speech_ended.began) / 1e6
            == 0.5
        )
