"""The robot's own voice is no visitor's in any figure, also in logs from before it was marked."""

from __future__ import annotations

import msgspec
import pytest

from tests.analysis.example_sessions import figures_of, timeline_drawing
from tests.timeline.random_sessions import SECOND, plan, start, timed
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import UtteranceEpisode
from woz_tui.timeline.timeline import timeline_of

SENTENCE = "The whales are upstairs on the left"
#: Only a microphone has this one verb; a robot that finds speech by itself has others.
MICROPHONE = {"mic": ["listen_room"]}


def heard(
    *,
    own: bool | None = None,
    ended: float = 6.1,
    text: str = "",
    words: list[m.SpokenWord] | None = None,
    verbs: dict[str, list[str]] | None = None,
) -> list[m.Message]:
    """The robot speaks from 2 s to 5 s, and a microphone hears it; nobody else is there."""
    began, last = 1_800_000, round(ended * SECOND)
    said = m.Command(command="c", verb="say", args={"text": SENTENCE}, source="key")
    over = m.Done(command="c", sent={}, latency_us=0, duration_us=3_000_000)
    course: list[tuple[float, m.Message]] = [
        (0, start()),
        (0.1, msgspec.structs.replace(plan(), verbs=verbs or MICROPHONE)),
        (2, said),
        (2, m.Dispatched(command="c", latency_us=0)),
        (2.3, m.SpeechStarted(driver="mic", segment=1, began=began, own=own)),
        (5, over),
        (ended, m.SpeechEnded(driver="mic", segment=1, began=began, ended=last, own=own)),
    ]
    if text:
        spoken = m.SpeechText(driver="mic", segment=1, text=text, words=words or [])
        course.append((ended + 1, spoken))
    return timed(*course, (30, m.SessionEnd(reason="enough")))


def figures(messages: list[m.Message]) -> tuple[int, int, float]:
    """Cues, stretches of a visitor's speech, and their seconds."""
    found = figures_of(messages).whole
    speech = found.reactions.get("speech")
    return speech.cues if speech else 0, found.utterances, found.speech.total / SECOND


def test_what_is_marked_as_the_robots_is_counted_nowhere() -> None:
    assert figures(heard(own=True)) == (0, 0, 0.0)
    assert figures(heard(own=False)) == (1, 1, 4.3)
    lanes = [lane.name for lane in timeline_drawing(heard(own=True)).lanes]
    assert "visitor speaks" not in lanes


def test_an_older_log_is_counted_by_the_same_rule() -> None:
    assert figures(heard()) == (0, 0, 0.0)
    assert figures(heard(verbs={"mic": ["say", "listen_room"]})) == (1, 1, 4.3)


def test_in_an_older_log_speech_that_goes_on_is_a_visitors_from_there() -> None:
    """8.5 s: longer than 0.6 s and the silence that ends speech after the robot's 5 s."""
    assert figures(heard(ended=8.5)) == (1, 1, 3.5)


@pytest.mark.parametrize(
    ("text", "counted"), [("the whales are upstairs", 0), ("excuse me where is the exit", 1)]
)
def test_in_an_older_log_the_words_tell_whose_they_are(text: str, counted: int) -> None:
    assert figures(heard(text=text))[:2] == (counted, counted)
    (spoken,) = timeline_of(heard(text=text)).of(UtteranceEpisode)
    assert (spoken.own, spoken.overlap) == (not counted, bool(counted))
    assert figures_of(heard(text=text)).whole.overlaps == counted


def test_words_with_times_say_when_the_visitor_spoke() -> None:
    texts = ["the", "whales", "excuse", "me", "hello"]
    words = [
        m.SpokenWord(text=text, began=3_000_000 + n * 200_000, ended=3_200_000 + n * 200_000)
        for n, text in enumerate(texts)
    ]
    messages = heard(text=" ".join(texts), words=words)
    cues, utterances, seconds = figures(messages)
    assert (cues, utterances) == (1, 1)
    assert seconds == pytest.approx(0.6)
