"""Somebody who answers in a browser: a connection of its own, and where this page stands.

What was answered is kept by the session, so that a page can be loaded anew at any moment, on
another tablet too. Here is only what belongs to the page itself.
"""

from __future__ import annotations

import asyncio
import base64
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.console.link.message_feed import GONE, Incoming, Loss
from woz_tui.features.choices.history import ChoiceHistory
from woz_tui.features.choices.kinds import AskChoicePicture, AskChoose, ChoiceOffered
from woz_tui.features.page.follower import SessionFollower
from woz_tui.features.page.item_forms import UnreadAnswerError, answer_of
from woz_tui.features.page.news import News, within
from woz_tui.features.questionnaires.answers import OpenQuestionnaire, answer_told
from woz_tui.features.questionnaires.console import questionnaires_of
from woz_tui.features.questionnaires.items import DOES_NOT_APPLY, PREFER_NOT, SKIPPED, ways_out
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    AskQuestionnaire,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol.messages import SessionChanged
from woz_tui.protocol.welcome import QuestionnaireItem, QuestionnaireWords
from woz_tui.system.clock import Clock
from woz_tui.system.tasks import end_tasks

#: Seconds for which the session may take to say what holds.
_WELCOME_S = 3.0
#: Forms whose second sending is known.
_FORMS = 50
#: What ends a questionnaire.
_ENDS = ("done", "declined")
#: What leaves an item without an answer, and the reason that is stored.
_WAYS = {"skip": "", DOES_NOT_APPLY: DOES_NOT_APPLY, PREFER_NOT: PREFER_NOT}


def choosing(place: int) -> str:
    """What a form says by whose button the option at this place is chosen."""
    return f"choose-{place}"


class SelfBegun:
    """A questionnaire that begins by itself when the participant opens the page, on whichever
    tablet, once for each participant: one that was taken back does not come again.

    Args:
        name: Which; empty: none.
        begin: Begins it where it is not due, which a participant may not; whether it has.
    """

    def __init__(self, name: str, begin: Callable[[str], Awaitable[bool]]) -> None:
        self.name, self.begin = name, begin
        #: For whom it has begun.
        self.had: set[str | None] = set()


class NotSentError(Exception):
    """The robot process does not answer: nobody knows whether it came."""


class ParticipantSeat:
    """One browser in which somebody answers.

    Args:
        path: The session's socket.
        clock: For how long something was on the page, where the page itself does not say.
        explain: As for `HostConnection`.
        name: What the wizard's events call it.
        failed: Is told what has failed, and why.
        begins: What begins by itself, of all seats together.
    """

    def __init__(
        self,
        path: Path,
        clock: Clock,
        explain: Callable[[Loss], Loss] | None,
        name: str,
        *,
        failed: Callable[[str, BaseException], None],
        begins: SelfBegun,
    ) -> None:
        self.follower = SessionFollower(
            path, "participant", explain, clock, heard=self._hear, name=name, failed=failed
        )
        self._failed, self._begins = failed, begins
        #: How many participants have come since this page is open.
        self._people = 0
        self.news = News()
        #: Whether the last questionnaire is over, so that somebody is to be thanked.
        self.thanks = False
        #: Why the last form was not taken.
        self.complaint = ""
        self._clock = clock
        self._introduced: object = None
        #: Instructions that were read, and items that may be left out now that they were asked for
        #: once more, each with its round.
        self._read: set[tuple[str, str]] = set()
        self._asked_again: set[tuple[str, str]] = set()
        self._shown: tuple[object, str] = (None, "")
        self._shown_us = 0
        self._forms = 0
        #: What the last forms said, by their numbers.
        self._sent: dict[str, Mapping[str, Any]] = {}
        self._one = asyncio.Lock()
        self._started = asyncio.Event()
        self._joining: asyncio.Task[None] | None = None
        self._following: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Join the session, unless that is done; returns when it has told what holds. Raises
        `ConnectionError`.
        """
        failed = self._joining is not None and self._joining.done() and self._following is None
        if self._joining is None or failed:
            self._joining = asyncio.create_task(self._join(), name="participant's page")
        await asyncio.shield(self._joining)

    async def _join(self) -> None:
        await self.follower.start()
        await within(_WELCOME_S, self.follower.news.wait())
        self._following = asyncio.create_task(self._follow(), name="participant's news")

    async def _follow(self) -> None:
        while True:
            self.follower.news.clear()
            try:
                self.publish()
            except Exception as error:  # noqa: BLE001 - what comes next may be told again
                self._failed("the participant's page", error)
            await self.follower.news.wait()

    async def close(self) -> None:
        """Leave the session."""
        await end_tasks(self._joining, self._following)
        self.news.close()
        self.follower.close()

    async def begin_by_itself(self) -> None:
        """Begin the questionnaire that is to begin when the page is opened."""
        state, name = self.follower.state, self._begins.name
        free = name and not self.lost and self.asked is None and not state.ended
        if not free or name in questionnaires_of(state).history.had:
            return
        participant = state.session.study.participant
        if participant in self._begins.had:
            return
        self._begins.had.add(participant)
        self._started.clear()
        due = await self.follower.ask(AskQuestionnaire(questionnaire=name, source="participant"))
        if due.ok or await self._begins.begin(name):
            await within(_WELCOME_S, self._started.wait())
        else:
            self._begins.had.discard(participant)

    # -- what holds -----------------------------------------------------------------------------

    @property
    def asked(self) -> OpenQuestionnaire | None:
        """The questionnaire that is put to somebody now."""
        return questionnaires_of(self.follower.state).open

    @property
    def offered(self) -> ChoiceOffered | None:
        """The choice that somebody has now; a questionnaire goes before it."""
        history = self.follower.state.session.history(ChoiceHistory)
        return history.offered if self.asked is None else None

    @property
    def words(self) -> QuestionnaireWords:
        """What the page says by itself."""
        return self.follower.state.settings.study.words

    @property
    def lost(self) -> bool:
        """Whether the robot process cannot be reached, although its session goes on."""
        state = self.follower.state
        return bool(state.lost or not state.welcomed) and not state.ended

    @property
    def round(self) -> str:
        """What is asked, in a word that is another one each time; a page of another round is to be
        loaded anew.
        """
        if self.lost:
            return "lost"
        asked, offered = self.asked, self.offered
        if offered is not None:
            return f"choice-{offered.seq}"
        if asked is not None:
            return f"{asked.began}-{asked.name}"
        return f"none-{self.thanks}-{self._people}"

    @property
    def introduced(self) -> bool:
        """Whether the introduction was read in this round."""
        asked = self.asked
        return asked is not None and (bool(asked.answers) or self._introduced == asked.round)

    @property
    def open_item(self) -> str:
        """The first item that nobody has answered, here or on another tablet, or an instruction
        before it that was not read here; empty: all are.
        """
        asked = self.asked
        if asked is None:
            return ""
        shown, first = asked.shown, asked.first_open()
        place = shown.index(asked.items[first]) if first < len(asked.items) else len(shown)
        before = place
        while before and shown[before - 1].asks == "page":
            before -= 1
        unread = (
            each.name for each in shown[before:place] if (self.round, each.name) not in self._read
        )
        return next(unread, shown[place].name if place < len(shown) else "")

    def ways(self, item: QuestionnaireItem) -> list[str]:
        """How an item can go without an answer now: one that wants to be asked for once more does
        not offer that before.
        """
        late = item.soft and (self.round, item.name) not in self._asked_again
        return [way for way in ways_out(item) if way != SKIPPED or not late]

    @property
    def notice(self) -> str:
        """What the page says beside everything else."""
        return self.words.stopped if self.follower.state.session.stop is not None else ""

    def publish(self) -> None:
        """Tell open pages what is asked."""
        told = {"round": self.round, "open": self.open_item, "notice": self.notice}
        self.news.publish(told)

    def _hear(self, message: Incoming) -> None:
        match message:
            case QuestionnaireEnded():
                self.thanks = message.reason != "left"
            case QuestionnaireStarted():
                self.thanks = False
                self._started.set()
            case ChoiceOffered():
                self.thanks = False
            case SessionChanged(participant=str()):
                self.thanks, self._people = False, self._people + 1

    # -- what is on the page --------------------------------------------------------------------

    def show(self, item: str) -> int:
        """An item is about to be shown; for how long it has been so far, in microseconds: a page
        that is loaded anew shows it still.
        """
        shown = (self.round, item)
        if shown != self._shown:
            self._shown, self._shown_us = shown, self._clock.now_us()
        return self._clock.now_us() - self._shown_us

    def next_form(self) -> str:
        """A number for a form, by which its second sending is known."""
        self._forms += 1
        return str(self._forms)

    # -- what is sent ---------------------------------------------------------------------------

    async def take(self, form: Mapping[str, Any]) -> None:
        """Work in a form that was sent. One that was sent twice, by a double tap or by loading a
        page anew, counts once. Raises `NotSentError`.
        """
        async with self._one:
            number = str(form.get("form", ""))
            if self.lost:
                raise NotSentError
            if form.get("round") != self.round or self._sent.get(number) == form:
                return
            self.complaint = ""
            if (asked := self.asked) is not None:
                await self._take(asked, form)
            elif (offered := self.offered) is not None:
                await self._choose(offered, form)
            self._sent[number] = form
            if len(self._sent) > _FORMS:
                del self._sent[next(iter(self._sent))]

    async def _take(self, asked: OpenQuestionnaire, form: Mapping[str, Any]) -> None:
        what = form.get("what", "")
        if what == "begin":
            self._introduced = asked.round
        elif what == "seen":
            self._read.add((self.round, str(form.get("item", ""))))
        elif what in _ENDS:
            await self._ask(
                AskQuestionnaire(questionnaire=asked.name, what=what, source="participant")
            )
        elif item := next((each for each in asked.items if each.name == form.get("item")), None):
            await self._answer(asked, item, form)

    async def _choose(self, offered: ChoiceOffered, form: Mapping[str, Any]) -> None:
        chosen = [
            option
            for place, option in enumerate(offered.options)
            if form.get("what") == choosing(place)
        ]
        if chosen:
            took_us = self._took_us(self.round, form)
            await self._ask(AskChoose(offer=offered.seq, option=chosen[0], after_us=took_us))

    async def picture(self, offer: int, place: int) -> tuple[str, bytes]:
        """The picture of an option, its type and what it holds. Raises `LookupError`."""
        reply = await self.follower.ask(AskChoicePicture(offer=offer, place=place))
        match reply.data:
            case {"type": str(kind), "bytes": str(content)} if reply.ok:
                return kind, base64.b64decode(content)
        raise LookupError(reply.reason)

    async def _answer(
        self, asked: OpenQuestionnaire, item: QuestionnaireItem, form: Mapping[str, Any]
    ) -> None:
        what = str(form.get("what"))
        if what in _WAYS:
            reason = _WAYS[what]
            answer = AskAnswer(
                questionnaire="", item=item.name, skipped=True, reason=reason, given="browser"
            )
        else:
            try:
                answer = answer_of(item, form, self.words)
            except UnreadAnswerError as error:
                self.complaint = self.words.soft_button if item.soft else str(error)
                self._asked_again.add((self.round, item.name))
                return
        took_us = self._took_us(item.name, form)
        answer = msgspec.structs.replace(answer, questionnaire=asked.name, answered_us=took_us)
        if await self._ask(answer):
            asked.answers[item.name] = answer_told(answer)
            self._shown = (None, "")

    def _took_us(self, item: str, form: Mapping[str, Any]) -> int:
        """How long an item was shown, by the page's own clock; it cannot be longer than since the
        page was given away.
        """
        here = self.show(item)
        try:
            return min(here, max(0, round(float(form["took"]) * 1000)))
        except (KeyError, ValueError, OverflowError):
            return here  # a browser without JavaScript

    async def _ask(self, request: AskAnswer | AskQuestionnaire | AskChoose) -> bool:
        """Whether the session took it; a refusal becomes the complaint."""
        reply = await self.follower.ask(request)
        if reply.reason == GONE:
            raise NotSentError
        self.complaint = "" if reply.ok else self.words.refused
        return reply.ok
