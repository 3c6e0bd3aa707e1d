"""Who plays what where several wizards play one robot: the panels' parts (`for` in the file).

A panel is played by the wizards whose part it names. Where none of them is there it is played by
the wizard without a part, and where that one is not there either, by every wizard: no panel is left
without somebody who can play it. A verb by itself belongs with the panels that cover it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Protocol

from woz_tui.protocol.panels import TYPED, covers_verb


class PartedPanel(Protocol):
    """What counts here of a panel, in the file or on the screen."""

    @property
    def title(self) -> str:
        """Unique in the file."""

    @property
    def parts(self) -> Sequence[str]:
        """One of which a wizard plays to use it."""

    @property
    def covers(self) -> Sequence[str]:
        """Verbs that belong with it."""


def players(parts: Collection[str], wizards: Mapping[str, str]) -> frozenset[str]:
    """Who plays a panel for these parts. `wizards`: console -> its part, or nothing."""
    for wanted in (set(parts) - {""}, {""}):
        if found := frozenset(console for console, part in wizards.items() if part in wanted):
            return found
    return frozenset(wizards)


def verb_players(
    verb: str, panels: Iterable[PartedPanel], wizards: Mapping[str, str], driver: str = ""
) -> frozenset[str]:
    """Who sends `verb` to `driver` (empty: to any) by itself: whoever plays a panel that covers it,
    else every wizard.
    """
    covering = [
        players(panel.parts, wizards) for panel in panels if covers_verb(panel.covers, verb, driver)
    ]
    return frozenset().union(*covering) if covering else frozenset(wizards)


def panel_players(
    panel: PartedPanel, panels: Iterable[PartedPanel], wizards: Mapping[str, str]
) -> frozenset[str]:
    """Who plays the actions of `panel`. Typed sentences are for whoever can type some."""
    if panel.title == TYPED and not panel.parts:
        return verb_players("say", panels, wizards)
    return players(panel.parts, wizards)


def part_names(found: Iterable[str], wizards: Mapping[str, str]) -> str:
    """Parts, and consoles that play none in particular: `voice`."""
    return ", ".join(sorted(wizards.get(name) or name for name in found))


def player_names(found: Iterable[str], wizards: Mapping[str, str]) -> str:
    """Parts and consoles: `voice (con2)`."""
    named = (f"{wizards[name]} ({name})" if wizards.get(name) else name for name in found)
    return " and ".join(sorted(named))
