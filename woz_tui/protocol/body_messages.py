"""What a body or a panel shows to those who look at it: messages of drivers that have a face, a
personality or knobs.

Everybody imports these from `woz_tui.protocol.messages`, where all messages are together.
"""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Json, Message


class Shown(Message, frozen=True, kw_only=True, omit_defaults=True):
    """Something to be seen at `driver`. Only the subclasses are sent."""

    driver: str = ""


class FaceShown(Shown, frozen=True, kw_only=True, omit_defaults=True, tag="face.shown"):
    """The face changed: exactly the picture that the device gets.

    `rows` are the matrix's rows from the top, blank between them, each in hexadecimal with the
    leftmost light as its highest bit; `width` lights a row. `brightness` is 0..1.
    """

    width: int
    rows: str
    emotion: str
    intensity: float
    brightness: float = 1.0


class BodyChanged(Shown, frozen=True, kw_only=True, omit_defaults=True, tag="body.changed"):
    """What a body is doing and how it does it; `values` has all of its settings and states."""

    values: dict[str, Json]


class ControlsMoved(Shown, frozen=True, kw_only=True, omit_defaults=True, tag="controls.moved"):
    """Knobs, sliders and buttons of a panel: name -> 0..127, only those that moved.

    `waiting` names all controls that do not count yet, because the robot's value is another than
    the hand's (soft take-over); `targets` tells where some of them begin to count, 0..127. `lit`
    names all buttons whose light is on.
    """

    values: dict[str, int]
    waiting: list[str] = msgspec.field(default_factory=list)
    targets: dict[str, int] = msgspec.field(default_factory=dict)
    lit: list[str] = msgspec.field(default_factory=list)


class SettingsShown(Shown, frozen=True, kw_only=True, omit_defaults=True, tag="settings.shown"):
    """A robot's settings as it has them now, read back from it; said on a change.

    `values` has all of them by name; `wanted` what was asked for, of those that are otherwise (the
    robot changed them by itself, or has not done so yet); `conflicts` sentences about settings that
    work against each other.
    """

    values: dict[str, Json]
    wanted: dict[str, Json] = msgspec.field(default_factory=dict)
    conflicts: list[str] = msgspec.field(default_factory=list)
