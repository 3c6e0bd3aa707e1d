"""`woz say` and `woz voices`: hear a voice, and list what is there, without a session."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest
from woz_drivers.speech import driver
from woz_drivers.speech.synthesis import finish

from tests.config.reading import panel
from tests.drivers.speech_rig import SCRIPT
from tests.fakes.sound import journal_entries
from woz_tui import cli


def script(path: Path, body: str) -> None:
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o700)


@pytest.fixture
def journal(tmp_path: Path) -> Path:
    return tmp_path / "journal"


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A player starts slowly on a busy machine; `margin` leaves it two seconds at the most."""
    monkeypatch.setattr(driver, "finish", lambda running, seconds: finish(running, seconds + 40.0))


@pytest.fixture
def settings(tmp_path: Path, journal: Path) -> dict[str, str]:
    """A voice and a loudspeaker that write down what they do."""
    words = ("--voice", "{voice} {speed}")
    return {
        "synthesise": shlex.join((*SCRIPT, "synthesise", str(journal), "--wav", "{wav}", *words)),
        "play": shlex.join((*SCRIPT, "play", str(journal), "--wav", "{wav}")),
        "cache": str(tmp_path / "cache"),
        "margin": "2 s",
    }


def options(settings: dict[str, str]) -> list[str]:
    return [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]


def test_a_text_is_heard_with_the_voice_that_is_tried(
    settings: dict[str, str], journal: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tried = ["say", "Hello there", "--voice", "en-gb", "--speed", "90", *options(settings)]
    assert cli.main(tried) == 0
    assert [line["voice"] for line in journal_entries(journal, "synthesise")] == ["en-gb 90"]
    assert len(journal_entries(journal, "played")) == 1
    assert "from: synthesised" in capsys.readouterr().out
    assert cli.main(tried) == 0
    assert "from: cache" in capsys.readouterr().out


def test_the_voice_of_an_experiment(
    settings: dict[str, str], tmp_path: Path, journal: Path
) -> None:
    file = tmp_path / "museum.yaml"
    lines = "".join(f"      {name}: {json.dumps(value)}\n" for name, value in settings.items())
    file.write_text(
        "title: Museum\nrobot:\n  name: guide\n  drivers:\n"
        "    range: {type: rangefinder, port: /dev/null}\n"
        f"    mouth:\n      type: speech\n      voice: fr\n{lines}"
        "panels:\n  - title: All\n    actions:\n      - {key: h, label: Hi, say: Hi}\n"
    )
    assert cli.main(["say", "Hello", str(file)]) == 0
    assert [line["voice"] for line in journal_entries(journal, "synthesise")] == ["fr 160"]


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["--speed", "10"], "60 to 450"),
        (["--set", "nothing=1"], "unknown"),
        (["--on", "left"], "does not speak"),
        (["--robot", "pepper"], "experiment file"),
        (["--set", "play=/no/such/player {wav}"], "does not exist"),
    ],
)
def test_what_cannot_be_said_is_a_sentence(
    words: list[str],
    what: str,
    monkeypatch: pytest.MonkeyPatch,
    settings: dict[str, str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("woz_tui.cli.say._THERE_S", 0.2)
    more = [] if "--robot" in words else options(settings)
    assert cli.main(["say", "Hello", *more, *words]) == 1
    assert what in capsys.readouterr().err


def test_the_voices_of_this_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    programs = tmp_path / "bin"
    programs.mkdir()
    script(
        programs / "espeak-ng",
        "echo 'Pty Language       Age/Gender VoiceName          File          Other Languages'\n"
        "echo ' 5  de              --/M      German             gmw/de'\n"
        "echo ' 2  en-gb           --/M      English_(Great_Britain) gmw/en            (en 2)'",
    )
    script(programs / "flite", "echo 'Voices available: kal slt '")
    script(programs / "festival", "echo '(kal_diphone)'")
    for name in ("en_US-joe-medium.onnx", "en_US-joe-medium.onnx.json", "other.onnx"):
        (tmp_path / name).touch()
    monkeypatch.setenv("PATH", f"{programs}:/usr/bin:/bin")
    monkeypatch.chdir(tmp_path)
    assert cli.main(["voices", "--json"]) == 0
    found = [(one["engine"], one["name"]) for one in json.loads(capsys.readouterr().out)]
    assert found[:2] == [("espeak-ng", "de"), ("espeak-ng", "en-gb")]
    assert ("piper", "en_US-joe-medium") in found
    assert [name for engine, name in found if engine in ("flite", "festival")] == [
        "kal",
        "slt",
        "kal_diphone",
    ]
    assert ("piper", "other") not in found
    assert cli.main(["voices", "--language", "de"]) == 0
    shown = capsys.readouterr().out
    assert "German" in shown
    assert "joe" not in shown
    assert cli.main(["voices", "--language", "it"]) == 1
    told = capsys.readouterr().err
    assert told.endswith("de, en\n") and "apt install" not in told


def test_no_voices(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert cli.main(["voices"]) == 1
    assert "apt install espeak-ng" in capsys.readouterr().err


@pytest.mark.parametrize("robot", ["furhat", "nao"])
def test_a_robot_that_speaks_by_itself_lists_no_voices(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], robot: str
) -> None:
    path = tmp_path / "e.yaml"
    path.write_text(panel("{label: A, say: Hello}"))
    assert cli.main(["voices", str(path), "--robot", robot]) == 1
    said = capsys.readouterr().err
    assert f"{robot}: this robot does not list its voices" in said
    assert "espeak" not in said


def test_a_robot_file_speaks_without_an_experiment(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("name: mine\ndrivers: {head: {type: furhat}}\n")
    assert cli.main(["voices", str(path)]) == 1
    assert "head: this robot does not list its voices" in capsys.readouterr().err
    assert cli.main(["voices", str(path), "--robot", "nao"]) == 1
    assert "--robot is for experiments" in capsys.readouterr().err


def test_whose_voices_are_asked_for_is_not_the_language_of_errors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LC_ALL", "C")
    path = tmp_path / "e.yaml"
    path.write_text(panel("{label: A, say: Hello}", head="title: T\nrobot: nobody\n"))
    assert cli.main(["voices", str(path), "--language", "de"]) == 1
    assert "there is no robot 'nobody'" in capsys.readouterr().err
