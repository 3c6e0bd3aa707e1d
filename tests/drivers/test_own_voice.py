"""Whose voice it is: when the robot spoke, and whose words were understood."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from woz_tui.drivers.own_voice import RobotSpeech, is_robots, visitors_words
from woz_tui.protocol import messages as m

SECOND = 1_000_000
SENTENCE = "This bowl is Roman glass, and it was found in a well."


def speech(*messages: m.Message) -> RobotSpeech:
    found = RobotSpeech()
    for message in messages:
        found = found.after(message)
    return found


def sentence(begins: float, ends: float | None, text: str = SENTENCE) -> Iterable[m.Message]:
    command, t = f"c{begins}", round(begins * SECOND)
    yield m.Command(command=command, verb="say", args={"text": text}, source="key", t=t - 1000)
    yield m.Dispatched(command=command, driver="pepper", latency_us=1000, t=t)
    if ends is not None:
        end = round(ends * SECOND)
        yield m.Done(command=command, sent={}, latency_us=1000, duration_us=1, t=end)


def test_words_do_not_tell_while_the_robot_makes_sounds_without_any() -> None:
    assert is_robots("ba lu do", "")
    assert not is_robots("what a noise", "Good morning everybody")


def test_the_robot_is_heard_while_it_speaks_and_half_a_second_longer() -> None:
    said = speech(*sentence(2, 5))
    heard = [said.heard_at(round(t * SECOND)) for t in (1.9, 2, 4.9, 5.5, 5.6)]
    assert heard == [False, True, True, True, False]
    goes_on = speech(*sentence(2, None))
    assert goes_on.heard_at(60 * SECOND), "it has not ended"
    assert not goes_on.heard_at(600 * SECOND), "its end was lost with a piece of the log"


def test_what_never_begins_and_what_is_no_speech_is_not_heard() -> None:
    waits, *_ = sentence(1, None)
    wave = m.Command(command="w", verb="wave", args={}, source="key", t=0)
    moves = m.Dispatched(command="w", driver="pepper", latency_us=1, t=0)
    gone = m.Superseded(command="c1", by="c2", t=SECOND)
    assert not speech(waits, wave, moves).heard_at(2 * SECOND)
    assert not speech(waits, gone).heard_at(2 * SECOND)


def test_since_when_it_is_silent() -> None:
    said = speech(*sentence(1, 2), *sentence(3, 4), *sentence(6, None))
    found = [said.silent_since(round(t * SECOND)) for t in (0.5, 1.5, 2.5, 3.5, 5, 7)]
    assert found == [None, None, 2 * SECOND, None, 4 * SECOND, None]


@pytest.mark.parametrize(
    ("heard", "robots"),
    [
        (SENTENCE, True),
        ("this bowl is rome in glass and it was found", True),
        ("", True),
        ("wait a moment how old is it", False),
        ("well a in found was it", False),  # its words, but not in its order
        ("stop", False),
    ],
)
def test_six_words_in_ten_that_come_in_its_order_are_the_robots(heard: str, robots: bool) -> None:
    assert is_robots(heard, "\\rspd=80\\" + SENTENCE) is robots


def test_words_that_are_not_the_robots() -> None:
    words = [
        m.SpokenWord(text=text, began=n, ended=n + 1)
        for n, text in enumerate(["this", "bowl", "Excuse", "me,", "Roman"])
    ]
    assert [word.text for word in visitors_words(words, SENTENCE)] == ["Excuse", "me,"]
