"""What is said of profiles in the log and on the socket."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class ProfileChanged(Message, frozen=True, kw_only=True, tag="profile.changed"):
    """What the wizard may use changed: only what `profile` of the experiment names; an empty one is
    everything.
    """

    names_console = True
    profile: str = msgspec.field(default_factory=str)
    source: str = msgspec.field(default_factory=lambda: "key")
    console: str = ""


class AskProfile(Request, frozen=True, kw_only=True, tag="profile"):
    """Play with what a profile of the experiment allows; an empty one allows everything."""

    sourced = True
    profile: str = ""
    source: str = "program"


KINDS = FeatureKinds(messages=(ProfileChanged,), requests=(AskProfile,), open=(ProfileChanged,))
