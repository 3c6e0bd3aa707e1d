"""Files that are right: everything that can be said, and what becomes of it."""

from __future__ import annotations

import hashlib
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import pytest

from tests.config.catalogue import CATALOGUE, Colour, Joint, Rule
from tests.config.reading import HEAD, ROBOT, errors, only, panel, read_experiment
from woz_tui.config.experiment import Action, Call, Experiment, ParallelCalls, Wait
from woz_tui.config.loading import load
from woz_tui.config.reload_changes import compare
from woz_tui.features.scripts.section import SCRIPT

GOOD = Path(__file__).parent / "good"


@pytest.fixture(scope="module")
def everything() -> Experiment:
    return load(GOOD / "everything.yaml", CATALOGUE)


def calls(action: Action) -> list[tuple[str, str, dict[str, Any]]]:
    found: list[Call] = []
    for step in action.steps:
        if isinstance(step, ParallelCalls):
            found += step.calls
    return [(call.driver, call.verb, dict(call.args)) for call in found]


def test_text_stays_as_typed(everything: Experiment) -> None:
    assert everything.title == "007"
    assert everything.conditions == ("No", "12:30")
    assert everything.variables == {"room": "No", "time": "12:30"}
    assert [action.label for action in everything.panels[0].actions] == ["No", "1e3", "Quoted: yes"]
    assert calls(everything.panels[0].actions[0]) == [("voice", "say", {"text": "12:30"})]


def test_settings_become_the_drivers_own_dataclass(everything: Experiment) -> None:
    head, voice = everything.drivers
    assert head.settings.joints == {"pan": Joint(1), "tilt": Joint(2, -20.0, 30.0)}
    assert head.settings.rate == 50.0
    assert head.offer.sensors == ("joint.pan", "joint.tilt")
    settings = voice.settings
    assert settings.words == ("No", "12:30", "1e3")
    assert (settings.pause, settings.colour, settings.mode) == (0.25, Colour.BLUE, "loud")
    assert (settings.pair, settings.numbers) == ((1.0, 2.5), [1, -2])
    assert settings.rules == (Rule("now"),)
    assert settings.limit is None
    assert settings.command == ("espeak", "-v", "de")
    assert settings.either == 7
    assert settings.folder == GOOD.absolute() / "sounds"
    assert settings.extra == {"a": [1, 2.5, True, None, "text"]}
    assert settings.from_ == "there"


def test_keys_are_in_normal_form(everything: Experiment) -> None:
    keys = [action.key for panel in everything.panels for action in panel.actions]
    assert keys == ["h", "!", "ctrl+a", "c r", "", "g", "p", "n", *[""] * 10]


def test_merged_mappings_and_verbs_together(everything: Experiment) -> None:
    assert calls(everything.panels[0].actions[1]) == [
        ("head", "play", {"move": "nod"}),
        ("voice", "say", {"text": "12:30"}),
    ]


def test_steps(everything: Experiment) -> None:
    action = everything.action("Steps")
    assert action is not None
    assert action.when_busy == "refuse"
    assert action.steps[1] == Wait(0.25)
    assert calls(action) == [
        ("voice", "say", {"text": "Hi"}),
        ("head", "play", {"move": "shake"}),
        ("head", "pose", {"joints": {"pan": 10.0}, "seconds": 2.0}),
        ("head", "pose", {"joints": {"tilt": 5.0}, "seconds": 1.0}),
        (
            "head",
            "poses",
            {
                "poses": [
                    {"joints": {"pan": 10.0}, "seconds": 1.0},
                    {"joints": {"pan": 0.0, "tilt": 3.0}},
                ]
            },
        ),
        ("head", "home", {}),
        ("head", "blink", {}),
        ("head", "torque", {"on": False}),
        ("session", "mark", {"text": "half way"}),
        ("voice", "sound", {"file": "none.wav"}),
        ("session", "set", {"condition": "No", "trial": 3}),
        ("session", "lock", {"panel": "Steps"}),
        ("head", "torque", {"on": True}),
    ]


def test_missing_files_and_parts_that_nobody_plays_are_warnings(everything: Experiment) -> None:
    said = [f"{problem.path}: {problem.message}" for problem in everything.warnings]
    deaf = said.pop(0)
    assert deaf.startswith("engagement.handshake.by: no driver recognises the answer")
    stiff = said.pop(0)
    assert stiff.startswith("engagement.attention.look: the robot does not look to sounds")
    assert said == [
        "panels[1].actions[0].steps[6].sound: there is no file 'none.wav'",
    ]


def test_the_rest_of_the_file(everything: Experiment) -> None:
    assert everything.participant_pattern == r"P\d\d"
    assert everything.session.deadline == 2.0
    assert everything.session.abandon_after == 600.0
    assert everything.session.stale_after == 0.5
    assert SCRIPT.of(everything) == ("No", "Steps", "No")
    assert [panel.locked for panel in everything.panels] == [False, False, False]
    assert everything.panels[0].actions[2].locked
    assert everything.panels[0].actions[2].help == "Off"


def test_the_hash_covers_every_file_that_was_read(tmp_path: Path) -> None:
    (tmp_path / "r.yaml").write_text("drivers: {robot: {type: simulated}}\n")
    text = panel("{key: a, label: A, say: Hi}", head="title: T\nrobot: r.yaml\n")
    experiment = read_experiment(tmp_path, text)
    files = [(tmp_path / name).read_bytes() for name in ("experiment.yaml", "r.yaml")]
    assert experiment.sha256 == hashlib.sha256(b"".join(files)).hexdigest()
    assert experiment.files == (tmp_path / "experiment.yaml", tmp_path / "r.yaml")


def test_an_experiment_is_frozen(everything: Experiment) -> None:
    with pytest.raises(FrozenInstanceError):
        everything.title = "other"  # type: ignore[misc]


def test_several_robots_prefix_their_drivers(tmp_path: Path) -> None:
    text = panel(
        "{key: a, label: A, say: Hi, on: [left, right]}",
        "{key: b, label: B, say: {text: Hi, on: left}, emotion: {emotion: sad, on: right.robot}}",
        "{key: c, label: C, on: right, steps: [{say: Hi}, {say: Ho, on: left}]}",
        head="title: T\nrobots: {left: simulated, right: simulated}\n",
    )
    both, two, steps = read_experiment(tmp_path, text).panels[0].actions
    assert [call[0] for call in calls(both)] == ["left.robot", "right.robot"]
    assert [call[:2] for call in calls(two)] == [("left.robot", "say"), ("right.robot", "emotion")]
    assert [call[0] for call in calls(steps)] == ["right.robot", "left.robot"]


@pytest.mark.parametrize(
    ("action", "args"),
    [
        ("{label: A, say: No}", {"text": "No"}),
        ("{label: A, say: {text: 1e3, volume: 1}}", {"text": "1e3", "volume": 1.0}),
        ("{label: A, say: Hi, speed: 0.5}", {"text": "Hi", "speed": 0.5}),
        ("{label: A, say: 'a {condition} {{b}}'}", {"text": "a {condition} {{b}}"}),
        ("{label: A, pose: {pan: 10}}", {"joints": {"pan": 10.0}}),
        ("{label: A, pose: {pan: 1, tilt: 2}, seconds: 1 s}",
         {"joints": {"pan": 1.0, "tilt": 2.0}, "seconds": 1.0}),
        ("{label: A, repeat: }", {}),
        ("{label: A, repeat: 3}", {"times": 3}),
        ("{label: A, torque: yes}", {"on": True}),
        ("{label: A, sound: 'https://example.org/a.wav'}", {"file": "https://example.org/a.wav"}),
    ],
)  # fmt: skip
def test_arguments_beside_and_under_the_verb(
    tmp_path: Path, action: str, args: dict[str, Any]
) -> None:
    ((_, _, found),) = calls(only(tmp_path, action, head=ROBOT))
    assert found == args


def test_two_verbs_of_one_lane_together_are_a_warning(tmp_path: Path) -> None:
    experiment = read_experiment(
        tmp_path, panel("{label: A, emotion: sad, screen: a.png}", head=HEAD)
    )
    said = [problem.message for problem in experiment.warnings]
    assert said == [
        "there is no file 'a.png'",
        "waits until 'emotion' has ended: both use the face of robot",
    ]


def test_a_key_that_the_keyboard_lacks_is_a_warning(tmp_path: Path) -> None:
    text = panel("{key: ñ, label: A, say: Hi}")
    (warning,) = read_experiment(tmp_path, text).warnings
    assert "the us keyboard has no key for 'ñ'" in warning.message
    assert not read_experiment(tmp_path, text + "keyboard: es\n").warnings


def test_a_locked_action_in_the_script_is_a_warning(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi, locked: true}") + "script: [A]\n"
    (warning,) = read_experiment(tmp_path, text).warnings
    assert warning.path == "script[0]"


CHOSEN = HEAD + "conditions: [cool, warm, text]\n"


@pytest.mark.parametrize(
    ("written", "texts"),
    [
        ("{any: [Hm., No]}", {"": ("Hm.", "No")}),
        (
            "{cool: Hi, warm: {any: [a, b]}, text: x}",
            {"cool": ("Hi",), "warm": ("a", "b"), "text": ("x",)},
        ),
        ("{text: {cool: a, warm: b, text: c}}", {"cool": ("a",), "warm": ("b",), "text": ("c",)}),
    ],
)
def test_texts_by_condition_and_variants_stand_in_place(
    tmp_path: Path, written: str, texts: dict[str, tuple[str, ...]]
) -> None:
    if "text: x" in written:  # the name of an argument comes before that of a condition
        written = f"{{text: {written}}}"
    (call,) = only(tmp_path, f"{{label: A, say: {written}}}", CHOSEN).calls
    assert call.args == {}
    assert {name: choice.texts for name, choice in call.choices.items()} == {"text": texts}


def test_a_file_of_each_condition_is_looked_for(tmp_path: Path) -> None:
    (tmp_path / "a.wav").write_bytes(b"RIFF\x25\0\0\0WAVEdata\1\0\0\0\0")
    sound = "{label: A, sound: {cool: a.wav, warm: b.wav}}"
    text = panel(sound, head=ROBOT + "conditions: [cool, warm]\n")
    (warning,) = read_experiment(tmp_path, text).warnings
    assert warning.path.endswith("sound.warm")
    assert "b.wav" in warning.message


def test_an_argument_called_like_a_condition_stays_the_argument(tmp_path: Path) -> None:
    """As it was before texts could stand in place."""
    (call,) = only(tmp_path, "{label: A, say: {text: Hi}}", CHOSEN).calls
    assert (call.args, call.choices) == ({"text": "Hi"}, {})


def test_a_byte_order_mark_and_windows_line_ends_change_nothing(tmp_path: Path) -> None:
    text = panel("{key: a, label: Führung, say: Grüß Gott}")
    plain = read_experiment(tmp_path, text)
    (tmp_path / "experiment.yaml").write_bytes(
        b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()
    )
    assert load(tmp_path / "experiment.yaml", CATALOGUE).panels == plain.panels


def test_every_action_may_lack_a_key_but_not_a_name(tmp_path: Path) -> None:
    assert not errors(tmp_path, panel("{name: A, say: Hi}", "{label: B, say: Hi}"))


def test_a_pattern_that_takes_long_is_warned_of_and_stays_valid(tmp_path: Path) -> None:
    text = panel("{key: a, label: A, say: Hi}")
    endless = "(?:(?:A|A)+(?:A|A|A|A)*(?:A|A|A|A)*)+1"
    slow = read_experiment(tmp_path, text + f"participants: {{pattern: '{endless}'}}\n")
    assert slow.participant_pattern == endless
    (warning,) = slow.warnings
    assert warning.path == "participants.pattern"
    for quick in (r"P\d\d", "(([A-Z]+)+)+[0-9]"):
        assert not read_experiment(
            tmp_path, text + f"participants: {{pattern: '{quick}'}}\n"
        ).warnings


def test_what_stands_first_among_the_sensors(tmp_path: Path) -> None:
    """What no driver names may still come from the robot; the model needs its section."""
    action = "{key: a, label: A, say: Hi}"
    experiment = read_experiment(
        tmp_path, panel(action, head=f"{ROBOT}sensors: [joint.pan, pan, pose, weather]\n")
    )
    assert experiment.sensors == ("joint.pan", "pan", "pose", "weather")
    (only,) = experiment.warnings
    assert (only.place.line, only.place.column) == (ROBOT.count("\n") + 1, 33)
    assert "weather" in only.message
    bare = read_experiment(tmp_path, panel(action, head=f"{ROBOT}sensors: [engagement]\n"))
    (model,) = bare.warnings
    assert "no section engagement" in model.message
    other = read_experiment(tmp_path, panel(action, head=f"{ROBOT}sensors: [pose]\n"))
    assert not compare(experiment, other).drivers
    assert list(compare(experiment, other).changes) == ["sensors changed"]
