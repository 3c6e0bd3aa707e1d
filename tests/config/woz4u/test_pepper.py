"""The robot of a WoZ4U file: addresses, folders, what is set on connect, arrow keys."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.settings import AutonomySettings, VoiceSettings

from tests.config.woz4u.reading import does, messages, panel, problems, read_experiment, settings

NO_ROBOT = "gestures: []\n"


@pytest.mark.woz4u("pepper_ips")
def test_the_robots_to_choose_from(tmp_path: Path) -> None:
    text = "pepper_ips: [192.168.1.4, pepper.local, tcp://10.0.0.3:9559, 192.168.1.4]\n"
    pepper_settings = settings(read_experiment(tmp_path, text, start=""))
    assert pepper_settings.robots == ("192.168.1.4", "pepper.local", "tcp://10.0.0.3:9559")
    assert problems(tmp_path, text, start="") == [
        "1:62: warning: pepper_ips[3]: '192.168.1.4' appears twice"
    ]


@pytest.mark.woz4u("pepper_ips")
@pytest.mark.parametrize("text", ["", "pepper_ips:\n", "pepper_ips: []\n", "pepper_ips: ['']\n"])
def test_without_a_robot_a_simulated_one_is_played(tmp_path: Path, text: str) -> None:
    assert settings(read_experiment(tmp_path, NO_ROBOT, start=text)).robots == ("simulated",)
    assert messages(tmp_path, NO_ROBOT, start=text) == [
        "warning: pepper_ips: no robot is named; a simulated one is used (pepper_ips: [simulated])"
    ]


def test_one_address_without_a_list(tmp_path: Path) -> None:
    assert settings(read_experiment(tmp_path, "", start="pepper_ips: 10.0.0.9\n")).robots == (
        "10.0.0.9",
    )
    assert messages(tmp_path, "", start="pepper_ips: 10.0.0.9\n") == [
        "warning: pepper_ips: expected a list of addresses; this one is read as a list of one"
    ]


def test_an_address_that_is_none_is_an_error(tmp_path: Path) -> None:
    text = "pepper_ips:\n  - 10.0.0.9\n  - {ip: 10.0.0.8}\n"
    assert problems(tmp_path, "", start=text) == [
        "3:5: pepper_ips[1]: expected a robot's address, such as 192.168.1.20, not a mapping"
    ]


@pytest.mark.woz4u("camera_save_dir", "audio_save_dir")
def test_folders_of_pictures_and_recordings(tmp_path: Path) -> None:
    pepper_settings = settings(
        read_experiment(
            tmp_path, "camera_save_dir: faces\naudio_save_dir: /home/nao/recordings/museum\n"
        )
    )
    assert (pepper_settings.pictures, pepper_settings.recordings) == (
        "faces",
        "/home/nao/recordings/museum",
    )
    assert settings(read_experiment(tmp_path, "")).pictures == ""


@pytest.mark.woz4u(
    "autonomous_life_config",
    "autonomous_state",
    "tangential_collision",
    "blinking",
    "orthogonal_collision",
    "basic_awareness",
    "engagement_mode",
    "head_breathing",
    "arms_breathing",
    "body_breathing",
    "legs_breathing",
    "listening_movement",
    "speaking_movement",
)
def test_what_the_robot_does_by_itself(tmp_path: Path) -> None:
    text = """autonomous_life_config:
  autonomous_state: "solitary"
  tangential_collision: 0.05
  orthogonal_collision: "0.4"
  blinking: False
  basic_awareness: true
  engagement_mode: fullyengaged
  head_breathing: "no"
  arms_breathing: on
  body_breathing: "True"
  legs_breathing: 0
  listening_movement: FALSE
  speaking_movement: 1
"""
    assert problems(tmp_path, text) == []
    assert settings(read_experiment(tmp_path, text)).autonomy == AutonomySettings(
        state="solitary",
        tangential=0.05,
        orthogonal=0.4,
        blinking=False,
        awareness=True,
        engagement="FullyEngaged",
        head_breathing=False,
        arms_breathing=True,
        body_breathing=True,
        legs_breathing=False,
        listening_movement=False,
        speaking_movement=True,
    )


@pytest.mark.woz4u("autonomous_life_config")
@pytest.mark.parametrize("nothing", ['""', "", "~", "null", "' '"])
def test_an_empty_value_leaves_the_robots(tmp_path: Path, nothing: str) -> None:
    names = ("autonomous_state", "blinking", "tangential_collision", "engagement_mode")
    text = "autonomous_life_config:\n" + "".join(f"  {name}: {nothing}\n" for name in names)
    assert settings(read_experiment(tmp_path, text)).autonomy == AutonomySettings()
    assert problems(tmp_path, text) == []


def test_values_that_cannot_be_used_leave_the_robots_with_a_warning(tmp_path: Path) -> None:
    text = """autonomous_life_config:
  autonomous_state: solitry
  tangential_collision: 40
  blinking: maybe
  breathing: true
"""
    assert settings(read_experiment(tmp_path, text)).autonomy == AutonomySettings()
    assert problems(tmp_path, text) == [
        "3:3: warning: autonomous_life_config.autonomous_state: 'solitry' is not known; the robot's"
        " value stays; did you mean 'solitary'?",
        "4:3: warning: autonomous_life_config.tangential_collision: '40' is out of range; allowed"
        " is 0 to 5 m; the robot's value stays",
        "5:3: warning: autonomous_life_config.blinking: expected true or false, not 'maybe'; the"
        " robot's value stays",
        "6:3: warning: autonomous_life_config.breathing: this key is not used; did you mean"
        " 'legs_breathing'?",
    ]


def test_a_list_instead_of_the_settings_is_an_error(tmp_path: Path) -> None:
    (problem,) = problems(tmp_path, "autonomous_life_config: [solitary]\n")
    assert problem == (
        "2:1: autonomous_life_config: expected a mapping, such as {autonomous_state: solitary},"
        " not a list"
    )


@pytest.mark.woz4u("volume", "voice_speed", "voice_pitch")
def test_the_voice(tmp_path: Path) -> None:
    experiment = read_experiment(tmp_path, "volume: 0.35\nvoice_speed: '85'\nvoice_pitch: 1.2\n")
    assert settings(experiment).voice == VoiceSettings(volume=0.35, speed=85.0, pitch=1.2)
    assert [does(action) for action in panel(experiment, "Voice").actions] == [
        [("volume", {"level": 0.35})],
        [("speech_speed", {"percent": 85.0})],
        [("speech_pitch", {"pitch": 1.2})],
    ]


@pytest.mark.woz4u("volume", "voice_pitch")
@pytest.mark.parametrize(
    ("text", "value", "warning"),
    [
        (
            "volume: 0,5",
            VoiceSettings(volume=0.5),
            "'0,5' is read as 0.5: the decimal sign is a point",
        ),
        (
            "volume: 50",
            VoiceSettings(),
            "'50' is out of range; allowed is 0 to 1; the robot's value stays",
        ),
        (
            "volume: .nan",
            VoiceSettings(),
            "expected a number (0 to 1), not '.nan'; the robot's value stays",
        ),
        ("voice_pitch: 0", VoiceSettings(pitch=0.0), ""),
        (
            "voice_pitch: 0.5",
            VoiceSettings(),
            "0.5 is not a pitch: allowed are 0 and 1 to 4; the robot's value stays",
        ),
        ("voice_speed: ''", VoiceSettings(), ""),
    ],
)  # fmt: skip
def test_odd_figures_of_the_voice(
    tmp_path: Path, text: str, value: VoiceSettings, warning: str
) -> None:
    assert settings(read_experiment(tmp_path, f"{text}\n")).voice == value
    found = messages(tmp_path, f"{text}\n")
    assert found == ([f"warning: {text.partition(':')[0]}: {warning}"] if warning else [])


@pytest.mark.woz4u("default_head_turn_deg", "default_turn_deg", "default_drive_dist")
def test_steps_of_the_arrow_keys(tmp_path: Path) -> None:
    text = "default_head_turn_deg: 20\ndefault_turn_deg: '45'\ndefault_drive_dist : 15\n"
    steps = read_experiment(tmp_path, text).steps
    assert (steps.head, steps.turn, steps.drive) == (20.0, 45.0, 0.15)
    assert steps.hip == pytest.approx(11.46)  # 0.2 rad


@pytest.mark.woz4u("default_drive_dist")
def test_a_step_backwards_is_none(tmp_path: Path) -> None:
    text = "default_drive_dist: -10\n"
    assert read_experiment(tmp_path, text).steps.drive == read_experiment(tmp_path, "").steps.drive
    assert messages(tmp_path, text) == [
        "warning: default_drive_dist: '-10' is out of range; allowed is 1 to 500 cm; the usual"
        " step is taken"
    ]
