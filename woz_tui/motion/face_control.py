"""State of the face: emotion, gaze, lids, brightness, from people and from moves.

People write an emotion in four ways (by name, by intensity, as a mood, as a breakdown) and they
all write the same thing: the last one counts, and everything that shows it follows. What a move
or a mode wants of the face lies on top as long as it lasts, except for what people touch then.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping
from typing import Any

from woz_tui.motion.control_scales import FACE
from woz_tui.motion.emotions import affect_emotion, emotion_affect
from woz_tui.motion.engine_io import EndedInput, InputResult
from woz_tui.motion.face_drawing import CRASH_S, FaceState
from woz_tui.motion.move_types import FaceChange
from woz_tui.motion.personality import CurrentPersonality
from woz_tui.motion.pose_sources import FaceOverlay
from woz_tui.protocol.messages import Json

# -- blinking -------------------------------------------------------------------------------------
# Blinking: the eyes' height goes along a cosine from open to closed and back.


class Blinks:
    """Decides when to blink, by chance that starts from `seed`, and how open the eyes are."""

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(seed)
        self._waited = 0.0  # in mean pauses
        self._draw = self._chance.uniform(-0.5, 0.5)
        self._phase: float | None = None

    @property
    def blinking(self) -> bool:
        """Whether a blink is going on."""
        return self._phase is not None

    def begin(self) -> None:
        """Blink now; one that is going on is left alone."""
        if self._phase is None:
            self._phase = 0.0

    def open(self) -> None:
        """Have the eyes open at once."""
        self._phase = None

    def step(self, dt: float, rate: float, length: float, irregularity: float) -> float:
        """How open the eyes are, 0..1, `dt` seconds later.

        Args:
            dt: Seconds.
            rate: Blinks a minute; 0 for one who does not blink by itself.
            length: Seconds a blink takes.
            irregularity: 0..1; at 1 pauses lie between half and one and a half of the mean.
        """
        if self._phase is not None:
            self._phase += dt / length
            if self._phase >= 1.0:
                self._phase = None
        if rate > 0.0:
            self._waited += dt * rate / 60.0
            if self._waited >= 1.0 + irregularity * self._draw:
                self._waited = 0.0
                self._draw = self._chance.uniform(-0.5, 0.5)
                self.begin()
        if self._phase is None:
            return 1.0
        return 0.5 + 0.5 * math.cos(2.0 * math.pi * self._phase)


# --------------------------------------------------------------------------------------------------

NEUTRAL, CRASH = "neutral", "crash"
#: A mouth opens in so many steps: more could not be told apart on lights.
MOUTHS = 4
_NO_OVERLAY = FaceOverlay()
_NO_CHANGE = FaceChange()


class FaceControl:
    """The state of one face.

    Args:
        seed: Of its blinks.
        token: Names the next input that takes time.
    """

    def __init__(self, seed: int, token: Callable[[], int]) -> None:
        self._token = token
        self.emotion = NEUTRAL
        self.intensity = 1.0  # of the next emotion, while it is neutral
        self.valence, self.arousal = 0.0, 0.0
        self.x, self.y = 0.0, 0.0
        self.brightness = 1.0
        self.blinks_by_itself = True
        #: How wide the mouth is open, 0..1: as loud as the robot's voice is.
        self.mouth = 0.0
        #: Where the eyes look while somebody else leads them: saccade following.
        self.led: tuple[float, float] | None = None
        self._blinks = Blinks(seed)
        self._lid = 1.0
        self._crash: float | None = None
        self._crash_token = 0
        self._overlay: FaceOverlay = _NO_OVERLAY
        self._overlay_crash: float | None = None
        self._touched: set[str] = set()
        self._ended: list[EndedInput] = []

    # -- what people write ----------------------------------------------------------------------

    def show(self, args: Mapping[str, Any]) -> InputResult:
        """Verb `emotion`. A breakdown plays and leads back to the emotion from before; it takes
        time, so it gets a token.
        """
        emotion, intensity = args["emotion"], args.get("intensity", self.intensity)
        self._touched |= {"emotion", "intensity"}
        self.end_crash(f"replaced by {emotion}")
        sent: dict[str, Json] = {"emotion": emotion, "intensity": intensity}
        if emotion == CRASH:
            self._crash, self._crash_token = 0.0, self._token()
            return InputResult(sent, self._crash_token, CRASH_S)
        self._set_emotion(emotion, intensity)
        return InputResult(sent)

    def show_affect(self, valence: float, arousal: float) -> InputResult:
        """Verb `affect`: an emotion as a mood."""
        emotion, intensity = affect_emotion(valence, arousal)
        self._touched |= {"emotion", "intensity"}
        self.end_crash("replaced by a mood")
        self._set_emotion(emotion, self.intensity if emotion == NEUTRAL else intensity)
        self.valence, self.arousal = valence, arousal
        return InputResult(
            {"valence": valence, "arousal": arousal, "emotion": emotion, "intensity": intensity}
        )

    def look_at(self, x: float, y: float) -> InputResult:
        self._touched |= {"x", "y"}
        self.x, self.y = x, y
        return InputResult({"x": x, "y": y})

    def turn(self, control: str, place: float) -> None:
        """Move one of the face's knobs."""
        value = FACE[control].value(place)
        match control:
            case "eye-x":
                self.look_at(value, self.y)
            case "eye-y":
                self.look_at(self.x, value)
            case "valence":
                self.show_affect(value, self.arousal)
            case "arousal":
                self.show_affect(self.valence, value)
            case "intensity":
                self._touched.add("intensity")
                self._set_emotion(self.emotion, value)
            case _:
                self.brightness = value

    @property
    def blinking(self) -> bool:
        """Whether the eyes are on their way down or up again."""
        return self._blinks.blinking

    def blink(self) -> None:
        self._blinks.begin()

    def end_crash(self, why: str) -> None:
        """End a breakdown, if there is one."""
        if self._crash is not None:
            self._ended.append(EndedInput(self._crash_token, why))
            self._crash = None

    def drop(self, token: int, why: str) -> None:
        """End a breakdown if it has this token."""
        if token == self._crash_token:
            self.end_crash(why)

    def rest(self) -> None:
        """Open the eyes and drop the overlay."""
        self._blinks.open()
        self._lid = 1.0
        self._overlay = _NO_OVERLAY

    def _set_emotion(self, emotion: str, intensity: float) -> None:
        self.emotion, self.intensity = emotion, intensity
        self.valence, self.arousal = emotion_affect(emotion, intensity)

    # -- what moves and modes want --------------------------------------------------------------

    def set_overlay(self, wish: FaceOverlay | None) -> None:
        """Lay this over what people have set; None: nothing."""
        self._overlay = wish or _NO_OVERLAY

    def begin_overlay(self) -> None:
        """A new source of the pose begins: its overlay wins over what people set before."""
        self._touched.clear()
        self._overlay = _NO_OVERLAY
        self._overlay_crash = None

    # -- what is shown --------------------------------------------------------------------------

    @property
    def shown(self) -> tuple[str, float]:
        """Emotion and intensity as they are seen; neutral has none."""
        if self._crash is not None:
            return CRASH, 1.0
        face = self._overlay.face or _NO_CHANGE
        emotion, intensity = self.emotion, self.intensity
        if face.emotion is not None and "emotion" not in self._touched:
            emotion = face.emotion
            intensity = 1.0 if face.intensity is None else face.intensity
        if face.intensity is not None and "intensity" not in self._touched:
            intensity = face.intensity
        return emotion, 0.0 if emotion == NEUTRAL else min(1.0, max(0.0, intensity))

    @property
    def eyes(self) -> tuple[float, float]:
        """Where the eyes are seen to look, -1..1."""
        if self.led is not None:
            return self.led
        face = self._overlay.face or _NO_CHANGE
        x = self.x if face.x is None or "x" in self._touched else face.x
        y = self.y if face.y is None or "y" in self._touched else face.y
        across, up = self._overlay.glance
        return min(1.0, max(-1.0, x + across)), min(1.0, max(-1.0, y + up))

    def step(self, dt: float, character: CurrentPersonality, may_blink: bool) -> None:
        """`dt` seconds later."""
        if self._crash is not None:
            self._crash += dt
            if self._crash >= CRASH_S:
                self.end_crash("")
        wished = (
            self._overlay.face or _NO_CHANGE
        ).emotion == CRASH and "emotion" not in self._touched
        self._overlay_crash = (self._overlay_crash or 0.0) + dt if wished else None
        by_itself = may_blink and self.blinks_by_itself
        self._lid = self._blinks.step(
            dt,
            character["blink_rate"] if by_itself else 0.0,
            character["blink_time"],
            character["blink_irregularity"],
        )

    def state(self) -> FaceState:
        """What is to be drawn; rounded far below a light, so that pictures can be kept."""
        emotion, intensity = self.shown
        x, y = self.eyes
        lid = self._lid
        face = self._overlay.face
        if face is not None and face.lid is not None:
            lid = min(lid, max(0.0, face.lid))
        crash = self._overlay_crash if self._crash is None else self._crash
        return FaceState(
            *(round(x, 3), round(y, 3), emotion, round(intensity, 3), round(lid, 3), crash),
            mouth=round(self.mouth * MOUTHS) / MOUTHS,
        )

    def ended(self) -> list[EndedInput]:
        """Inputs that ended since the last call."""
        ended, self._ended = self._ended, []
        return ended

    def places(self) -> dict[str, float]:
        """Where the face's knobs stand, 0..1."""
        values = {
            "eye-x": self.x,
            "eye-y": self.y,
            "valence": self.valence,
            "arousal": self.arousal,
            "intensity": self.intensity,
            "brightness": self.brightness,
        }
        return {name: FACE[name].place(value) for name, value in values.items()}
