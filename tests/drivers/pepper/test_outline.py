"""What the console is told of a Pepper, and the arithmetic behind it: no robot is needed."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot import tags
from woz_drivers.naoqi_robot.eyes import EyeColor
from woz_drivers.naoqi_robot.settings import AutonomySettings, VoiceSettings
from woz_drivers.naoqi_robot.settings_reading import DesiredSettings, conflicts
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings

from woz_tui.drivers.contract import RejectedError
from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import RobotOutline

ONE = PepperSettings(robots=("10.0.0.1", "10.0.0.2"))
DEGREES = st.floats(-400, 400)


def wanted(settings: PepperSettings = ONE) -> DesiredSettings:
    return DesiredSettings(settings)


# -- the outline ---------------------------------------------------------------------------------


def test_the_outline_is_read_by_the_console_and_has_every_setting() -> None:
    told = RobotOutline.read(Pepper.offer(ONE).outline)
    assert told is not None
    assert sorted(line.name for line in told.settings) == sorted(PEPPER.settings)
    assert told.robots == ["10.0.0.1", "10.0.0.2", "simulated"]
    assert told.camera
    sections = dict.fromkeys(line.section for line in told.settings)
    assert list(sections) == ["Robot", "Autonomy", "Safety", "Voice", "Eyes", "Tablet"]
    assert all(tag.help for tag in told.tags)


def test_a_file_with_values_that_no_robot_takes_is_told_where() -> None:
    wrong = dataclasses.replace(ONE, eyes="grean", voice=VoiceSettings(pitch=0.5))
    assert [place for place, _ in wrong.problems()] == ["eyes", "voice.pitch"]
    right = dataclasses.replace(ONE, eyes="green", voice=VoiceSettings(pitch=1.5))
    assert right.problems() == []


# -- animations ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "path"),
    [
        ("Hey_1", "animations/Stand/Gestures/Hey_1"),
        ("hey_1", "animations/Stand/Gestures/Hey_1"),
        ("Gestures/Hey_1", "animations/Stand/Gestures/Hey_1"),
        ("animations/Stand/Gestures/Hey_1", "animations/Stand/Gestures/Hey_1"),
        (" BodyTalk_16 ", "animations/Stand/BodyTalk/Speaking/BodyTalk_16"),
        ("Happy_4", "animations/Stand/Emotions/Positive/Happy_4"),
        # Two folders have it: that of the gestures is meant.
        ("ShowSky_1", "animations/Stand/Gestures/ShowSky_1"),
        ("Waiting/ShowSky_1", "animations/Stand/Waiting/ShowSky_1"),
        ("our_lab/wave", "our_lab/wave"),
        ("animations/[posture]/Gestures/Hey_1", "animations/[posture]/Gestures/Hey_1"),
    ],
)
def test_a_short_name_becomes_a_path_and_any_path_is_tried(typed: str, path: str) -> None:
    assert PEPPER.animations.path_of(typed) == path


def test_an_unknown_short_name_is_refused_with_the_nearest() -> None:
    with pytest.raises(RejectedError) as raised:
        PEPPER.animations.path_of("Heey_1")
    assert "did you mean 'Hey_1'" in raised.value.remedy


def test_the_known_paths_are_each_there_once_and_find_themselves() -> None:
    names = PEPPER.animations
    assert len(set(names.moves)) == len(names.moves) == 370
    assert [path for path in names.moves if names.path_of(path) != path] == []


# -- joints --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("yaw", "low", "high"),
    [(0, -40.5, 25.5), (-33.33, -40.5, 25.5), (61.6, -35.2, 20.9), (-119.5, -35.0, 13.5)],
)
def test_the_heads_bend_is_limited_by_its_turn_as_documented(
    yaw: float, low: float, high: float
) -> None:
    allowed = PEPPER.joints.head_pitch(yaw)
    assert [allowed.low, allowed.high] == pytest.approx([low, high])


@given(DEGREES, DEGREES)
def test_the_nearest_direction_is_always_one_that_the_head_can_take(
    yaw: float, pitch: float
) -> None:
    turned, bent = PEPPER.joints.head(yaw, pitch)
    assert PEPPER.joints.ranges["HeadYaw"].contains(turned)
    assert PEPPER.joints.head_pitch(turned).contains(bent)
    assert PEPPER.joints.head(turned, bent) == (turned, bent)


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        ({"HeadYaw": 120}, "-119.5 to 119.5"),
        ({"HeadYaw": 100, "HeadPitch": 20}, "with the head turned by 100"),
        ({"RElbowRoll": 0}, "0.5 to 89.5"),
        ({"LHand": 2}, "0 to 1"),
        ({"HeadYow": 1}, "no joint 'HeadYow'"),
        ({"HeadYaw": "left"}, "takes a number"),
        ({}, "names joints"),
    ],
)
def test_an_impossible_pose_is_refused_before_anything_moves(pose: Json, says: str) -> None:
    with pytest.raises(RejectedError, match=says.replace("(", r"\(")):
        PEPPER.joints.checked(pose)


# -- texts ---------------------------------------------------------------------------------------


def test_blank_lines_part_paragraphs() -> None:
    assert tags.paragraphs("One\nline.\r\n\r\n \t\n\nTwo.\n") == ["One line.", "Two."]
    assert tags.paragraphs(" \n\n\t\n") == []


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_a_text_file_is_read_in_either_encoding(tmp_path: Path, encoding: str) -> None:
    file = tmp_path / "text.txt"
    file.write_bytes("Grüße, Zoë & Søren".encode(encoding))
    assert tags.read_text(file) == "Grüße, Zoë & Søren"


def test_what_has_no_end_is_not_read(tmp_path: Path) -> None:
    pipe, long, zero = (tmp_path / name for name in ("pipe.txt", "long.txt", "zero.txt"))
    os.mkfifo(pipe)
    long.write_bytes(b"x" * (tags.LONGEST + 1))
    zero.symlink_to("/dev/zero")
    for path, words in ((pipe, "no text file"), (zero, "no text file"), (long, "longer than")):
        with pytest.raises(RejectedError, match=words):
            tags.read_text(path)
    with pytest.raises(RejectedError, match="cannot be read"):
        tags.read_text(tmp_path / "a\0b")


def test_a_file_that_is_not_there_is_refused_by_name(tmp_path: Path) -> None:
    for path in (tmp_path / "nothing.txt", tmp_path):
        with pytest.raises(RejectedError, match=str(path)):
            tags.read_text(path)


def test_twice_the_speed_is_half_the_time_but_for_the_pauses() -> None:
    slow, fast = (tags.seconds("x" * 140 + r"\pau=1000\ ", speed) for speed in (100, 200))
    assert slow - 1 == pytest.approx(2 * (fast - 1))


# -- colours -------------------------------------------------------------------------------------


@given(st.integers(0, 0xFFFFFF))
def test_a_colour_survives_the_robots_order_of_parts(number: int) -> None:
    color = EyeColor.of(f"#{number:06x}")
    assert (color.number, color.text) == (number, f"#{number:06x}")
    assert EyeColor.read_back([color.blue, color.green, color.red]) == color


@pytest.mark.parametrize("nonsense", [None, 1.0, [], [1.0, 0.5]])
def test_what_is_no_colour_is_unknown(nonsense: Json) -> None:
    assert EyeColor.read_back(nonsense) is None


# -- wanted and conflicts ------------------------------------------------------------------------


def test_what_the_file_asks_for_is_wanted_until_the_robot_has_it() -> None:
    settings = wanted(
        dataclasses.replace(
            ONE,
            autonomy=AutonomySettings(blinking=False, orthogonal=0.4),
            voice=VoiceSettings(volume=0.5),
        )
    )
    has: dict[str, Json] = {"blinking": True, "orthogonal": 0.40001, "volume": 0.7}
    assert settings.differing(has) == {"blinking": False, "volume": 0.5}
    assert settings.differing(has | {"blinking": False, "volume": 0.5}) == {}
    assert settings.differing({}) == {}  # unknown is no difference


def test_a_body_is_not_wanted_to_breathe_as_a_whole_where_its_parts_are_to_differ() -> None:
    settings = wanted(dataclasses.replace(ONE, autonomy=AutonomySettings(body_breathing=True)))
    still: dict[str, Json] = {"body_breathing": False, "head_breathing": True}
    assert settings.differing(still) == {"body_breathing": True}
    settings.note("autonomy", {"head_breathing": True})
    assert settings.differing(still) == {"body_breathing": True}
    settings.note("autonomy", {"head_breathing": False})
    assert settings.differing(still) == {"head_breathing": False}


def test_a_command_changes_what_is_wanted_and_other_verbs_do_not() -> None:
    settings = wanted()
    assert settings.differing({"volume": 0.7, "posture": "Stand"}) == {}
    settings.note("volume", {"level": 0.4})
    settings.note("sound", {"volume": 1.0})
    settings.note("posture", {"name": "StandInit"})
    assert settings.differing({"volume": 0.7, "posture": "Stand"}) == {"volume": 0.4}


def test_eyes_that_blink_are_not_called_different() -> None:
    settings = wanted()
    settings.note("eyes", {"color": "green"})
    assert settings.differing({"eyes": "#000000"}) == {}
    assert settings.differing({"eyes": "#01fe00"}) == {}
    assert settings.differing({"eyes": "#ff0000"}) == {}
    assert settings.differing({"eyes": "#ff0000"}) == {"eyes": "#00ff00"}


def test_life_wakes_the_robot_and_puts_it_to_rest_so_torque_is_not_wanted_any_more() -> None:
    settings = wanted()
    settings.note("torque", {"on": True})
    assert settings.differing({"awake": False}) == {"awake": True}
    settings.note("autonomy", {"state": "disabled"})
    assert settings.differing({"awake": False, "state": "disabled"}) == {}


@pytest.mark.parametrize(
    ("values", "used", "says"),
    [
        ({"state": "solitary"}, (), "moves and talks by itself"),
        ({"state": "safeguard"}, (), "may not obey"),
        ({"state": "disabled", "awake": False}, (), "nothing moves until the robot is woken up"),
        ({"awareness": True}, ("nudge",), "awareness turns the head away"),
        ({"body_breathing": True}, ("gaze",), "the head breathes"),
        ({"arms_breathing": True}, ("play",), "the arms breathe"),
        ({"speaking_movement": True}, ("say",), "speaking movement"),
        ({"blinking": True}, ("eyes",), "blinking darkens"),
        ({"tangential": 0.05}, (), "tangential security distance is 0.05 m"),
        ({"orthogonal": 0.0}, (), "orthogonal security distance is 0 m"),
    ],
)
def test_what_works_against_the_wizard_is_one_sentence(
    values: dict[str, Json], used: tuple[str, ...], says: str
) -> None:
    found = conflicts(values, used)
    assert len(found) == 1
    assert says in found[0]


@pytest.mark.woz4u("blinking", "autonomous_state")
def test_blinking_that_was_asked_for_needs_an_interactive_robot() -> None:
    has: dict[str, Json] = {"state": "disabled", "awake": True, "blinking": True}
    (found,) = conflicts(has, ("eyes",), {"blinking": True})
    assert "blinks only while autonomous life is interactive, not disabled" in found
    assert conflicts(has, (), {}) == [], "the robot switches it on by itself as well"
    assert conflicts({**has, "blinking": False}, (), {"blinking": True}) == []
    alive = conflicts({**has, "state": "interactive"}, (), {"blinking": True})
    assert not any("blinks" in text for text in alive)


def test_a_robot_that_only_obeys_has_no_conflicts() -> None:
    calm: dict[str, Json] = {
        **{"state": "disabled", "awake": True, "awareness": False, "blinking": False},
        **{"speaking_movement": False, "arms_breathing": False, "head_breathing": False},
        **{"tangential": 0.1, "orthogonal": 0.4},
    }
    assert conflicts(calm, ("gaze", "nudge", "play", "pose", "say", "eyes")) == []
    assert conflicts({}, ("gaze", "play", "say", "eyes")) == []


def test_a_life_of_its_own_that_was_asked_for_surprises_nobody() -> None:
    alive: dict[str, Json] = {"state": "solitary", "awake": True}
    assert conflicts(alive, ()) != []
    assert conflicts(alive, (), {"state": "interactive"}) != []
    assert conflicts(alive, (), {"state": "solitary"}) == []
