"""`woz demo` is heard where a voice is installed; else its screen says that it is silent."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.sound.wav import Wav

from tests.e2e.lab import Lab, end_session, recording, until
from tests.fakes.sound import RATE, square
from tests.fakes.terminal import FakeTerminal

pytestmark = pytest.mark.real_clock

#: Takes its text from standard input and writes a sound as long as it takes to be seen.
SPEAKS = """cat >> {folder}/spoken
while [ "$1" != -w ]; do shift; done
cp {folder}/sound.wav "$2\""""


def demo(lab: Lab, *options: str, **scripts: str) -> FakeTerminal:
    """A demo on a machine whose programs of sound are these scripts."""
    for name, script in scripts.items():
        lab.file(name.replace("_", "-"), f"#!/bin/sh\n{script}\n").chmod(0o755)
    words = ["demo", "--recordings", str(lab.recordings), *options]
    path = f"{lab.folder}:/usr/bin:/bin"
    cache = str(lab.folder / "cache")
    environment = {"PATH": path, "WOZ_SILENT": "", "XDG_CACHE_HOME": cache}
    terminal = lab.terminal(words, columns=100, rows=36, env=environment)
    recording(terminal)
    return terminal


def test_the_first_line_of_the_script_is_heard(lab: Lab) -> None:
    wav(lab.folder / "sound.wav")
    journal = lab.folder / "played"
    plays = f'echo "$2" >> {journal}'
    terminal = demo(lab, aplay=plays, espeak_ng=SPEAKS.format(folder=lab.folder))
    terminal.wait_text("voice")
    terminal.send(" ")
    spoken = lab.folder / "spoken"
    until(lambda: journal.exists() and ".wav" in journal.read_text(), "a sound")
    assert spoken.read_text() == "Hello P01, nice to see you.\n"
    assert "Silent" not in terminal.text
    end_session(terminal)
    assert terminal.wait_exit() == 0
    until(lambda: not lab.processes(), "the end of the voice with its session")


@pytest.mark.parametrize(("options", "told"), [((), True), (("--silent",), False)])
def test_a_silent_demo_says_so(lab: Lab, options: tuple[str, ...], told: bool) -> None:
    terminal = demo(lab, *options, aplay="exit 1", espeak_ng="exit 1")
    if told:
        terminal.wait_text("Silent: no loudspeaker")
    end_session(terminal)
    assert terminal.wait_exit() == 0
    assert (b"Silent" in terminal.written) is told
    helps = b"(plug one in; `aplay -l` lists them)"  # in the shell, which has room for it
    assert (helps in terminal.written) is told


def wav(path: Path) -> None:
    path.write_bytes(Wav("S16_LE", RATE, 1, square(0.2, 0.5)).to_bytes())
