"""Lines become events: requests find their ends, changes become episodes, nothing gets lost."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from tests.export.logs import Timed, courses, session_of, start, visit
from woz_tui.export.event_model import ExportEvent, ExportSession
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered, QuestionnaireEnded
from woz_tui.protocol import messages as m


def only(session: ExportSession, kind: str) -> ExportEvent:
    events = [event for event in session.events if event.kind == kind]
    assert len(events) == 1, [event.kind for event in session.events]
    return events[0]


def test_an_action_lasts_from_its_request_to_its_end(tmp_path: Path) -> None:
    session = session_of(tmp_path, visit())
    hello, nod, dance = (event for event in session.events if event.kind == "action")
    assert (hello.begin, hello.end, hello.outcome) == (2_000_000, 3_500_000, "done")
    assert (hello.panel, hello.key, hello.source, hello.mistake) == ("Speech", "h", "key", True)
    assert hello.latency == 11_000, "from the key to the driver's start"
    assert (nod.outcome, nod.reason, nod.duration) == ("refused", "locked", 0)
    assert (dance.outcome, dance.end) == ("open", session.duration)


def test_a_command_has_what_was_asked_and_what_was_sent(tmp_path: Path) -> None:
    command = only(session_of(tmp_path, visit()), "command")
    assert (command.begin, command.acted, command.end) == (2_001_000, 2_011_000, 3_500_000)
    assert (command.latency, command.driver) == (10_000, "voice")
    assert command.text.startswith("Hello")
    assert command.details["args"] == command.details["sent"] == {"text": command.text}


def command(
    name: str, driver: str, verb: str = "say", run: str = "", source: str = "key"
) -> m.Command:
    return m.Command(command=name, run=run, verb=verb, driver=driver, args={}, source=source)


def test_an_action_is_as_late_as_its_first_command_to_a_driver(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.ActionRequested(run="r1", action="Begin", source="key")),
        (1, command("c1", "session", run="r1")),
        (1.1, m.Dispatched(command="c1", driver="session", latency_us=100_000)),
        (1.2, m.Done(command="c1", sent={}, latency_us=100_000, duration_us=0)),
        (2, command("c2", "voice", run="r1")),
        (2.5, m.Dispatched(command="c2", driver="voice", latency_us=500_000)),
        (3, m.ActionDone(run="r1", action="Begin")),
    ]
    session = session_of(tmp_path, course)
    assert only(session, "action").latency == 1_500_000
    latencies = [event.latency for event in session.events if event.kind == "command"]
    assert latencies == [100_000, 500_000]


def test_a_knob_on_its_way_is_a_command_like_others(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, command("c1", "robot", verb="control", source="midi")),
        (1.1, m.Dispatched(command="c1", driver="robot", latency_us=100_000)),
        (2, m.Done(command="c1", sent={}, latency_us=100_000, duration_us=900_000)),
    ]
    event = only(session_of(tmp_path, course), "command")
    assert (event.end, event.outcome, event.acted) == (2_000_000, "done", 1_100_000)


def test_speech_stands_where_it_was_spoken(tmp_path: Path) -> None:
    speech = only(session_of(tmp_path, visit()), "speech")
    assert (speech.begin, speech.end, speech.text) == (3_550_000, 4_900_000, "What is this?")


def test_numbers_of_speech_that_begin_anew_are_other_sentences(tmp_path: Path) -> None:
    course: list[Timed] = [(0, start())]
    for begin in (1, 5):
        end = begin + 1
        began, ended = begin * 1_000_000, end * 1_000_000
        course += [
            (begin, m.SpeechStarted(driver="ears", segment=1, began=began)),
            (end, m.SpeechEnded(driver="ears", segment=1, began=began, ended=ended)),
            (end, m.SpeechText(driver="ears", segment=1, text=f"from {begin}")),
        ]
    spoken = [each for each in session_of(tmp_path, course).events if each.kind == "speech"]
    assert [(each.begin, each.end, each.text) for each in spoken] == [
        (1_000_000, 2_000_000, "from 1"),
        (5_000_000, 6_000_000, "from 5"),
    ]


def test_a_sentence_whose_driver_is_lost_is_lost_there(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.SpeechStarted(driver="ears", segment=1, began=1_000_000)),
        (2, m.DriverLost(driver="ears")),
        (3, m.Note(text="over")),
    ]
    speech = only(session_of(tmp_path, course), "speech")
    assert (speech.end, speech.outcome) == (2_000_000, "lost")


def test_states_of_engagement_follow_each_other(tmp_path: Path) -> None:
    session = session_of(tmp_path, visit())
    idle, engaged = (event for event in session.events if event.kind == "engagement")
    assert (idle.label, idle.begin, idle.end) == ("Idle", 0, 1_000_000)
    assert idle.details["left_by"] == engaged.outcome == "came"
    assert (engaged.label, engaged.end) == ("Engaged", session.duration)


def test_a_state_that_crosses_trials_is_one_event_and_its_times_add_up_by_trial(
    tmp_path: Path,
) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, engagement_changed("Wait", "Engaged")),
        (2, m.TrialStarted(trial=1, condition="cold")),
        (5, m.TrialEnded(trial=1, outcome="done")),
        (6, m.Note(text="over")),
    ]
    session = session_of(tmp_path, course)
    events = [event for event in session.events if event.label == "Engaged"]
    assert [(each.begin, each.end, each.trial) for each in events] == [(1_000_000, 6_000_000, None)]
    rows = [each for each in session.figures.stays if each.state == "Engaged"]
    assert [(row.condition, row.trial, row.duration, row.changed) for row in rows] == [
        ("warm", -1, 1_000_000, True),
        ("cold", 1, 3_000_000, False),
        ("cold", -1, 1_000_000, False),
    ]


def test_a_model_begins_where_it_comes_and_is_in_no_state_while_it_is_off(tmp_path: Path) -> None:
    sent: dict[str, m.Json] = {"run": "off"}
    off = m.Done(command="c1", driver="engagement", sent=sent, latency_us=0, duration_us=0)
    request = m.Command(command="c1", verb="run", driver="engagement", args=sent, source="key")
    course: list[Timed] = [
        (0, start()),
        (2, m.EngagementAdopted(settings={"model": "x"})),
        (3, engagement_changed("Wait", "Engaged")),
        (4, request),
        (4, off),
        (5, engagement_changed("Engaged", "Wait")),
        (6, m.Note(text="over")),
    ]
    session = session_of(tmp_path, course)
    states = [event for event in session.events if event.kind == "engagement"]
    assert [(each.label, each.begin, each.end, each.outcome) for each in states] == [
        ("Wait", 2_000_000, 3_000_000, ""),
        ("Engaged", 3_000_000, 4_000_000, "went"),
    ]
    assert "left_by" not in states[1].details
    assert only(session, "engagement.changed").begin == 5_000_000, "the line is there nonetheless"


def engagement_changed(was: str, now: str) -> m.EngagementChanged:
    return m.EngagementChanged(was=was, now=now, outcome="went", why="", verdicts={})


def test_events_know_their_trial_and_condition(tmp_path: Path) -> None:
    session = session_of(tmp_path, visit())
    trial = only(session, "trial")
    assert (trial.label, trial.outcome, trial.duration) == ("1", "done", 8_000_000)
    assert [(e.trial, e.condition) for e in session.events if e.kind == "note"] == [(1, "cold")]
    assert only(session, "questionnaire").trial is None, "after the trial's end"


def test_a_break_inside_a_trial_and_the_next_number_belong_to_no_trial(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.SessionChanged(trial=1)),
        (1, m.ConditionsAssigned(participant="P07", order=["warm"], method="hand")),
        (2, m.Note(text="before")),
        (3, m.TrialStarted(trial=1)),
        (4, m.Note(text="in it")),
        (5, m.BreakStarted()),
        (6, m.Note(text="break")),
        (7, m.BreakEnded()),
        (8, m.Note(text="on")),
        (9, m.TrialEnded(trial=1, outcome="done")),
        (10, m.Note(text="after")),
        (11, m.TrialStarted(trial=2)),
        (12, m.BreakStarted()),
        (13, m.TrialEnded(trial=2, outcome="aborted")),
        (14, m.BreakEnded()),
        (15, m.Note(text="late")),
    ]
    events = session_of(tmp_path, course).events
    assert {event.text: event.trial for event in events if event.kind == "note"} == {
        "before": None, "in it": 1, "break": None, "on": 1, "after": None, "late": None,
    }  # fmt: skip
    assert [event.trial for event in events if event.kind == "trial"] == [1, 2]
    assert [event.trial for event in events if event.kind == "break"] == [None, None]


def test_a_number_set_by_hand_holds_in_a_session_without_trials(tmp_path: Path) -> None:
    course: list[Timed] = [(0, start()), (1, m.SessionChanged(trial=3)), (2, m.Note(text="x"))]
    assert only(session_of(tmp_path, course), "note").trial == 3


def test_a_break_belongs_to_no_trial_also_where_numbers_are_set_by_hand(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.SessionChanged(trial=3)),
        (2, m.BreakStarted()),
        (3, m.Note(text="in it")),
        (4, m.BreakEnded()),
        (5, m.Note(text="after")),
    ]
    events = session_of(tmp_path, course).events
    assert [event.trial for event in events if event.kind in ("break", "note")] == [None, None, 3]


def test_the_last_answer_counts_and_has_its_scale(tmp_path: Path) -> None:
    session = session_of(tmp_path, visit())
    friendly, other = asked_in(session.figures).answers
    assert (friendly.value, friendly.low, friendly.high, friendly.answered_us) == (
        6.0,
        1,
        7,
        500_000,
    )
    assert (other.item, other.text, other.value) == ("else", "-it blinked", None)


def test_a_stop_lasts_until_its_release(tmp_path: Path) -> None:
    stop = only(session_of(tmp_path, visit()), "stop")
    assert (stop.label, stop.source, stop.duration) == ("all", "key", 1_000_000)
    assert stop.details["confirmed"] == ["voice"]


def test_a_stop_of_driving_alone_lasts_until_it_is_confirmed(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.StopPressed(source="key", scope="drive")),
        (2, m.StopConfirmed(confirmed=["base"], missing=[], elapsed_us=1_000_000)),
        (3, m.StopPressed(source="key")),
        (4, m.StopPressed(source="midi")),
        (5, m.StopReleased(source="key")),
    ]
    session = session_of(tmp_path, course)
    stops = [event for event in session.events if event.kind == "stop"]
    assert [(each.label, each.begin, each.end, each.outcome) for each in stops] == [
        ("drive", 1_000_000, 2_000_000, "done"),
        ("all", 3_000_000, 5_000_000, "released"),
    ]
    again = only(session, "stop.pressed")
    assert (again.begin, again.end, again.source) == (4_000_000, None, "midi")


def test_a_questionnaire_whose_beginning_is_lost_begins_with_its_first_answer(
    tmp_path: Path,
) -> None:
    answer = QuestionnaireAnswered(questionnaire="q", item="a", question="?", value=3.0)
    end = QuestionnaireEnded(questionnaire="q", reason="done", answered=1)
    session = session_of(tmp_path, [(0, start()), (1, answer), (2, end)])
    event = only(session, "questionnaire")
    assert (event.label, event.begin, event.end, event.outcome) == (
        *("q", 1_000_000, 2_000_000, "done"),
    )
    assert [(each.item, each.round, each.value) for each in asked_in(session.figures).answers] == [
        ("a", 1, 3.0)
    ]


def test_what_came_before_the_first_code_belongs_to_nobody(tmp_path: Path) -> None:
    session = session_of(
        tmp_path,
        [
            (0, start(participant="")),
            (1, m.Note(text="early")),
            (2, m.SessionChanged(participant="P08")),
            (3, m.Note(text="first")),
            (4, m.SessionChanged(participant="P09")),
            (5, m.Note(text="second")),
        ],
    )
    notes = [(event.text, event.participant) for event in session.events if event.kind == "note"]
    assert notes == [("early", ""), ("first", "P08"), ("second", "P09")]
    assert session.participants == ["P08", "P09"]


def test_nothing_counts_in_a_re_run(tmp_path: Path) -> None:
    line = m.RerunStarted(original="x", original_session="S01")
    course: list[Timed] = [(0, start("")), (1, line), (20, m.Note(text="late"))]
    assert {event.counted for event in session_of(tmp_path, course).events} == {False}


@pytest.mark.parametrize(
    ("message", "kind"),
    [
        (m.ActionDone(run="r9", action="Hello"), "action.done"),
        (m.Failed(command="c9", reason="hot"), "command.failed"),
        (m.TrialEnded(trial=3, outcome="done"), "trial.ended"),
        (m.StopReleased(source="key"), "stop.released"),
        (QuestionnaireEnded(questionnaire="q", reason="done", answered=1), "questionnaire.ended"),
    ],
)
def test_an_end_without_a_beginning_is_a_moment(
    tmp_path: Path, message: m.Message, kind: str
) -> None:
    event = only(session_of(tmp_path, [(0, start()), (1, message)]), kind)
    assert (event.begin, event.end) == (1_000_000, None)


def test_a_run_that_begins_twice_is_two_events(tmp_path: Path) -> None:
    request = m.ActionRequested(run="r1", action="Nod", source="key")
    session = session_of(tmp_path, [(0, start()), (1, request), (2, request)])
    assert [(e.begin, e.end, e.outcome) for e in session.events] == [
        (1_000_000, 2_000_000, "open"),
        (2_000_000, 2_000_000, "open"),
    ]


def test_a_kind_of_tomorrow_is_kept_with_all_it_says(tmp_path: Path) -> None:
    log = tmp_path / "2026-03-01T10-00-00_P07_S01.jsonl"
    log.write_text('{"seq":0,"t":5,"kind":"robot.dreamt","of":["sheep"],"driver":"head"}\n')
    from woz_tui.export.log_sources import find_sources, read_session  # noqa: PLC0415

    session = read_session(find_sources([log])[0][0])
    event = only(session, "robot.dreamt")
    assert (event.driver, event.details) == ("head", {"of": ["sheep"]})
    assert any("robot.dreamt" in sentence for sentence in session.damage)


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_whatever_happened_events_are_in_order_and_within_the_session(
    tmp_path: Path, course: list[Timed]
) -> None:
    session = session_of(tmp_path, course)
    assert session.events == sorted(session.events, key=lambda event: (event.begin, event.seq))
    for event in session.events:
        assert 0 <= event.begin <= session.duration
        assert event.end is None or event.begin <= event.end <= session.duration
    noted = [message for _, message in course if isinstance(message, m.Note)]
    assert [e.text for e in session.events if e.kind == "note"] == [note.text for note in noted]
    asked = [message for _, message in course if isinstance(message, m.ActionRequested)]
    assert len([event for event in session.events if event.kind == "action"]) == len(asked)
