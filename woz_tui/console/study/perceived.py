"""What the wizard does not get to see, so as to know no more than the robot could.

As with blind conditions, messages are changed before the picture takes them: what is hidden never
arrives there. Its place on the screen stays, with a word that it is kept from the wizard.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import msgspec

from woz_tui.core import messages as m
from woz_tui.core.messages import Json
from woz_tui.core.settings import StudySettings
from woz_tui.experiment.engagement import STATES
from woz_tui.experiment.study import BLURRED, PERCEIVED
from woz_tui.sensing.proxemics import ZONES

#: What stands in the place of something hidden.
HIDDEN = "hidden"
#: How a sign of the engagement model says that it is hidden, or only known coarsely.
KEPT, COARSE = "hidden", "blurred"
#: The signs of the engagement model among what can be hidden.
_SIGNS = ("presence", "gaze", "distance", "identity")
#: Blurred, a distance is near up to the end of personal space (see `sensing.proxemics`), in metres.
NEAR_M = next(limit for limit, name in ZONES if name == "personal")
#: Blurred, a loudness is loud from the threshold of speech on; where none is told, from here (RMS).
LOUD = 0.02
#: Blurred, what was said is as many dots as it has more words than these.
_WORDS = (0, 3, 10)
_DOT = "●"
#: Values of a body that its face shows.
_FACE = frozenset(("emotion", "intensity", "valence", "arousal", "eye_x", "eye_y"))

#: Settings of a robot that its face shows.
_EYES = frozenset(("eyes", "eyes_brightness"))

#: Notices of the engagement model, and those that may tell what a sensor measured.
_MODEL = ("handshake:", "engagement:")
_SENSED = re.compile(
    r"\b(loud|louder|loudest|quiet|speech|distance|metres|near|far)\b", re.IGNORECASE
)
_FIGURE = re.compile(r"\d+(\.\d+)?")


class Perception:
    """What passes of each message. `hidden` and `blurred`: see `experiment.study`."""

    def __init__(self, hidden: Iterable[str] = (), blurred: Iterable[str] = ()) -> None:
        self.hidden = frozenset(hidden) & frozenset(PERCEIVED)
        self.blurred = (frozenset(blurred) & frozenset(BLURRED)) - self.hidden
        self._thresholds: dict[str, float] = {}

    def __bool__(self) -> bool:
        """Whether anything is kept from the wizard."""
        return bool(self.hidden or self.blurred)

    def __eq__(self, other: object) -> bool:
        """Two that keep the same."""
        return isinstance(other, Perception) and (self.hidden, self.blurred) == (
            other.hidden,
            other.blurred,
        )

    __hash__ = None  # type: ignore[assignment]

    def hides(self, what: str) -> bool:
        """Whether it is not shown at all."""
        return what in self.hidden

    def blurs(self, what: str) -> bool:
        """Whether it is shown, but not legibly."""
        return what in self.blurred

    def keeps(self, *names: str) -> bool:
        """Whether any of these is not shown as it is."""
        return any(name in self.hidden or name in self.blurred for name in names)

    def message(self, told: m.Message) -> m.Message | None:
        """What the wizard may know of it; None: nothing."""
        change = _CHANGES.get(type(told)) if self else None
        return change(self, told) if change is not None else told

    def finding(self, subject: str, text: str) -> str:
        """What a check found out about `subject`, without the value of what is kept."""
        kind = kind_of(subject)
        hears = self.keeps("transcript") and subject == "speech"
        return "gives values" if hears or (kind and self.keeps(kind)) else text

    # -- sensors ------------------------------------------------------------------------------

    def _reading(self, told: m.Reading) -> m.Message:
        kind = kind_of(told.sensor)
        if kind == "loudness" and told.value is not None and told.sensor.endswith(".threshold"):
            self._thresholds[told.sensor.removesuffix(".threshold")] = told.value
        if self.hides(kind):
            return msgspec.structs.replace(told, value=None, text="")
        if self.blurs(kind):
            return msgspec.structs.replace(told, value=None, text=self._coarse(kind, told))
        return told

    def _coarse(self, kind: str, told: m.Reading) -> str:
        if told.value is None:
            return ""
        if kind == "distance":
            return "near" if told.value < NEAR_M else "far"
        return "loud" if told.value >= self._thresholds.get(told.sensor, LOUD) else "quiet"

    def _sensor(self, told: m.SensorChanged) -> m.Message | None:
        kind = kind_of(told.sensor)
        if self.hides(kind):
            return None
        return msgspec.structs.replace(told, why="") if self.blurs(kind) else told

    # -- the engagement model -----------------------------------------------------------------

    def _shown(self, told: m.EngagementShown) -> m.Message | None:
        if self.hides("engagement"):
            return None
        signs = {name: self._sign(name, sign) for name, sign in told.signs.items()}
        visitor = "" if self.hides("identity") else told.visitor
        return msgspec.structs.replace(told, signs=signs, visitor=visitor)

    def _sign(self, name: str, sign: m.SignShown) -> m.SignShown:
        if self.hides(name):
            return m.SignShown(filter=KEPT, forced=sign.forced)
        if self.blurs(name):
            return m.SignShown(
                filter=COARSE, verdict=sign.verdict, stale=sign.stale, forced=sign.forced
            )
        return sign

    def _changed(self, told: m.EngagementChanged) -> m.Message | None:
        """Without its reason where that may tell a sign that is kept."""
        if self.hides("engagement"):
            return None
        if not self.keeps(*_SIGNS, "transcript"):
            return told
        verdicts: dict[str, Json] = {
            name: value
            for name, value in told.verdicts.items()
            if not self.hides("identity" if name == "id" else name)
        }
        visitor = "" if self.hides("identity") else told.visitor
        return msgspec.structs.replace(told, why="", verdicts=verdicts, visitor=visitor)

    def _visitor(self, told: m.VisitorChanged) -> m.Message | None:
        return None if self.hides("identity") else told

    def _effect(self, told: m.ActionRequested | m.ActionEnd | m.Command) -> m.Message:
        """What a state of the model brings with it is named after the state."""
        state = told.action.removeprefix("on ")
        if not self.hides("engagement") or state not in STATES or state == told.action:
            return told
        return msgspec.structs.replace(told, action="on engagement")

    def _mode(self, told: m.ModeChanged) -> m.Message:
        return msgspec.structs.replace(told, why="") if self.keeps("engagement", *_SIGNS) else told

    def _notice(self, told: m.Notice) -> m.Message | None:
        """Without figures of what is kept; what a hidden model wants of the wizard is left out."""
        if self.hides("engagement") and told.level == "info" and told.text.startswith(_MODEL):
            return None
        if not self.keeps("loudness", "distance") or not _SENSED.search(told.text):
            return told
        text, remedy = (_FIGURE.sub("…", words) for words in (told.text, told.remedy))
        return msgspec.structs.replace(told, text=text, remedy=remedy)

    # -- what is said, what the robot looks like ------------------------------------------------

    def _begins(self, told: m.SpeechStarted) -> m.Message | None:
        return None if self.hides("loudness") else told

    def _ends(self, told: m.SpeechEnded) -> m.Message | None:
        return None if self.hides("loudness") and not told.detail else told

    def _heard(self, told: m.SpeechText) -> m.Message | None:
        if self.hides("transcript"):
            return None
        return self._blurred(told) if self.blurs("transcript") else told

    def _blurred(self, told: m.SpeechText) -> m.Message:
        return msgspec.structs.replace(told, text=dots(told.text))

    def _cue(self, told: m.CueGiven) -> m.Message:
        if not told.text or not self.keeps("transcript"):
            return told
        text = "" if self.hides("transcript") else dots(told.text)
        return msgspec.structs.replace(told, text=text)

    def _face(self, told: m.FaceShown) -> m.Message | None:
        return None if self.hides("face") else told

    def _body(self, told: m.BodyChanged) -> m.Message:
        """A body's values, without what its face shows."""
        if not self.hides("face"):
            return told
        return msgspec.structs.replace(told, values=_faceless(told.values))

    def _settings(self, told: m.SettingsShown) -> m.Message:
        """A robot's settings, without those that its face shows."""
        if not self.hides("face"):
            return told
        return msgspec.structs.replace(
            told, values=eyeless(told.values), wanted=eyeless(told.wanted)
        )


def _faceless(values: object) -> dict[str, Json]:
    """A body's values, those that its face shows as the word that they are hidden."""
    told = values if isinstance(values, dict) else {}
    return {
        name: HIDDEN if name in _FACE else _faceless(value) if isinstance(value, dict) else value
        for name, value in told.items()
    }


def eyeless(values: object) -> dict[str, Json]:
    """A robot's settings, those of its eyes as the word that they are hidden."""
    told = values if isinstance(values, dict) else {}
    return {name: HIDDEN if name in _EYES else value for name, value in told.items()}


def dots(text: str) -> str:
    """One to three dots for a short, a longer and a long utterance; none for an empty one."""
    words = len(text.split())
    return " ".join(_DOT for more in _WORDS if words > more)


def kind_of(sensor: str) -> str:
    """What a sensor tells, in the words of the experiment file: `left.joint.pan` -> `joints`; a
    sensor that cannot be hidden is empty.
    """
    parts = sensor.split(".")
    if "joint" in parts or "setpoint" in parts:
        return "joints"
    return next((part for part in reversed(parts) if part in PERCEIVED), "")


def perception_of(study: StudySettings) -> Perception:
    """As a welcome's settings tell it."""
    return Perception(study.perception.hide, study.perception.blur)


_CHANGES: Mapping[type[m.Message], Callable[[Perception, Any], m.Message | None]] = {
    m.Reading: Perception._reading,
    m.SensorChanged: Perception._sensor,
    m.EngagementShown: Perception._shown,
    m.EngagementChanged: Perception._changed,
    m.VisitorChanged: Perception._visitor,
    m.ModeChanged: Perception._mode,
    m.Notice: Perception._notice,
    m.SpeechStarted: Perception._begins,
    m.SpeechEnded: Perception._ends,
    m.SpeechText: Perception._heard,
    m.CueGiven: Perception._cue,
    m.FaceShown: Perception._face,
    m.BodyChanged: Perception._body,
    m.SettingsShown: Perception._settings,
    **dict.fromkeys(
        (m.ActionRequested, m.ActionDone, m.ActionFailed, m.ActionStopped, m.ActionRefused),
        Perception._effect,
    ),
    m.Command: Perception._effect,
}
