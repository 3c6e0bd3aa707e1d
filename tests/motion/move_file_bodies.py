"""Two bodies for move files: one with three joints, one whose joints have the names of roles."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.motion.body_shape import BodyShape, FaceShape, JointShape

EYEPI = BodyShape(
    joints={
        "pitch": JointShape("z", -90, 90, 360, 20_000, (0.02, 0, 0.04)),
        "middle": JointShape("-y", 0, 90, 250, 20_000, (0.02, 0, 0.03), home=72, start=45),
        "top": JointShape("y", 0, 90, 320, 20_000, (0.08, 0, 0), home=63, start=28.65),
    },
    roles={"pan": {"pitch": 1}, "nod": {"top": 1}, "lean": {"middle": 1}},
    face=FaceShape(),
)
FIVE = BodyShape(
    joints={
        "base": JointShape("z", -110, 110, 220, 900, (0, 0, 0.06)),
        "lean": JointShape("y", -20, 40, 120, 600, (0, 0, 0.05)),
        "neck": JointShape("y", -35, 40, 200, 1200, (0, 0, 0.18)),
        "nod": JointShape("y", -30, 35, 300, 2000, (0.02, 0, 0.07)),
        "roll": JointShape("x", -25, 25, 250, 1500, (0.03, 0, 0.02)),
    },
    roles={
        "pan": {"base": 1},
        "nod": {"neck": 0.4, "nod": 0.6},
        "lean": {"lean": -0.8, "neck": 0.4},
        "roll": {"roll": 1},
    },
)
HEADS: Mapping[str, BodyShape] = {"eyepi": EYEPI, "five": FIVE}
