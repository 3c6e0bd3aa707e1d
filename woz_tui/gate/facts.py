"""What holds at the moment, as far as whoever asks the gate knows it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from woz_tui.protocol.panel_players import PartedPanel
from woz_tui.protocol.sentence import Sentence


class GatedPanel(PartedPanel, Protocol):
    """What counts here of a panel, in the file or on the screen."""

    @property
    def locked(self) -> bool:
        """Whether it is at first."""


@dataclass(frozen=True, slots=True)
class Watcher:
    """A wizard's console that is heard. `held`: its keys drive only while they are held, because
    `line` (tmux, screen ...) would hide that its line is lost, or the file says so.
    """

    console: str
    part: str = ""
    held: bool = False
    line: str = ""


@dataclass(frozen=True, slots=True)
class Driving:
    """Who watches over the command that is asked about, if it drives.

    `unwatched`: why nobody does; empty: somebody does. `console`, `part`: whose it is; None: it
    belongs to no part. `keys`: those that are down, by console.
    """

    unwatched: str = ""
    console: str = ""
    part: str | None = None
    watchers: Sequence[Watcher] = ()
    keys: Collection[tuple[str, str]] = ()


@dataclass(frozen=True, slots=True)
class Facts:
    """What holds; by default nothing stands against anything.

    Attributes:
        now: On the axis of `t`.
        ended: Whether the session is ending.
        stopped: Whether the stop is pressed.
        unconfirmed: Drivers that have not confirmed it.
        unrecorded: Why what happens now would not be recorded; empty: it is.
        panels: Of the file.
        locked: Whether a panel was locked or unlocked since, by title.
        wizards: Consoles that play, with their parts.
        helpers: Programs and drivers that belong to a part, with it.
        scheduled: How many requests wait for their moment.
        driving: Who watches over the command that is asked about; None: it does not drive.
        features: What features have to say of the moment, by name.
        failed: Those of them that have failed, and said this before.
        consents: Who has consented to having their face learnt, and by which driver.
    """

    now: int = 0
    ended: bool = False
    stopped: bool = False
    unconfirmed: Sequence[str] = ()
    unrecorded: str = ""
    panels: Sequence[GatedPanel] = ()
    locked: Mapping[str, bool] = field(default_factory=dict)
    wizards: Mapping[str, str] = field(default_factory=dict)
    helpers: Mapping[str, str] = field(default_factory=dict)
    scheduled: int = 0
    driving: Driving | None = None
    features: Mapping[str, object] = field(default_factory=dict)
    failed: Collection[str] = ()
    consents: Collection[tuple[str, str]] = ()


def console_of(part: str) -> Sentence:
    """What a sentence calls the console that plays `part`."""
    if part:
        return Sentence("gate.console_of_part", "the console that plays {part}", part=part)
    return Sentence("gate.wizards_console", "the wizard's console")
