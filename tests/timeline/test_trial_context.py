"""Whose time it is: participant, condition, trial and break at each moment."""

from __future__ import annotations

from typing import TypeVar

from tests.timeline.random_sessions import SECOND, start, timed
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import (
    BreakEpisode,
    EngagementEpisode,
    Episode,
    MomentEpisode,
    TrialEpisode,
    UtteranceEpisode,
)
from woz_tui.timeline.timeline import timeline_of
from woz_tui.timeline.trial_context import ContextSpan

E = TypeVar("E", bound=Episode)
ASSIGNED = m.ConditionsAssigned(participant="P01", order=["warm", "cold"], method="hand")


def of(messages: list[m.Message], kind: type[E]) -> list[E]:
    return timeline_of(messages).of(kind)


def notes(messages: list[m.Message]) -> dict[str, tuple[str, str, int | None, bool]]:
    """Text of each note -> its context."""
    return {
        each.message.text: (
            each.context.participant,
            each.context.condition,
            each.context.trial,
            each.context.in_break,
        )
        for each in of(messages, MomentEpisode)
        if isinstance(each.message, m.Note)
    }


def pieces(parts: tuple[ContextSpan, ...]) -> list[tuple[float, str, int | None]]:
    """Seconds, condition, trial."""
    return [
        ((part.end - part.begin) / SECOND, part.context.condition, part.context.trial)
        for part in parts
    ]


def test_an_engagement_over_two_conditions_is_one_with_two_parts() -> None:
    """95 s: it begins in `neutral`, covers all of `empathic` and ends in `funny`."""
    timeline = timeline_of(
        timed(
            (0, start(condition="neutral")),
            (0, m.EngagementAdopted(settings={"start": "run"})),
            (1, m.TrialStarted(trial=1, condition="neutral")),
            (10, engagement_changed("Wait", "EngagedWithKnown", visitor="V01")),
            (20, m.TrialEnded(trial=1, outcome="done")),
            (20, m.TrialStarted(trial=2, condition="empathic")),
            (60, engagement_changed("EngagedWithKnown", "UserSpeaks")),
            (80, m.TrialEnded(trial=2, outcome="done")),
            (80, m.TrialStarted(trial=3, condition="funny")),
            (105, engagement_changed("UserSpeaks", "PersonDetected", outcome="error")),
            (120, m.SessionEnd(reason="wizard")),
        )
    )
    [engaged] = timeline.of(EngagementEpisode)
    assert pieces(timeline.parts(engaged)) == [
        (10, "neutral", 1), (60, "empathic", 2), (25, "funny", 3),
    ]  # fmt: skip
    assert (engaged.duration, engaged.outcome, engaged.reason) == (95 * SECOND, "left", "error")
    assert engaged.visitor == "V01"
    empathic = sum(s.end - s.begin for s in timeline.spans if s.context.condition == "empathic")
    assert empathic == 60 * SECOND, "all of it"


def engagement_changed(
    was: str, now: str, outcome: str = "o", visitor: str = ""
) -> m.EngagementChanged:
    return m.EngagementChanged(
        was=was, now=now, outcome=outcome, why="", verdicts={}, visitor=visitor
    )


def test_a_break_belongs_to_no_trial_also_inside_one() -> None:
    messages = timed(
        (0, start()),
        (1, m.SessionChanged(trial=1)),
        (1, ASSIGNED),
        (2, m.Note(text="before")),
        (3, m.TrialStarted(trial=1)),
        (4, m.Note(text="in it")),
        (5, m.BreakStarted()),
        (6, m.Note(text="break")),
        (7, m.BreakEnded()),
        (8, m.Note(text="on")),
        (9, m.TrialEnded(trial=1, outcome="done")),
        (10, m.Note(text="after")),
    )
    assert {text: (trial, pause) for text, (_, _, trial, pause) in notes(messages).items()} == {
        "before": (None, False), "in it": (1, False), "break": (None, True),
        "on": (1, False), "after": (None, False),
    }  # fmt: skip
    timeline = timeline_of(messages)
    [trial] = timeline.of(TrialEpisode)
    assert pieces(timeline.parts(trial)) == [(2, "warm", 1), (2, "warm", None), (2, "warm", 1)]
    [pause] = of(messages, BreakEpisode)
    assert (pause.duration, pause.outcome) == (2 * SECOND, "done")


def test_a_trial_that_ends_or_begins_ends_a_break() -> None:
    messages = timed(
        (0, start()),
        (1, m.TrialStarted(trial=1)),
        (2, m.BreakStarted()),
        (3, m.TrialEnded(trial=1, outcome="aborted")),
        (4, m.BreakStarted()),
        (6, m.TrialStarted(trial=1)),
        (7, m.Note(text="x")),
    )
    assert [(each.duration, each.outcome, each.cut) for each in of(messages, BreakEpisode)] == [
        (SECOND, "open", True), (2 * SECOND, "open", True),
    ]  # fmt: skip
    assert notes(messages)["x"] == ("P01", "warm", 1, False)


def test_a_number_that_is_set_holds_only_where_no_trials_are_begun() -> None:
    by_hand = timed((0, start()), (1, m.SessionChanged(trial=3)), (2, m.Note(text="x")))
    assert notes(by_hand)["x"] == ("P01", "warm", 3, False)
    begun = timed(
        (0, start()), (1, m.SessionChanged(trial=3)), (1, ASSIGNED), (2, m.Note(text="x"))
    )
    assert notes(begun)["x"] == ("P01", "warm", None, False)


def test_trials_of_one_number_are_told_apart() -> None:
    messages = timed(
        (0, start()),
        (1, m.TrialStarted(trial=1)),
        (2, m.TrialEnded(trial=1, outcome="aborted")),
        (3, m.TrialStarted(trial=1)),
        (4, m.TrialEnded(trial=1, outcome="done", text="well")),
    )
    first, second = of(messages, TrialEpisode)
    assert (first.outcome, second.outcome, second.text) == ("aborted", "done", "well")
    assert first.context.trial == second.context.trial == 1
    assert first.context.run != second.context.run
    timeline = timeline_of(messages)
    assert [timeline.counts(each.context) for each in (first, second)] == [False, True]
    assert timeline.counts(timeline.spans[0].context)


def test_a_trial_that_another_one_follows_is_over() -> None:
    first, second = of(
        timed((0, start()), (1, m.TrialStarted(trial=1)), (3, m.TrialStarted(trial=2))),
        TrialEpisode,
    )
    assert (first.duration, first.outcome, first.cut) == (2 * SECOND, "open", True)
    assert second.cut


def test_what_stands_before_the_first_line_is_the_participants_but_in_no_trial() -> None:
    lost = timed((1, m.Note(text="x")), (2, start("P08", "cold")))
    assert notes(lost)["x"] == ("P08", "cold", None, False)
    more = timed((1, m.Note(text="x")), (2, m.TrialStarted(trial=4, condition="cold")))
    assert notes(more)["x"] == ("", "cold", None, False)


def test_the_order_of_lines_decides_within_one_microsecond() -> None:
    messages = timed(
        (0, start()),
        (1, m.Note(text="last of warm")),
        (1, m.SessionChanged(condition="cold")),
        (1, m.Note(text="first of cold")),
    )
    found = notes(messages)
    assert [found[text][1] for text in ("last of warm", "first of cold")] == ["warm", "cold"]


def test_speech_is_in_the_context_in_which_it_was_spoken() -> None:
    messages = timed(
        (0, start()),
        (10, m.SpeechStarted(driver="mic", segment=1, began=9_700_000)),
        (12, m.SessionChanged(condition="cold")),
        (14, m.SpeechEnded(driver="mic", segment=1, began=9_700_000, ended=13_000_000)),
        (15, m.SpeechText(driver="mic", segment=1, text="what is this?")),
    )
    timeline = timeline_of(messages)
    [spoken] = timeline.of(UtteranceEpisode)
    assert pieces(timeline.parts(spoken)) == [(2.3, "warm", None), (1.0, "cold", None)]
