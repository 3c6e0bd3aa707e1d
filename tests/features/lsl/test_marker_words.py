"""Each deed becomes a short word with its own moment, and a beginning says on what it stands."""

from __future__ import annotations

from collections.abc import Iterable

from msgspec.structs import replace

from woz_tui.features.lsl.marker_words import MarkerWords
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.questionnaires.kinds import QuestionnaireEnded, QuestionnaireStarted
from woz_tui.protocol import messages as m
from woz_tui.protocol.description import ArgumentDescription, Description, VerbDescription

ROBOT = Description(
    verbs=[
        VerbDescription(
            name="play",
            driver="robot",
            summary="",
            arguments=[
                ArgumentDescription(
                    name="move", kind="text", type="text", choices=["wave", "big bow"]
                )
            ],
            lane="body",
            limit_s=30,
        )
    ]
)


def said(messages: Iterable[m.Message], *, texts: bool = False) -> list[tuple[int, str]]:
    """The words of messages that come at 1, 2, 3 ..."""
    words = MarkerWords(ROBOT, texts=texts)
    found = (words.of(replace(each, seq=t, t=t)) for t, each in enumerate(messages, 1))
    return [(word.t, word.text) for each in found for word in each]


def action(*told: m.Message, verb: str = "say", **args: m.Json) -> list[m.Message]:
    """An action with one command, and what is told of it."""
    return [
        m.ActionRequested(run="a1", action="Say hello", source="key"),
        m.Command(command="c1", run="a1", verb=verb, args=args, driver="robot", source="key"),
        m.Dispatched(command="c1", driver="robot", latency_us=5),
        *told,
    ]


DONE = m.Done(command="c1", sent={}, latency_us=5, duration_us=9, evidence="measured")
END = m.ActionDone(run="a1", action="Say hello", evidence="measured")


def test_what_the_robot_told_is_its_beginning() -> None:
    mark = m.CommandMark(command="c1", sort="word", text="Hello")
    assert said(action(mark, mark, DONE, END, text="Hello P07")) == [
        (1, "action/Say-hello/asked"),
        (3, "say/sent"),
        (4, "say/begin/reported"),
        (4, "action/Say-hello/begin/reported"),
        (6, "say/end/measured"),
        (7, "action/Say-hello/end/measured"),
    ]


def test_where_nothing_is_told_it_began_when_it_was_sent() -> None:
    assert said(action(DONE, END))[2:4] == [
        (3, "say/begin/timed"),
        (3, "action/Say-hello/begin/timed"),
    ]


def test_what_was_refused_has_not_begun() -> None:
    refused = [
        m.Command(command="c1", verb="say", args={}, driver="robot", source="key"),
        m.Refused(command="c1", code="stopped", reason="the stop is pressed"),
    ]
    assert said(refused) == [(2, "say/refused")]


def test_a_stroke_and_an_arrival_have_words_also_behind_the_end() -> None:
    stroke = m.CommandMark(command="c1", sort="stroke")
    arrived = m.MotionArrived(command="c1", evidence="measured")
    found = said(action(stroke, DONE, arrived, verb="play", move="big bow"))
    assert (3, "play/big-bow/sent") in found
    assert found[2:] == [
        *((4, "play/big-bow/begin/reported"), (4, "action/Say-hello/begin/reported")),
        *((4, "play/big-bow/stroke"), (5, "play/big-bow/end/measured")),
        (6, "play/big-bow/arrived/measured"),
    ]


def test_a_moment_is_that_of_the_event_not_of_its_line() -> None:
    lines = [
        m.Note(text="x"),
        m.SpeechStarted(driver="ears", segment=1, began=1),
        m.SpeechEnded(driver="ears", segment=1, began=1, ended=2),
        m.Marker(text="onset", at=3, source="program"),
        m.StopPressed(source="key", pressed=4),
    ]
    assert said(lines) == [
        *((1, "visitor/speech/begin"), (2, "visitor/speech/end")),
        *((3, "mark"), (4, "stop/pressed")),
    ]


def test_the_study_has_words() -> None:
    lines = [
        m.TrialStarted(trial=2, condition="warm"),
        PhaseChanged(phase="Opening talk"),
        QuestionnaireStarted(questionnaire="robot/ux", title="", items=[]),
        QuestionnaireEnded(questionnaire="robot/ux", reason="declined", answered=0),
        m.TrialEnded(trial=2, outcome="aborted", text="the head fell asleep"),
        m.SessionEnd(reason="wizard"),
    ]
    assert [word for _, word in said(lines)] == [
        *("trial/2/begin", "phase/Opening-talk", "questionnaire/robot-ux/begin"),
        *("questionnaire/robot-ux/declined", "trial/2/aborted", "session/end"),
    ]


def test_a_marker_says_its_text_where_texts_are_shared() -> None:
    assert said([m.Marker(text="smile")]) == [(1, "mark")]
    assert said([m.Marker(text="smile")], texts=True) == [(1, "mark/smile")]


def test_what_came_over_a_stream_does_not_go_out_again() -> None:
    assert said([m.Marker(text="fixation", source="lsl")]) == []


def test_knobs_on_their_way_have_no_words() -> None:
    moved = m.Command(command="c", verb="control", args={}, driver="robot", source="midi")
    assert said([moved, m.Dispatched(command="c", latency_us=1)]) == []
