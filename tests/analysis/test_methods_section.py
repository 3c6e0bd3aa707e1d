"""Sentences for a method section: right in number and grammar, nothing guessed."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import msgspec

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time, study
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.methods_section import by_hand, paragraphs
from woz_tui.analysis.session_reading import read_report
from woz_tui.analysis.study_figures import Studies, StudyFacts
from woz_tui.analysis.text_format import counted, listed, times
from woz_tui.config.about_file import About
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import (
    Questionnaire,
    QuestionnaireItem,
    StudySettings,
    WelcomeSettings,
)


def facts(*sessions: SessionFigures) -> StudyFacts:
    studies = Studies()
    for figures in sessions:
        studies.add(figures)
    return next(iter(studies.found.values()))


def text(*sessions: SessionFigures) -> str:
    return " ".join(
        sentence for each in paragraphs(facts(*sessions)) for sentence in each.sentences
    )


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def test_a_study_in_sentences(tmp_path: Path) -> None:
    sessions = [read_report(path, places=[]).figures for path in study(tmp_path)]
    assert text(*sessions) == (
        "In all, 2 participants took part in 4 sessions of 1.7 min on average (SD 0.0 min). "
        "The condition cold had 2 participants and the condition warm had 2 participants. "
        "The robot was run by woz-tui 0.1.0 with the experiment file guide.yaml. "
        "The robot was controlled by 2 wizards: W1 led 1 session and W2 led 3 sessions. "
        "Training of the wizards was not recorded. "
        "What the wizard could choose from was not recorded. "
        "In all, 5 actions were asked for, all by key. All of them were carried out. "
        "No restriction of the wizard's view was recorded. "
        "Of 5 wizard actions, 0 (0.0 %) were marked as mistakes. "
        "Of 6 cues that needed an answer, the wizard answered 5 within 10 s (83.3 %). "
        "The reaction time was 3 s in the median (95 % quantile 4.8 s, longest 5 s). "
        "One cue was without a reaction time: 1 not answered within the window. "
        "Marked as mistakes were 0 of 2 wizard actions in cold and 0 of 3 wizard actions in warm. "
        "Of cues, 2 of 3 in cold and 3 of 3 in warm were answered in time. "
        "The time from the request of a wizard action to its start in the robot, the "
        "wait behind an earlier act included, was 1.0 ms in the "
        "median (95 % quantile 1.0 ms, longest 1.0 ms), over 5 wizard actions. "
        "No line was lost from the logs."
    )


def test_one_of_each_is_singular() -> None:
    session = ExampleSession().act(1, edited=True)
    session.add(2, m.Mistake(run="a00001", action="Hello"))
    session.add(3, m.StopPressed(source="key"), m.StopReleased(source="key"))
    found = text(session_figures(session.end(60)))
    assert "In all, 1 participant took part in 1 session of 1.0 min." in found
    assert "by 1 wizard (W2), who led 1 session." in found
    assert "In all, 1 action was asked for, by key. It was carried out." in found
    assert "Before being said, 1 prepared sentence was rewritten by the wizard." in found
    assert "Of 1 wizard action, 1 (100.0 %) was marked as a mistake." in found
    assert "The emergency stop was pressed once in 1 session." in found
    assert "No line was lost from the log." in found
    assert not re.search(r"\b1 \w+s (was|were)\b|\b1 were\b", found)


def test_a_robot_that_a_stop_did_not_reach_is_said() -> None:
    session = ExampleSession().act(1)
    for at in (3, 5):
        session.add(at, m.StopPressed(source="key"))
        missing = ["robot"] if at == 3 else ["base", "robot"]
        session.add(
            at, m.StopConfirmed(confirmed=[], missing=missing, unreached=["robot"], elapsed_us=1)
        )
    found = text(session_figures(session.end(60)))
    assert "The emergency stop was pressed twice in 1 session." in found
    assert "It did not reach robot (twice), which was not connected." in found
    assert "base" not in found


def test_a_lost_console_is_no_emergency_stop() -> None:
    session = ExampleSession().act(1).add(3, m.StopPressed(source="console-lost", scope="drive"))
    drive: list[m.Message] = [
        m.StopConfirmed(confirmed=[], missing=["robot"], unreached=["robot"], elapsed_us=1)
    ]
    found = text(session_figures(session.add(3, *drive).end(60)))
    assert "emergency stop" not in found
    assert "did not reach" not in found


def test_what_was_not_recorded_is_said() -> None:
    session = ExampleSession(participant="", condition="", wizard="").end(60)
    found = text(session_figures(session))
    assert found.startswith("There was 1 session of 1.0 min. No participant was recorded in 1")
    assert "The wizard was not recorded." in found
    assert "wizard action" not in found
    assert "reaction time" not in found


def test_what_the_wizard_had_and_saw() -> None:
    panels = [
        PanelView(title="Speech", actions=[ActionView(name=name, label=name) for name in "ab"]),
        PanelView(title="Driving", actions=[ActionView(name="c", label="c")], locked=True),
    ]
    plan = m.SessionPlan(
        title="Guide", panels=panels, script=[], verbs={}, variables=[], conditions=[],
        keyboard="us", drivers=[], settings=WelcomeSettings(),
    )  # fmt: skip
    session = ExampleSession().add(0, plan)
    session.add(0, m.PerceptionChanged(hidden=["gaze", "identity"], blurred=["transcript"]))
    found = text(session_figures(session.act(2).act(3, source="script").end(60)))
    assert "chose from 3 prepared actions on 2 panels (Speech and Driving)." in found
    assert "One panel (Driving) was locked unless unlocked on purpose." in found
    assert (
        "the wizard did not see the gaze or the identity and saw the transcript of speech" in found
    )
    assert "In all, 2 actions were asked for, 1 by key and 1 by the script." in found


def test_data_that_were_left_out() -> None:
    session = (
        ExampleSession()
        .add(1, m.TrialStarted(trial=1))
        .act(2)
        .add(3, m.TrialEnded(trial=1, outcome="done"))
    )
    session.add(4, m.TrialStarted(trial=2)).act(5).add(6, m.TrialEnded(trial=2, outcome="excluded"))
    example = (
        ExampleSession(session="S02")
        .add(1, m.RerunStarted(original="x", original_session="S01"))
        .end(9)
    )
    found = text(session_figures(session), session_figures(example))
    assert "Of 2 trials, 1 was excluded and left out." in found
    assert "One re-run of a session was left out." in found
    assert "The log of 1 session was cut off before the end." in found
    assert "In all, 1 action was asked for" in found


def test_words() -> None:
    assert (counted(1, "stop"), counted(0, "stop"), times(1), times(2), times(3)) == (
        *("1 stop", "0 stops", "once", "twice", "3 times"),
    )
    assert [listed(words) for words in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == [
        *("", "a", "a and b", "a, b and c")
    ]


def test_cues_that_the_end_cut_off_are_not_held_against_the_wizard() -> None:
    session = ExampleSession().add(1, m.Marker(text="x", source="key")).act(2)
    session.add(55, m.Marker(text="y", source="key"))
    found = text(session_figures(session.end(60)))
    assert (
        "Of 2 cues that needed an answer, the wizard answered 1 within 10 s (100.0 % of those "
        "not cut off by a break or by the end of the trial or the log)." in found
    )


def test_that_a_lost_console_stops_the_drive_is_no_emergency_stop() -> None:
    session = ExampleSession().add(
        1, m.StopPressed(source="no wizard's console is attached", scope="drive")
    )
    assert "emergency stop" not in text(session_figures(session.end(9)))


def test_another_robot_than_the_files_own_is_named() -> None:
    other = replace(session_figures(ExampleSession().act(1).end(60)), robot="nao")
    assert "In 1 session the file was played with the robot nao." in text(other)
    assert "the robot nao" not in text(replace(other, robot=""))


def test_robots_that_differ_by_a_file_are_one_sentence() -> None:
    own = session_figures(ExampleSession().act(1).end(60))
    two = [replace(own, robot=robot) for robot in ("nao", "pepper", "nao")]
    assert "In 3 sessions the file was played with the robots nao (2) and pepper (1)." in text(*two)
    many = [replace(own, robot=f"robots/P{number:02}.yaml") for number in range(1, 25)]
    assert (
        "In 24 sessions the file was played with 24 robot files, robots/P01.yaml to"
        " robots/P24.yaml." in text(*many)
    )


def test_that_the_robot_was_simulated_is_said() -> None:
    own = session_figures(ExampleSession().act(1).end(60))
    assert "simulated" not in text(own)
    simulated = replace(own, simulated=("robot",))
    assert "The robot was simulated (robot); no hardware moved." in text(simulated, simulated)
    real = replace(own, simulated=())
    assert "simulated" not in text(real)
    assert "The robot was simulated in 1 session (robot)" in text(simulated, real)


def test_every_cue_without_a_reaction_time_is_named() -> None:
    session = ExampleSession().add(1, m.Marker(text="x", source="key")).act(2)
    session.add(20, m.Marker(text="y", source="key")).add(21, m.Marker(text="z", source="key"))
    session.add(55, m.Marker(text="y", source="key"))
    found = text(session_figures(session.end(60)))
    assert (
        "3 cues were without a reaction time: 1 not answered within the window, 1 superseded by a"
        " newer cue and 1 cut off by a break or by the end of the trial or the log." in found
    )


def test_what_no_log_knows_comes_from_the_file_about_the_study() -> None:
    about = About(technology="speech recognition", training="90 % of the cues", robot="one NAO")
    found = facts(session_figures(ExampleSession().act(1).end(60)))
    told = " ".join(sentence for each in paragraphs(found, about) for sentence in each.sentences)
    assert "One NAO. The wizard stood for speech recognition." in told
    assert "Before the first session wizards had to reach: 90 % of the cues." in told
    assert "the technology that the wizard stood for" in by_hand()
    left = by_hand(about)
    assert "the technology that the wizard stood for" not in left
    assert "what the method leaves open" in left


def test_suspicion_is_what_the_named_item_says() -> None:
    item: dict[str, m.Json] = {
        "name": "person", "question": "A person?", "low": 1, "high": 5, "ends": ["never", "always"]
    }  # fmt: skip
    sessions = []
    for who, value in (("P01", 2.0), ("P02", 2.0), ("P03", 4.0)):
        session = ExampleSession(participant=who, session=f"S{who[1:]}").act(1)
        session.add(70, QuestionnaireStarted(questionnaire="end", title="", items=[item]))
        answer = QuestionnaireAnswered(
            questionnaire="end", item="person", question="A person?", value=value
        )
        session.add(71, answer, QuestionnaireEnded(questionnaire="end", answered=1, reason="done"))
        sessions.append(session_figures(session.end(80)))
    told = paragraphs(facts(*sessions), About(suspicion="end.person"))
    [suspicion] = [each.sentences for each in told if each.head == "Suspicion"]
    told_so = (
        'Whether a wizard was suspected was asked ("A person?"; 1 = never and 5 = always); the'
        " answers were 2 twice and 4 once."
    )
    assert suspicion == (told_so,)
    assert "Suspicion" not in [each.head for each in paragraphs(facts(*sessions))]
    other = paragraphs(facts(*sessions), About(suspicion="end.other"))
    assert "Whether a wizard was suspected was not answered (end.other)." in [
        sentence for each in other for sentence in each.sentences
    ]


def test_a_questionnaire_can_say_itself_that_it_asks_for_suspicion() -> None:
    items = (QuestionnaireItem("person", "A person?"), QuestionnaireItem("why", "Why?", text=True))
    check = Questionnaire(name="end", role="suspicion", items=items)
    plan = m.SessionPlan(
        title="", panels=[], verbs={}, variables=[], conditions=[], keyboard="us", drivers=[],
        settings=WelcomeSettings(study=StudySettings(questionnaires=[check])),
    )  # fmt: skip
    session = ExampleSession().add(0, plan).act(1)
    asked: list[dict[str, m.Json]] = [
        {"name": "person", "question": "A person?", "low": 1, "high": 7},
        {"name": "why", "question": "Why?", "text": True},
    ]
    session.add(70, QuestionnaireStarted(questionnaire="end", title="", items=asked))
    for item, said in (("person", {"value": 6.0}), ("why", {"text": "it waited"})):
        answer = {"questionnaire": "end", "item": item, "question": item, **said}
        session.add(71, msgspec.convert(answer, QuestionnaireAnswered))
    session.add(72, QuestionnaireEnded(questionnaire="end", answered=2, reason="done"))
    found = text(session_figures(session.end(80)))
    assert "the answers were 6 once." in found
    assert "the answers were in words once." in found
