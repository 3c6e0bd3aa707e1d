"""Time limits that run in the present state, where the robot process has told them."""

from __future__ import annotations

from woz_tui.console.cells import Piece
from woz_tui.console.console_state import ConsoleState
from woz_tui.protocol import messages as m

#: The limit that counts from the entry into a state, and what ends there in words.
_LIMITS = {
    "PersonDetected": ("approach", "to engage"),
    "UserSpeaks": ("listening", "to speak"),
    "RobotThinks": ("thinking", "to answer"),
    "RobotReplies": ("talking", "to reply"),
    "RobotSpeaks": ("talking", "to speak"),
}
#: States that `absent` ends.
_BUSY = ("Handshake", "UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks")
#: From this share of a limit on it is amber.
_SOON = 0.75


def running_limits(picture: ConsoleState, shown: m.EngagementShown, now: int) -> list[Piece]:
    """`12 of 60 s to speak`, for the state as it stands."""
    return [*_state_limit(picture, shown, now), *_absent(picture, shown)]


def _absent(picture: ConsoleState, shown: m.EngagementShown) -> list[Piece]:
    """That a state ends soon because nobody is there."""
    limit = picture.settings.engagement.timeouts.get("absent")
    presence = shown.signs.get("presence")
    if not limit or shown.state not in _BUSY or presence is None or presence.verdict != 0:
        return []
    return [(f"ends {limit:g} s after the visitor left", "muted")]


def _state_limit(picture: ConsoleState, shown: m.EngagementShown, now: int) -> list[Piece]:
    limits = picture.settings.engagement
    name, words = _LIMITS.get(shown.state, ("", ""))
    limit: float | None
    if shown.state == "Handshake":
        limit, words = limits.handshake, "for the handshake"
    else:
        limit = limits.timeouts.get(name)
    if limit is None or limit <= 0:
        return []
    gone = max(0, now - shown.since) / 1e6
    look = "warn" if gone >= _SOON * limit else "muted"
    return [(f"{min(gone, limit):.0f} of {limit:.0f} s {words}", look)]
