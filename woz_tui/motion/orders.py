"""What each verb does, once its input counts: arguments to changes and an answer.

Every order reads all of its arguments before it changes anything, so a refused one leaves no
trace.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.core.messages import Json
from woz_tui.motion.asked import Angles, Asked
from woz_tui.motion.controls import FACE
from woz_tui.motion.easing import EASE
from woz_tui.motion.facework import FaceWork
from woz_tui.motion.inputs import CONTROLS
from woz_tui.motion.kinematics import Aim, Chain
from woz_tui.motion.modes import Mode
from woz_tui.motion.move import Move
from woz_tui.motion.personality import Character
from woz_tui.motion.primaries import Following, Line, Playing, Primary
from woz_tui.motion.saccade import Saccade, direction
from woz_tui.motion.shapes import BodyShape
from woz_tui.motion.steering import Steering
from woz_tui.motion.ticks import Answer, Refused
from woz_tui.motion.tracking import Tracker

#: A nudge takes at least so long, in seconds: held arrow keys become one even movement.
NUDGE_S = 0.15
#: The move that the mode `demo` plays.
DEMO = "demo"


class Orders:
    """Carries out inputs on the parts of one body."""

    def __init__(
        self,
        *,
        shape: BodyShape,
        moves: Mapping[str, Move],
        chain: Chain,
        steering: Steering,
        face: FaceWork,
        character: Character,
    ) -> None:
        self._shape = shape
        #: What can be played now.
        self.moves = moves
        self._chain = chain
        self._steering = steering
        self._face = face
        self._character = character
        self._tokens = 0
        #: Seconds since the engine began, as of the last tick; and where the joints were then.
        self.now = 0.0
        self.joints: Mapping[str, float] = {}
        self.verbs: Mapping[str, Callable[[Asked], Answer]] = {
            "play": self._play,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "joints": self._joints,
            "control": self._control,
            "mode": self._mode,
            "personality": lambda asked: Answer(character.become(asked)),
            "breathing": self._breathing,
            "emotion": self._emotion,
            "affect": self._affect,
            "look": self._look,
            "brightness": self._brightness,
            "blink": self._blink,
            "blinking": self._blinking,
        }

    def _token(self) -> int:
        self._tokens += 1
        return self._tokens

    # -- moves, gaze, pose ----------------------------------------------------------------------

    def _play(self, asked: Asked) -> Answer:
        move = self.moves[asked.choice("move", tuple(self.moves))]
        speed = asked.within("speed", 0.1, 5.0, 1.0)
        amplitude = asked.within("amplitude", 0.0, 3.0, 1.0)
        playing = self._steering.play(move, speed, amplitude, self._token())
        self._face.begin_lead()
        seconds = move.length / playing.rate(self._character["tempo"], self._character["speed"])
        sent: dict[str, Json] = {"move": move.name, "speed": speed, "amplitude": amplitude}
        return Answer({**sent, "seconds": round(seconds, 3)}, playing.token, seconds)

    def _pose(self, asked: Asked) -> Answer:
        angles, seconds = asked.joints(self._shape.joints), asked.seconds()
        return self._go("pose", [(angles, seconds)], self._easing(asked))

    def _poses(self, asked: Asked) -> Answer:
        return self._go("poses", asked.poses(self._shape.joints), self._easing(asked))

    def _home(self, asked: Asked) -> Answer:
        home = {name: joint.home for name, joint in self._shape.joints.items()}
        seconds = asked.seconds() if asked.given("seconds") else 1.0
        return self._go("home", [(Angles(home, {}, {}), seconds)], self._easing(asked))

    def _gaze(self, asked: Asked) -> Answer:
        point = [name for name in ("x", "y", "z") if asked.given(name)]
        angle = [name for name in ("yaw", "pitch") if asked.given(name)]
        if bool(point) == bool(angle):
            raise Refused(
                "gaze looks either at a point or in a direction",
                "give x, y and z, or yaw and pitch",
            )
        seconds, easing = asked.seconds(), self._easing(asked)
        pose = self._steering.stance.pose
        if point:
            target = (asked.number("x"), asked.number("y"), asked.number("z"))
            try:
                aim = self._chain.aim_at(target, pose)
            except ValueError as error:
                raise Refused(f"gaze: {error}") from None
            return self._look_at(aim, "gaze", seconds, easing)
        yaw, pitch = direction(self._chain, pose)
        yaw = asked.within("yaw", -180.0, 180.0, yaw)
        down = asked.within("pitch", -90.0, 90.0, -pitch)
        return self._look_at(self._chain.aim_along(yaw, -down, pose), "gaze", seconds, easing)

    def _nudge(self, asked: Asked) -> Answer:
        left, down = asked.within("yaw", -180, 180, 0.0), asked.within("pitch", -180, 180, 0.0)
        pose = self._steering.stance.pose
        yaw, pitch = direction(self._chain, pose)
        yaw = (yaw + left + 180.0) % 360.0 - 180.0
        pitch = min(90.0, max(-90.0, pitch - down))
        aim = self._chain.aim_along(yaw, pitch, pose)
        if self._steering.move:  # the arrow keys turn whoever dances, and do not end the dance
            self._steering.shift(aim.joints, "nudge")
            return Answer(_off_the_mark(Angles(dict(aim.joints), {}, {}).told(), aim))
        return self._look_at(aim, "nudge", NUDGE_S, "")

    def _look_at(self, aim: Aim, name: str, seconds: float, easing: str) -> Answer:
        answer = self._go(name, [(Angles(dict(aim.joints), {}, {}), seconds)], easing)
        return Answer(_off_the_mark(answer.sent, aim), answer.token, answer.seconds)

    def _easing(self, asked: Asked) -> str:
        return asked.choice("easing", tuple(EASE), self._shape.easing)

    def _go(self, name: str, poses: list[tuple[Angles, float]], easing: str) -> Answer:
        goals = [(angles.joints, seconds) for angles, seconds in poses]
        line = self._steering.go(name, goals, self._token(), easing)
        late = line.seconds - sum(seconds for _, seconds in goals)
        told = [angles.told() for angles, _ in poses]
        sent: dict[str, Json] = told[0] if name != "poses" else {"poses": list(told)}
        sent["seconds"] = round(line.seconds, 3)
        if late > 1e-9 and all(seconds > 0.0 for _, seconds in goals):
            sent["late_s"] = round(late, 3)
        return Answer(sent, line.token, line.seconds)

    def _joints(self, asked: Asked) -> Answer:
        angles = asked.joints(self._shape.joints)
        self._steering.put(angles.joints, "joints")
        return Answer(angles.told())

    # -- controls -------------------------------------------------------------------------------

    def places(self) -> dict[str, float]:
        """Where every control of the body stands, 0..1."""
        stance = self._steering.stance
        return {
            **{name: stance.place(name) for name in self._shape.joints},
            "zoom": stance.zoom,
            **self._face.places(),
            **self._character.places(),
        }

    def control(self, asked: Asked) -> str:
        """Which control an input is about."""
        return asked.choice("control", (*self._shape.joints, *CONTROLS))

    def _control(self, asked: Asked) -> Answer:
        name = self.control(asked)
        if asked.given("value") == asked.given("by"):
            raise Refused("control needs either a value or by how much", "both are 0 to 1")
        wish = asked.number("value") if asked.given("value") else 0.0
        if asked.given("by"):
            wish = self.places()[name] + asked.number("by")
        place = min(1.0, max(0.0, wish))
        sent: dict[str, Json] = {"control": name, "value": round(place, 4)}
        if place != wish:
            sent["clamped"] = {name: wish}
        if name in self._shape.joints:
            self._steering.turn(name, place, f"control {name}")
        elif name == "zoom":
            self._steering.turn_zoom(place, "control zoom")
        elif name in FACE:
            self._face.turn(name, place)
            self._eyes_moved(name.startswith("eye"))
        else:
            self._character.turn(name, place)
        return Answer(sent)

    # -- modes ----------------------------------------------------------------------------------

    def _mode(self, asked: Asked) -> Answer:
        mode = Mode(asked.choice("mode", tuple(mode.value for mode in Mode)))
        if mode is Mode.NORMAL:
            self.leave("stopped")
            self._steering.stop("stopped")
            return Answer({"mode": mode.value})
        # What begins goes on from where everything is: the primary is made first, it may refuse.
        primary = self._primary(mode)
        self._face.stop(f"replaced by {mode.value}")
        self._face.begin_lead()
        self._steering.enter(mode, primary)
        return Answer({"mode": mode.value})

    def leave(self, why: str) -> None:
        """What the stop ends besides what moves the joints."""
        self._face.stop(why)
        self._face.begin_lead()
        if self._steering.mode is Mode.SACCADE:
            self.eyes_back()

    def eyes_back(self) -> None:
        """The eyes are the face's own again, in its middle."""
        self._face.led = None
        self._face.look(0.0, 0.0)

    def _primary(self, mode: Mode) -> Primary:
        if mode is Mode.TRACKING:
            tracker = Tracker(self._shape, self._chain)
            tracker.begin(self.now, self.joints)
            return Following(tracker)
        if mode is Mode.SACCADE:
            line = isinstance(self._steering.primary, Line)
            pose = self._steering.here if line else self._steering.stance.pose
            return Saccade(self._chain, self._shape, pose, self._face.eyes)
        move = self.moves.get(DEMO)
        if move is None:
            raise Refused("there is no demo", f"it is the move called {DEMO!r}")
        return Playing(move, self._shape, 1.0, 1.0, 0, own_pace=True)

    # -- face and ways --------------------------------------------------------------------------

    def _emotion(self, asked: Asked) -> Answer:
        return self._face.show(asked, self._token)

    def _affect(self, asked: Asked) -> Answer:
        valence = asked.within("valence", -1.0, 1.0)
        return self._face.feel(valence, asked.within("arousal", -1.0, 1.0))

    def _look(self, asked: Asked) -> Answer:
        x, y = asked.within("x", -1.0, 1.0, 0.0), asked.within("y", -1.0, 1.0, 0.0)
        answer = self._face.look(x, y)
        self._eyes_moved(True)
        return answer

    def _eyes_moved(self, moved: bool) -> None:
        """In saccade following they take the head along."""
        primary = self._steering.primary
        if moved and isinstance(primary, Saccade):
            primary.look(self._face.x, self._face.y)

    def _brightness(self, asked: Asked) -> Answer:
        self._face.brightness = asked.within("level", 0.0, 1.0)
        return Answer({"level": self._face.brightness})

    def _blink(self, asked: Asked) -> Answer:
        self._face.blink()
        return Answer({})

    def _blinking(self, asked: Asked) -> Answer:
        self._face.blinks_by_itself = asked.flag("on")
        return Answer({"on": self._face.blinks_by_itself})

    def _breathing(self, asked: Asked) -> Answer:
        self._character.breathes = asked.flag("on")
        return Answer({"on": self._character.breathes})


def _off_the_mark(sent: Mapping[str, Json], aim: Aim) -> dict[str, Json]:
    """What is answered, and how far the head's gaze misses if it cannot get there."""
    if aim.reachable:
        return dict(sent)
    return {**sent, "reachable": False, "error_deg": round(aim.error_deg, 2)}
