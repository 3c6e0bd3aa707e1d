"""Who gives the signs of engagement, and a warning where nobody does."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HELLO, errors, panel, warned

_WITHOUT = (
    "no driver gives {}, so engagement never begins; add an action for the wizard, such as"
    " {{key: ..., label: ..., toggle: {}}}"
)


@pytest.mark.parametrize(
    ("sees", "action", "missing", "rest"),
    [
        ("presence, gaze, distance", "{label: A, say: Hi}", [], ""),
        ("presence, gaze", "{label: A, say: Hi}", ["distance"], "presence, gaze"),
        ("distance", "{label: A, say: Hi}", ["presence", "gaze"], "distance"),
        ("", "{label: A, say: Hi}", ["presence", "gaze", "distance"], ""),
        ("presence, distance", "{key: g, label: G, toggle: gaze}", [], ""),
        ("presence, distance", "{label: G, sense: gaze, value: on}", [], ""),
        ("presence", "{label: G, sense: all, value: on}", [], ""),
        ("presence, gaze", "{label: G, sense: all, value: sensor}", ["distance"], "presence, gaze"),
        ("gaze, distance", "{label: G, steps: [{toggle: presence}, {wait: 1}]}", [], ""),
    ],
)
def test_a_sign_that_nobody_gives_is_a_warning_with_a_remedy(
    tmp_path: Path, sees: str, action: str, missing: list[str], rest: str
) -> None:
    expected = []
    if missing:
        text = "engagement.signs: " + _WITHOUT.format(" and ".join(missing), missing[0])
        expected = [text + (f", or leave it out: signs: [{rest}]" if rest else "")]
    assert warned(tmp_path, "{}", HELLO, action, sees=sees) == expected


def test_signs_that_are_not_used_need_nobody(tmp_path: Path) -> None:
    assert not warned(tmp_path, "{signs: [presence]}", sees="presence")


def test_a_robot_that_asks_for_names_needs_a_voice_and_an_ear(tmp_path: Path) -> None:
    asks = "{signs: [gaze], handshake: {by: robot}}"
    path = "engagement.handshake.by: "
    for sees in ("gaze", "gaze, loudness", "gaze, speech, loudness", "gaze, identity"):
        (deaf,) = warned(tmp_path, asks, sees=sees)
        assert deaf.startswith(f"{path}no driver recognises the answer"), sees
        assert "by: wizard" in deaf
    assert not warned(tmp_path, asks, sees="gaze, speech.text")
    head = "title: T\nrobot: {drivers: {eye: {type: camera, sees: [gaze, loudness]}}}\n"
    mute = warned(tmp_path, asks, "{label: A, mark: x}", head=head)
    assert [line.partition(";")[0] for line in mute] == [
        f"{path}the robot cannot ask for a name: no driver offers 'say'"
    ]
    forgets = warned(tmp_path, asks, sees="gaze, identity, speech.text")
    assert forgets == [
        f"{path}returning visitors are not recognised: no driver offers 'learn_face'"
    ]
    faces = "{signs: [gaze], handshake: {by: robot, face_consent: May I?}}"
    assert warned(tmp_path, faces, sees="gaze, speech.text") == [
        "engagement.handshake.face_consent: it is not asked: no driver offers 'learn_face'"
    ]


def test_a_robot_that_looks_to_sounds_needs_ears_and_a_neck(tmp_path: Path) -> None:
    looks = "{signs: [gaze], attention: {look: true}}"
    (found,) = warned(tmp_path, looks, sees="gaze")
    assert found.startswith("engagement.attention.look: the robot does not look to sounds")
    assert "'gaze'" in found and "'direction'" in found
    assert not warned(tmp_path, "{signs: [gaze]}", sees="gaze")


@pytest.mark.parametrize(
    ("attention", "finds"),
    [
        ("mode: Unengaged", False),
        ("mode: Unengaged, look: true", False),
        ("mode: Unengaged, camera: head", False),
        ("mode: Unengaged, look: true, camera: head", True),
        ("mode: SemiEngaged", True),
    ],
)
def test_a_mode_that_cannot_find_anybody_is_a_warning(
    tmp_path: Path, attention: str, finds: bool
) -> None:
    found = warned(tmp_path, f"{{signs: [gaze], attention: {{{attention}}}}}", sees="gaze")
    modes = [line for line in found if line.startswith("engagement.attention.mode")]
    assert (not modes) == finds
    assert all("camera: head" in line for line in modes)


def test_two_robots_with_one_sign_each_need_a_choice(tmp_path: Path) -> None:
    camera = "{drivers: {eye: {type: camera, sees: [gaze, loudness]}, voice: {type: voice}}}"
    head = f"title: T\nrobots: {{left: {camera}, right: {camera}}}\n"
    action = "{label: A, mark: x}"
    assert warned(tmp_path, "{signs: [gaze]}", action, head=head) == [
        "engagement.gaze: left.gaze and right.gaze give gaze; choose one:"
        " gaze: {sensor: left.gaze}",
        "engagement.sound: left.loudness and right.loudness give loudness; choose one:"
        " sound: {sensor: left.loudness}",
    ]
    chosen = "{signs: [gaze], gaze: {sensor: right.gaze}, sound: {sensor: left.loudness}}"
    assert not warned(tmp_path, chosen, action, head=head)


def test_a_broken_robot_file_does_not_make_sensors_unknown(tmp_path: Path) -> None:
    head = "title: T\nrobot: {drivers: {eye: {type: camra}}}\n"
    text = panel(HELLO, head=f"{head}engagement: {{gaze: {{sensor: gaze}}}}\n")
    assert [line for line in errors(tmp_path, text) if "sensor" in line] == []
