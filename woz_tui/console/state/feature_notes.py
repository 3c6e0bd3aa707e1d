"""Sentences for the wizard, and what features keep for a screen to say them."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple, TypeVar, cast

from woz_tui.feature import pieces
from woz_tui.protocol import messages as m
from woz_tui.timeline.session_state import SessionState

log = logging.getLogger(__name__)


class StudyNews(NamedTuple):
    """A sentence for the wizard and its look. `right`: names of the actions that would have been
    right instead; `command`: that of the console which helps, and what to do with it. `run`: of
    which action it is true; if that is refused, it is not said.
    """

    text: str
    look: str
    right: tuple[str, ...] = ()
    command: tuple[str, str] = ("", "")
    run: str = ""


class FeatureNotes:
    """What a feature keeps for a screen, beside what its history keeps of the session."""

    #: The kinds of messages that it keeps something of.
    hears: ClassVar[tuple[type[m.Message], ...]] = ()

    def __init__(self, session: SessionState) -> None:
        self.session = session

    def apply(self, message: Any) -> StudyNews | None:
        """Work a message in that `session` has taken; a sentence of it for the wizard, if any."""
        return None

    def follow(self) -> None:
        """Take over what `session` holds, which may have come without its messages."""

    def keep(self, before: Any) -> None:
        """Keep what the same notes had before the line to the session was lost: the last messages,
        which come anew, may not reach back so far.
        """


N = TypeVar("N", bound=FeatureNotes)


class AllNotes:
    """The notes of all features on one screen. Those that raise are named, and kept no more."""

    def __init__(self, session: SessionState) -> None:
        kinds: list[type[FeatureNotes]] = [*pieces("notes", type).values()]
        self._all = {kind: kind(session) for kind in kinds}

    def of(self, kind: type[N]) -> N | None:
        """A feature's notes; None if they have failed."""
        return cast("N | None", self._all.get(kind))

    def apply(self, message: m.Message) -> Iterator[StudyNews]:
        """Work a message in; the sentences of it."""
        for kind, notes in [*self._all.items()]:
            if not isinstance(message, kind.hears):
                continue
            try:
                news = notes.apply(message)
            except Exception:  # noqa: BLE001 - of others: the rest has to go on
                self._give_up(kind)
            else:
                if news is not None:
                    yield news

    def follow(self) -> None:
        """Take over what the session holds."""
        for kind, notes in [*self._all.items()]:
            try:
                notes.follow()
            except Exception:  # noqa: BLE001 - of others: the rest has to go on
                self._give_up(kind)

    def keep(self, before: AllNotes) -> None:
        """Keep what these had of the same session."""
        for kind, notes in [*self._all.items()]:
            if (old := before.of(kind)) is not None:
                try:
                    notes.keep(old)
                except Exception:  # noqa: BLE001 - of others: the rest has to go on
                    self._give_up(kind)

    def _give_up(self, kind: type[FeatureNotes]) -> None:
        log.exception("%s failed", kind.__name__)
        del self._all[kind]
