"""What of a training somebody sees from whom something is kept."""

from __future__ import annotations

import pytest

from tests.features.training.examples import COURSE, CUES
from woz_tui.features.training.kinds import CueGiven
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session import redactor as redaction
from woz_tui.session.redactor import ParticipantRedactor, PerceptionFilter, Redactor

CUE = CueGiven(cue="q1", sort="question", text="Where am I?", expects=["Map"], window_us=1)


@pytest.mark.parametrize(
    ("perception", "text"),
    [
        (PerceptionFilter(), "Where am I?"),
        (PerceptionFilter(["distance"]), "Where am I?"),
        (PerceptionFilter(["transcript"]), ""),
        (PerceptionFilter([], ["transcript"]), "●"),
    ],
)
def test_the_visitors_words_are_a_transcript(perception: PerceptionFilter, text: str) -> None:
    redactor = Redactor()
    redactor.perception = perception
    seen = redactor.message(CUE)
    assert isinstance(seen, CueGiven)
    assert (seen.text, seen.expects) == (text, ["Map"])


def test_it_tells_nothing_of_the_condition() -> None:
    blind = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}))
    assert blind.blind
    for message in (*CUES, *COURSE):
        assert blind.message(message) == message


def test_a_participant_sees_nothing_of_it() -> None:
    assert not any(map(ParticipantRedactor().message, (*CUES, *COURSE)))


def test_what_cannot_be_redacted_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(message: CueGiven, perception: PerceptionFilter) -> CueGiven:
        raise ZeroDivisionError

    monkeypatch.setattr(redaction, "_redactions", lambda: {CueGiven: fails})
    redactor = Redactor()
    redactor.perception = PerceptionFilter(["transcript"])
    assert redactor.message(CUE) is None
