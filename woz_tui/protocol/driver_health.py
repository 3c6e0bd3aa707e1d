"""How drivers and their lanes are.

Everybody imports these from `woz_tui.protocol.messages`, where all messages are together.
"""

from __future__ import annotations

from woz_tui.protocol.envelope import Message


class DriverHealth(Message, frozen=True, kw_only=True, omit_defaults=True):
    """How a driver is. Only the subclasses are sent."""

    driver: str
    detail: str = ""
    remedy: str = ""


class DriverConnecting(
    DriverHealth, frozen=True, kw_only=True, omit_defaults=True, tag="driver.connecting"
):
    """It is looking for its hardware."""


class DriverConnected(
    DriverHealth, frozen=True, kw_only=True, omit_defaults=True, tag="driver.connected"
):
    """It is ready; `detail` says with what (port, models found)."""


class DriverLost(DriverHealth, frozen=True, kw_only=True, omit_defaults=True, tag="driver.lost"):
    """Its hardware went away; it looks for it by itself."""


class DriverFaulted(
    DriverHealth, frozen=True, kw_only=True, omit_defaults=True, tag="driver.faulted"
):
    """A part of it does not answer or reports an alarm; `detail` names the part."""


class LaneFaulted(Message, frozen=True, kw_only=True, omit_defaults=True, tag="lane.faulted"):
    """A job outlived its limit and its cancelling; its lane takes nothing until it has ended."""

    driver: str
    lane: str
    command: str


class LaneRecovered(Message, frozen=True, kw_only=True, omit_defaults=True, tag="lane.recovered"):
    """The job of a faulted lane has ended at last."""

    driver: str
    lane: str
