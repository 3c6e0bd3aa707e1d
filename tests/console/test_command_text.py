"""Commands as the list of events and the failures tell them."""

from __future__ import annotations

import pytest

from woz_tui.console.state.command_text import command_words
from woz_tui.protocol import messages as m


@pytest.mark.parametrize(
    ("verb", "args", "told"),
    [
        ("nudge", {"pitch": -8.0}, "head 8° up"),
        ("nudge", {"yaw": 8, "pitch": 2.5}, "head 8° left, head 2.5° down"),
        ("hip", {"pitch": -11.46}, "hip 11.46° back"),
        ("hip", {"roll": -3}, "hip 3° right"),
        ("drive", {"x": 0.2}, "drive 0.2 m forward"),
        ("drive", {"turn": -90.0}, "turn 90° right"),
        ("drive", {"x": 0.0}, "drive x 0"),
        ("drive", {"x": 1, "speed": 0.2}, "drive x 1 speed 0.2"),
        ("torque", {"on": True}, "torque on"),
        ("torque", {"on": False}, "torque off"),
        ("volume", {"level": 0.65}, "volume 0.65"),
        ("volume", {"level": 0}, "volume 0"),
        ("speech_pitch", {"pitch": 1.2}, "speech_pitch 1.2"),
        ("autonomy", {"awareness": False}, "autonomy awareness off"),
        ("autonomy", {"state": "solitary"}, "autonomy solitary"),
        ("play", {"move": "animations/Stand/Gestures/Hey_1"}, "play Hey_1"),
        ("screen", {"file": "pictures/plan.png"}, "screen plan.png"),
        ("screen", {"file": "https://example.org/a.mp4"}, "screen https://example.org/a.mp4"),
        ("pose", {"joints": {"HeadYaw": 3}, "seconds": 2.0}, "pose seconds 2"),
        ("say", {"text": "and/or?"}, "“and/or?”"),
        ("say", {"text": r"^start(a/b) Hello \pau=500\ you"}, "“Hello you”"),
        ("picture", {}, "picture"),
    ],
)
def test_a_command_in_words(verb: str, args: dict[str, m.Json], told: str) -> None:
    assert command_words(m.Command(command="c1", verb=verb, args=args, source="key", t=0)) == told
