"""The traits of a body: their values now, their ranges, and changes without a jump.

Rates (tempo, speed) may change at once, because whoever uses them counts on from where it is.
Sizes (compression, smoothing, amplitude) would move the body by themselves, so they are eased.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any, get_type_hints

from woz_tui.drivers.fields import Doc, Range
from woz_tui.motion.body_shape import Personality
from woz_tui.motion.control_scales import TRAITS
from woz_tui.motion.easing import GlidingValue
from woz_tui.motion.engine_io import InputResult
from woz_tui.protocol.messages import Json

#: How fast changed sizes glide, 1/s: by 95 % in 0.6 s, and a pose at the end of a range of 180
#: degrees comes to its middle with no more than 270 degrees a second.
GLIDES = 8.0

#: The traits by name, in their order.
NAMES = tuple(field.name for field in fields(Personality))


_HINTS = get_type_hints(Personality, include_extras=True)
#: What robot files say of each trait: its range, and what it is.
RANGES: Mapping[str, Range] = {
    name: next(note for note in _HINTS[name].__metadata__ if isinstance(note, Range))
    for name in NAMES
}
SUMMARIES: Mapping[str, str] = {
    name: next(note.text for note in _HINTS[name].__metadata__ if isinstance(note, Doc))
    for name in NAMES
}


class CurrentPersonality:
    """The traits of one body at this moment; units as in `body_shape.Personality`."""

    def __init__(self, first: Personality, named: Mapping[str, Personality]) -> None:
        self._named = named
        self._traits: dict[str, float | None] = asdict(first)
        self.name = next((name for name, one in named.items() if one == first), "")
        self.breathes = True
        #: Sizes on their way to what they shall be.
        self.compression = GlidingValue(first.compression, GLIDES)
        self.smoothing = GlidingValue(first.smoothing, GLIDES)
        self.amplitude = GlidingValue(first.amplitude, GLIDES)

    def __getitem__(self, trait: str) -> float:
        """A trait as it is set; `breathing_rate` follows the tempo unless it was set."""
        value = self._traits[trait]
        return self["tempo"] / 4.0 if value is None else value

    @property
    def changed(self) -> bool:
        """Whether it is no longer what its name stands for in the robot file."""
        return self.name in self._named and self._traits != asdict(self._named[self.name])

    @property
    def traits(self) -> dict[str, Json]:
        """All traits as they are set."""
        return dict(self._traits)

    def become(self, args: Mapping[str, Any]) -> InputResult:
        """Verb `personality`: a named set, single traits, or both."""
        name = args["name"]
        taken = asdict(self._named[name]) if name else {}
        taken |= {trait: args[trait] for trait in NAMES if trait in args}
        self._traits.update(taken)
        self.name = name or self.name
        return InputResult({"name": name, **taken} if name else taken)

    def turn(self, trait: str, place: float) -> None:
        """Move the knob of a trait."""
        self._traits[trait] = TRAITS[trait].value(place)

    def places(self) -> dict[str, float]:
        """Where the traits' knobs stand, 0..1."""
        return {trait: scale.place(self[trait]) for trait, scale in TRAITS.items()}

    def step(self, dt: float, exact: bool) -> None:
        """`dt` seconds later. `exact`: the body has to hit something, so it neither compresses
        nor smooths.
        """
        for size, trait in (
            (self.compression, "compression"),
            (self.smoothing, "smoothing"),
            (self.amplitude, "amplitude"),
        ):
            size.step(0.0 if exact and trait != "amplitude" else self[trait], dt)
