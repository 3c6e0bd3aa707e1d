"""Locked sections: their panels are there, locked, and cover what the section could send."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.woz4u.reading import messages, panel, read_experiment, titles

#: Lock -> the panel's title, verbs that a lock of this section has to stop.
SECTIONS = {
    "lock_anim_speech_section": ("Speech", {"say", "read"}),
    "lock_gesture_section": ("Gestures", {"play"}),
    "lock_tablet_section": ("Tablet", {"screen", "tablet"}),
    "lock_audio_section": ("Sounds", {"sound"}),
    "lock_color_section": ("Eyes", {"eyes", "eyes_brightness"}),
    "lock_eye_anim_section": ("Eye animations", {"eyes_animation"}),
    "lock_movement_control_section": (
        "Movement",
        {"gaze", "nudge", "hip", "drive", "posture", "pose", "home", "torque"},
    ),
    "lock_autonomous_life_section": ("Autonomy", {"autonomy", "collision"}),
    "lock_volume_section": ("Voice", {"volume", "speech_speed", "speech_pitch"}),
}
ITEMS = """animated_speech: [{title: A, string: a}]
gestures: [{title: B, gesture: a/b}]
tablet_items: [{title: C, file_name: "http://a.example/"}]
audio_files: [{title: D, location: /d.wav}]
colors: [{title: E, red: 1, green: 1, blue: 1}]
rasta_anim: {duration: 1}
volume: 1
"""


@pytest.mark.woz4u(
    "lock_anim_speech_section",
    "lock_gesture_section",
    "lock_tablet_section",
    "lock_audio_section",
    "lock_color_section",
    "lock_eye_anim_section",
    "lock_movement_control_section",
    "lock_autonomous_life_section",
    "lock_volume_section",
)
@pytest.mark.parametrize("lock", SECTIONS)
@pytest.mark.parametrize("full", [False, True])
def test_a_locked_section(tmp_path: Path, lock: str, full: bool) -> None:
    title, verbs = SECTIONS[lock]
    items = ITEMS if full else ""
    experiment = read_experiment(tmp_path, f'{lock}: "true"\n{items}')
    locked = panel(experiment, title)
    assert locked.locked
    assert set(locked.covers) == verbs
    others = [shown for shown in experiment.panels if shown.title != title]
    assert not any(shown.locked for shown in others)
    assert bool(locked.actions) is (full or title in ("Movement", "Autonomy"))
    assert messages(tmp_path, f'{lock}: "true"\n{items}') == []


def test_every_action_is_covered_by_its_own_panel_alone(tmp_path: Path) -> None:
    """So a lock stops what stands in its section, and nothing of another one."""
    experiment = read_experiment(tmp_path, ITEMS)
    assert titles(experiment) == [title for title, _ in SECTIONS.values()]
    for shown in experiment.panels:
        used = {call.verb for action in shown.actions for call in action.calls}
        assert used
        assert used <= set(shown.covers)


@pytest.mark.parametrize(
    ("value", "locked"),
    [
        ('"true"', True),
        ("true", True),
        ('"True"', True),
        ("yes", True),
        ("1", True),
        ('"false"', False),
        ("False", False),
        ("0", False),
        ('""', False),
        ("", False),
    ],
)
@pytest.mark.woz4u("lock_gesture_section")
def test_spellings_of_a_lock(tmp_path: Path, value: str, locked: bool) -> None:
    text = f"lock_gesture_section: {value}\n{ITEMS}"
    assert panel(read_experiment(tmp_path, text), "Gestures").locked is locked
    assert messages(tmp_path, text) == []


@pytest.mark.parametrize("value", ["ture", "[true]", "{a: b}"])
def test_a_lock_that_cannot_be_read_is_shut(tmp_path: Path, value: str) -> None:
    text = f"lock_gesture_section: {value}\n{ITEMS}"
    assert panel(read_experiment(tmp_path, text), "Gestures").locked
    (message,) = messages(tmp_path, text)
    assert message.startswith("warning: lock_gesture_section: expected true or false, not ")
    assert message.endswith("; the section is locked to be on the safe side")
