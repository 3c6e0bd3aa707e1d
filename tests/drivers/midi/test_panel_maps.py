"""Map files: built in, in a file, in the robot file; and every mistake with its place."""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest
import yaml
from woz_drivers.midi import MidiPanel
from woz_drivers.midi.panel_maps import BUILT_IN
from woz_drivers.midi.resolved_map import mapped_controls, signal_of
from woz_drivers.midi.settings import MidiSettings

from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.json_schema import included_schema
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Ask

ROOT = Path(__file__).parents[3]

BODY = """
  body:
    type: body
    joints:
      pitch: {axis: z, min: -90, max: 90, speed: 360}
      middle: {axis: -y, min: 0, max: 90, speed: 250}
      top: {axis: y, min: 0, max: 90, speed: 320}
    zoom: {middle: 1, top: -1}
    roles: {pan: {pitch: 1}, nod: {top: 1}, lean: {middle: 1}}
    face: {}
    personalities: {upbeat: {tempo: 3}}
"""


def experiment(folder: Path, panel: str, actions: str = "") -> Experiment:
    """An experiment with a body and this panel."""
    (folder / "robot.yaml").write_text(f"drivers:{BODY}  panel:\n{panel}", encoding="utf-8")
    (folder / "it.yaml").write_text(
        "title: it\nrobot: robot.yaml\npanels:\n  - title: P\n    actions:\n"
        f"      - {{key: h, label: Hello, emotion: happy}}\n{actions}",
        encoding="utf-8",
    )
    return load(folder / "it.yaml", plugins.installed())


def problems(folder: Path, panel: str) -> list[str]:
    with pytest.raises(ExperimentError) as raised:
        experiment(folder, panel)
    return [str(problem).removeprefix(f"{folder}/") for problem in raised.value.problems]


@pytest.mark.toolkit("K1")
@pytest.mark.parametrize("name", BUILT_IN)
def test_a_built_in_map_fits_the_body(tmp_path: Path, name: str) -> None:
    found = experiment(tmp_path, f"    type: midi\n    map: {name}\n")
    assert found.warnings == ()
    settings = next(spec.settings for spec in found.drivers if spec.name == "panel")
    assert settings.problems() == list(settings.panel.problems()) == []


@pytest.mark.parametrize("name", BUILT_IN)
def test_the_files_to_begin_with_say_what_is_built_in(name: str) -> None:
    file = ROOT / "experiments" / "midi" / f"{name}.yaml"
    midi_settings: MidiSettings = settings_from_texts(MidiSettings, {"map": str(file)}, ROOT)
    assert midi_settings.map == BUILT_IN[name]
    written = MidiPanel.map_file(MidiSettings(map=name))
    assert file.read_text(encoding="utf-8").endswith(written)


def test_the_schema_of_map_files_fits_them() -> None:
    validator = jsonschema.Draft202012Validator(included_schema(MidiPanel, "map"))
    for name in BUILT_IN:
        text = (ROOT / "experiments" / "midi" / f"{name}.yaml").read_text("utf-8")
        validator.validate(yaml.safe_load(text))
    wrong = {"controls": {"a": {"controll": "pitch"}}}
    assert not validator.is_valid(wrong)


@pytest.mark.toolkit("S3")
def test_a_robot_changes_some_controls_of_a_map_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "midi").mkdir()
    (tmp_path / "midi" / "mine.yaml").write_text(
        "title: mine\ncontrols:\n  fader: {cc: 7, channel: 2, control: zoom, range: [0.2, 0.8]}\n"
        "  pad: {note: 60, action: Hello}\n",
        encoding="utf-8",
    )
    found = experiment(
        tmp_path,
        "    type: midi\n    map: midi/mine.yaml\n    controls:\n"
        "      fader: {control: tempo}\n      more: {program: 3, verb: home, args: {seconds: 2}}\n",
    )
    assert tmp_path / "midi" / "mine.yaml" in found.files
    settings = next(spec.settings for spec in found.drivers if spec.name == "panel")
    by_name = {control.name: control for control in mapped_controls(settings)}
    assert str(signal_of(by_name["fader"])) == "cc 7, channel 2"
    assert by_name["fader"].turned(0.25) == Ask(
        "verb", "control", {"control": "tempo", "value": 0.25}, "body", "midi", "fader"
    )
    assert by_name["pad"].press() == Ask("action", "Hello", source="midi", key="pad")
    assert by_name["more"].press().args == {"seconds": 2}


def test_every_mistake_of_a_map_file_has_its_place(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(
        "layout: nanokontrol2\n"
        "controls:\n"
        "  knob-1: {control: pich}\n"
        "  knob-2: {emotion: happy}\n"
        "  knob-3: {control: tempo, range: [1, 0]}\n"
        "  button-1: {emotion: hapy}\n"
        "  button-2: {play: nod, mode: demo}\n"
        "  button-3: {action: Helo}\n"
        "  button-4: {action: Hello, press: toggle}\n"
        "  buton-5: {play: nod}\n"
        "  a: {cc: 16, control: tempo}\n"
        "  b: {cc: 16, control: speed}\n"
        "  button-6: {args: {move: nod}}\n"
        "  button-7: {verb: breathing, args: {on: true}, press: toggle}\n"
        "  button-8: {verb: breathing, args: {on: true}, press: momentary}\n",
        encoding="utf-8",
    )
    assert problems(tmp_path, "    type: midi\n    map: m.yaml\n") == [
        "m.yaml:4:12: controls.knob-2.emotion: it turns and cannot be pressed: a knob takes"
        " control, or verb with argument",
        "m.yaml:5:28: controls.knob-3.range: the low end comes first: [low, high]; `reversed`"
        " turns it round",
        "m.yaml:7:25: controls.button-2.mode: a control has one function: play is set already",
        "m.yaml:9:29: controls.button-4.press: action cannot be taken back: leave press out",
        "m.yaml:10:3: controls.buton-5: its signal is missing: set cc, note, program or"
        " bend; did you mean 'button-5'?",
        "m.yaml:12:3: controls.b: sends cc 16, and so does 'a'",
        "m.yaml:13:14: controls.button-6.args: needs verb",
        *(
            f"m.yaml:{line}:49: controls.button-{line - 7}.press: say in `back` with which"
            " arguments it is taken back"
            for line in (14, 15)
        ),
    ]


def test_what_nobody_could_carry_out_is_found_too(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(
        "layout: nanokontrol2\ncontrols:\n"
        "  knob-1: {control: pich}\n"
        "  knob-2: {verb: volume, argument: level}\n"
        "  knob-3: {verb: gaze, argument: yaw, range: [-400, 90]}\n"
        "  button-1: {emotion: hapy}\n"
        "  button-2: {action: Helo}\n"
        "  button-3: {verb: play, args: {mov: nod}}\n",
        encoding="utf-8",
    )
    assert problems(tmp_path, "    type: midi\n    map: m.yaml\n") == [
        "m.yaml:3:3: controls.knob-1: 'pich' is no control; did you mean 'pitch'?",
        "m.yaml:4:3: controls.knob-2: 'body' does not offer 'volume'; did you mean 'home'?",
        "m.yaml:5:3: controls.knob-3: yaw must be -180 to 180 degrees, not -400",
        "m.yaml:6:3: controls.button-1: 'hapy' is no emotion; did you mean 'happy'?",
        "m.yaml:7:3: controls.button-2: there is no action 'Helo'; did you mean 'Hello'?",
        "m.yaml:8:3: controls.button-3: play has no argument 'mov'; did you mean 'move'?",
        "m.yaml:8:3: controls.button-3: play needs 'move'",
    ]


def test_mistakes_in_the_robot_file_and_files_that_are_not_there(tmp_path: Path) -> None:
    line = BODY.count("\n") + 2
    assert problems(tmp_path, "    type: midi\n    map: thesys\n    on: bodi\n") == [
        f"robot.yaml:{line + 1}:5: drivers.panel.map: 'thesys': there is no such file; did you"
        " mean 'thesis'?"
    ]
    assert problems(tmp_path, "    type: midi\n    controls: {knob-9: {control: zoom}}\n") == [
        f"robot.yaml:{line + 1}:16: drivers.panel.controls.knob-9: its signal is missing:"
        " set cc, note, program or bend; did you mean 'knob-8'?"
    ]
    (tmp_path / "m.yaml").write_text("- knob-1\n", encoding="utf-8")
    assert problems(tmp_path, "    type: midi\n    map: m.yaml\n") == [
        "m.yaml:1:1: file: expected a mapping, not a list"
    ]


def test_a_built_in_map_for_another_body_only_warns(tmp_path: Path) -> None:
    found = experiment(tmp_path, "    type: midi\n    map: nanokontrol2\n")
    assert found.warnings == ()
    (tmp_path / "robot.yaml").write_text(
        "drivers:\n  body:\n    type: body\n    joints:\n"
        "      neck: {axis: z, min: -90, max: 90, speed: 90}\n  panel: {type: midi}\n",
        encoding="utf-8",
    )
    (tmp_path / "it.yaml").write_text(
        "title: it\nrobot: robot.yaml\npanels: [{title: P, actions: []}]\n", encoding="utf-8"
    )
    warnings = [
        str(problem) for problem in load(tmp_path / "it.yaml", plugins.installed()).warnings
    ]
    assert any("'pitch' is no control" in warning for warning in warnings)
