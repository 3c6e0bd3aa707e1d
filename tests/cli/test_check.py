"""`woz check`: errors on stderr, or the keys as a table."""

from __future__ import annotations

import argparse
import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import ROBOT, panel
from woz_tui.cli import check
from woz_tui.config.screen_language import use

GOOD = panel(
    "{key: h, label: Hello, say: 'Hello {participant}', play: {move: nod, speed: 0.5}}",
    "{key: ctrl+1, label: Chord, pose: {pan: 10}, seconds: 2}",
    "{key: ctrl+shift+b, label: Beside, torque: off}",
    "{key: c r, label: Two keys, steps: [{home: 1}, {wait: 0.5}, {note: done}]}",
    "{key: é, label: Foreign, locked: true, poses: [{pan: 1, seconds: 1}, {tilt: 2}]}",
    "{label: No key, sound: missing.wav}",
    head=ROBOT,
)


@pytest.fixture(autouse=True)
def _a_quiet_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("TMUX", "STY", "FORCE_COLOR", "COLUMNS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")


@pytest.fixture
def german() -> Iterator[None]:
    use("de")
    yield
    use("en")


def checked(folder: Path, text: str, *options: str) -> int:
    path = folder / "e.yaml"
    path.write_text(text, encoding="utf-8")
    parser = argparse.ArgumentParser()
    check.add(parser)
    return check.check(parser.parse_args([str(path), *options]), CATALOGUE)


def test_errors_go_to_stderr_and_the_code_is_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert checked(tmp_path, GOOD.replace("label: Hello", "lable: Hello")) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    lines = printed.err.splitlines()
    assert lines[0].endswith("lable: unknown; did you mean 'label'?")
    assert lines[-1] == f"{tmp_path / 'e.yaml'}: 1 error"


def test_what_is_wrong_is_told_in_the_language_that_is_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], german: None
) -> None:
    wrong = GOOD.replace("label: Hello", "lable: Hello").replace("say:", "sai:")
    assert checked(tmp_path, wrong) == 1
    told = capsys.readouterr().err
    assert "lable: unbekannt; meinten Sie 'label'?" in told
    assert told.splitlines()[-1] == f"{tmp_path / 'e.yaml'}: 2 Fehler"
    assert checked(tmp_path, GOOD) == 0
    out = capsys.readouterr().out
    assert "Warnung: P > No key > sound: es gibt keine Datei 'missing.wav'" in out
    assert out.splitlines()[-1] == "6 Aktionen in 1 Gruppe, keine Fehler, 2 Warnungen"


def test_programs_get_code_and_values_and_the_english(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], german: None
) -> None:
    checked(tmp_path, GOOD.replace("label: Hello", "lable: Hello"), "--format", "json")
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert problem["message"] == "unknown; did you mean 'label'?"
    assert problem["code"] == "check.unknown"
    assert problem["values"]["near"]["code"] == "check.did_you_mean"
    assert problem["values"]["near"]["values"] == {"near": "label"}


def test_the_table_says_what_each_key_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert checked(tmp_path, GOOD, "--keys") == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    out = printed.out
    assert "\x1b" not in out
    assert "keys on a plain terminal with a us keyboard" in out
    for key, label, does in (
        ("$", "repeat", "repeat the last sentence"),
        ("ctrl+n", "interrupt", ""),
    ):
        assert re.search(rf" {re.escape(key)} .* {label} +{does}", out), key
    assert 'say "Hello {participant}" + play nod speed 0.5' in out
    assert "1*" in out
    assert "* instead of ctrl+1: sends the same bytes as 1" in out
    assert "ctrl+shift+b: sends the same bytes as ctrl+b" in out
    assert "home 1, then wait 0.5 s, then note done" in out
    assert "poses pan 1 seconds 1; tilt 2 (locked)" in out
    assert "* instead of é: no key of the us keyboard gives é" in out


def test_warnings_and_the_drivers_verbs_follow_the_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checked(tmp_path, GOOD, "--all")
    out = capsys.readouterr().out
    assert "warning: P > No key > sound: there is no file 'missing.wav'" in out
    assert "head (head)" in out
    assert "speed: number, 0.1 to 4" in out
    assert "move: choice, one of nod, shake, required" in out
    assert "joint.pan, joint.tilt" in out


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--terminal", "kitty"], "keys on a kitty terminal with a us keyboard"),
        (["--terminal", "linux"], "ctrl+u: drive forward"),
        (["--terminal", "tmux", "--layout", "fr"], "keys on a tmux terminal with a fr keyboard"),
    ],
)
def test_another_terminal_and_another_keyboard(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], expected: str
) -> None:
    assert checked(tmp_path, GOOD, *options) == 0
    assert expected in capsys.readouterr().out


def test_on_a_kitty_terminal_only_the_foreign_key_needs_a_reserve(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checked(tmp_path, GOOD, "--terminal", "kitty")
    assert capsys.readouterr().out.count("* instead of") == 1


@pytest.mark.parametrize("columns", ["40", "80", "160"])
def test_the_table_keeps_to_the_width(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    columns: str,
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    checked(tmp_path, GOOD, "--all")
    out = capsys.readouterr().out
    widest = max(len(line) for line in out.splitlines() if "warning:" not in line)
    assert widest <= int(columns)


def test_the_last_line_is_the_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    checked(tmp_path, GOOD)
    *warnings, verdict = capsys.readouterr().out.splitlines()[1:]
    assert len(warnings) == 2
    assert verdict == "6 actions on 1 panel, no errors, 2 warnings"


def test_keys_and_verbs_are_shown_when_they_are_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checked(tmp_path, GOOD)
    out = capsys.readouterr().out
    assert "instead of" not in out
    assert "speed: number" not in out
    checked(tmp_path, GOOD, "--keys")
    out = capsys.readouterr().out
    assert "instead of" in out
    assert "speed: number" not in out


@pytest.mark.parametrize(
    ("written", "meant"),
    [("gesture: nod", "play"), ("speech: Hi", "say"), ("hotkey: h", "key"), ("pla: nod", "play")],
)
def test_a_word_of_another_program_finds_ours(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], written: str, meant: str
) -> None:
    assert checked(tmp_path, panel(f"{{label: A, {written}}}", head=ROBOT)) == 1
    assert f"unknown; did you mean {meant!r}?" in capsys.readouterr().err


def test_json_for_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(tmp_path, GOOD, "--format", "json") == 0
    report: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert report["ok"] is True
    first, second = report["keys"][:2]
    assert first["key"] == "h"
    assert second["wanted"] == "ctrl+1"
    assert second["reserve"] is True
    assert {driver["name"] for driver in report["drivers"]} == {"head", "voice"}
    assert report["problems"][0]["warning"] is True


def test_json_of_a_broken_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(tmp_path, "title: T\n", "--format", "json") == 1
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] is False
    assert {problem["path"] for problem in report["problems"]} == {"robot", "panels"}


def test_a_keymap_is_looked_at_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keymap = tmp_path / "keymap.yaml"
    keymap.write_text("say: ctrl+g\n")
    assert checked(tmp_path, GOOD, "--keymap", str(keymap)) == 0
    assert "ctrl+g: type something to say" in capsys.readouterr().out
    keymap.write_text("stop: x\n")
    assert checked(tmp_path, GOOD, "--keymap", str(keymap)) == 1
    assert "the key of the stop cannot be changed" in capsys.readouterr().err


def test_colours_only_where_they_are_wanted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    checked(tmp_path, GOOD)
    assert "\x1b[33m" in capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    checked(tmp_path, GOOD)
    assert "\x1b[33m" not in capsys.readouterr().out


def test_the_command_with_the_installed_drivers(capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    check.add(parser)
    demo = Path(__file__).parents[2] / "experiments" / "demo.yaml"
    arguments = parser.parse_args([str(demo)])
    assert check.run(arguments) == 0
    assert "Museum guide" in capsys.readouterr().out


def test_parts_and_verbs_that_nobody_s_panel_covers(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "e.yaml"
    path.write_text(
        "title: T\nrobot: {drivers: {robot: {type: simulated}}}\npanels:\n"
        "  - {title: Speech, for: voice, covers: [say], actions: [{label: Hi, say: Hi}]}\n"
        "  - {title: Rest, actions: [{label: Ho, say: Ho}]}\n"
    )
    parser = argparse.ArgumentParser()
    check.add(parser)
    assert check.run(parser.parse_args([str(path), "--all"])) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "voice Speech (no part) Rest (everybody) drive by hand: no panel" in told


MODEL = """title: T
robot: {drivers: {eye: {type: camera, sees: [presence, loudness]}, voice: {type: voice}}}
engagement:
  threshold: 0.7
  samples: 10
  gaze: {filter: joint}
  distance: {filter: median, samples: 9}
  social_distance: 1.2
  timeouts: {lost: 3, listening: null}
  handshake: {by: robot, attempts: 2}
  on_enter: {Wait: [Looks, {say: Bye, sound: a.wav}, {wait: 1}, {repeat: 2}]}
"""


def test_the_engagement_model_in_a_few_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    looks, who = "{key: g, label: Looks, toggle: gaze}", "{label: Who, visitor: V1}"
    assert checked(tmp_path, panel(looks, who, head=MODEL), "--all") == 0
    out = capsys.readouterr().out
    told: dict[str, str] = {}
    for line in out.splitlines():
        about, _, text = line.partition("  ")
        told.setdefault(about, text.strip())
    assert told["engaged"] == "who is there and looks and is within 1.2 m"
    assert told["presence"] == "fifo 7 of 10, from presence (eye)"
    assert told["gaze"] == "joint, from 70 % on, by 'Looks'"
    assert told["distance"] == "median of 9, no driver gives it"
    assert told["identity"] == "fifo 7 of 10, by 'Who'"
    assert told["speech"] == "loudness (eye), above the learnt threshold, 1 s of silence end it"
    assert told["timeouts"] == "lost 3 s, talking 120 s, unengaged 10 s"
    assert told["turns"] == "end when whoever spoke has gone or was replaced"
    assert told["handshake"] == "led by the robot, asks 2 times within 60 s"
    assert told["starts"] == "running"
    assert told["on Wait"] == (
        "say Bye + sound a.wav, then wait 1 s, then repeat 2, beside it plays 'Looks'"
    )
    assert told["toggle"] == "set a sign by hand to the opposite of its present value"
    assert "toggle gaze" in out
    assert "no driver gives distance" in out


@pytest.mark.parametrize(
    ("sees", "settings", "about"),
    [
        ("presence, speech", "", "speech cut by eye"),
        ("presence", "", "speech no driver detects it"),
        ("loudness", "sound: {threshold: 0.1}", "louder than 0.1,"),
        ("presence", "handshake: {by: nobody}", "visitors without a name stay without one"),
        ("presence", "handshake: {by: wizard}", "led by the wizard, 60 s at most"),
        (
            "presence",
            "timeouts: {listening: null, talking: null, unengaged: null}",
            "timeouts none",
        ),
        (
            *("presence", "turns: paper"),
            "turns last until they are over, as in the paper timeouts listening 60 s, talking",
        ),
        ("presence", "start: off", "switched off"),
        ("presence", "signs: [gaze]", "engaged who looks"),
        (
            *("presence", "presence: {rate: 3}"),
            "fifo 4 of 8, at most 3 samples a second, from presence (eye)",
        ),
    ],
)
def test_other_models(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], sees: str, settings: str, about: str
) -> None:
    head = f"title: T\nrobot: {{drivers: {{eye: {{type: camera, sees: [{sees}]}}}}}}\n"
    text = panel("{label: A, mark: x}", head=f"{head}engagement: {{{settings}}}\n")
    assert checked(tmp_path, text, "--all") == 0
    assert about in " ".join(capsys.readouterr().out.split())


def test_the_engagement_model_for_programs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        checked(tmp_path, panel("{label: Looks, toggle: gaze}", head=MODEL), "--format", "json")
        == 0
    )
    model = json.loads(capsys.readouterr().out)["engagement"]
    assert model["signs"]["presence"] == {
        "used": True,
        "filter": "fifo",
        "needed": 7,
        "places": 10,
        "rate": None,
        "sensors": ["presence (eye)"],
        "actions": [],
    }
    assert model["signs"]["gaze"]["actions"] == ["Looks"]
    assert model["on_enter"]["Wait"][1] == "plays 'Looks'"
    assert {verb["name"] for verb in model["verbs"]} >= {"toggle", "sense", "force"}
    assert checked(tmp_path, GOOD, "--format", "json") == 0
    assert json.loads(capsys.readouterr().out)["engagement"] is None


ANOTHER = "drivers: {voice: {type: voice}}"


def test_another_robot_is_shown_with_what_it_does_and_leaves_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "speaker.yaml").write_text(ANOTHER)
    assert checked(tmp_path, GOOD, "--robot", "speaker") == 0
    out = capsys.readouterr().out
    hello = next(line for line in out.splitlines() if "Hello" in line and "P " in line)
    assert hello.split() == ["P", "Hello", "say", "play"]
    assert any(line.split() == ["Chord", "nothing", "pose"] for line in out.splitlines())
    assert "warning: P > Hello > play: is left out on speaker" in out
    assert checked(tmp_path, GOOD, "--robot", "speaker", "--format", "json") == 0
    report = json.loads(capsys.readouterr().out)
    assert report["left_out"]["Chord"] == [{"what": "pose", "why": "not offered"}]


def test_all_robots_are_a_column_each_and_a_broken_one_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "1-speaker.yaml").write_text(ANOTHER)
    (tmp_path / "robots" / "2-wrong.yaml").write_text("drivers: {}")
    assert checked(tmp_path, GOOD, "--robot", "all") == 1
    out = capsys.readouterr().out
    assert next(line for line in out.splitlines() if "Chord" in line).split()[1] == "no"
    assert next(line for line in out.splitlines() if "Hello" in line).split()[1] == "part"
    assert "1 1-speaker: leaves out" in out
    lines = out.splitlines()
    heads = [line.split()[0] for line in lines if line.strip()]
    assert heads.index("1") < heads.index("action") < heads.index("Hello"), "names come first"
    assert "2-wrong: " in out
    checked(tmp_path, GOOD, "--robot", "all", "--format", "json")
    report = json.loads(capsys.readouterr().out)
    assert report["robots"]["1-speaker"]["Hello"] == ["play"]


def test_a_long_table_of_robots_repeats_its_heading(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "speaker.yaml").write_text(ANOTHER)
    actions = "".join(f"      - {{label: A{n}, say: Hi}}\n" for n in range(50))
    checked(tmp_path, f"title: T\nrobot: simulated\npanels:\n  - title: P\n    actions:\n{actions}",
            "--robot", "all")  # fmt: skip
    lines = capsys.readouterr().out.splitlines()
    at = [number for number, line in enumerate(lines) if line.startswith("action")]
    assert len(at) >= 3
    assert max(b - a for a, b in itertools.pairwise(at)) <= 24


def test_errors_are_counted_for_the_file_that_has_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other.yaml"
    other.write_text("drivers: {voice: {type: voic, speed: 2}, ear: {type: eer}}")
    assert checked(tmp_path, GOOD, "--robot", str(other)) == 1
    assert capsys.readouterr().err.splitlines()[-1] == f"{other}: 2 errors"
    wrong = GOOD.replace("label: Hello", "lable: Hello")
    assert checked(tmp_path, wrong, "--robot", str(other)) == 1
    counts = capsys.readouterr().err.splitlines()[-2:]
    assert sorted(counts) == sorted([f"{tmp_path / 'e.yaml'}: 1 error", f"{other}: 2 errors"])


def test_a_robot_file_is_checked_as_what_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "e.yaml"
    assert checked(tmp_path, ANOTHER) == 0
    out = capsys.readouterr().out
    assert "voice (voice)  say, " in out
    assert f"{path}: a robot file of 1 driver, no errors" in out
    assert f"woz check EXPERIMENT --robot {path}" in out
    assert checked(tmp_path, ANOTHER, "--all") == 0
    assert "text: text, required" in capsys.readouterr().out
    assert checked(tmp_path, ANOTHER, "--format", "json") == 0
    [driver] = json.loads(capsys.readouterr().out)["drivers"]
    assert (driver["name"], driver["verbs"][0]["name"]) == ("voice", "say")


def test_what_is_wrong_with_a_robot_file_is_told_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "e.yaml"
    assert checked(tmp_path, "name: f\ndrivers:\n  ear: {type: voic}\n") == 1
    err = capsys.readouterr().err.splitlines()
    assert err[0].startswith(f"{path}:3:9: drivers.ear.type: there is no driver")
    assert err[-1] == f"{path}: 1 error"
    assert checked(tmp_path, ANOTHER, "--robot", "voice") == 1
    assert f"woz check EXPERIMENT --robot {path}" in capsys.readouterr().err
