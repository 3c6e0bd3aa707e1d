"""What goes wrong for a program that plays a robot; all of it is a `WozError`."""

from __future__ import annotations

from typing import Self

from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import Reply


class WozError(Exception):
    """Something that was asked for did not happen. `hint`: what helps, if anybody knows. `code`:
    which sentence the reason is, such as `gate.panel_locked`; empty: a driver's own words.
    """

    def __init__(self, reason: str, hint: str = "", code: str = "") -> None:
        super().__init__(f"{reason} ({hint})" if hint else reason)
        self.reason = reason
        self.hint = hint
        self.code = code

    def again(self) -> Self:
        """The same to be raised once more: an error keeps every place that has raised it."""
        return type(self)(self.reason, self.hint, self.code)


class WozRefusedError(WozError):
    """It was not begun: wrong arguments, the stop, a lock, a profile, too late ..."""


class WozUnknownVerbError(WozRefusedError, AttributeError):
    """The session's robot has no such verb."""


class WozFailedError(WozError):
    """It was tried and did not work, or took too long, or a motion did not arrive."""


class WozStoppedError(WozError):
    """The stop, the wizard or the end of the session cut it short."""


class WozSupersededError(WozError):
    """Something newer took its place."""


class WozConnectionError(WozError, ConnectionError):
    """There is no session to connect to, or the connection to it is lost."""


def code_of(line: m.ActionEnd | m.End | Reply) -> str:
    """The code of its reason."""
    return line.wording["reason"].code if "reason" in line.wording else ""


def error_of(end: m.ActionEnd | m.End) -> WozError | None:
    """The error that an end stands for; None: it went well."""
    hint, code = end.remedy if isinstance(end, m.End) else "", code_of(end)
    match end:
        case m.ActionDone() | m.Done():
            return None
        case m.ActionRefused() | m.Refused():
            return WozRefusedError(end.reason, hint, code)
        case m.ActionStopped() | m.Stopped():
            return WozStoppedError(end.reason or "stopped", hint, code)
        case m.ActionSuperseded() | m.Superseded():
            return WozSupersededError(end.reason or f"replaced by {end.by}", hint, code)
    return WozFailedError(end.reason or "failed", hint, code)


def error_of_motion(end: m.MotionInterrupted) -> WozError:
    """The error that a motion stands for that does not arrive."""
    if end.by:
        return WozSupersededError(end.reason)
    if end.stopped:
        return WozStoppedError(end.reason)
    return WozFailedError(f"the motion does not arrive: {end.reason}")
