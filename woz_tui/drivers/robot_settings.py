"""A setting of a robot in one row: its words, its range, the verb that changes it, where the robot
file asks for it. The robot file, the verb and the line of the console's screen are made from it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

from woz_tui.drivers.contract import Argument, RejectedError, Verb
from woz_tui.drivers.fields import Doc, OneOf, Range
from woz_tui.drivers.robot_verbs import COMMON_VERBS, common_verb
from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import Setting

Kind = Literal["flag", "choice", "number", "color", "text"]

_SHARE = Range(0, 1)


@contextlib.contextmanager
def problem_at(path: str, found: list[tuple[str, str]]) -> Iterator[None]:
    """What is rejected in here is a problem that is `found` in the setting at `path`."""
    try:
        yield
    except RejectedError as error:
        found.append((path, f"{error.what}; {error.remedy}"))


@dataclass(frozen=True, slots=True)
class RobotSetting:
    """One setting.

    Attributes:
        section: Where on the robot's screen it stands.
        name: Its key among the values that are read back.
        kind: What its value is.
        what: What it is or does.
        verb: What changes it, with its value as `argument`; empty: it is only shown.
        file: Where the robot file asks for it; empty: nowhere.
        label: What the screen calls it; empty: its name.
        choices: Of a choice.
        range: Of a number.
        gap: Between these two of a number it takes none.
        step: How far an arrow key changes a number.
    """

    section: str
    name: str
    kind: Kind
    what: str = ""
    verb: str = ""
    argument: str = ""
    file: str = ""
    label: str = ""
    choices: tuple[str, ...] = ()
    range: Range = _SHARE
    gap: tuple[float, float] | None = None
    step: float = 0.1

    @property
    def doc(self) -> Doc:
        """What it is, for the robot file."""
        return Doc(self.what)

    @property
    def doc_on_connect(self) -> Doc:
        """The same of one that stands alone in the robot file."""
        of = "colour of the " if self.kind == "color" else ""
        return Doc(f"{of}{self.label or self.name} on connect: {self.what}")

    @property
    def one_of(self) -> OneOf:
        """What the robot file may say of a choice; empty: it is left as it is."""
        return OneOf(("", *self.choices))

    def allows(self, number: float) -> bool:
        """Whether the robot takes that number."""
        low, high = self.gap or (0.0, 0.0)
        return self.range.contains(number) and not low < number < high

    @property
    def numbers(self) -> str:
        """What the robot takes, in words."""
        if self.gap is None:
            return str(self.range)
        return f"{self.gap[0]:g}, or {replace(self.range, low=self.gap[1])}"

    def taken(self, *, required: bool = False, default: Json = None) -> Argument:
        """The argument of the verb that changes it."""
        number = self.kind == "number"
        kind = "text" if self.kind == "color" else self.kind
        return Argument(
            *(self.argument, kind, self.what, required, default),
            range=self.range if number else None,
            choices=self.choices,
        )

    def changed_by(self, summary: str = "", *more: Argument, **fields: Any) -> Verb:
        """The verb that changes it, with what else it takes; `fields`: others of the verb."""
        own = (self.taken(required=True), *more)
        if self.verb in COMMON_VERBS:
            return common_verb(self.verb, summary, *own, **fields)
        return Verb(self.verb, summary or f"set {self.what}", own, **fields)

    def line(self) -> Setting:
        """As the console is told."""
        return Setting(
            name=self.name,
            section=self.section,
            label=self.label or self.name.replace("_", " "),
            verb=self.verb,
            argument=self.argument,
            kind=self.kind,
            choices=list(self.choices),
            low=self.range.low or 0.0,
            high=self.range.high or 0.0,
            step=self.step,
            unit=self.range.unit,
            help=self.what,
        )
