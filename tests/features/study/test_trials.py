"""Trials, breaks and what is offered after them, on the wizard's screen."""

from __future__ import annotations

import msgspec
import pytest

from tests.console import scenes, study_scene
from tests.console.piloting import piloted_console
from tests.console.scripted_feed import raw
from tests.features.questionnaires import scene
from woz_tui.console.screens.leave import LeaveDialog
from woz_tui.console.screens.start import StartDialog
from woz_tui.console.state.study import StudyView
from woz_tui.features.questionnaires.console import QuestionnaireNotes
from woz_tui.features.questionnaires.dialog import OfferDialog, QuestionnaireDialog
from woz_tui.features.questionnaires.kinds import AskQuestionnaire, QuestionnaireAnswered
from woz_tui.features.study.kinds import AskTrial
from woz_tui.features.study.trial_dialog import TrialDialog, trial_status
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.timeline.study_history import StudyState

#: What ending a session may ask for.
ENDING = AskTrial | AskQuestionnaire | r.AskEnd
NOW, SECOND = study_scene.NOW, study_scene.SECOND


def trial_ended(number: int = 3, outcome: str = "done", t: int = NOW) -> m.TrialEnded:
    return m.TrialEnded(trial=number, outcome=outcome, t=t)


async def test_to_begin_and_to_end_a_trial_are_two_keys_each() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.press("asterisk", "b")
        asked = pilot.feed.last(AskTrial)
        assert isinstance(asked, AskTrial)
        assert asked.what == "begin"
        assert pilot.console.dialog is None
        await pilot.tell(study_scene.trial(1, "warm", ago=0))
        await pilot.press("asterisk", "d")
        asked = pilot.feed.last(AskTrial)
        assert isinstance(asked, AskTrial)
        assert asked.what == "done"


async def test_enter_does_what_comes_next() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        for message, what in ((study_scene.trial(ago=0), "begin"), (trial_ended(), "done")):
            await pilot.press("asterisk", "enter")
            asked = pilot.feed.last(AskTrial)
            assert isinstance(asked, AskTrial)
            assert asked.what == what
            await pilot.tell(message)


@pytest.mark.parametrize(("key", "what"), [("a", "aborted"), ("x", "excluded")])
async def test_a_trial_that_does_not_count_gets_a_word(key: str, what: str) -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        await pilot.press("asterisk", key)
        await pilot.type("fire alarm")
        assert pilot.feed.last(AskTrial) is None
        await pilot.press("enter")
        asked = pilot.feed.last(AskTrial)
        assert isinstance(asked, AskTrial)
        assert (asked.what, asked.text) == (what, "fire alarm")


async def test_the_word_for_a_trial_takes_a_text_that_comes_as_many_keys() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        await pilot.press("asterisk")
        assert pilot.console.keyboard.text_of("e") == ""
        await pilot.press("a")
        assert pilot.console.keyboard.text_of("e") == "e"


@pytest.mark.parametrize("key", ["d", "a"])
async def test_a_trial_that_somebody_else_has_ended_meanwhile_is_not_mistaken_for_the_next(
    key: str,
) -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(2))) as pilot:
        await pilot.press("asterisk", *(("a",) if key == "a" else ()))
        await pilot.tell(trial_ended(2), study_scene.trial(3, ago=0))
        await pilot.press(*(("d",) if key == "d" else (*"fell", "enter")))
        assert pilot.feed.last(AskTrial) is None
        assert "Trial 2 is over already" in pilot.text("StopBar")
        await pilot.press("asterisk", "d")
        assert pilot.feed.last(AskTrial) is not None


async def test_a_break_and_its_end() -> None:
    async with piloted_console(study_scene.welcome(), size=(120, 40)) as pilot:
        await pilot.press("asterisk", "p")
        await pilot.tell(m.BreakStarted(t=NOW))
        await pilot.pass_time(65)
        assert "break 01:05" in pilot.text("StatusLines")
        await pilot.press("asterisk", "r")
        asked = [request.what for request in pilot.feed.asked if isinstance(request, AskTrial)]
        assert asked == ["break", "resume"]
        await pilot.tell(m.BreakEnded(t=NOW + 66 * SECOND))
        assert "break" not in pilot.text("StatusLines")


async def test_the_header_counts_trials_and_their_time_without_jumping() -> None:
    async with piloted_console(
        study_scene.welcome(study_scene.trial(ago=59)), size=(120, 40)
    ) as pilot:
        first = pilot.text("StatusLines").splitlines()[0]
        assert "trial 3 of 4 00:59" in first
        await pilot.pass_time(62)
        second = pilot.text("StatusLines").splitlines()[0]
        assert "trial 3 of 4 02:01" in second
        assert first.index("session") == second.index("session")


async def test_a_small_screen_has_the_trial_too() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        assert "trial 3/4 02:41" in pilot.text("StatusLines")
        assert "cold" in pilot.text("StatusLines")


async def test_what_a_trial_demands_is_offered_when_it_is_done() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:

        def done(asked: r.Request, ref: int) -> r.Reply:
            pilot.feed.deliver(trial_ended())
            return r.Reply(ref=ref, ok=True)

        pilot.feed.answers[AskTrial] = done
        await pilot.press("asterisk", "d")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))
        await pilot.settle()
        assert "This visit" in pilot.drawn()
        await pilot.press("enter")
        asked = pilot.feed.last(AskQuestionnaire)
        assert isinstance(asked, AskQuestionnaire)
        assert (asked.questionnaire, asked.what) == ("quick", "begin")


async def test_what_an_excluded_trial_demands_is_offered_too() -> None:
    """The last trial of a condition has a questionnaire about the condition behind it."""
    block: m.Json = [{**study_scene.QUICK, "when": "condition"}]
    told = study_scene.study_description(questionnaires=block)
    async with piloted_console(study_scene.welcome(study_scene.trial(4), study=told)) as pilot:

        def excluded(asked: r.Request, ref: int) -> r.Reply:
            pilot.feed.deliver(trial_ended(4, "excluded"))
            return r.Reply(ref=ref, ok=True)

        pilot.feed.answers[AskTrial] = excluded
        await pilot.press("asterisk", "x", "enter")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))


async def test_one_questionnaire_after_the_other_is_offered() -> None:
    both: m.Json = [study_scene.QUICK, {**study_scene.ROBOT, "when": "trial"}]
    told = study_scene.study_description(questionnaires=both)
    async with piloted_console(study_scene.welcome(study_scene.trial(), study=told)) as pilot:
        await pilot.tell(trial_ended(), scene.questionnaire_started(study_scene.QUICK))
        await pilot.press("asterisk", "q")
        await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
        await pilot.until(lambda: "This visit" in pilot.drawn())
        await pilot.tell(scene.questionnaire_ended("quick"))
        await pilot.until(lambda: "Thank you!" in pilot.drawn())
        await pilot.press("ctrl+q")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))
        await pilot.settle()
        assert "You and the robot" in pilot.drawn()


@pytest.mark.parametrize(
    ("number", "outcome", "offered"),
    [
        (3, "done", "begin trial 4"),
        (3, "excluded", "begin trial 4"),
        (3, "aborted", "begin trial 3 again"),
    ],
)
async def test_the_trial_to_be_begun_is_named(number: int, outcome: str, offered: str) -> None:
    told = study_scene.study_description(trial=number)
    async with piloted_console(study_scene.welcome(study_scene.trial(number), study=told)) as pilot:
        await pilot.tell(trial_ended(number, outcome))
        await pilot.press("asterisk")
        await pilot.settle()
        assert f"{offered}  " in pilot.drawn()


async def test_a_trial_that_is_set_by_hand_is_the_next_one() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(4))) as pilot:
        await pilot.tell(trial_ended(4), m.SessionChanged(trial=2, t=NOW))
        await pilot.press("asterisk")
        await pilot.settle()
        assert " b   begin trial 2 again" in pilot.drawn()


async def test_behind_a_trial_that_was_run_too_early_comes_the_first_that_is_not_over() -> None:
    state = (study_scene.conditions_assigned(over=[1]), study_scene.trial(4))
    async with piloted_console(study_scene.welcome(*state)) as pilot:
        await pilot.tell(trial_ended(4))
        await pilot.press("asterisk")
        await pilot.settle()
        assert " b   begin trial 2  " in pilot.drawn()
        await pilot.press("ctrl+q", "ctrl+q")
        await pilot.settle()
        assert "2 of 4 trials are still to do" in pilot.drawn()


async def test_when_all_trials_are_over_none_can_be_begun() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(4))) as pilot:
        await pilot.tell(trial_ended(4))
        await pilot.press("asterisk")
        await pilot.settle()
        assert "all 4 trials are over" in pilot.drawn()
        assert "begin trial" not in pilot.drawn()


async def test_between_trials_the_order_points_at_the_condition_of_the_next() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(2, "warm"))) as pilot:
        await pilot.press("asterisk")
        await pilot.settle()
        assert "▸ 1. warm" in pilot.drawn()
        await pilot.press("ctrl+q")
        await pilot.tell(trial_ended(2), scene.questionnaire_ended("quick"))
        await pilot.press("asterisk")
        await pilot.settle()
        assert "▸ 2. cold" in pilot.drawn()
        assert "▸ 1. warm" not in pilot.drawn()


async def test_a_letter_that_does_nothing_names_those_that_do() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        await pilot.press("asterisk", "z")
        await pilot.settle()
        assert "does nothing here; press d a x p" in pilot.drawn()
        assert isinstance(pilot.console.dialog, TrialDialog)


async def test_what_is_answered_and_not_confirmed_is_called_so() -> None:
    answer = QuestionnaireAnswered(
        questionnaire="quick", item="pleasant", question="?", value=5.0, t=NOW
    )
    async with piloted_console(
        study_scene.welcome(scene.questionnaire_started(study_scene.QUICK), answer)
    ) as pilot:
        await pilot.press("asterisk")
        await pilot.settle()
        assert "This visit: answered, not confirmed" in pilot.drawn()


async def test_no_trial_can_be_begun_while_something_is_asked() -> None:
    """The robot process would refuse it."""
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.tell(scene.questionnaire_started())
        await pilot.press("asterisk")
        await pilot.settle()
        assert "leave it unfinished" in pilot.drawn()
        assert "begin trial" not in pilot.drawn()


async def test_the_row_of_the_script_says_what_the_trial_key_does_now() -> None:
    first = msgspec.structs.replace(study_scene.welcome(study_scene.trial(4)), script=[])
    async with piloted_console(first) as pilot:
        await pilot.tell(trial_ended(4), scene.questionnaire_started(study_scene.QUICK))
        assert "*  goes on with: This visit" in pilot.text("StopBar")
        await pilot.tell(scene.questionnaire_ended("quick"))
        assert "all trials are over" in pilot.text("StopBar")


async def test_who_comes_late_hears_which_trial_is_next() -> None:
    late = study_scene.welcome(study_scene.trial(3), trial_ended(3))
    async with piloted_console(late) as pilot:
        await pilot.press("asterisk")
        await pilot.settle()
        assert "begin trial 4" in pilot.drawn()


async def test_at_the_participants_terminal_the_wizard_goes_on_playing() -> None:
    there = m.ConsoleAttached(console="con2", role="participant", t=NOW)
    async with piloted_console(study_scene.welcome(there)) as pilot:
        await pilot.press("asterisk", "1")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))
        await pilot.settle()
        await pilot.press("down", "enter")
        assert pilot.feed.last(AskQuestionnaire) is not None
        await pilot.tell(scene.questionnaire_started())
        assert pilot.console.dialog is None


async def test_before_it_covers_the_screen_the_wizard_reads_how_to_come_back() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.press("asterisk", "1")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))
        await pilot.settle()
        assert "ctrl+q brings the console back" in pilot.drawn()


async def test_a_refusal_is_told() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        pilot.feed.answers[AskTrial] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="no condition is set", hint="choose the order first"
        )
        await pilot.press("asterisk", "b")
        assert "no condition is set" in pilot.text("StopBar")


async def test_what_was_not_ticked_is_told_with_the_first_trial() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        await pilot.tell(study_scene.trial(1, "warm", ago=0))
        assert "2 preflight items are not ticked" in pilot.text("StopBar")
        assert "to list them" in pilot.text("StopBar"), "the key that opens the list is named"
        assert f"▲ Trial 1 of 4 begins  not ticked: {study_scene.CHECKS[0]}" in pilot.text(
            "EventList"
        )
        assert pilot.console.dialog is None


async def test_a_console_that_comes_later_is_told_no_old_news() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        assert "not ticked" not in pilot.text("StopBar")


async def test_the_dialog_shows_the_order_and_a_time_that_goes_on() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial())) as pilot:
        await pilot.press("asterisk")
        assert isinstance(pilot.console.dialog, TrialDialog)
        assert "trial 3 of 4, 02:41" in pilot.drawn()
        assert "2. cold" in pilot.drawn()
        await pilot.pass_time(2)
        assert "trial 3 of 4, 02:43" in pilot.drawn()


async def test_leaving_lists_what_is_open_in_one_dialog() -> None:
    told = study_scene.study_description(
        questionnaires=[study_scene.ROBOT, {**study_scene.QUICK, "when": "end"}]
    )
    first = study_scene.welcome(study_scene.trial(3), study=told)
    async with piloted_console(first, size=(100, 36)) as pilot:
        await pilot.press("ctrl+q")
        await pilot.settle()
        for line in (
            "Trial 3 is still running; ending the session marks it as aborted.",
            "You and the robot has not been answered: ask it first",
            "This visit has not been answered: ask it first",
            "enter: do it, or the next answer",
        ):
            assert line in pilot.drawn()
        await pilot.press("down", "down", "down", "enter", "down", "enter", "down", "enter")
        for line in ("marks it as done.", "robot has not been answered: skip", "visit has not"):
            assert line in pilot.drawn()
        await pilot.press("up", "up", "up", "enter")
        asked = [each for each in pilot.feed.asked if isinstance(each, AskTrial | r.AskEnd)]
        assert [type(each) for each in asked] == [AskTrial, r.AskEnd]
        assert isinstance(asked[0], AskTrial)
        assert asked[0].what == "done"
        assert pilot.feed.last(AskQuestionnaire) is None


async def test_a_trial_that_is_marked_done_brings_its_questionnaire() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(3)), size=(100, 36)) as pilot:
        await pilot.press("ctrl+q")
        assert "This visit has not been answered" not in pilot.drawn()
        await pilot.press("down", "down", "down", "enter")
        assert "marks it as done." in pilot.drawn()
        assert "This visit has not been answered: ask it first" in pilot.drawn()
        await pilot.press("enter")
        assert "marks it as aborted." in pilot.drawn()
        assert "This visit has not been answered" not in pilot.drawn()
        await pilot.press("enter", "up", "enter")
        done, asked = (each for each in pilot.feed.asked if isinstance(each, ENDING))
        assert isinstance(done, AskTrial)
        assert done.what == "done"
        assert isinstance(asked, AskQuestionnaire)
        assert asked.questionnaire == "quick"


async def test_the_answer_about_one_trial_is_none_about_the_next() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(3)), size=(100, 36)) as pilot:
        await pilot.press("ctrl+q", "down", "down", "down", "enter", "ctrl+q")
        await pilot.tell(trial_ended(3), study_scene.trial(4, ago=0))
        await pilot.press("ctrl+q")
        assert "Trial 4 is still running; ending the session marks it as aborted." in pilot.drawn()


async def test_a_trial_that_cannot_be_marked_done_ends_no_session() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(3))) as pilot:
        pilot.feed.answers[AskTrial] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="no trial is running"
        )
        await pilot.press("ctrl+q", "down", "down", "down", "enter", "up", "enter")
        assert "no trial is running" in pilot.drawn()
        assert pilot.feed.last(r.AskEnd) is None


async def test_who_ends_a_study_without_a_participant_can_still_say_who_it_was() -> None:
    first = msgspec.structs.replace(study_scene.welcome(), state=raw([scenes.start("", "")]))
    async with piloted_console(first, size=(100, 36)) as pilot:
        await pilot.press("ctrl+q")
        assert "No participant was given: the log has no code" in pilot.drawn()
        await pilot.press("down", "down", "down", "enter")
        assert "No participant was given: give it first" in pilot.drawn()
        await pilot.press("up", "enter")
        await pilot.until(lambda: isinstance(pilot.console.dialog, StartDialog))
        await pilot.type("P09")
        await pilot.press("tab", "down", "enter")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LeaveDialog))
        await pilot.tell(m.SessionChanged(participant="P09", t=NOW))
        await pilot.press("ctrl+q", "ctrl+q")
        assert "No participant" not in pilot.drawn()
        assert pilot.feed.last(r.AskEnd) is None


async def test_who_ends_a_study_without_a_participant_can_leave_it_at_that() -> None:
    told = study_scene.study_description(questionnaires=[])
    first = study_scene.welcome(study=told)
    first = msgspec.structs.replace(first, state=raw([scenes.start("", "")]))
    async with piloted_console(first) as pilot:
        await pilot.press("ctrl+q", "down", "down", "enter")
        assert pilot.feed.last(r.AskEnd) is not None


async def test_free_play_has_no_participant_to_ask_for() -> None:
    first = scenes.welcome(state=[scenes.start("", "")])
    first = msgspec.structs.replace(first, conditions=[])
    async with piloted_console(first) as pilot:
        await pilot.press("ctrl+q")
        assert "No participant" not in pilot.drawn()


async def test_behind_a_questionnaire_that_leaving_brought_the_wizard_is_asked_again() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.press("ctrl+q", "down", "down")
        await pilot.tell(scene.questionnaire_started())
        await pilot.press("enter")
        await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
        await pilot.tell(scene.questionnaire_ended())
        await pilot.press("ctrl+q")
        await pilot.until(lambda: isinstance(pilot.console.dialog, LeaveDialog))
        assert pilot.feed.last(r.AskEnd) is None


@pytest.mark.parametrize(("role", "may"), [("wizard", True), ("watcher", False)])
async def test_the_session_is_ended_by_who_may(role: str, may: bool) -> None:
    async with piloted_console(study_scene.welcome(role=role)) as pilot:
        await pilot.press("ctrl+q")
        assert ("End the session" in pilot.drawn()) is may


async def test_leaving_tells_what_the_end_would_cut_off() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(3))) as pilot:
        await pilot.tell(scene.questionnaire_started(study_scene.QUICK))
        await pilot.press("ctrl+q")
        await pilot.settle()
        drawn = pilot.drawn()
        assert "Trial 3 is still running; ending the session" in drawn
        assert "This visit: 0 of 1 answered" in drawn
        assert "You and the robot has not been answered" in drawn
        await pilot.press("down", "down", "enter")
        assert pilot.feed.last(r.AskEnd) is not None, "nothing can be asked beside what is asked"


async def test_a_title_is_cut_only_where_there_is_no_room_for_it() -> None:
    first = study_scene.welcome()
    state = raw([scenes.start("", "")])
    named = msgspec.structs.replace(first, title="Warm or sober", state=state)
    async with piloted_console(named) as pilot:
        assert " Warm or sober  " in pilot.drawn().splitlines()[0]
        assert "no participant" in pilot.drawn().splitlines()[0]


async def test_leaving_says_when_a_session_ends_that_is_left_running() -> None:
    first = scenes.welcome(settings={"abandon_after": 600.0})
    async with piloted_console(first) as pilot:
        await pilot.press("ctrl+q")
        await pilot.settle()
        assert "it ends by itself after 10 min without a console (abandon_after)" in pilot.drawn()
        await pilot.press("down", "enter")
        assert pilot.console.return_value == "detached"


async def test_leaving_between_trials_names_what_is_due_and_the_trials_left() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(3)), size=(100, 30)) as pilot:
        await pilot.tell(trial_ended(3))
        await pilot.press("ctrl+q")
        await pilot.settle()
        drawn = pilot.drawn()
        assert "This visit has not been answered" in drawn
        assert "You and the robot has not been answered" in drawn
        assert "1 of 4 trials is still to do" in drawn
        await pilot.press("down", "down", "enter")
        asked = pilot.feed.last(AskQuestionnaire)
        assert isinstance(asked, AskQuestionnaire)
        assert asked.questionnaire == "quick"


async def test_leaving_behind_the_last_trial_and_its_questionnaires_warns_of_nothing() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial(4))) as pilot:
        await pilot.tell(
            trial_ended(4),
            scene.questionnaire_ended("quick"),
            scene.questionnaire_ended(),
        )
        await pilot.press("ctrl+q")
        await pilot.settle()
        assert "▲" not in pilot.drawn()


async def test_what_was_declined_is_not_offered_again() -> None:
    async with piloted_console(
        study_scene.welcome(scene.questionnaire_ended(reason="declined"))
    ) as pilot:
        await pilot.press("ctrl+q", "down", "down", "enter")
        assert pilot.feed.last(r.AskEnd) is not None


# -- what follows from the messages ---------------------------------------------------------------


def study(*messages: m.Message, **told: m.Json) -> StudyView:
    study_view = StudyView()
    study_view.session.study.settings = study_scene.study_settings(
        study_scene.study_description(**told)
    )
    tell(study_view, scenes.start(), study_scene.conditions_assigned(), *messages)
    return study_view


def tell(study_view: StudyView, *messages: m.Message) -> None:
    for message in messages:
        study_view.session.apply(message)
        study_view.apply(message)


def asked(study_view: StudyView) -> QuestionnaireNotes:
    notes = study_view.notes.of(QuestionnaireNotes)
    assert notes is not None
    return notes


@pytest.mark.parametrize(
    ("number", "outcome", "due"),
    [
        (1, "done", ["each"]),
        (2, "done", ["each", "block"]),
        (2, "excluded", ["block"]),
        (2, "aborted", []),
        (4, "done", ["each", "block", "last"]),
    ],
)
def test_what_is_due_after_a_trial(number: int, outcome: str, due: list[str]) -> None:
    whens = {"each": "trial", "block": "condition", "last": "end", "own": "hand"}
    listed: list[m.Json] = [{"name": name, "when": when} for name, when in whens.items()]
    study_view = study(
        study_scene.trial(number), trial_ended(number, outcome), questionnaires=listed
    )
    assert asked(study_view).due == due
    tell(study_view, study_scene.trial(number + 1, ago=0))
    assert asked(study_view).due == []


def test_what_was_left_stays_due_and_what_was_answered_does_not() -> None:
    study_view = study(study_scene.trial(1), trial_ended(1))
    tell(
        study_view,
        scene.questionnaire_started(study_scene.QUICK),
        scene.questionnaire_ended("quick", "left"),
    )
    assert asked(study_view).due == ["quick"]
    tell(study_view, scene.questionnaire_ended("quick"))
    assert asked(study_view).due == []


def test_without_participant_and_trial_nothing_is_for_the_end() -> None:
    last: list[m.Json] = [{"name": "last", "when": "end"}]
    study_view = StudyView()
    study_view.session.study.settings = study_scene.study_settings(
        study_scene.study_description(questionnaires=last)
    )
    assert asked(study_view).unanswered() == []
    tell(study_view, m.SessionChanged(participant="P08", t=NOW))
    assert asked(study_view).unanswered() == ["last"]


@pytest.mark.parametrize(("source", "told"), [("midi", 1), ("gamepad", 1), ("engagement", 0)])
def test_any_hand_outside_of_a_trial_is_told_once(source: str, told: int) -> None:
    study_view = study()
    for run in ("r1", "r2"):
        tell(study_view, m.ActionRequested(run=run, action="Hello", source=source, t=NOW))
    assert len(study_view.read_news()) == told


def test_another_participant_begins_anew() -> None:
    study_view = study(
        study_scene.trial(1),
        trial_ended(1),
        scene.questionnaire_ended("quick"),
        scene.questionnaire_ended(),
    )
    assert asked(study_view).unanswered() == []
    tell(study_view, m.SessionChanged(participant="P08", t=NOW))
    state = study_view.session.study
    assert (state.order, state.planned, asked(study_view).due, state.last_ended) == (
        (),
        0,
        [],
        None,
    )
    assert asked(study_view).unanswered() == ["robot"]


def test_where_a_session_stands_in_words() -> None:
    assert trial_status(StudyState(), NOW) == "no trial yet"
    single = study(
        study_scene.conditions_assigned(["warm"]), study_scene.trial(1), trial_ended(1),
        design={"order": "latin-square", "within": False, "trials": 1},
    )  # fmt: skip
    assert trial_status(single.session.study, NOW) == "the trial is over"
    assert trial_status(study().session.study, NOW) == "no trial yet, 4 planned"
    aborted = study(study_scene.trial(2), trial_ended(2, "aborted"))
    assert trial_status(aborted.session.study, NOW) == "trial 2 of 4 is over: aborted"


async def test_an_open_dialog_follows_what_the_participant_does() -> None:
    """At their own terminal they finish while it is open: nothing can be gone on with then."""
    begun = scene.questionnaire_started(study_scene.QUICK)
    async with piloted_console(study_scene.welcome(study_scene.trial(), begun)) as pilot:
        await pilot.press("asterisk")
        assert "go on with: This visit" in pilot.drawn()
        await pilot.tell(scene.questionnaire_ended("quick"))
        drawn = pilot.drawn()
        assert "go on with" not in drawn
        assert "done: this trial is over" in drawn
        await pilot.press("enter")
        asked = pilot.feed.last(AskTrial)
        assert isinstance(asked, AskTrial)
        assert asked.what == "done"
