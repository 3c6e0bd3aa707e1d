"""What a robot file may say about a device in the wizard's hands."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated

from woz_drivers.hands.device_models import DEVICES, GAMEPAD, MODELS, TRIGGERS
from woz_drivers.panels.control_functions import (
    BUTTON,
    JUMP,
    SOFT,
    ControlFunction,
    MappedControl,
    function_problems,
)
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section, Sibling

#: The common verb that moves a robot through the room.
_DRIVE = "drive"
#: The shortest time between two requests for the same steps, in seconds.
LEAST_EVERY_S = 0.2


@dataclass(frozen=True, slots=True)
class HandControl(ControlFunction):
    """What one control of a device does."""

    hold: Annotated[
        str, Doc("dead man's button: a stick counts only while this button is held")
    ] = ""
    every: Annotated[
        float,
        Seconds(0.0, 10.0),
        Doc("asks again so often while the stick is away from its middle; 0: only when it moves"),
    ] = 0.0
    rate: Annotated[
        float,
        Range(0.0, 1000.0),
        Doc(
            "moves the value for as long as the stick is away from its middle, at most so much of"
            " it a second; 0: the stick's place is the value"
        ),
    ] = 0.0


@dataclass(frozen=True, slots=True)
class HandsSettings(Section):
    """What a robot file may say about a device in the wizard's hands."""

    device: Annotated[str, OneOf(DEVICES), Doc("what is in the wizard's hands")] = GAMEPAD
    controls: Annotated[dict[str, HandControl], Doc("control -> what it does")] = field(
        default_factory=dict
    )
    on: Annotated[
        str, Sibling(), Doc("driver that is meant where several offer a verb; empty: none")
    ] = ""
    dead_zone: Annotated[
        float, Range(0.0, 0.9), Doc("share of a stick's way around its middle that counts as rest")
    ] = 0.15
    hold: Annotated[
        float,
        Seconds(0.2, 5.0),
        Doc("what is held counts as let go when nothing is heard of it for so long"),
    ] = 0.5
    take_over: Annotated[
        str,
        OneOf((SOFT, JUMP)),
        Doc("soft: a body's control counts once it has passed the robot's value; jump: at once"),
    ] = SOFT
    part: Annotated[
        str, Doc("plays only what the wizard of this part plays (`for` of panels); empty: all")
    ] = ""

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        return [*self._problems()]

    def _problems(self) -> Iterator[tuple[str, str]]:
        model = MODELS[self.device]
        for name, mapped in self.controls.items():
            path = f"controls.{name}"
            if name not in model:
                yield path, f"a {self.device} has no {name!r}{_near(name, self.device)}"
                continue
            kind = _kind(name, mapped, self.device)
            yield from function_problems(path, mapped, kind)
            if mapped.hold and mapped.hold not in model:
                near = _near(mapped.hold, self.device)
                yield f"{path}.hold", f"a {self.device} has no {mapped.hold!r}{near}"
            elif mapped.hold == name:
                yield f"{path}.hold", "the dead man's button is another control than the stick"
            if kind == BUTTON:
                for field_name in ("hold", "every", "rate"):
                    if getattr(mapped, field_name):
                        yield f"{path}.{field_name}", "is for sticks and triggers"
                if mapped.verb == _DRIVE:
                    yield path, "a button cannot drive: use a stick, or an action"
            elif mapped.verb == _DRIVE and not (mapped.hold and mapped.every):
                missing = "hold" if not mapped.hold else "every"
                yield path, f"driving needs {missing}: hold: left-bumper, every: 1"
            elif 0 < mapped.every < LEAST_EVERY_S:
                yield f"{path}.every", f"at least {LEAST_EVERY_S} s"
            elif mapped.rate:
                yield from _rate_problems(path, mapped)


def _rate_problems(path: str, mapped: HandControl) -> Iterator[tuple[str, str]]:
    """Of what moves a value instead of being one."""
    if mapped.every:
        yield f"{path}.rate", "steps or a rate: leave out every, or rate"
    if not mapped.hold:
        yield path, "a rate needs a dead man's button: hold: left-bumper"
    if mapped.take_over:
        yield f"{path}.take_over", "a rate begins where the robot stands: leave it out"


def _near(name: str, device: str) -> str:
    near = difflib.get_close_matches(name, MODELS[device], n=1)
    return f"; did you mean {near[0]!r}?" if near else "; woz hands --show names its controls"


def _kind(name: str, mapped: ControlFunction, device: str) -> str:
    """A trigger is a button where it is not given a value to set."""
    pressed = name in TRIGGERS and not mapped.continuous
    return BUTTON if pressed else MODELS[device][name].kind


def mapped_controls(settings: HandsSettings) -> tuple[MappedControl, ...]:
    """All controls of the device, free ones too."""
    return tuple(
        MappedControl(
            replace(control, kind=_kind(name, mapped, settings.device)),
            mapped,
            mapped.on or settings.on,
            soft=bool(mapped.control and not mapped.rate)
            and (mapped.take_over or settings.take_over) == SOFT,
            source=settings.device,
        )
        for name, control in MODELS[settings.device].items()
        for mapped in (settings.controls.get(name, HandControl()),)
    )
