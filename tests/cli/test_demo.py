"""`woz demo`: whichever robot is named, its experiment is there and takes what it begins with."""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path

import pytest
from woz_drivers.microphone import voice_detection

from tests.session.rig import SessionRig
from woz_tui.cli import demo
from woz_tui.cli import run as run_command
from woz_tui.config.bundled_files import bundled_file, robot_files
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import plans_trials
from woz_tui.config.loading import load
from woz_tui.config.robot_fit import fitted
from woz_tui.drivers.plugins import installed
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.system.clock import RealClock


@pytest.mark.parametrize("robot", demo.DEMOS)
def test_a_demo_can_begin_as_it_would(robot: str) -> None:
    name, condition, participant = demo.DEMOS[robot]
    file = bundled_file(name)
    assert file is not None
    experiment = load(file, installed())
    if plans_trials(experiment):  # who comes, and what they get, is asked at the start
        assert (condition, participant) == ("", "")
        return
    assert condition in (experiment.conditions or ("",))
    assert re.fullmatch(experiment.participant_pattern, participant)


def test_the_robot_is_chosen_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    demo.add(parser)
    assert parser.parse_args([]).robot == "simulated"
    assert demo.run(parser.parse_args(["--robot", "eyepy"])) == 2
    assert "did you mean 'eyepi'?" in capsys.readouterr().err
    assert demo.run(parser.parse_args(["--robot", "xyz"])) == 2
    assert {"simulated", "ros"} <= {*re.split(r"[ ,\n]+", capsys.readouterr().err)}
    assert re.search(r"\bros\b", parser.format_help())


@pytest.mark.parametrize("robot", [*robot_files(None)])
@pytest.mark.parametrize("name", ["demo.yaml", "interview.yaml"])
def test_the_same_file_runs_on_every_robot(name: str, robot: str) -> None:
    file = bundled_file(name)
    assert file is not None
    own, other = load(file, installed()), load(file, installed(), robot=robot)
    for before in (action for panel in own.panels for action in panel.actions):
        after = other.action(before.name)
        assert after is not None
        done = [call.verb for call in after.calls]
        left_out = [each.what for each in after.left_out if "." not in each.what]
        assert sorted({*done, *left_out}) == sorted({call.verb for call in before.calls})


def shown_by(robot: str) -> Experiment:
    file = bundled_file(demo.DEMOS[demo.DEFAULT][0])
    assert file is not None
    return fitted(load(file, installed(), robot=demo.NAMES.get(robot, robot)))


@pytest.mark.parametrize("robot", demo.other_robots())
def test_a_demo_has_the_size_of_its_robot(robot: str) -> None:
    experiment = shown_by(robot)
    verbs = {(spec.name, verb.name) for spec in experiment.drivers for verb in spec.offer.verbs}
    actions = [action for panel in experiment.panels for action in panel.actions]
    assert len(actions) >= 10
    for action in actions:
        assert action.calls
        assert not action.left_out
        for call in action.calls:
            assert (call.driver, call.verb) in verbs or call.driver in ("session", "engagement")
            if call.verb in ("lock", "unlock"):
                assert call.args["panel"] in {panel.title for panel in experiment.panels}
    first = experiment.action(SCRIPT.of(experiment)[0])
    assert first is not None
    assert "say" in [call.verb for call in first.calls] or "say" not in {v for _, v in verbs}
    sensors = {name for spec in experiment.drivers for name in spec.offer.sensors}
    if experiment.engagement is not None:
        assert {*experiment.engagement.settings.signs} <= sensors
    assert {*experiment.sensors} <= {*sensors, "engagement", "pose"}


def test_robots_differ_in_what_their_demos_show() -> None:
    def labels(robot: str) -> set[str]:
        return {each.label for panel in shown_by(robot).panels for each in panel.actions}

    assert {"Nod", "Happy", "Whale song"} <= labels("reachy-mini")
    assert not {"Forward", "Drive on", "Picture", "Lean in"} & labels("reachy-mini")
    assert {"Forward", "Drive on"} <= labels("nao")
    model = shown_by("reachy-mini").engagement
    assert model is not None
    assert model.settings.signs == ("presence",)
    assert shown_by("qtrobot").engagement is None


@pytest.mark.parametrize(
    ("options", "drivers"),
    [
        (("--camera",), ["simulated", "faces"]),
        (("--microphone",), ["simulated", "microphone"]),
        (("--camera", "--microphone"), ["simulated", "faces", "microphone"]),
    ],
)
def test_camera_and_microphone_are_for_the_demo_of_the_engagement_model(
    options: tuple[str, ...],
    drivers: list[str],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parser = argparse.ArgumentParser()
    demo.add(parser)
    assert demo.run(parser.parse_args(["--robot", "pepper", *options])) == 2
    assert f"{options[0]} is for --robot guide" in capsys.readouterr().err
    played: list[list[str]] = []

    def play(arguments: argparse.Namespace, experiment: Path, robot: str, shown: object) -> int:
        played.append([one.type for one in load(experiment, installed(), robot=robot).drivers])
        return 0

    monkeypatch.setattr(run_command, "play", play)
    assert demo.run(parser.parse_args(list(options))) == 0
    assert played == [drivers]


SPEAKS = f"""#!{sys.executable} -S
import sys, time
quiet, loud = bytes(640), bytes((0, 32, 0, 224) * 160)
for n in range(3000):  # a minute
    sys.stdout.buffer.write(loud if n % 100 > 60 else quiet)
    sys.stdout.flush()
    time.sleep(0.02)
"""
MISSING = "#!/bin/sh\necho 'audio open error: No such file or directory' >&2\nexit 1\n"


@pytest.mark.parametrize(
    ("script", "kind", "says"),
    [(SPEAKS, m.SpeechEnded, ""), (MISSING, m.DriverLost, "audio open error")],
)
async def test_the_machines_microphone_is_heard_and_its_lack_is_a_sentence(
    script: str,
    kind: type[m.Message],
    says: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By an `arecord` of ours, on a machine without the package that tells voices."""
    monkeypatch.setattr(voice_detection, "PACKAGE", "no_such_package")
    (tmp_path / "arecord").write_text(script)
    (tmp_path / "arecord").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    file = bundled_file(demo.DEMOS[demo.WITH_REAL][0])
    assert file is not None
    experiment = load(file, installed(), robot=demo.REAL[False, True])
    who = SessionIdentity(participant="G01", condition="alone")
    async with SessionRig(tmp_path, (), who, installed(), experiment, clock=RealClock()) as rig:
        await rig.until(lambda: rig.of(kind))
    found = rig.of(kind)[0]
    if isinstance(found, m.DriverLost):
        assert says in found.detail
        assert found.remedy


def test_an_example_that_is_not_installed_is_none() -> None:
    assert bundled_file("nowhere.yaml") is None
