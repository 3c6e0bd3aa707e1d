"""What gamepads, Stream Decks and the others have in common for whoever reads them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple


class KeyFace(NamedTuple):
    """What a key with a display shows: `state` as the console calls it, `note` below the label."""

    label: str
    state: str = ""
    note: str = ""


class HandDevice:
    """A device that is plugged in and open, and what of it is not at rest.

    Args:
        kind: gamepad or stream-deck.
        name: What it calls itself.
        path: Where it is.
    """

    def __init__(self, kind: str, name: str, path: str) -> None:
        self.kind = kind
        self.name = name
        self.path = path
        #: All controls that are not at rest, as the session is told them.
        self.held: dict[str, float] = {}
        #: Called in the event loop: after `held` has changed; when the device cannot be read any
        #: more (for whoever opened it); when it has been let go and held nothing any more.
        self.on_change: Callable[[], None] = lambda: None
        self.on_lost: Callable[[str], None] = lambda why: None
        self.on_gone: Callable[[], None] = lambda: None

    def move(self, control: str, value: float) -> None:
        """A control is at `value` now."""
        if self.held.get(control, 0.0) == value:
            return
        if value:
            self.held[control] = value
        else:
            del self.held[control]
        self.on_change()

    def show(self, faces: Mapping[str, KeyFace]) -> None:
        """Show these on its keys, as far as it can; keys that are not named go dark."""

    def close(self) -> None:
        """Let go of it."""
