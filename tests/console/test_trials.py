"""Trials, breaks and what is offered after them, on the wizard's screen."""

from __future__ import annotations

import pytest

from tests.console import scenes, studied
from tests.console.driving import sitting
from woz_tui.console.screens.leave import LeaveDialog
from woz_tui.console.screens.questionnaire import QuestionnaireDialog
from woz_tui.console.screens.trial import OfferDialog, TrialDialog, trial_status
from woz_tui.console.study.study_view import StudyView
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW, SECOND = studied.NOW, studied.SECOND


def over(number: int = 3, outcome: str = "done", t: int = NOW) -> m.TrialEnded:
    return m.TrialEnded(trial=number, outcome=outcome, t=t)


async def test_to_begin_and_to_end_a_trial_are_two_keys_each() -> None:
    async with sitting(studied.welcome()) as seat:
        await seat.press("asterisk", "b")
        asked = seat.feed.last(r.AskTrial)
        assert isinstance(asked, r.AskTrial)
        assert asked.what == "begin"
        assert seat.console.dialog is None
        await seat.tell(studied.trial(1, "warm", ago=0))
        await seat.press("asterisk", "d")
        asked = seat.feed.last(r.AskTrial)
        assert isinstance(asked, r.AskTrial)
        assert asked.what == "done"


async def test_enter_does_what_comes_next() -> None:
    async with sitting(studied.welcome()) as seat:
        for message, what in ((studied.trial(ago=0), "begin"), (over(), "done")):
            await seat.press("asterisk", "enter")
            asked = seat.feed.last(r.AskTrial)
            assert isinstance(asked, r.AskTrial)
            assert asked.what == what
            await seat.tell(message)


@pytest.mark.parametrize(("key", "what"), [("a", "aborted"), ("x", "excluded")])
async def test_a_trial_that_does_not_count_gets_a_word(key: str, what: str) -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:
        await seat.press("asterisk", key)
        await seat.type("fire alarm")
        assert seat.feed.last(r.AskTrial) is None
        await seat.press("enter")
        asked = seat.feed.last(r.AskTrial)
        assert isinstance(asked, r.AskTrial)
        assert (asked.what, asked.text) == (what, "fire alarm")


@pytest.mark.parametrize("key", ["d", "a"])
async def test_a_trial_that_somebody_else_has_ended_meanwhile_is_not_mistaken_for_the_next(
    key: str,
) -> None:
    async with sitting(studied.welcome(studied.trial(2))) as seat:
        await seat.press("asterisk", *(("a",) if key == "a" else ()))
        await seat.tell(over(2), studied.trial(3, ago=0))
        await seat.press(*(("d",) if key == "d" else (*"fell", "enter")))
        assert seat.feed.last(r.AskTrial) is None
        assert "Trial 2 is over already" in seat.text("StopBar")
        await seat.press("asterisk", "d")
        assert seat.feed.last(r.AskTrial) is not None


async def test_a_break_and_its_end() -> None:
    async with sitting(studied.welcome(), size=(120, 40)) as seat:
        await seat.press("asterisk", "p")
        await seat.tell(m.BreakStarted(t=NOW))
        await seat.pass_time(65)
        assert "break 01:05" in seat.text("StatusLines")
        await seat.press("asterisk", "r")
        asked = [request.what for request in seat.feed.asked if isinstance(request, r.AskTrial)]
        assert asked == ["break", "resume"]
        await seat.tell(m.BreakEnded(t=NOW + 66 * SECOND))
        assert "break" not in seat.text("StatusLines")


async def test_the_header_counts_trials_and_their_time_without_jumping() -> None:
    async with sitting(studied.welcome(studied.trial(ago=59)), size=(120, 40)) as seat:
        first = seat.text("StatusLines").splitlines()[0]
        assert "trial 3 of 4 00:59" in first
        await seat.pass_time(62)
        second = seat.text("StatusLines").splitlines()[0]
        assert "trial 3 of 4 02:01" in second
        assert first.index("session") == second.index("session")


async def test_a_small_screen_has_the_trial_too() -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:
        assert "trial 3/4 02:41" in seat.text("StatusLines")
        assert "cold" in seat.text("StatusLines")


async def test_what_a_trial_demands_is_offered_when_it_is_done() -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:

        def done(asked: r.AnyRequest, ref: int) -> r.Reply:
            seat.feed.deliver(over())
            return r.Reply(ref=ref, ok=True)

        seat.feed.answers[r.AskTrial] = done
        await seat.press("asterisk", "d")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        assert "This visit" in seat.drawn()
        await seat.press("enter")
        asked = seat.feed.last(r.AskQuestionnaire)
        assert isinstance(asked, r.AskQuestionnaire)
        assert (asked.questionnaire, asked.what) == ("quick", "begin")


async def test_what_an_excluded_trial_demands_is_offered_too() -> None:
    """The last trial of a condition has a questionnaire about the condition behind it."""
    block: m.Json = [{**studied.QUICK, "when": "condition"}]
    told = studied.told(questionnaires=block)
    async with sitting(studied.welcome(studied.trial(4), study=told)) as seat:

        def excluded(asked: r.AnyRequest, ref: int) -> r.Reply:
            seat.feed.deliver(over(4, "excluded"))
            return r.Reply(ref=ref, ok=True)

        seat.feed.answers[r.AskTrial] = excluded
        await seat.press("asterisk", "x", "enter")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))


async def test_one_questionnaire_after_the_other_is_offered() -> None:
    both: m.Json = [studied.QUICK, {**studied.ROBOT, "when": "trial"}]
    told = studied.told(questionnaires=both)
    async with sitting(studied.welcome(studied.trial(), study=told)) as seat:
        await seat.tell(over(), studied.started(studied.QUICK))
        await seat.press("asterisk", "q")
        await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
        await seat.until(lambda: "This visit" in seat.drawn())
        await seat.tell(studied.ended("quick"))
        await seat.until(lambda: "Thank you!" in seat.drawn())
        await seat.press("ctrl+q")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        assert "You and the robot" in seat.drawn()


@pytest.mark.parametrize(
    ("number", "outcome", "offered"),
    [
        (3, "done", "begin trial 4"),
        (3, "excluded", "begin trial 4"),
        (3, "aborted", "begin trial 3 again"),
    ],
)
async def test_the_trial_to_be_begun_is_named(number: int, outcome: str, offered: str) -> None:
    told = studied.told(trial=number)
    async with sitting(studied.welcome(studied.trial(number), study=told)) as seat:
        await seat.tell(over(number, outcome))
        await seat.press("asterisk")
        await seat.settle()
        assert f"{offered}  " in seat.drawn()


async def test_a_trial_that_is_set_by_hand_is_the_next_one() -> None:
    async with sitting(studied.welcome(studied.trial(4))) as seat:
        await seat.tell(over(4), m.SessionChanged(trial=2, t=NOW))
        await seat.press("asterisk")
        await seat.settle()
        assert " b   begin trial 2 again" in seat.drawn()


async def test_behind_a_trial_that_was_run_too_early_comes_the_first_that_is_not_over() -> None:
    state = (studied.assigned(over=[1]), studied.trial(4))
    async with sitting(studied.welcome(*state)) as seat:
        await seat.tell(over(4))
        await seat.press("asterisk")
        await seat.settle()
        assert " b   begin trial 2  " in seat.drawn()
        await seat.press("ctrl+q", "ctrl+q")
        await seat.settle()
        assert "2 of 4 trials have not begun" in seat.drawn()


async def test_when_all_trials_are_over_none_can_be_begun() -> None:
    async with sitting(studied.welcome(studied.trial(4))) as seat:
        await seat.tell(over(4))
        await seat.press("asterisk")
        await seat.settle()
        assert "all 4 trials are over" in seat.drawn()
        assert "begin trial" not in seat.drawn()


async def test_between_trials_the_order_points_at_the_condition_of_the_next() -> None:
    async with sitting(studied.welcome(studied.trial(2, "warm"))) as seat:
        await seat.press("asterisk")
        await seat.settle()
        assert "▸ 1. warm" in seat.drawn()
        await seat.press("ctrl+q")
        await seat.tell(over(2), studied.ended("quick"))
        await seat.press("asterisk")
        await seat.settle()
        assert "▸ 2. cold" in seat.drawn()
        assert "▸ 1. warm" not in seat.drawn()


async def test_a_letter_that_does_nothing_names_those_that_do() -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:
        await seat.press("asterisk", "z")
        await seat.settle()
        assert "there are: d a x p" in seat.drawn()
        assert isinstance(seat.console.dialog, TrialDialog)


async def test_what_is_answered_and_not_confirmed_is_called_so() -> None:
    answer = m.QuestionnaireAnswered(
        questionnaire="quick", item="pleasant", question="?", value=5.0, t=NOW
    )
    async with sitting(studied.welcome(studied.started(studied.QUICK), answer)) as seat:
        await seat.press("asterisk")
        await seat.settle()
        assert "This visit: answered, not confirmed" in seat.drawn()


async def test_no_trial_can_be_begun_while_something_is_asked() -> None:
    """The robot process would refuse it."""
    async with sitting(studied.welcome()) as seat:
        await seat.tell(studied.started())
        await seat.press("asterisk")
        await seat.settle()
        assert "leave it unfinished" in seat.drawn()
        assert "begin trial" not in seat.drawn()


async def test_who_comes_late_hears_which_trial_is_next() -> None:
    late = studied.welcome(studied.trial(3), over(3))
    async with sitting(late) as seat:
        await seat.press("asterisk")
        await seat.settle()
        assert "begin trial 4" in seat.drawn()


async def test_at_the_participants_terminal_the_wizard_goes_on_playing() -> None:
    there = m.ConsoleAttached(console="con2", role="participant", t=NOW)
    async with sitting(studied.welcome(there)) as seat:
        await seat.press("asterisk", "1")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        await seat.press("down", "enter")
        assert seat.feed.last(r.AskQuestionnaire) is not None
        await seat.tell(studied.started())
        assert seat.console.dialog is None


async def test_before_it_covers_the_screen_the_wizard_reads_how_to_come_back() -> None:
    async with sitting(studied.welcome()) as seat:
        await seat.press("asterisk", "1")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        assert "ctrl+q brings the console back" in seat.drawn()


async def test_a_refusal_is_told() -> None:
    async with sitting(studied.welcome()) as seat:
        seat.feed.answers[r.AskTrial] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="no condition is set", hint="choose the order first"
        )
        await seat.press("asterisk", "b")
        assert "no condition is set" in seat.text("StopBar")


async def test_what_was_not_ticked_is_told_with_the_first_trial() -> None:
    async with sitting(studied.welcome(), size=(160, 50)) as seat:
        await seat.tell(studied.trial(1, "warm", ago=0))
        assert "2 not ticked in the preflight" in seat.text("StopBar")
        assert "to list them" in seat.text("StopBar"), "the key that opens the list is named"
        assert f"▲ Trial 1 of 4 begins  not ticked: {studied.CHECKS[0]}" in seat.text("EventList")
        assert seat.console.dialog is None


async def test_a_console_that_comes_later_is_told_no_old_news() -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:
        assert "not ticked" not in seat.text("StopBar")


async def test_the_dialog_shows_the_order_and_a_time_that_goes_on() -> None:
    async with sitting(studied.welcome(studied.trial())) as seat:
        await seat.press("asterisk")
        assert isinstance(seat.console.dialog, TrialDialog)
        assert "trial 3 of 4, 02:41" in seat.drawn()
        assert "2. cold" in seat.drawn()
        await seat.pass_time(2)
        assert "trial 3 of 4, 02:43" in seat.drawn()


async def test_leaving_offers_what_is_asked_at_the_end_first() -> None:
    async with sitting(studied.welcome()) as seat:
        await seat.press("ctrl+q", "down", "down", "enter")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        assert "You and the robot" in seat.drawn()
        assert seat.feed.last(r.AskEnd) is None
        await seat.press("down", "enter")
        assert seat.feed.last(r.AskEnd) is not None


async def test_behind_a_questionnaire_that_leaving_brought_the_wizard_is_asked_again() -> None:
    async with sitting(studied.welcome()) as seat:
        await seat.press("ctrl+q", "down", "down", "enter")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.tell(studied.started())
        await seat.press("enter")
        await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
        await seat.tell(studied.ended())
        await seat.press("ctrl+q")
        await seat.until(lambda: isinstance(seat.console.dialog, LeaveDialog))
        assert seat.feed.last(r.AskEnd) is None


async def test_leaving_without_one_questionnaire_offers_the_next_one() -> None:
    told = studied.told(questionnaires=[studied.ROBOT, {**studied.QUICK, "when": "end"}])
    async with sitting(studied.welcome(study=told)) as seat:
        await seat.press("ctrl+q", "down", "down", "enter")
        for title in ("You and the robot", "This visit"):
            await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
            await seat.settle()
            assert title in seat.drawn()
            assert seat.feed.last(r.AskEnd) is None
            await seat.press("down", "enter")
        assert seat.feed.last(r.AskEnd) is not None


@pytest.mark.parametrize(("role", "may"), [("wizard", True), ("watcher", False)])
async def test_the_session_is_ended_by_who_may(role: str, may: bool) -> None:
    async with sitting(studied.welcome(role=role)) as seat:
        await seat.press("ctrl+q")
        assert ("End the session" in seat.drawn()) is may


async def test_leaving_tells_what_the_end_would_cut_off() -> None:
    async with sitting(studied.welcome(studied.trial(3))) as seat:
        await seat.tell(studied.started(studied.QUICK))
        await seat.press("ctrl+q")
        await seat.settle()
        drawn = seat.drawn()
        assert "trial 3 is running: the end makes it aborted" in drawn
        assert "This visit: 0 of 1 answered" in drawn
        assert "You and the robot has not been answered" in drawn
        await seat.press("down", "down", "enter")
        assert seat.feed.last(r.AskEnd) is not None, "nothing can be asked beside what is asked"


async def test_leaving_between_trials_names_what_is_due_and_the_trials_left() -> None:
    async with sitting(studied.welcome(studied.trial(3)), size=(100, 30)) as seat:
        await seat.tell(over(3))
        await seat.press("ctrl+q")
        await seat.settle()
        drawn = seat.drawn()
        assert "This visit has not been answered" in drawn
        assert "You and the robot has not been answered" in drawn
        assert "1 of 4 trials has not begun" in drawn
        await seat.press("down", "down", "enter")
        await seat.until(lambda: isinstance(seat.console.dialog, OfferDialog))
        await seat.settle()
        assert "This visit" in seat.drawn()


async def test_leaving_behind_the_last_trial_and_its_questionnaires_warns_of_nothing() -> None:
    async with sitting(studied.welcome(studied.trial(4))) as seat:
        await seat.tell(over(4), studied.ended("quick"), studied.ended())
        await seat.press("ctrl+q")
        await seat.settle()
        assert "▲" not in seat.drawn()


async def test_what_was_declined_is_not_offered_again() -> None:
    async with sitting(studied.welcome(studied.ended(reason="declined"))) as seat:
        await seat.press("ctrl+q", "down", "down", "enter")
        assert seat.feed.last(r.AskEnd) is not None


# -- what follows from the messages ---------------------------------------------------------------


def study(*messages: m.Message, **told: m.Json) -> StudyView:
    made = StudyView()
    made.session.study.settings = studied.typed(studied.told(**told))
    made.adopt()
    tell(made, scenes.start(), studied.assigned(), *messages)
    return made


def tell(made: StudyView, *messages: m.Message) -> None:
    for message in messages:
        made.session.apply(message)
        made.apply(message)


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
    made = study(studied.trial(number), over(number, outcome), questionnaires=listed)
    assert made.due == due
    tell(made, studied.trial(number + 1, ago=0))
    assert made.due == []


def test_what_was_left_stays_due_and_what_was_answered_does_not() -> None:
    made = study(studied.trial(1), over(1))
    tell(made, studied.started(studied.QUICK), studied.ended("quick", "left"))
    assert made.due == ["quick"]
    tell(made, studied.ended("quick"))
    assert made.due == []


def test_without_participant_and_trial_nothing_is_for_the_end() -> None:
    last: list[m.Json] = [{"name": "last", "when": "end"}]
    made = StudyView()
    made.session.study.settings = studied.typed(studied.told(questionnaires=last))
    made.adopt()
    assert made.unasked() == []
    tell(made, m.SessionChanged(participant="P08", t=NOW))
    assert made.unasked() == ["last"]


@pytest.mark.parametrize(("source", "told"), [("midi", 1), ("gamepad", 1), ("engagement", 0)])
def test_any_hand_outside_of_a_trial_is_told_once(source: str, told: int) -> None:
    made = study()
    for run in ("r1", "r2"):
        tell(made, m.ActionRequested(run=run, action="Hello", source=source, t=NOW))
    assert len(made.read_news()) == told


def test_another_participant_begins_anew() -> None:
    made = study(studied.trial(1), over(1), studied.ended("quick"), studied.ended())
    assert made.unasked() == []
    tell(made, m.SessionChanged(participant="P08", t=NOW))
    assert (made.order, made.planned, made.due, made.last) == ((), 0, [], None)
    assert made.unasked() == ["robot"]


def test_where_a_session_stands_in_words() -> None:
    assert trial_status(StudyView(), NOW) == "no trial yet"
    single = study(
        studied.assigned(["warm"]), studied.trial(1), over(1),
        design={"order": "latin-square", "within": False, "trials": 1},
    )  # fmt: skip
    assert trial_status(single, NOW) == "the trial is over"
    assert trial_status(study(), NOW) == "no trial yet, 4 planned"
    assert (
        trial_status(study(studied.trial(2), over(2, "aborted")), NOW)
        == "trial 2 of 4 is over: aborted"
    )
