"""The participant's own terminal: a questionnaire or nothing, and no key plays the robot."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import msgspec
import pytest
from textual.pilot import Pilot

from tests.console import scenes, study_scene
from tests.console.piloting import PATIENCE, work_through
from tests.console.scripted_feed import ScriptedFeed
from tests.features.questionnaires import scene
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.message_feed import Incoming
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.features.questionnaires.terminal import ParticipantApp
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import QuestionnaireWords
from woz_tui.system.clock import ManualClock

#: Keys that play, mark, open, suspend or leave on a wizard's console.
WIZARDS = ["h", "f1", "space", "full_stop", "slash", "colon", "backspace", "up", "ctrl+t"]
WIZARDS += ["ctrl+r", "ctrl+z", "ctrl+p", "question_mark", "asterisk", "tab", "enter", "ctrl+e"]


@dataclass
class ParticipantPilot:
    app: ParticipantApp
    feed: ScriptedFeed
    pilot: Pilot[str]
    clock: ManualClock

    def drawn(self) -> str:
        strips = self.app.screen._compositor.render_strips()
        return "\n".join("".join(segment.text for segment in strip) for strip in strips)

    async def settle(self) -> None:
        for _ in range(3):
            await work_through(self.pilot)

    async def tell(self, *messages: Incoming) -> None:
        await asyncio.to_thread(self.feed.deliver, *messages)
        await self.settle()
        self.app.wake()
        await self.settle()

    async def press(self, *keys: str) -> None:
        for key in keys:
            await self.pilot.press(key)
        self.app.wake()
        await self.settle()

    def kinds(self) -> set[str]:
        return {type(asked).__name__ for asked in self.feed.asked}


@asynccontextmanager
async def seated(
    *first: Incoming, size: tuple[int, int] = (80, 24), only: str = ""
) -> AsyncIterator[ParticipantPilot]:
    feed = ScriptedFeed()
    feed.begin_with(*(first or (study_scene.welcome(role="participant"),)))
    clock = ManualClock()
    app = ParticipantApp(feed, Keyboard(feed), only=only, clock=clock)
    async with app.run_test(size=size) as pilot:
        participant_pilot = ParticipantPilot(app, feed, pilot, clock)
        await participant_pilot.settle()
        app.wake()
        await participant_pilot.settle()
        yield participant_pilot


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_it_waits_asks_and_thanks(size: tuple[int, int]) -> None:
    async with seated(size=size) as pilot:
        assert "Please wait." in pilot.drawn()
        await pilot.tell(scene.questionnaire_started(study_scene.QUICK))
        assert "This visit" in pilot.drawn()
        await pilot.press("enter", "6")
        pilot.clock.advance(0.5)
        await pilot.press("enter")
        answer = pilot.feed.last(AskAnswer)
        assert isinstance(answer, AskAnswer)
        assert (answer.item, answer.value) == ("pleasant", 6.0)
        ended = pilot.feed.last(AskQuestionnaire)
        assert isinstance(ended, AskQuestionnaire)
        assert ended.what == "done"
        await pilot.tell(scene.questionnaire_ended("quick"))
        assert "Thank you!" in pilot.drawn()
        assert pilot.app.is_running


async def test_it_speaks_the_language_of_the_experiment() -> None:
    words = QuestionnaireWords(wait="Bitte warten.", thanks="Danke!", questions_one="1 Frage.")
    study = study_scene.study_description(words=msgspec.to_builtins(words))
    first = study_scene.welcome(role="participant", study=study)
    async with seated(first) as pilot:
        assert pilot.drawn().split() == ["Bitte", "warten."]
        await pilot.tell(scene.questionnaire_started(study_scene.QUICK))
        assert "1 Frage." in pilot.drawn()
        await pilot.tell(scene.questionnaire_ended("quick"))
        assert "Danke!" in pilot.drawn()


async def test_it_shows_nothing_of_the_session() -> None:
    first = study_scene.welcome(*scenes.sensors(), role="participant", recent=scenes.history())
    async with seated(first, size=(160, 50)) as pilot:
        assert pilot.drawn().split() == ["Please", "wait."]


async def test_no_key_plays_marks_releases_or_opens_anything() -> None:
    async with seated() as pilot:
        await pilot.tell(m.StopPressed(source="key", t=study_scene.NOW))
        await pilot.press(*WIZARDS)
        assert pilot.kinds() == set()
        await pilot.tell(
            m.StopReleased(source="key", t=study_scene.NOW), scene.questionnaire_started()
        )
        await pilot.press("h", "f1", "ctrl+r", "ctrl+z", "ctrl+t", "full_stop", "asterisk")
        assert pilot.kinds() == set()
        for chord in ("h", "ctrl+r", "ctrl+z", ".", "up"):
            assert pilot.app.keyboard.arrive(chord) is False
        assert pilot.kinds() == set()


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
async def test_the_stop_works_as_everywhere(key: str) -> None:
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started())
        await pilot.press("enter", key)
        assert pilot.kinds() == {"AskStop"}
        assert pilot.app.is_running
        assert "How pleasant" in pilot.drawn()


async def test_it_is_left_by_the_wizards_key_alone() -> None:
    async with seated() as pilot:
        await pilot.press("q", "ctrl+d", "ctrl+z", "enter")
        assert pilot.app.is_running
        await pilot.pilot.press("ctrl+q")
        await pilot.pilot.pause()
        assert pilot.app.return_value == "detached"


async def test_a_lost_line_keeps_the_answers_and_sends_them_again() -> None:
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started())
        await pilot.press("enter")
        pilot.feed.answers[AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await pilot.press("6")
        await asyncio.to_thread(pilot.feed.cut, "gone")
        await pilot.settle()
        pilot.app.wake()
        await pilot.settle()
        assert "Just a moment" in pilot.drawn()
        del pilot.feed.answers[AskAnswer]
        await pilot.tell(study_scene.welcome(scene.questionnaire_started(), role="participant"))
        sent = [asked for asked in pilot.feed.asked if isinstance(asked, AskAnswer)]
        assert [(ask_answer.item, ask_answer.value) for ask_answer in sent] == [
            ("pleasant", 6.0)
        ] * 2
        assert "2 of 4" in pilot.drawn()


#: A scale, then a text.
TWO: dict[str, m.Json] = {
    **study_scene.QUICK,
    "items": [study_scene.SCALES[0], study_scene.SCALES[3]],
}


async def lost(pilot: ParticipantPilot) -> None:
    await asyncio.to_thread(pilot.feed.cut, "gone")
    await pilot.settle()
    pilot.app.wake()
    await pilot.settle()
    assert "Just a moment" in pilot.drawn()


async def test_a_text_that_was_not_confirmed_is_kept_as_answers_are() -> None:
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started(TWO))
        await pilot.press("enter", "6", *"kind")
        for away, back in (("ctrl+d", "n"), ("up", "down")):
            await pilot.press(away)
            assert "kind" not in pilot.drawn()
            await pilot.press(back, "!")
            assert "kind!" in pilot.drawn()
        await lost(pilot)
        assert "kind" not in pilot.drawn()
        await pilot.tell(study_scene.welcome(scene.questionnaire_started(TWO), role="participant"))
        assert "kind!!" in pilot.drawn()
        pilot.clock.advance(1)
        await pilot.press("backspace", "backspace", "enter")
        asked = pilot.feed.last(AskAnswer)
        assert isinstance(asked, AskAnswer)
        assert asked.text == "kind"


async def test_a_text_that_was_left_out_after_all_does_not_come_back() -> None:
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started(TWO))
        await pilot.press("enter", "6", *"kind", "ctrl+d", "n")
        pilot.clock.advance(1)
        await pilot.press("tab")
        pilot.clock.advance(1)
        await pilot.press("enter" if "finish" not in pilot.drawn() else "backspace")
        assert "Anything else?" in pilot.drawn()
        assert "kind" not in pilot.drawn()


async def test_the_next_participant_gets_nothing_of_the_one_before() -> None:
    """The line is away while one round ends and the next one of the same questionnaire begins."""
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started(TWO))
        pilot.feed.answers[AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await pilot.press("enter", "6", *"kind")
        await lost(pilot)
        sent = len(pilot.feed.asked)
        later = scene.questionnaire_started(TWO, t=study_scene.NOW + 60 * study_scene.SECOND)
        await pilot.tell(study_scene.welcome(later, role="participant"))
        assert len(pilot.feed.asked) == sent
        await pilot.press("enter")
        assert "1 of 2" in pilot.drawn()
        await pilot.press("3")
        assert "Anything else?" in pilot.drawn()
        assert "kind" not in pilot.drawn()


async def test_the_end_of_the_session_ends_it() -> None:
    async with seated() as pilot:
        await pilot.tell(m.SessionEnd(reason="wizard", t=study_scene.NOW))
        await asyncio.to_thread(pilot.feed.cut, "gone")
        deadline = asyncio.get_running_loop().time() + PATIENCE
        while pilot.app.return_value is None and asyncio.get_running_loop().time() < deadline:
            await pilot.pilot.pause(0.01)
        assert pilot.app.return_value == "ended"


async def test_one_questionnaire_alone_begins_when_it_is_due() -> None:
    async with seated(only="quick") as pilot:
        await pilot.tell(scene.questionnaire_started())
        assert "Please wait." in pilot.drawn()
        await pilot.tell(scene.questionnaire_ended(), study_scene.trial(1))
        assert pilot.kinds() == set()
        await pilot.tell(m.TrialEnded(trial=1, outcome="done", t=study_scene.NOW))
        asked = pilot.feed.last(AskQuestionnaire)
        assert isinstance(asked, AskQuestionnaire)
        assert (asked.questionnaire, asked.what) == ("quick", "begin")
        await pilot.tell(scene.questionnaire_started(study_scene.QUICK))
        assert "This visit" in pilot.drawn()
        begun = [each for each in pilot.feed.asked if isinstance(each, AskQuestionnaire)]
        await pilot.tell(scene.questionnaire_ended("quick", "left"))
        again = [each for each in pilot.feed.asked if isinstance(each, AskQuestionnaire)]
        assert again == begun, "the wizard has left it, and begins it again if need be"
        await pilot.tell(study_scene.trial(2))
        await pilot.tell(m.TrialEnded(trial=2, outcome="done", t=study_scene.NOW))
        again = [each for each in pilot.feed.asked if isinstance(each, AskQuestionnaire)]
        assert len(again) == len(begun) + 1


async def test_a_request_that_was_lost_with_the_line_is_made_again() -> None:
    over = study_scene.trial(1), m.TrialEnded(trial=1, outcome="done", t=study_scene.NOW)
    async with seated(only="quick") as pilot:
        pilot.feed.answers[AskQuestionnaire] = lambda sent, ref: r.Reply(ref=-1, ok=True)  # lost
        await pilot.tell(*over)
        asked = pilot.feed.asked
        assert sum(isinstance(each, AskQuestionnaire) for each in asked) == 1
        await lost(pilot)
        await pilot.tell(study_scene.welcome(*over, role="participant"))
        assert sum(isinstance(each, AskQuestionnaire) for each in asked) == 2


async def test_who_stops_the_robot_amid_a_questionnaire_reads_so_and_goes_on() -> None:
    async with seated() as pilot:
        await pilot.tell(scene.questionnaire_started(study_scene.QUICK))
        await pilot.press("enter", "escape")
        assert pilot.feed.last(r.AskStop) is not None
        await pilot.tell(m.StopPressed(source="the participant", t=study_scene.NOW))
        assert "The robot has been stopped." in pilot.drawn()
        assert "How pleasant was it" in pilot.drawn()
        await pilot.press("6")
        assert pilot.feed.last(AskAnswer) is not None
        await pilot.tell(m.StopReleased(source="key", t=study_scene.NOW))
        assert "stopped" not in pilot.drawn()
