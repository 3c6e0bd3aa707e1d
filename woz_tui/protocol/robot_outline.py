"""What a driver of a whole robot tells of it, so that a console can show and change its settings.

It is the `outline` that a driver offers, made with `RobotOutline.as_json()`; the console
reads it with `RobotOutline.read`. Values come as `messages.SettingsShown`.
"""

from __future__ import annotations

from typing import Literal

import msgspec

from woz_tui.protocol.envelope import Json


class Setting(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One line of the robot's settings.

    `name`: its key in `SettingsShown.values`. To change it, send `verb` with the new value as
    `argument`; without a verb it is only shown. `kind`: flag, choice (of `choices`), number (from
    `low` to `high`, an arrow key changes it by `step`), color (`#rrggbb`) or text.
    """

    name: str
    section: str
    label: str
    verb: str = ""
    argument: str = ""
    kind: Literal["flag", "choice", "number", "color", "text"] = "text"
    choices: list[str] = []
    low: float = 0.0
    high: float = 1.0
    step: float = 0.1
    unit: str = ""
    help: str = ""


class Tag(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    r"""Something that may stand in an utterance: `\rspd=100\` and what it does, in a few words."""

    text: str
    help: str = ""


class RobotOutline(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A whole robot. `robots`: addresses that the verb `connect` takes. `moves`: names that its
    verb `play` is known to take, for completion (it may take others). `tags`: what may stand in
    `say`. `camera`: it has pictures (`protocol.camera_pictures`).
    """

    kind: Literal["robot"] = "robot"
    settings: list[Setting] = []
    robots: list[str] = []
    moves: list[str] = []
    tags: list[Tag] = []
    camera: bool = False

    def as_json(self) -> dict[str, Json]:
        """As the `outline` that a driver offers."""
        fields: dict[str, Json] = msgspec.to_builtins(self)
        return {"kind": "robot", **fields}

    @classmethod
    def read(cls, outline: Json) -> RobotOutline | None:
        """What a driver's `outline` says; None if it is something else or cannot be read."""
        if not isinstance(outline, dict) or outline.get("kind") != "robot":
            return None
        try:
            return msgspec.convert(outline, cls)
        except msgspec.ValidationError:
            return None
