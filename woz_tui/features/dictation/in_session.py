"""Takes dictated texts in, and tells of which sentences they became."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any, ClassVar

from woz_tui.features.dictation.kinds import AskDictated, Dictated, DictationSaid
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


class DictationInSession(SessionFeature):
    """Texts that wait in the field of `say`. They are no speech of a visitor."""

    requests = (AskDictated,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._count = 0
        self._waiting: list[Dictated] = []

    def idle(self) -> bool:
        return not self._waiting

    def carry_out(self, request: AskDictated, client: Client) -> str:
        if client.role != "program":
            raise RequestError(Sentence("dictation.only_dictation", "`woz dictate` dictates"))
        text = cleaned(request.text)[:LONGEST]
        if not text:
            raise RequestError(Sentence("dictation.nothing", "nothing was dictated"))
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
        return ""

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

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {m.Command: _sent}


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
