"""Which verbs of a robot a behaviour of BML stands for.

Names of moves and emotions are those that most robots here have; a robot that lacks one does not
play the behaviour, and the planner is told.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from woz_tui.bml.bml_block import Behaviour, WarningKind
from woz_tui.protocol.description import VerbDescription
from woz_tui.protocol.envelope import Json

#: Lexeme of a face -> emotion.
FACES: Mapping[str, str] = {
    **dict.fromkeys(("SMILE", "JOY", "HAPPINESS", "HAPPY"), "happy"),
    **dict.fromkeys(("RAISE_BROWS", "RAISE_LEFT_BROW", "RAISE_RIGHT_BROW", "SURPRISE"), "amazed"),
    **dict.fromkeys(("WIDEN_EYES", "RAISE_MOUTH_CORNERS", "AMAZED"), "amazed"),
    **dict.fromkeys(("LOWER_BROWS", "ANGER", "ANGRY", "SQUINT"), "angry"),
    **dict.fromkeys(("LOWER_MOUTH_CORNERS", "SADNESS", "SAD"), "sad"),
    **dict.fromkeys(("CLOSE_EYES", "BLINK", "SLEEPY"), "sleepy"),
    **dict.fromkeys(("NEUTRAL", "OBLIQUE_BROWS"), "neutral"),
}
#: Stance -> move.
STANCES: Mapping[str, str] = {
    **{"STANDING": "stand", "SITTING": "sit", "CROUCHING": "crouch", "LYING": "lie"},
}
#: Where a target is, in degrees: left and up of straight ahead are positive and negative.
TARGETS: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(("visitor", "participant", "audience", "user", "listener"), (0.0, 0.0)),
    **{"left": (30.0, 0.0), "right": (-30.0, 0.0), "up": (0.0, -20.0), "down": (0.0, 20.0)},
}
#: Where a direction of BML turns from a target, by degrees of its angle: yaw, pitch.
_DIRECTIONS: Mapping[str, tuple[float, float]] = {
    **{"RIGHT": (-1, 0), "LEFT": (1, 0), "UP": (0, -1), "DOWN": (0, 1)},
    **{"UPRIGHT": (-0.7, -0.7), "UPLEFT": (0.7, -0.7), "DOWNLEFT": (0.7, 0.7)},
    "DOWNRIGHT": (-0.7, 0.7),
}
#: Narrower than this is straight ahead, in degrees.
_MIDDLE = 15.0
_ANGLES = re.compile(r"^\s*(-?\d+(?:\.\d+)?)[\s,]+(-?\d+(?:\.\d+)?)\s*$")


class UnplayableError(Exception):
    """The robot does not play this behaviour; `kind` as in feedback."""

    def __init__(self, kind: WarningKind, reason: str) -> None:
        super().__init__(reason)
        self.kind = kind


@dataclass(frozen=True, slots=True)
class VerbCall:
    """A verb that begins at the sync point `point` and takes until `until`, where it can."""

    point: str
    verb: str
    args: Mapping[str, Json]
    until: str = "end"


class BehaviourCalls:
    """The verbs of one robot.

    Args:
        verbs: What it offers.
        targets: Where things are that planners look at and point to: name -> yaw and pitch in
            degrees.
    """

    def __init__(
        self, verbs: Iterable[VerbDescription], targets: Mapping[str, tuple[float, float]] = TARGETS
    ) -> None:
        self._verbs = {verb.name: verb for verb in verbs}
        self._targets = {name.lower(): place for name, place in targets.items()}

    def calls(self, behaviour: Behaviour) -> list[VerbCall]:  # noqa: PLR0911 - a table
        """What is to be called; nothing for a wait. Raises `UnplayableError`."""
        attributes = behaviour.attributes
        match behaviour.kind:
            case "wait":
                return []
            case "speech":
                return [self._call("start", "say", {"text": behaviour.text})]
            case "head" | "gesture":
                return [self._move(attributes["lexeme"], attributes)]
            case "pointing":
                yaw, _ = self._place(attributes)
                side = "left" if yaw > _MIDDLE else "right" if yaw < -_MIDDLE else "middle"
                return [self._move(f"point-{side}", attributes)]
            case "gaze":
                return [
                    self._gaze("start", "ready", self._place(attributes)),
                    self._gaze("relax", "end", (0.0, 0.0)),
                ]
            case "gazeShift" | "headDirectionShift":
                return [self._gaze("start", "end", self._place(attributes))]
            case "faceLexeme":
                return [
                    self._face("start", "attackPeak", attributes),
                    self._call("relax", "emotion", {"emotion": "neutral"}),
                ]
            case "posture" | "postureShift":
                stance = behaviour.inner.get("stance", {}).get("type", "").upper()
                if stance in STANCES:
                    return [self._move(STANCES[stance], attributes)]
        raise UnplayableError(
            "BEHAVIOR_TYPE_NOT_SUPPORTED", f"{behaviour.id}: no verb plays <{behaviour.kind}> here"
        )

    def stretched(self, call: VerbCall, seconds: float, usual: float) -> VerbCall:
        """The call so that it takes so long instead of `usual`, where the verb can."""
        arguments = {each.name: each for each in self._verbs[call.verb].arguments}
        if "seconds" in arguments and call.verb != "say":
            return replace(call, args={**call.args, "seconds": round(seconds, 3)})
        speed = arguments.get("speed")
        if speed is not None and call.verb == "play" and seconds > 0 and usual > 0:
            low, high = speed.low or 0.1, speed.high or 10.0
            factor = min(max(usual / seconds, low), high)
            return replace(call, args={**call.args, "speed": round(factor, 3)})
        return call

    # -- single calls --------------------------------------------------------------------------

    def _call(
        self, point: str, verb: str, args: Mapping[str, Json], until: str = "end"
    ) -> VerbCall:
        found = self._verbs.get(verb)
        if found is None:
            raise UnplayableError("BEHAVIOR_TYPE_NOT_SUPPORTED", f"this robot has no {verb}")
        names = {argument.name for argument in found.arguments}
        return VerbCall(
            point, verb, {key: value for key, value in args.items() if key in names}, until
        )

    def _move(self, lexeme: str, attributes: Mapping[str, str]) -> VerbCall:
        move = lexeme.strip().lower().replace("_", "-")
        call = self._call("start", "play", {"move": move})
        argument = next(each for each in self._verbs["play"].arguments if each.name == "move")
        if argument.choices and move not in argument.choices:
            raise UnplayableError("BEHAVIOR_TYPE_NOT_SUPPORTED", f"this robot has no move {move!r}")
        return call

    def _gaze(self, point: str, until: str, place: tuple[float, float]) -> VerbCall:
        return self._call(point, "gaze", {"yaw": place[0], "pitch": place[1]}, until)

    def _face(self, point: str, until: str, attributes: Mapping[str, str]) -> VerbCall:
        lexeme = attributes["lexeme"].strip().upper()
        emotion = FACES.get(lexeme, lexeme.lower())
        call = self._call(point, "emotion", {"emotion": emotion}, until)
        argument = next(
            (each for each in self._verbs["emotion"].arguments if each.name == "emotion"), None
        )
        if argument is not None and argument.choices and emotion not in argument.choices:
            raise UnplayableError(
                "BEHAVIOR_TYPE_NOT_SUPPORTED", f"this robot has no face for {lexeme}"
            )
        return call

    def _place(self, attributes: Mapping[str, str]) -> tuple[float, float]:
        target = attributes["target"]
        if found := _ANGLES.match(target):
            yaw, pitch = float(found[1]), float(found[2])
        elif target.strip().lower() in self._targets:
            yaw, pitch = self._targets[target.strip().lower()]
        else:
            raise UnplayableError("NO_SUCH_TARGET", f"nobody knows where {target!r} is")
        direction = attributes.get("offsetDirection", "").upper()
        angle = _number(attributes.get("offsetAngle", "0"))
        turn = _DIRECTIONS.get(direction, (0.0, 0.0))
        return yaw + turn[0] * angle, pitch + turn[1] * angle


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0
