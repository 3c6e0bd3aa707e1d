"""What a panel's map says; two that need no file, for a panel like the Korg nanoKONTROL2.

`nanokontrol2` is how the EyePi robot was played in its published program (UTRobotics, University
of Twente). `thesis` is appendix A of J. Oosterkamp's thesis. Here buttons 1-8 are the upper row
(S, control changes 32-39), 9-16 the middle one (M, 48-55), 17-24 the lower one (R, 64-71); the
appendix counts its buttons from above to below, then from left to right, so its 7, 8 and 9 are
S3, M3 and R3. It leaves out button 15; the mode without a button, saccade following, lies there.
Neither source uses the transport keys: the session's own things are there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.midi.layouts import LAYOUTS
from woz_drivers.midi.mapped import Mapped
from woz_drivers.midi.rules import claimed_twice, found_in
from woz_tui.core.fields import Doc, OneOf, Section


@dataclass(frozen=True, slots=True)
class PanelMap(Section):
    """A whole panel: a file of its own, or right in the robot file."""

    title: Annotated[str, Doc("what it is")] = ""
    layout: Annotated[
        str, OneOf(tuple(LAYOUTS)), Doc("a panel whose controls are known by name; none: see cc")
    ] = "none"
    device: Annotated[str, Doc("the sound card's name, as in /proc/asound/cards")] = ""
    controls: Annotated[dict[str, Mapped], Doc("control -> what it does")] = field(
        default_factory=dict
    )

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        layout = LAYOUTS[self.layout]
        return [*found_in(self.controls, layout), *claimed_twice(self, tuple(self.controls))]


_TRANSPORT = {
    "stop": Mapped(stop="all"),
    "cycle": Mapped(release=True),
    "play": Mapped(script=True),
    "record": Mapped(mark="panel"),
}


def _play(move: str) -> Mapped:
    return Mapped(play=move)


NANOKONTROL2 = PanelMap(
    title="EyePi on a Korg nanoKONTROL2",
    layout="nanokontrol2",
    controls={
        "slider-1": Mapped(control="middle"),
        "slider-2": Mapped(control="top", reversed=True),
        "slider-3": Mapped(control="zoom"),
        "slider-5": Mapped(control="arousal"),
        "slider-6": Mapped(control="valence"),
        "slider-7": Mapped(control="intensity"),
        "slider-8": Mapped(control="eye-y"),
        "knob-1": Mapped(control="pitch"),
        "knob-2": Mapped(control="tempo"),
        "knob-3": Mapped(control="smoothing"),
        "knob-4": Mapped(control="compression"),
        "knob-7": Mapped(control="brightness"),
        "knob-8": Mapped(control="eye-x"),
        "button-3": _play("nod"),
        "button-4": Mapped(stop="normal"),
        "button-5": Mapped(mode="demo"),
        "button-6": Mapped(emotion="friendly"),
        "button-7": Mapped(emotion="neutral"),
        "button-8": Mapped(emotion="happy"),
        "button-11": _play("shake"),
        "button-12": _play("point-left"),
        "button-13": _play("point-right"),
        "button-14": Mapped(mode="tracking"),  # ours: that program had no key for it
        "button-15": Mapped(emotion="sleepy"),
        "button-16": Mapped(emotion="amazed"),
        "button-19": _play("dance"),
        "button-20": _play("point-middle"),
        "button-21": Mapped(mode="saccade"),
        "button-22": Mapped(emotion="crash"),
        "button-23": Mapped(emotion="sad"),
        "button-24": Mapped(emotion="angry"),
        **_TRANSPORT,
    },
)

THESIS = PanelMap(
    title="Oosterkamp's appendix A on a Korg nanoKONTROL2",
    layout="nanokontrol2",
    controls={
        "knob-1": Mapped(control="pitch"),
        "knob-2": Mapped(control="tempo"),
        "knob-3": Mapped(control="smoothing"),
        "knob-4": Mapped(control="compression"),
        "knob-8": Mapped(control="eye-x"),
        "button-3": _play("nod"),  # 7 in the appendix, and so on down each column
        "button-11": _play("shake"),
        "button-19": _play("dance"),
        "button-4": Mapped(stop="normal"),
        "button-12": Mapped(stop="normal"),
        "button-20": Mapped(stop="normal"),
        "button-5": Mapped(mode="demo"),
        "button-13": Mapped(mode="tracking"),
        "button-21": Mapped(mode="saccade"),  # 15, which the appendix leaves out
        "button-22": Mapped(emotion="crash"),  # 18
        "button-7": Mapped(emotion="neutral"),
        "button-15": Mapped(emotion="sleepy"),
        "button-23": Mapped(emotion="sad"),
        "button-8": Mapped(emotion="happy"),
        "button-16": Mapped(emotion="amazed"),
        "button-24": Mapped(emotion="angry"),
        "slider-1": Mapped(control="middle"),
        "slider-2": Mapped(control="top"),
        "slider-3": Mapped(control="zoom"),
        "slider-5": Mapped(control="arousal"),
        "slider-6": Mapped(control="valence"),
        "slider-7": Mapped(control="intensity"),
        **_TRANSPORT,
    },
)

#: By the names under which robot files know them.
BUILT_IN: Mapping[str, PanelMap] = {"nanokontrol2": NANOKONTROL2, "thesis": THESIS}
