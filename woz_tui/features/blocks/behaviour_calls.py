"""Which verbs of a robot a behaviour of BML stands for.

What the robot's own table says comes first (`bml:` in its file), then what robots here usually call
their moves and expressions. What a robot has nothing for is not played, and the planner is told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.bridge.ros_data import RosDataError, read_data
from woz_tui.bridge.topic_table import TopicTable
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.features.blocks.bml_block import Behaviour, WarningKind
from woz_tui.protocol.envelope import Json

#: Lexeme of a head movement or a gesture -> what robots play for it, the best first. The lexeme
#: itself in small letters (`POINT_LEFT`: `point-left`) comes before these.
MOVES: Mapping[str, tuple[str, ...]] = {
    "NOD": ("play nod", "play Yes_1"),
    "SHAKE": ("play shake", "play No_3", "play No_1"),
    "TILT": ("play tilt", "play roll"),
    "BEAT": ("play beat", "play Explain_1", "play bounce", "play nod"),
    **dict.fromkeys(("WAVE", "GREET", "HELLO"), ("play wave", "play greet", "play Hey_1")),
    "BOW": ("play bow", "play BowShort_1"),
    "DANCE": ("play dance",),
}
#: Lexeme of a face -> the same.
FACES: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("SMILE", "JOY", "HAPPINESS", "HAPPY", "RAISE_MOUTH_CORNERS"),
        ("emotion happy", "play smile", "play happy"),
    ),
    **dict.fromkeys(
        ("RAISE_BROWS", "RAISE_LEFT_BROW", "RAISE_RIGHT_BROW", "SURPRISE", "WIDEN_EYES", "AMAZED"),
        ("emotion amazed", "emotion surprised", "play BrowRaise"),
    ),
    "OPEN_MOUTH": ("emotion amazed", "emotion surprised", "play Oh"),
    **dict.fromkeys(("LOWER_BROWS", "ANGER", "ANGRY"), ("emotion angry", "play frown")),
    "SQUINT": ("emotion angry",),
    **dict.fromkeys(("LOWER_MOUTH_CORNERS", "SADNESS", "SAD"), ("emotion sad",)),
    **dict.fromkeys(("FEAR", "AFRAID"), ("emotion afraid", "emotion amazed", "emotion surprised")),
    **dict.fromkeys(("DISGUST", "DISGUSTED"), ("emotion disgusted", "emotion angry")),
    "BLINK": ("blink", "play blink", "emotion sleepy"),
    "WINK": ("play wink", "blink"),
    **dict.fromkeys(("CLOSE_EYES", "SLEEPY"), ("emotion sleepy", "play CloseEyes")),
    **dict.fromkeys(("NEUTRAL", "OBLIQUE_BROWS"), ("emotion neutral",)),
}
#: Action unit of FACS -> the lexeme whose expression is nearest.
ACTION_UNITS: Mapping[str, str] = {
    **dict.fromkeys(("1", "2"), "RAISE_BROWS"),
    **{"4": "LOWER_BROWS", "5": "WIDEN_EYES", "6": "SMILE", "7": "SQUINT", "12": "SMILE"},
    **{"9": "DISGUST", "10": "DISGUST", "15": "LOWER_MOUTH_CORNERS", "17": "LOWER_MOUTH_CORNERS"},
    **{"20": "FEAR", "23": "ANGER", "24": "ANGER", "43": "CLOSE_EYES", "45": "BLINK", "46": "WINK"},
    **dict.fromkeys(("25", "26", "27"), "OPEN_MOUTH"),
}
#: Stance -> the same as for moves.
STANCES: Mapping[str, tuple[str, ...]] = {
    "STANDING": ("posture Stand", "play stand", "play attentive"),
    "SITTING": ("posture Sit", "play sit"),
    "CROUCHING": ("posture Crouch", "play crouch"),
    "LYING": ("posture LyingBack", "play lie", "play asleep"),
}
#: Where a target is, in degrees: left and down of straight ahead are positive.
TARGETS: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(("visitor", "participant", "audience", "user", "listener"), (0.0, 0.0)),
    **{"left": (30.0, 0.0), "right": (-30.0, 0.0), "up": (0.0, -20.0), "down": (0.0, 20.0)},
}
#: Where a walk goes that names a direction, in metres ahead and to the left.
STEPS: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(("forward", "forwards", "ahead"), (0.5, 0.0)),
    **dict.fromkeys(("back", "backward", "backwards"), (-0.5, 0.0)),
    **{"left": (0.0, 0.5), "right": (0.0, -0.5)},
}
#: Verbs that go to a place by its name, where a robot has one.
GO_TO = ("goto", "go_to", "navigate")
#: Which verb a single word of the robot's table stands for, by behaviour; the first that it has.
WORD_VERBS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("gesture", "head", "pointing"), ("play",)),
    **dict.fromkeys(("faceLexeme", "faceFacs"), ("emotion", "play")),
    "posture": ("posture", "play"),
    "locomotion": GO_TO,
}
#: Where a direction of BML turns from a target, by degrees of its angle: yaw, pitch.
_DIRECTIONS: Mapping[str, tuple[float, float]] = {
    **{"RIGHT": (-1, 0), "LEFT": (1, 0), "UP": (0, -1), "DOWN": (0, 1)},
    **{"UPRIGHT": (-0.7, -0.7), "UPLEFT": (0.7, -0.7), "DOWNLEFT": (0.7, 0.7)},
    "DOWNRIGHT": (-0.7, 0.7),
}
#: A length that differs by less is no other one, in seconds.
ALIKE_S = 0.02
#: Narrower than this is straight ahead, in degrees.
_MIDDLE = 15.0
_PAIR = re.compile(r"^\s*(-?\d+(?:\.\d+)?)[\s,]+(-?\d+(?:\.\d+)?)\s*$")


class UnplayableError(Exception):
    """The robot does not play this behaviour; `kind` as in feedback."""

    def __init__(self, reason: str, kind: WarningKind = "BEHAVIOR_TYPE_NOT_SUPPORTED") -> None:
        super().__init__(reason)
        self.kind = kind


@dataclass(frozen=True, slots=True)
class VerbCall:
    """A verb that begins at the sync point `point` and takes until `until`, where it can; the
    `turn`-th of `turns` repetitions that share this time.
    """

    point: str
    verb: str
    args: Mapping[str, Json]
    driver: str = ""
    until: str = "end"
    turn: int = 0
    turns: int = 1

    def span(self, times: Mapping[str, float]) -> tuple[float, float]:
        """Its beginning and its length, in seconds, where the sync points are at `times`."""
        seconds = (times[self.until] - times[self.point]) / self.turns
        return times[self.point] + self.turn * seconds, seconds

    @property
    def words(self) -> str:
        """`play nod`, or `gaze yaw 20, pitch 0`."""
        parts = [
            value
            if isinstance(value, str)
            else f"{name} {value:g}"
            if isinstance(value, float | int)
            else f"{name} {value}"
            for name, value in self.args.items()
        ]
        return f"{self.verb} {', '.join(parts)}".strip()


@dataclass(frozen=True, slots=True)
class TableCall:
    """A verb in a robot's table."""

    verb: str
    args: Mapping[str, Json]
    driver: str


@dataclass(frozen=True, slots=True)
class BmlTable:
    """The section `bml` of a robot file.

    `calls`: behaviour -> lexeme, action unit, stance or place -> what is done for it. `targets`:
    name -> yaw and pitch in degrees. `moves`: the robot file's own names of moves. `topics`: what
    EyePi's extension of BML refers to; None: the robot has none.
    """

    calls: Mapping[str, Mapping[str, tuple[TableCall, ...]]] = field(default_factory=dict)
    targets: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    moves: Mapping[str, str] = field(default_factory=dict)
    topics: TopicTable | None = None


#: Whether a driver finds nothing wrong with a verb and its arguments, as far as can be said.
Accepts = Callable[[str, str, Mapping[str, Json]], bool]


class BehaviourCalls:
    """The verbs of one robot.

    Args:
        verbs: What it offers, each with the name of its driver.
        table: What its file says.
        accepts: Whether a driver finds nothing wrong with a verb and its arguments.
    """

    def __init__(
        self,
        verbs: Iterable[tuple[str, Verb]],
        table: BmlTable | None = None,
        accepts: Accepts = lambda driver, verb, args: True,
    ) -> None:
        #: Of several drivers with one verb the first; `_every` has all.
        self._verbs: dict[str, tuple[str, Verb]] = {}
        self._every: dict[tuple[str, str], Verb] = {}
        for driver, verb in verbs:
            self._verbs.setdefault(verb.name, (driver, verb))
            self._every[driver, verb.name] = verb
        self._table = table or BmlTable()
        self._accepts = accepts
        self._targets = {**TARGETS, **{n.lower(): at for n, at in self._table.targets.items()}}

    def calls(self, behaviour: Behaviour) -> list[VerbCall]:
        """What is to be called; nothing for a wait. Raises `UnplayableError`."""
        attributes = behaviour.attributes
        match behaviour.kind:
            case "wait":
                return []
            case "speech":
                return [self._call("say", {"text": behaviour.text})]
            case "head" | "gesture":
                return self._repeated(self._move(behaviour.kind, attributes["lexeme"]), behaviour)
            case "pointing":
                return self._pointing(attributes)
            case "gaze":
                return [
                    replace(self._gaze(self._place(attributes)), until="ready"),
                    replace(self._gaze((0.0, 0.0)), point="relax"),
                ]
            case "gazeShift" | "headDirectionShift":
                return [self._gaze(self._place(attributes))]
            case "faceLexeme" | "faceFacs" | "face" | "faceShift":
                return self._face(behaviour)
            case "posture" | "postureShift":
                return self._posture(behaviour)
            case "locomotion":
                return self._locomotion(attributes["target"])
            case "eyePiGaze":
                ahead = {"influence": attributes.get("influence", "")}
                return [
                    replace(self._look(attributes), until="ready"),
                    replace(self._look(ahead), point="relax"),
                ]
            case "EyePiGazeShift":
                return [self._look(attributes)]
            case "directRosMessage":
                return self._message(attributes["topic"], behaviour.text)
        raise UnplayableError(f"no verb plays <{behaviour.kind}> here")

    def stretched(self, call: VerbCall, seconds: float, usual: float) -> VerbCall:
        """The call so that it takes so long instead of `usual`, where the verb can."""
        arguments = {each.name: each for each in self._verb_of(call).arguments}
        if call.verb == "say":
            return call
        if "seconds" in arguments:
            return replace(call, args={**call.args, "seconds": round(seconds, 3)})
        speed = arguments.get("speed")
        alike = abs(seconds - usual) < ALIKE_S
        if speed is not None and call.verb == "play" and seconds > 0 < usual and not alike:
            bounds = speed.range
            low = (bounds.low if bounds is not None else None) or 0.1
            high = (bounds.high if bounds is not None else None) or 10.0
            faster = _number(call.args.get("speed"), 1.0) * usual / seconds
            return replace(call, args={**call.args, "speed": round(min(max(faster, low), high), 3)})
        return call

    def lane(self, call: VerbCall) -> tuple[str, str]:
        """Driver and lane in which it is carried out."""
        return call.driver, self._verb_of(call).lane

    def _verb_of(self, call: VerbCall) -> Verb:
        return self._every[call.driver, call.verb]

    # -- by the table, or by what is usual -------------------------------------------------------

    def _found(self, kind: str, lexeme: str, usual: Sequence[str]) -> list[VerbCall]:
        """What the robot's table says, else the first of `usual` (`play nod`) that the robot has;
        nothing: neither.
        """
        if own := self._from_table(kind, lexeme):
            return own
        for words in usual:
            verb, _, value = words.partition(" ")
            if (call := self._call_if_there(verb, value)) is not None:
                return [call]
        return []

    def _from_table(self, kind: str, lexeme: str) -> list[VerbCall]:
        entries = self._table.calls.get(kind, {})
        alike = FACES.get(lexeme.upper(), ()) if kind == "faceLexeme" else ()
        exact = (each for name, each in entries.items() if _same(name, lexeme))
        near = (
            each for name, each in entries.items() if alike and FACES.get(name.upper()) == alike
        )
        found = next(exact, None) or next(near, ())
        return [VerbCall("start", each.verb, each.args, each.driver) for each in found]

    def _call_if_there(self, verb: str, value: str) -> VerbCall | None:
        """The call if the robot has the verb, and this among its choices."""
        driver, found = self._verbs.get(verb, ("", None))
        if found is None:
            return None
        main = found.arguments[0] if found.arguments else None
        if not value or main is None:
            complete = not any(argument.required for argument in found.arguments)
            return VerbCall("start", verb, {}, driver) if complete and not value else None
        if verb == "play":
            value = self._table.moves.get(value, value)
        args: dict[str, Json] = {main.name: value}
        fits = value in main.choices if main.choices else self._accepts(driver, verb, args)
        return VerbCall("start", verb, args, driver) if fits else None

    def _call(self, verb: str, args: Mapping[str, Json]) -> VerbCall:
        driver, found = self._verbs.get(verb, ("", None))
        if found is None:
            raise UnplayableError(f"this robot has no verb {verb!r}")
        names = {argument.name for argument in found.arguments}
        return VerbCall("start", verb, {k: v for k, v in args.items() if k in names}, driver)

    def _with(self, call: VerbCall, argument: str, value: float) -> VerbCall:
        """The call with a number, where its verb takes one and the table does not say it."""
        known: dict[str, Argument] = {each.name: each for each in self._verb_of(call).arguments}
        if argument not in known or argument in call.args:
            return call
        return replace(call, args={**call.args, argument: round(value, 3)})

    # -- behaviours --------------------------------------------------------------------------------

    def _move(self, kind: str, lexeme: str) -> list[VerbCall]:
        name = lexeme.strip()
        small = name.lower().replace("_", "-")
        usual = (f"play {small}", f"play {name}", *MOVES.get(name.upper(), ()))
        other = "gesture" if kind == "head" else "head"
        found = self._found(kind, name, ()) or self._found(other, name, usual)
        if not found:
            raise UnplayableError(f"this robot has no move for {name}")
        return found

    def _repeated(self, calls: list[VerbCall], behaviour: Behaviour) -> list[VerbCall]:
        turns = behaviour.repetitions
        if (amount := behaviour.attributes.get("amount")) is not None:
            calls = [self._with(call, "amplitude", 2 * _number(amount, 0.5)) for call in calls]
        return [replace(call, turn=turn, turns=turns) for turn in range(turns) for call in calls]

    def _pointing(self, attributes: Mapping[str, str]) -> list[VerbCall]:
        if own := self._from_table("pointing", attributes["target"]):
            return own
        yaw, _ = self._place(attributes)
        side = "left" if yaw > _MIDDLE else "right" if yaw < -_MIDDLE else "middle"
        found = self._found("pointing", side, (f"play point-{side}",))
        if not found:
            raise UnplayableError(f"this robot has no move point-{side}")
        return found

    def _gaze(self, place: tuple[float, float]) -> VerbCall:
        return self._call("gaze", {"yaw": place[0], "pitch": place[1]})

    def _face(self, behaviour: Behaviour) -> list[VerbCall]:
        """An expression, which a shift leaves there; everything else ends it."""
        shown = [
            found
            for kind, parts in _face_parts(behaviour)
            if (found := self._expression(kind, parts))
        ]
        if not shown:
            raise UnplayableError("this robot has no such face")
        # A face has one expression: that of the first part for which the robot has one.
        calls = [replace(call, until="attackPeak") for call in shown[0]]
        if behaviour.kind == "faceShift":
            return calls
        own = self._from_table("faceLexeme", "NEUTRAL")
        emotion = any(call.verb == "emotion" for call in calls)
        back = own or (self._found("faceLexeme", "NEUTRAL", FACES["NEUTRAL"]) if emotion else [])
        return [*calls, *(replace(call, point="relax") for call in back)]

    def _expression(self, kind: str, attributes: Mapping[str, str]) -> list[VerbCall]:
        lexeme = attributes.get("lexeme", "").strip()
        if kind == "faceFacs":
            unit = attributes.get("au", "").strip().upper().removeprefix("AU")
            if own := self._from_table(kind, unit):
                return own
            lexeme = ACTION_UNITS.get(unit, "")
        usual = (f"emotion {lexeme.lower()}", *FACES.get(lexeme.upper(), ()), f"play {lexeme}")
        found = self._found("faceLexeme", lexeme, usual if lexeme else ())
        if (amount := attributes.get("amount")) is not None:
            found = [self._with(call, "intensity", _number(amount, 1.0)) for call in found]
        return found

    def _posture(self, behaviour: Behaviour) -> list[VerbCall]:
        stance = behaviour.inner.get("stance", {}).get("type", "").strip()
        stance = stance or behaviour.attributes.get("stance", "").strip()
        if found := stance and self._found("posture", stance, STANCES.get(stance.upper(), ())):
            return found
        pose = behaviour.inner.get("pose", {}).get("lexeme", "").strip()
        small = pose.lower().replace("_", "-")
        if found := pose and self._found("posture", pose, (f"play {small}", f"play {pose}")):
            return found
        raise UnplayableError(f"this robot has no posture for {stance or pose or 'nothing'}")

    def _locomotion(self, target: str) -> list[VerbCall]:
        """To a place of the table or of the robot, or some way from where it stands."""
        if found := self._found("locomotion", target, [f"{verb} {target}" for verb in GO_TO]):
            return found
        self._call("drive", {})
        pair = _PAIR.match(target)
        if pair is not None:
            ahead, left = float(pair[1]), float(pair[2])
        elif (step := STEPS.get(target.strip().lower())) is not None:
            ahead, left = step
        else:
            raise _unknown_place(target, "locomotion")
        drive = self._call("drive", {"x": ahead, "y": left})
        if not left or "y" in drive.args:
            return [drive]
        turn = round(math.degrees(math.atan2(left, ahead)), 1)  # it cannot go sideways
        return [
            self._call("drive", {"turn": turn}),
            self._call("drive", {"x": round(math.hypot(ahead, left), 3)}),
        ]

    def _place(self, attributes: Mapping[str, str]) -> tuple[float, float]:
        target = attributes["target"]
        if found := _PAIR.match(target):
            yaw, pitch = float(found[1]), float(found[2])
        elif target.strip().lower() in self._targets:
            yaw, pitch = self._targets[target.strip().lower()]
        else:
            raise _unknown_place(target, "targets")
        turn = _offset(attributes)
        return yaw + turn[0], pitch + turn[1]

    # -- EyePi's extension -------------------------------------------------------------------------

    def _look(self, attributes: Mapping[str, str]) -> VerbCall:
        """A look at a place of the camera's picture, by the robot's table of topics."""
        x, y = (_number(attributes.get(name), 0.0) for name in ("x", "y"))
        eyes = attributes.get("influence", "").upper() == "EYES"
        found = self._topics().look(x, y, eyes=eyes)
        if found is None:
            raise UnplayableError("the robot's table of topics says nothing of saliency")
        call = self._call(found.verb, found.args)
        turned = {"yaw": _offset(attributes)[0], "pitch": _offset(attributes)[1]}
        args = {
            name: value + turned[name]
            if name in turned and isinstance(value, int | float)
            else value
            for name, value in call.args.items()
        }
        return replace(call, args=args)

    def _message(self, topic: str, text: str) -> list[VerbCall]:
        """What a message stands for, by the same table."""
        try:
            found = self._topics().calls(topic, read_data(text))
        except RosDataError as error:
            raise UnplayableError(str(error), "PARSING_FAILURE") from error
        return [self._call(each.verb, each.args) for each in found]

    def _topics(self) -> TopicTable:
        if self._table.topics is None:
            raise UnplayableError("the robot file names no table of topics (bml: {topics: FILE})")
        return self._table.topics


def _offset(attributes: Mapping[str, str]) -> tuple[float, float]:
    """How far from its target a gaze is to be: yaw and pitch, in degrees."""
    angle = _number(attributes.get("offsetAngle"), 0.0)
    turn = _DIRECTIONS.get(attributes.get("offsetDirection", "").upper(), (0.0, 0.0))
    return turn[0] * angle, turn[1] * angle


def _face_parts(behaviour: Behaviour) -> list[tuple[str, Mapping[str, str]]]:
    """A face by itself, or the parts of one that has several."""
    own = behaviour.attributes
    if behaviour.kind in ("faceLexeme", "faceFacs"):
        return [(behaviour.kind, own)]
    inner = {name.removeprefix("face").lower(): at for name, at in behaviour.inner.items()}
    parts = [("faceLexeme", inner.get("lexeme", {})), ("faceFacs", inner.get("facs", {}))]
    shared = {name: own[name] for name in ("amount", "lexeme", "au") if name in own}
    return [(kind, {**shared, **at}) for kind, at in parts]


def _same(one: str, other: str) -> bool:
    return one.strip().casefold().replace("-", "_") == other.strip().casefold().replace("-", "_")


def _number(value: Json, default: float) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return default
    return number if math.isfinite(number) else default


def _unknown_place(target: str, table: str) -> UnplayableError:
    return UnplayableError(
        f"nobody knows where {target!r} is: name it in the robot file, bml: {table}",
        "NO_SUCH_TARGET",
    )
