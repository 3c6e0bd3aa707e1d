"""What any robot's driver may be asked without an argument to type: pictures, recordings, tablet.

An experiment need not have a button for these; a WoZ4U file has none for recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.console.console_state import ConsoleState
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class OfferedCall:
    """A verb with its arguments, and what it does in the wizard's words."""

    verb: str
    text: str
    args: Mapping[str, Json]


OFFERED_CALLS = (
    OfferedCall("picture", "picture of its camera, as a file", {}),
    OfferedCall("record_sound", "record its microphones, on the robot", {"on": True}),
    OfferedCall("record_sound", "end the recording on the robot", {"on": False}),
    OfferedCall("listen", "record its microphones, beside the log", {"on": True}),
    OfferedCall("listen", "end the recording beside the log", {"on": False}),
    OfferedCall("tablet", "tablet: the default again", {"what": "default"}),
    OfferedCall("tablet", "tablet: show nothing", {"what": "hide"}),
    OfferedCall("tablet", "tablet: switch its wifi on", {"what": "wifi"}),
)


def offered_calls(picture: ConsoleState) -> Iterator[tuple[str, OfferedCall]]:
    """Driver and order, of the drivers that tell of a whole robot and offer the verb."""
    for driver in picture.robot_outlines:
        for order in OFFERED_CALLS:
            if order.verb in picture.verbs.get(driver, ()):
                yield driver, order
