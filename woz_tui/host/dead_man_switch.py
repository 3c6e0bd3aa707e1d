"""Lets the robot drive while the wizard watches who plays the part that drives, and no longer."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from woz_tui.host.client_connection import ClientConnection
from woz_tui.protocol import messages as m
from woz_tui.session.session import Session

#: Why nobody drives.
NOBODY = "no wizard's console is attached"


def console_of(part: str) -> str:
    """What a sentence calls the console that plays `part`."""
    return f"the console that plays {part}" if part else "the wizard's console"


class DeadManSwitch:
    """Allows to drive, and ends it.

    What a wizard has asked for drives while the player of that wizard's part watches. What nobody's
    part has asked for (a program, a control panel) drives while one of those watches whose part
    drives (see `PartLimits.drivers`).

    Args:
        session: Whose bus drives.
        wizards: Gives the consoles that play at the moment.
    """

    def __init__(self, session: Session, wizards: Callable[[], Sequence[ClientConnection]]) -> None:
        self._session = session
        self._wizards = wizards
        #: Console -> the part it played last.
        self._parts: dict[str, str] = {}
        #: Parts that have driven since driving was ended last; None: what belongs to no part.
        self._drove: set[str | None] = set()
        #: Parts that watched over what belongs to none.
        self._watching: set[str] = set()
        session.bus.unwatched = NOBODY
        session.bus.watch = self._why_not

    def update(self) -> None:
        """Consoles came, went, fell silent or were heard again: end driving for which nobody is
        responsible any more.
        """
        bus, wizards = self._session.bus, self._wizards()
        self._parts |= {each.name: each.part for each in wizards}
        drivers = self._session.parts.drivers(self._driving_verbs())
        responsible = [each for each in wizards if each.name in drivers]
        watching = {each.part for each in responsible if not each.silent}
        silent = next((each.silent for each in responsible), NOBODY)
        reason, before = "" if watching else silent, bus.unwatched
        bus.unwatched = reason
        left = {part for part in self._drove if part is not None}
        left -= {each.part for each in wizards if not each.silent}
        if None in self._drove:
            left |= self._watching - watching
        if left or (reason and not before):
            self._drove.clear()
            bus.halt_driving(self._away(min(left)) if left else reason)
        self._watching = watching

    def _away(self, part: str) -> str:
        """Why the console of this part does not watch."""
        players = [each for each in self._wizards() if each.part == part]
        if not players:
            return f"{console_of(part)} is not attached any more"
        return players[0].silent or f"{console_of(part)} does not drive any more"

    def _why_not(self, command: m.Command) -> str:
        """Why nobody watches over a command that drives; empty: somebody does."""
        part = self._part_of(command)
        if part is not None and all(each.silent or each.part != part for each in self._wizards()):
            return f"{console_of(part)} is not attached, or does not respond"
        self._drove.add(part)
        return ""

    def _part_of(self, command: m.Command) -> str | None:
        run = self._session.state.actions.get(command.run)
        return self._parts.get(run.request.console if run is not None else command.console)

    def _driving_verbs(self) -> frozenset[str]:
        offered = self._session.bus.verbs.values()
        return frozenset(verb.name for verbs in offered for verb in verbs.values() if verb.drives)
