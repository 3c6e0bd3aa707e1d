"""Base classes of messages and answers: the fields that each line carries."""

from __future__ import annotations

from typing import Any, ClassVar

import msgspec

#: What an argument or a sensor value may be.
Json = None | bool | int | float | str | list[Any] | dict[str, Any]


class Message(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind"):
    """Number `seq`, time `t` and `ts`: the hub fills them in, whoever makes a message does not."""

    #: Whether it names the connection (`console`) whose request brought it about.
    names_console: ClassVar[bool] = False
    seq: int = -1
    t: int = -1
    ts: str = ""


class RestrictedMessage(Message, frozen=True, kw_only=True):
    """A message whose words may tell something that is kept from some.

    `tells`: what that is: `condition`, `request` (the words quote what was asked for), or what a
    sensor measures (`loudness`, `identity` ..., see `config.study.PERCEIVED`). Only the subclasses
    are sent.
    """

    #: Whether nothing of it is shown where its words tell what is kept.
    kept_whole: ClassVar[bool] = False
    tells: tuple[str, ...] = ()


class Answer(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind"):
    """A line from the host that is no message of the session. Only the subclasses are sent."""
