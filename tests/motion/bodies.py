"""Bodies for tests, and a rig that lets virtual time pass for an engine."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import replace

from woz_tui.motion.body_shape import BodyShape, FaceShape, JointShape, Personality
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import InputResult, Tick
from woz_tui.motion.modes import Operator
from woz_tui.motion.move_types import Move
from woz_tui.motion.personality import RANGES
from woz_tui.protocol.messages import Json

#: No breath and no blink: what is left is what people wanted.
CALM = Personality(breathing=0.0, blink_rate=0.0)


def reach(trait: str) -> tuple[float, float]:
    """The least and the greatest value of a personality's trait."""
    return RANGES[trait].low or 0.0, RANGES[trait].high or 0.0


#: Oosterkamp's robot: three joints, speeds of the thesis.
EYEPI = BodyShape(
    joints={
        "pitch": JointShape("z", -90, 90, 360, 20_000, (0.02, 0, 0.04), home=0, start=0),
        "middle": JointShape("-y", 0, 90, 250, 20_000, (0.02, 0, 0.03), home=72, start=45),
        "top": JointShape("y", 0, 90, 320, 20_000, (0.08, 0, 0), home=63, start=28.65),
    },
    roles={"pan": {"pitch": 1}, "nod": {"top": 1}, "lean": {"middle": 1}},
    breathing={"middle": -1, "top": 1},
    zoom={"middle": 1, "top": -1},
    face=FaceShape(),
    personalities={
        "upbeat": Personality(tempo=3.0, breathing=4.0, speed=1.3, amplitude=1.2),
        "grumpy": Personality(tempo=1.2, breathing=1.5, smoothing=0.3, compression=0.4),
    },
)
#: The same without breath and blinks.
STILL = replace(EYEPI, personality=CALM)

#: Five joints, two of which share pan and nod, with modest accelerations.
FIVE = BodyShape(
    joints={
        "base": JointShape("z", -120, 120, 200, 2000, (0, 0, 0.1)),
        "low": JointShape("y", -60, 60, 150, 1500, (0, 0, 0.05), home=-20),
        "high": JointShape("y", -70, 80, 180, 1500, (0, 0, 0.12), home=30),
        "neck": JointShape("z", -80, 80, 300, None, (0.02, 0, 0.1)),
        "head": JointShape("y", -45, 45, 300, None, (0, 0, 0.03)),
    },
    roles={
        "pan": {"base": 0.4, "neck": 0.6},
        "nod": {"head": 0.7, "high": 0.3},
        "lean": {"low": 1},
    },
    breathing={"low": 0.5, "head": -0.5},
    eyes=(0.04, 0, 0.02),
    face=FaceShape(width=32, height=16),
)
#: One joint that nods; nothing that pans.
NODDER = BodyShape(
    joints={"chin": JointShape("y", -30, 40, 200)},
    roles={"nod": {"chin": 1}},
    face=FaceShape(),
    personality=CALM,
)
BODIES: Mapping[str, BodyShape] = {"eyepi": EYEPI, "five": FIVE, "nodder": NODDER}

DT = 0.02


class Rig:
    """An engine and its time, in ticks of `DT` seconds."""

    def __init__(
        self,
        shape: BodyShape = STILL,
        moves: Mapping[str, Move] = BUILT_IN,
        *,
        seed: int = 1,
        present: Mapping[str, float] | None = None,
    ) -> None:
        self.engine = Engine(shape, moves, seed=seed, present=present)
        self.count = 0
        self.last = self.engine.tick(0.0)

    def do(self, verb: str, hand: Operator = Operator.WIZARD, /, **args: Json) -> InputResult:
        """An input between two ticks."""
        return self.engine.apply(verb, args, hand)

    def tick(self) -> Tick:
        """The next tick."""
        self.count += 1
        self.last = self.engine.tick(self.count * DT)
        return self.last

    def run(self, seconds: float) -> list[Tick]:
        """All ticks of so many seconds."""
        return [self.tick() for _ in range(round(seconds / DT))]

    def until(self, reached: Callable[[Tick], bool], limit: float = 120.0) -> list[Tick]:
        """Ticks up to the first that `reached` is true of; fails after `limit` seconds."""
        ticks: list[Tick] = []
        while not (ticks and reached(ticks[-1])):
            assert len(ticks) * DT < limit, "it never came"
            ticks.append(self.tick())
        return ticks

    def wait(self, answer: InputResult, limit: float = 120.0) -> list[Tick]:
        """Ticks until the input of `answer` has ended."""
        return self.until(lambda tick: any(e.token == answer.token for e in tick.ended), limit)


def column(ticks: list[Tick], joint: str) -> list[float]:
    """A joint's setpoints."""
    return [tick.joints[joint] for tick in ticks]


def moves_safely(shape: BodyShape, ticks: list[Tick]) -> bool:
    """In range, never over speed from tick to tick."""
    rows = [tick.joints for tick in ticks]
    inside = all(
        joint.min <= row[name] <= joint.max for row in rows for name, joint in shape.joints.items()
    )
    slow = all(
        abs(after[name] - before[name]) <= joint.speed * DT + 1e-6
        for before, after in itertools.pairwise(rows)
        for name, joint in shape.joints.items()
    )
    return inside and slow
