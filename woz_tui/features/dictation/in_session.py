"""Takes dictated texts in, and tells of which sentences they became."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from difflib import SequenceMatcher
from functools import partial
from typing import Any, ClassVar

from woz_tui.features.dictation.kinds import (
    AskDictated,
    AskDictation,
    Dictated,
    DictationListens,
    DictationSaid,
)
from woz_tui.features.proposals.clean_text import cleaned
from woz_tui.features.proposals.marks import words
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

#: Characters of a text at the most.
LONGEST = 2000
#: A typed sentence is taken for a dictated one if it is so like it, 0 to 1, by its characters.
LIKE = 0.5
#: Texts so many times as long as a sentence are not that like it.
_MOST = 2 / LIKE - 1
#: Pairs of characters that may be compared: nothing else happens meanwhile. Longer texts are
#: compared by their words.
_AT_ONCE = 2_000_000
#: Texts that may still be said: what came before them the wizard has left out.
WAITING = 6
#: A console in whose field something is dictated says so at least so often, in seconds.
SILENT_S = 2.5
#: What was said at last in the field may end so much later than the field, in microseconds.
_LATE_US = 1_000_000

NOT_OPEN = Sentence("dictation.not_open", "the field for dictation is not open")


class DictationInSession(SessionFeature):
    """Texts for the field of `say`, as long as it is open. They are no speech of a visitor."""

    requests = (AskDictated, AskDictation)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._count = 0
        self._waiting: list[Dictated] = []
        #: Whose field is open, and when it falls silent; when it was open, in the session's time.
        self._console = ""
        self._silence: asyncio.TimerHandle | None = None
        self._opened = self._shut = 0

    def idle(self) -> bool:
        return not self._waiting and not self._console

    def close(self) -> None:
        self._close("closed")

    def carry_out(self, request: AskDictated | AskDictation, client: Client) -> str:
        if isinstance(request, AskDictated):
            self._dictate(request, client)
        elif request.on:
            self._open(client, request.again)
        else:
            self.lose(client.console, "closed")
        return ""

    def _open(self, client: Client, again: bool) -> None:
        """Its field is open, or is still open."""
        if client.role != "wizard":
            raise RequestError(
                Sentence("dictation.only_wizard", "a wizard's console has the field for dictation")
            )
        if self._console not in ("", client.console):
            raise RequestError(
                Sentence("dictation.taken", "somebody dictates at another console already")
            )
        if again and not self._console:
            raise RequestError(NOT_OPEN)
        if self._silence is not None:
            self._silence.cancel()
        loop = asyncio.get_running_loop()
        self._silence = loop.call_later(SILENT_S, partial(self._close, "silent"))
        if not self._console:
            self._console, self._opened = client.console, self.session.hub.now()
            self.session.hub.publish(DictationListens(on=True, console=client.console))

    def _close(self, why: str) -> None:
        if self._silence is not None:
            self._silence.cancel()
            self._silence = None
        if self._console:
            console, self._console = self._console, ""
            self._shut = self.session.hub.now()
            self.session.hub.publish(DictationListens(on=False, console=console, why=why))

    def lose(self, console: str, why: str = "left") -> None:
        if console == self._console:
            self._close(why)

    def _stopped(self, message: m.StopPressed) -> None:
        self._close("stop")

    def _dictate(self, request: AskDictated, client: Client) -> None:
        if client.role != "program":
            raise RequestError(Sentence("dictation.only_dictation", "`woz dictate` dictates"))
        text = cleaned(request.text)[:LONGEST]
        if not text:
            raise RequestError(Sentence("dictation.nothing", "nothing was dictated"))
        ended = self.session.hub.now() - max(0, request.took_us)
        heard = ended <= self._shut + _LATE_US and self._shut > self._opened
        if ended < self._opened or not (self._console or heard):
            raise RequestError(
                NOT_OPEN,
                Sentence("dictation.opens_it", "a key of the console opens it: dictate"),
            )
        self._count += 1
        self._waiting.append(
            self.session.hub.publish(
                Dictated(
                    dictation=self._count,
                    text=text,
                    lasted_us=request.lasted_us,
                    took_us=request.took_us,
                    tells=client.tells,
                )
            )
        )
        del self._waiting[:-WAITING]

    def _sent(self, message: m.Command) -> None:
        """A typed sentence: perhaps what was dictated since the last one."""
        text = message.args.get("text")
        if message.verb != "say" or message.source != "key" or message.run or not self._waiting:
            return
        if not isinstance(text, str) or len(text) > LONGEST:
            return
        found = _likest(self._waiting, text)
        if found is None:
            return
        likeness, said = found
        self.session.hub.publish(
            DictationSaid(
                command=message.command,
                dictations=[each.dictation for each in said],
                distance=round(1 - likeness, 3),
                after_us=message.t - said[-1].t,
                tells=said[-1].tells,
            )
        )
        del self._waiting[: self._waiting.index(said[-1]) + 1]

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {
        m.Command: _sent,
        m.StopPressed: _stopped,
    }


def _likest(waiting: Sequence[Dictated], text: str) -> tuple[float, Sequence[Dictated]] | None:
    """Which of the dictated texts a typed sentence was, one behind the other, and how like it they
    are; None: it is another sentence. The wizard may have taken others out of the field.
    """
    best, found, joined = 0.0, waiting[-1:], waiting[-1].text
    for first in range(len(waiting)):
        for end in range(first + 1, len(waiting) + 1):
            whole = " ".join(each.text for each in waiting[first:end])
            if len(whole) > _MOST * len(text):
                break  # it cannot be like enough, and would take long
            ratio = SequenceMatcher(None, words(whole), words(text), autojunk=False).ratio()
            if ratio >= best:
                best, found, joined = ratio, waiting[first:end], whole
    if len(joined) * len(text) <= _AT_ONCE:
        best = SequenceMatcher(None, joined, text, autojunk=False).ratio()
    return (best, found) if best >= LIKE else None
