"""What a wizard does not play because another one does: see `woz_tui.protocol.panel_players`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.repairs import SAY
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol.panel_players import panel_players, player_names, players, verb_players
from woz_tui.protocol.panels import covers_verb
from woz_tui.session.action_runner import CommandRefusal


class PartLimits:
    """Knows what a wizard does not play because another one does. Programs and control panels that
    belong to a part play what a further wizard of that part would. The others, and what the robot
    does by itself, play no part, so nothing is refused to them here.

    Args:
        read: Gives the experiment.
        wizards: Gives the consoles that play, with their parts.
        helpers: Gives programs and control panels that belong to a part, with it.
    """

    def __init__(
        self,
        read: Callable[[], Experiment],
        wizards: Callable[[], Mapping[str, str]],
        helpers: Callable[[], Mapping[str, str]] = dict,
    ) -> None:
        self._read = read
        self._wizards = wizards
        self._helpers = helpers

    def no_action(self, action: Action, origin: RequestOrigin) -> str:
        """Why this wizard may not play it; empty if they may. A phase plays what it begins with,
        whoever goes on to it.
        """
        wizards, panels = self._players(origin), self._read().panels
        if origin.console not in wizards or origin.source == "phase":
            return ""
        panel = next((each for each in panels if each.title == action.panel), None)
        if panel is None:  # a repair: it says something
            return self._no_verb(SAY, "", origin)
        found = panel_players(panel, panels, wizards)
        if origin.console in found:
            return ""
        return f"the panel {panel.title!r} is played by {player_names(found, wizards)}"

    def no_verb(self, verb: str, driver: str, origin: RequestOrigin) -> CommandRefusal | None:
        """Why this wizard may not send it to `driver` by itself; None if they may."""
        reason = self._no_verb(verb, driver, origin)
        return CommandRefusal("part", reason) if reason else None

    def _no_verb(self, verb: str, driver: str, origin: RequestOrigin) -> str:
        wizards = self._players(origin)
        found = verb_players(verb, self._read().panels, wizards, driver)
        if origin.console not in wizards or origin.console in found:
            return ""
        return f"{verb!r} is played by {player_names(found, wizards)}"

    def _players(self, origin: RequestOrigin) -> Mapping[str, str]:
        """Who plays, and whoever asks, if it belongs to a part."""
        wizards, part = self._wizards(), self._helpers().get(origin.console, "")
        return {**wizards, origin.console: part} if part else wizards

    def drivers(self, drives: frozenset[str]) -> frozenset[str]:
        """Consoles of the wizards whose part drives: who plays a panel that covers a verb of
        `drives`, or has an action with one; every wizard, where no panel does.
        """
        wizards = self._wizards()
        found = [
            players(panel.parts, wizards)
            for panel in self._read().panels
            if any(covers_verb(panel.covers, verb) for verb in drives)
            or drives.intersection(call.verb for each in panel.actions for call in each.calls)
        ]
        return frozenset().union(*found) if found else frozenset(wizards)
