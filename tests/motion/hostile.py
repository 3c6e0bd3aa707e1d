"""Inputs that no engine should have to take: all verbs, both hands, many of them absurd."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

from tests.motion.bodies import reach
from woz_tui.motion.body_feeds import Sighting
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.body_verbs import CONTROLS, EMOTIONS, KINDS
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.modes import Mode, Operator
from woz_tui.motion.personality import NAMES

ABSURD: list[Any] = [
    *(math.nan, math.inf, -math.inf, 1e300, -1e300, 10**400, -1, 0, 5e-324, 1e-9),
    *(None, "", "left", "\0", "n" * 500, [], [1], {}, {"joints": 3}, True, False, b"raw"),
    *([[[[]]]], {"a": {"b": [math.nan]}}, object(), 3 + 4j),
]
VERBS = (*KINDS, "control")
#: Names of all arguments that any verb takes, and some that none does.
ARGUMENTS = (
    *("move", "speed", "amplitude", "joints", "seconds", "easing", "poses", "yaw", "pitch"),
    *("x", "y", "z", "control", "value", "by", "mode", "name", "emotion", "intensity"),
    *("valence", "arousal", "level", "on", "nonsense", ""),
)


class Hostile:
    """A stream of inputs for a body; the same for the same seed."""

    def __init__(self, shape: BodyShape, seed: object) -> None:
        self._shape = shape
        self._chance = random.Random(f"hostile {seed}")
        self._t = 0.0

    def input(self) -> tuple[Any, Any, Operator]:
        """Verb, arguments and hand; one in four is absurd in some way."""
        chance = self._chance
        hand = chance.choice((Operator.WIZARD, Operator.WIZARD, Operator.PROGRAM))
        verb = chance.choice(VERBS)
        if chance.random() < 0.02:
            verb = "mode"
        args = self._sensible(verb)
        spoil = chance.random()
        if spoil < 0.15 and args:
            args[chance.choice(list(args))] = chance.choice(ABSURD)
        elif spoil < 0.2:
            args[chance.choice(ARGUMENTS)] = chance.choice(ABSURD)
        elif spoil < 0.23:
            return verb, chance.choice(ABSURD), hand
        elif spoil < 0.25:
            return chance.choice([*ABSURD, "fly"]), args, hand
        return verb, args, hand

    def time(self) -> Any:
        """The next tick's time: 20 ms later as a rule; after an absurd one, too, time goes on."""
        chance = self._chance.random()
        if chance >= 0.985:
            return self._chance.choice(ABSURD)
        if chance < 0.95:
            self._t += 0.02
        elif chance < 0.98:
            self._t += self._chance.uniform(0.0, 3.0)
        else:
            self._t -= self._chance.uniform(0.0, 50.0)
        return self._t

    def seen(self) -> Any:
        """What the camera sees."""
        chance = self._chance
        x, y = (chance.choice([None, chance.uniform(-1, 1), math.nan, 1e300]) for _ in range(2))
        return chance.choice(
            [None, Sighting(chance.randint(0, 10**12), chance.randint(0, 99), x, y)]
        )

    def often(self, share: float) -> bool:
        """True in that share of all cases."""
        return self._chance.random() < share

    def angles(self) -> dict[str, Any]:
        """Angles by joint: outside, missing, of strangers, no angles at all."""
        chance = self._chance
        joints: dict[str, Any] = {
            name: chance.uniform(joint.min - 20, joint.max + 20)
            for name, joint in self._shape.joints.items()
            if chance.random() < 0.8
        }
        if chance.random() < 0.3:
            joints[chance.choice(["tail", *self._shape.joints])] = chance.choice(ABSURD)
        return joints

    def _sensible(self, verb: str) -> dict[str, Any]:
        """Arguments that make sense, as a rule."""
        chance, u = self._chance, self._chance.uniform
        timed = {"seconds": u(-1, 3)} if chance.random() < 0.7 else {}
        table: dict[str, Callable[[], dict[str, Any]]] = {
            "play": lambda: {
                "move": chance.choice(list(BUILT_IN)),
                "speed": u(0.1, 5),
                "amplitude": u(0, 3),
            },
            "pose": lambda: {"joints": self.angles(), **timed},
            "joints": lambda: {"joints": self.angles()},
            "poses": lambda: {
                "poses": [{"joints": self.angles(), "seconds": u(-1, 2)} for _ in range(3)]
            },
            "home": lambda: timed,
            "gaze": lambda: {"yaw": u(-180, 180), "pitch": u(-90, 90), **timed},
            "nudge": lambda: {"yaw": u(-20, 20), "pitch": u(-20, 20)},
            "control": lambda: {
                "control": chance.choice([*self._shape.joints, *CONTROLS]),
                chance.choice(["value", "by"]): u(-0.2, 1.2),
            },
            "mode": lambda: {
                "mode": chance.choice(["normal", "normal", *(mode.value for mode in Mode)])
            },
            "personality": lambda: {trait: u(*reach(trait)) for trait in chance.sample(NAMES, 2)},
            "emotion": lambda: {"emotion": chance.choice(EMOTIONS)},
            "affect": lambda: {"valence": u(-1, 1), "arousal": u(-1, 1)},
            "look": lambda: {"x": u(-1, 1), "y": u(-1, 1)},
            "brightness": lambda: {"level": u(0, 1)},
            "breathing": lambda: {"on": chance.random() < 0.5},
            "blinking": lambda: {"on": chance.random() < 0.5},
        }
        return table.get(verb, dict)()
