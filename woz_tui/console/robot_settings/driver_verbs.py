"""What any robot's driver may be asked without an argument to type: pictures, recordings, tablet.

An experiment need not have a button for these; a WoZ4U file has none for recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.console.console_state import ConsoleState
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class Order:
    """A verb with its arguments, and what it does in the wizard's words."""

    verb: str
    text: str
    args: Mapping[str, Json]


ORDERS = (
    Order("picture", "picture of its camera, as a file", {}),
    Order("record_sound", "record its microphones, on the robot", {"on": True}),
    Order("record_sound", "end the recording on the robot", {"on": False}),
    Order("listen", "record its microphones, beside the log", {"on": True}),
    Order("listen", "end the recording beside the log", {"on": False}),
    Order("tablet", "tablet: the default again", {"what": "default"}),
    Order("tablet", "tablet: show nothing", {"what": "hide"}),
    Order("tablet", "tablet: switch its wifi on", {"what": "wifi"}),
)


def orders_of(picture: ConsoleState) -> Iterator[tuple[str, Order]]:
    """Driver and order, of the drivers that tell of a whole robot and offer the verb."""
    for driver in picture.robot_outlines:
        for order in ORDERS:
            if order.verb in picture.verbs.get(driver, ()):
                yield driver, order
