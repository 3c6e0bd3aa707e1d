"""What is asked of phases on the socket."""

from __future__ import annotations

from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


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


KINDS = FeatureKinds(requests=(AskPhase,))
