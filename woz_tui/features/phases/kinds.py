"""What is said of phases in the log and on the socket."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class PhaseChanged(Message, frozen=True, kw_only=True, tag="phase.changed"):
    """A phase of the experiment begins; an empty `phase`: none holds from here on.

    `source`: key, palette, program; trial, session (a participant or a trial was set, or the
    session begins) or reload where it began with that. `planned_us`: how long it is to last (0:
    nobody said).
    """

    names_console = True
    phase: str = msgspec.field(default_factory=str)
    source: str = msgspec.field(default_factory=lambda: "key")
    planned_us: int = 0
    console: str = ""


class AskPhase(Request, frozen=True, kw_only=True, tag="phase"):
    """Go on to the phase `phase` of the experiment; an empty one: to the next.

    `key`, `age_us` and `stale` as for an action.
    """

    sourced = True
    aged = True
    phase: str = ""
    source: str = "program"
    key: str = ""
    age_us: int = 0
    stale: bool = False


KINDS = FeatureKinds(messages=(PhaseChanged,), requests=(AskPhase,), open=(PhaseChanged,))
