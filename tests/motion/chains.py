"""Bodies for tests of geometry: EyePi, and chains that nobody has built."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st

from woz_tui.motion.body_shape import AXES, BodyShape, JointShape

Matrix = npt.NDArray[np.float64]


def eyepi(acceleration: float | None = 20_000) -> BodyShape:
    """Oosterkamp's robot: it turns at its base, leans with its middle joint, nods with its top."""
    return BodyShape(
        joints={
            "pitch": JointShape("z", -90, 90, 360, acceleration, (0.02, 0.0, 0.04), start=0),
            "middle": JointShape(
                "-y", 0, 90, 250, acceleration, (0.02, 0.0, 0.03), home=72, start=45
            ),
            "top": JointShape(
                "y", 0, 90, 320, acceleration, (0.08, 0.0, 0.0), home=63, start=28.65
            ),
        },
        roles={"pan": {"pitch": 1}, "nod": {"top": 1}, "lean": {"middle": 1}},
        breathing={"middle": -1, "top": 1},
        zoom={"middle": 1, "top": -1},
    )


def only(*joints: str) -> BodyShape:
    """EyePi with the roles of these joints alone."""
    whole = eyepi()
    return BodyShape(
        joints=whole.joints,
        roles={role: shares for role, shares in whole.roles.items() if set(shares) <= set(joints)},
    )


@st.composite
def bodies(draw: st.DrawFn, joints: int = 5) -> BodyShape:
    """Bodies of `joints` joints, any axes, offsets up to 20 cm, ranges of at least 60 degrees."""
    shapes = {}
    for number in range(joints):
        low = draw(st.floats(-150, 60))
        high = low + draw(st.floats(60, 180))
        shapes[f"j{number}"] = JointShape(
            draw(st.sampled_from(tuple(AXES))),
            low,
            high,
            draw(st.floats(30, 400)),
            draw(st.one_of(st.none(), st.floats(100, 20_000))),
            (draw(_SHORT), draw(_SHORT), draw(_SHORT)),
            home=(low + high) / 2,
        )
    eyes = (draw(_SHORT), draw(_SHORT), draw(_SHORT))
    return BodyShape(joints=shapes, eyes=eyes, view=draw(st.sampled_from(tuple(AXES))))


_SHORT = st.floats(-0.2, 0.2).map(lambda value: round(value, 3))


def by_matrices(shape: BodyShape, angles: Mapping[str, float]) -> tuple[list[Matrix], Matrix]:
    """Base, joints and eyes, and the gaze, by 4 x 4 matrices and Rodrigues' formula: the oracle."""
    frame = np.eye(4)
    places = [frame[:3, 3]]
    for name, joint in shape.joints.items():
        axis = np.array(AXES[joint.axis])
        cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        turn = np.radians(angles[name])
        link = np.eye(4)
        link[:3, :3] = np.eye(3) + np.sin(turn) * cross + (1 - np.cos(turn)) * cross @ cross
        link[:3, 3] = joint.offset
        frame = frame @ link
        places.append(frame[:3, 3])
    places.append(frame[:3, :3] @ np.array(shape.eyes) + frame[:3, 3])
    return places, frame[:3, :3] @ np.array(AXES[shape.view])


def missed_deg(origin: npt.ArrayLike, gaze: npt.ArrayLike, target: npt.ArrayLike) -> float:
    """By how many degrees a ray misses a point."""
    way = np.asarray(target, dtype=float) - np.asarray(origin, dtype=float)
    across = float(np.linalg.norm(np.cross(np.asarray(gaze, dtype=float), way)))
    return float(np.degrees(np.arctan2(across, np.dot(np.asarray(gaze, dtype=float), way))))
