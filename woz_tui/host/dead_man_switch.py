"""Lets the robot drive while the wizard watches who plays the part that drives, and no longer."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from woz_tui.gate.facts import Driving, Watcher, console_of
from woz_tui.host.client_connection import ClientConnection
from woz_tui.host.held_driving import DrivingMode, HeldDriving
from woz_tui.protocol import messages as m
from woz_tui.protocol.panel_players import players
from woz_tui.protocol.panels import covers_verb
from woz_tui.protocol.requests import AskAction, AskVerb
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session import Session

#: Why nobody drives.
NOBODY = Sentence("host.no_wizard", "no wizard's console is attached")


class DeadManSwitch:
    """Allows to drive, and ends it.

    Where a wizard's line may be lost without anybody seeing it (`driving_of`), only a held key
    drives, and a control that says when it is let go. What a wizard has asked for drives while the
    player of that wizard's part watches. What nobody's part has asked for (a program, a control
    panel) drives while one of those watches whose part drives (see `_driving_consoles`).

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
        self._held = HeldDriving(session)
        session.bus.unwatched = NOBODY
        session.bus.watch = self

    def update(self) -> None:
        """Consoles came, went, fell silent or were heard again: end driving for which nobody is
        responsible any more.
        """
        bus, wizards = self._session.bus, self._wizards()
        self._parts |= {each.name: each.part for each in wizards}
        driving = self._driving_consoles()
        responsible = [each for each in wizards if each.name in driving]
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
            bus.halt_driving(self._why_away(min(left)) if left else reason)
        self._watching = watching

    def _why_away(self, part: str) -> str:
        """Why the console of this part does not watch."""
        players = [each for each in self._wizards() if each.part == part]
        if not players:
            return Sentence(
                "host.detached", "{part} is not attached any more", part=console_of(part)
            )
        return players[0].silent or Sentence(
            "host.drives_no_more", "{part} does not drive any more", part=console_of(part)
        )

    def driving_of(self, client: ClientConnection) -> DrivingMode:
        """How keys of this console drive."""
        said = self._session.experiment.session.driving
        if said != "auto":
            return said
        return "held" if client.hello is not None and client.hello.line else "pressed"

    def play(
        self, client: ClientConnection, request: AskAction | AskVerb, play: Callable[[], str]
    ) -> str:
        """Carry a press out by `play`; the run. One that drives only while its key is held begins
        once: repeats go on with what the press has begun.
        """
        key = request.key if request.source == "key" else ""
        if not key or client.role != "wizard" or not self._drives_held(client, request):
            return play()
        return self._held.repeat(client.name, key) or self._held.press(client.name, key, play)

    def let_go(self, client: ClientConnection, key: str) -> None:
        """A key of this console is up."""
        self._held.let_go(client.name, key)

    def _drives_held(self, client: ClientConnection, request: AskAction | AskVerb) -> bool:
        if self.driving_of(client) == "pressed":
            return False
        if isinstance(request, AskVerb):
            return request.verb in self._driving_verbs()
        action = self._session.experiment.action(request.action)
        calls = action.calls if action is not None else ()
        return not self._driving_verbs().isdisjoint(call.verb for call in calls)

    def facts(self, command: m.Command) -> Driving:
        """Who watches over a command, for the gate."""
        console = self._console_of(command)
        watchers = [
            Watcher(
                each.name,
                each.part,
                self.driving_of(each) == "held",
                each.hello.line if each.hello is not None else "",
            )
            for each in self._wizards()
            if not each.silent
        ]
        return Driving("", console, self._parts.get(console), watchers, self._held.keys)

    def begins(self, command: m.Command) -> None:
        """It drives: note whose it is, and which key."""
        console = self._console_of(command)
        if command.source == "key":
            self._held.drive(console, command.key, command.command)
        self._drove.add(self._parts.get(console))

    def _driving_consoles(self) -> frozenset[str]:
        """Consoles of the wizards whose part drives: who plays a panel that covers a verb that
        does, or has an action with one; every wizard, where no panel does.
        """
        wizards, drives = self._session.state.wizards, self._driving_verbs()
        found = [
            players(panel.parts, wizards)
            for panel in self._session.experiment.panels
            if any(covers_verb(panel.covers, verb) for verb in drives)
            or drives.intersection(call.verb for each in panel.actions for call in each.calls)
        ]
        return frozenset().union(*found) if found else frozenset(wizards)

    def _console_of(self, command: m.Command) -> str:
        run = self._session.state.actions.get(command.run)
        return run.request.console if run is not None else command.console

    def _driving_verbs(self) -> frozenset[str]:
        offered = self._session.bus.verbs.values()
        return frozenset(verb.name for verbs in offered for verb in verbs.values() if verb.drives)
