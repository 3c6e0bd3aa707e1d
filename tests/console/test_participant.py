"""The participant's own terminal: a questionnaire or nothing, and no key plays the robot."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import msgspec
import pytest
from textual.pilot import Pilot

from tests.console import scenes, studied
from tests.console.driving import PATIENCE
from tests.console.scripted import ScriptedFeed
from woz_tui.console.keyboard import Keyboard
from woz_tui.console.message_feed import Incoming
from woz_tui.console.participant_app import ParticipantApp
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import QuestionnaireWords
from woz_tui.system.clock import ManualClock

#: Keys that play, mark, open, suspend or leave on a wizard's console.
WIZARDS = ["h", "f1", "space", "full_stop", "slash", "colon", "backspace", "up", "ctrl+t"]
WIZARDS += ["ctrl+r", "ctrl+z", "ctrl+p", "question_mark", "asterisk", "tab", "enter", "ctrl+e"]


@dataclass
class Seat:
    app: ParticipantApp
    feed: ScriptedFeed
    pilot: Pilot[str]
    clock: ManualClock

    def drawn(self) -> str:
        strips = self.app.screen._compositor.render_strips()
        return "\n".join("".join(segment.text for segment in strip) for strip in strips)

    async def settle(self) -> None:
        for _ in range(3):
            await self.pilot.pause(0)

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
) -> AsyncIterator[Seat]:
    feed = ScriptedFeed()
    feed.begin_with(*(first or (studied.welcome(role="participant"),)))
    clock = ManualClock()
    app = ParticipantApp(feed, Keyboard(feed), only=only, clock=clock)
    async with app.run_test(size=size) as pilot:
        seat = Seat(app, feed, pilot, clock)
        await seat.settle()
        app.wake()
        await seat.settle()
        yield seat


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_it_waits_asks_and_thanks(size: tuple[int, int]) -> None:
    async with seated(size=size) as seat:
        assert "Please wait." in seat.drawn()
        await seat.tell(studied.started(studied.QUICK))
        assert "This visit" in seat.drawn()
        await seat.press("enter", "6")
        seat.clock.advance(0.5)
        await seat.press("enter")
        answer = seat.feed.last(r.AskAnswer)
        assert isinstance(answer, r.AskAnswer)
        assert (answer.item, answer.value) == ("pleasant", 6.0)
        ended = seat.feed.last(r.AskQuestionnaire)
        assert isinstance(ended, r.AskQuestionnaire)
        assert ended.what == "done"
        await seat.tell(studied.ended("quick"))
        assert "Thank you!" in seat.drawn()
        assert seat.app.is_running


async def test_it_speaks_the_language_of_the_experiment() -> None:
    words = QuestionnaireWords(wait="Bitte warten.", thanks="Danke!", questions_one="1 Frage.")
    study = studied.told(words=msgspec.to_builtins(words))
    first = studied.welcome(role="participant", study=study)
    async with seated(first) as seat:
        assert seat.drawn().split() == ["Bitte", "warten."]
        await seat.tell(studied.started(studied.QUICK))
        assert "1 Frage." in seat.drawn()
        await seat.tell(studied.ended("quick"))
        assert "Danke!" in seat.drawn()


async def test_it_shows_nothing_of_the_session() -> None:
    first = studied.welcome(*scenes.sensors(), role="participant", recent=scenes.history())
    async with seated(first, size=(160, 50)) as seat:
        assert seat.drawn().split() == ["Please", "wait."]


async def test_no_key_plays_marks_releases_or_opens_anything() -> None:
    async with seated() as seat:
        await seat.tell(m.StopPressed(source="key", t=studied.NOW))
        await seat.press(*WIZARDS)
        assert seat.kinds() == set()
        await seat.tell(m.StopReleased(source="key", t=studied.NOW), studied.started())
        await seat.press("h", "f1", "ctrl+r", "ctrl+z", "ctrl+t", "full_stop", "asterisk")
        assert seat.kinds() == set()
        for chord in ("h", "ctrl+r", "ctrl+z", ".", "up"):
            assert seat.app.keyboard.arrive(chord) is False
        assert seat.kinds() == set()


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
async def test_the_stop_works_as_everywhere(key: str) -> None:
    async with seated() as seat:
        await seat.tell(studied.started())
        await seat.press("enter", key)
        assert seat.kinds() == {"AskStop"}
        assert seat.app.is_running
        assert "How pleasant" in seat.drawn()


async def test_it_is_left_by_the_wizards_key_alone() -> None:
    async with seated() as seat:
        await seat.press("q", "ctrl+d", "ctrl+z", "enter")
        assert seat.app.is_running
        await seat.pilot.press("ctrl+q")
        await seat.pilot.pause()
        assert seat.app.return_value == "detached"


async def test_a_lost_line_keeps_the_answers_and_sends_them_again() -> None:
    async with seated() as seat:
        await seat.tell(studied.started())
        await seat.press("enter")
        seat.feed.answers[r.AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await seat.press("6")
        await asyncio.to_thread(seat.feed.cut, "gone")
        await seat.settle()
        seat.app.wake()
        await seat.settle()
        assert "Just a moment" in seat.drawn()
        del seat.feed.answers[r.AskAnswer]
        await seat.tell(studied.welcome(studied.started(), role="participant"))
        sent = [asked for asked in seat.feed.asked if isinstance(asked, r.AskAnswer)]
        assert [(asked.item, asked.value) for asked in sent] == [("pleasant", 6.0)] * 2
        assert "2 of 4" in seat.drawn()


#: A scale, then a text.
TWO: dict[str, m.Json] = {**studied.QUICK, "items": [studied.SCALES[0], studied.SCALES[3]]}


async def lost(seat: Seat) -> None:
    await asyncio.to_thread(seat.feed.cut, "gone")
    await seat.settle()
    seat.app.wake()
    await seat.settle()
    assert "Just a moment" in seat.drawn()


async def test_a_text_that_was_not_confirmed_is_kept_as_answers_are() -> None:
    async with seated() as seat:
        await seat.tell(studied.started(TWO))
        await seat.press("enter", "6", *"kind")
        for away, back in (("ctrl+d", "n"), ("up", "down")):
            await seat.press(away)
            assert "kind" not in seat.drawn()
            await seat.press(back, "!")
            assert "kind!" in seat.drawn()
        await lost(seat)
        assert "kind" not in seat.drawn()
        await seat.tell(studied.welcome(studied.started(TWO), role="participant"))
        assert "kind!!" in seat.drawn()
        seat.clock.advance(1)
        await seat.press("backspace", "backspace", "enter")
        asked = seat.feed.last(r.AskAnswer)
        assert isinstance(asked, r.AskAnswer)
        assert asked.text == "kind"


async def test_a_text_that_was_left_out_after_all_does_not_come_back() -> None:
    async with seated() as seat:
        await seat.tell(studied.started(TWO))
        await seat.press("enter", "6", *"kind", "ctrl+d", "n")
        seat.clock.advance(1)
        await seat.press("tab")
        seat.clock.advance(1)
        await seat.press("enter" if "finish" not in seat.drawn() else "backspace")
        assert "Anything else?" in seat.drawn()
        assert "kind" not in seat.drawn()


async def test_the_next_participant_gets_nothing_of_the_one_before() -> None:
    """The line is away while one round ends and the next one of the same questionnaire begins."""
    async with seated() as seat:
        await seat.tell(studied.started(TWO))
        seat.feed.answers[r.AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await seat.press("enter", "6", *"kind")
        await lost(seat)
        sent = len(seat.feed.asked)
        later = studied.started(TWO, t=studied.NOW + 60 * studied.SECOND)
        await seat.tell(studied.welcome(later, role="participant"))
        assert len(seat.feed.asked) == sent
        await seat.press("enter")
        assert "1 of 2" in seat.drawn()
        await seat.press("3")
        assert "Anything else?" in seat.drawn()
        assert "kind" not in seat.drawn()


async def test_the_end_of_the_session_ends_it() -> None:
    async with seated() as seat:
        await seat.tell(m.SessionEnd(reason="wizard", t=studied.NOW))
        await asyncio.to_thread(seat.feed.cut, "gone")
        deadline = asyncio.get_running_loop().time() + PATIENCE
        while seat.app.return_value is None and asyncio.get_running_loop().time() < deadline:
            await seat.pilot.pause(0.01)
        assert seat.app.return_value == "ended"


async def test_one_questionnaire_alone_begins_when_it_is_due() -> None:
    async with seated(only="quick") as seat:
        await seat.tell(studied.started())
        assert "Please wait." in seat.drawn()
        await seat.tell(studied.ended(), studied.trial(1))
        assert seat.kinds() == set()
        await seat.tell(m.TrialEnded(trial=1, outcome="done", t=studied.NOW))
        asked = seat.feed.last(r.AskQuestionnaire)
        assert isinstance(asked, r.AskQuestionnaire)
        assert (asked.questionnaire, asked.what) == ("quick", "begin")
        await seat.tell(studied.started(studied.QUICK))
        assert "This visit" in seat.drawn()
        begun = [each for each in seat.feed.asked if isinstance(each, r.AskQuestionnaire)]
        await seat.tell(studied.ended("quick", "left"))
        again = [each for each in seat.feed.asked if isinstance(each, r.AskQuestionnaire)]
        assert again == begun, "the wizard has left it, and begins it again if need be"
        await seat.tell(studied.trial(2))
        await seat.tell(m.TrialEnded(trial=2, outcome="done", t=studied.NOW))
        again = [each for each in seat.feed.asked if isinstance(each, r.AskQuestionnaire)]
        assert len(again) == len(begun) + 1


async def test_a_request_that_was_lost_with_the_line_is_made_again() -> None:
    over = studied.trial(1), m.TrialEnded(trial=1, outcome="done", t=studied.NOW)
    async with seated(only="quick") as seat:
        seat.feed.answers[r.AskQuestionnaire] = lambda sent, ref: r.Reply(ref=-1, ok=True)  # lost
        await seat.tell(*over)
        asked = seat.feed.asked
        assert sum(isinstance(each, r.AskQuestionnaire) for each in asked) == 1
        await lost(seat)
        await seat.tell(studied.welcome(*over, role="participant"))
        assert sum(isinstance(each, r.AskQuestionnaire) for each in asked) == 2


async def test_who_stops_the_robot_amid_a_questionnaire_reads_so_and_goes_on() -> None:
    async with seated() as seat:
        await seat.tell(studied.started(studied.QUICK))
        await seat.press("enter", "escape")
        assert seat.feed.last(r.AskStop) is not None
        await seat.tell(m.StopPressed(source="the participant", t=studied.NOW))
        assert "The robot has been stopped." in seat.drawn()
        assert "How pleasant was it" in seat.drawn()
        await seat.press("6")
        assert seat.feed.last(r.AskAnswer) is not None
        await seat.tell(m.StopReleased(source="key", t=studied.NOW))
        assert "stopped" not in seat.drawn()
