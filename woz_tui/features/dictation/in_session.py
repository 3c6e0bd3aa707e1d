"""Takes dictated texts in, and tells of which sentences they became."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from difflib import SequenceMatcher
from typing import Any, ClassVar

from woz_tui.features.dictation.kinds import AskDictated, Dictated, DictationSaid
from woz_tui.features.proposals.clean_text import cleaned
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

#: Characters of a text at the most.
LONGEST = 2000
#: A typed sentence is taken for a dictated one if it is so like it, 0 to 1, by its characters.
LIKE = 0.5


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
        return ""

    def _sent(self, message: m.Command) -> None:
        """A typed sentence: perhaps what was dictated since the last one."""
        text = message.args.get("text")
        if message.verb != "say" or message.source != "key" or message.run or not self._waiting:
            return
        if not isinstance(text, str):
            return
        whole = " ".join(each.text for each in self._waiting)
        likeness = SequenceMatcher(None, whole, text, autojunk=False).ratio()
        if likeness < LIKE:
            return
        last = self._waiting[-1]
        self.session.hub.publish(
            DictationSaid(
                command=message.command,
                dictations=[each.dictation for each in self._waiting],
                distance=round(1 - likeness, 3),
                after_us=message.t - last.t,
                tells=last.tells,
            )
        )
        self._waiting.clear()

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {m.Command: _sent}
