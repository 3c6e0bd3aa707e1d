"""Changes a layer by acting it again: how much larger, and how far off, the hand has made it.

After Dontcheva, Yngve and Popovic (2003), "Layered acting for character animation": the animator
mimics what is there, and the system finds out what they changed. What was done and what is there
are brought onto each other in time first (dynamic time warping), so that a hand that is late
changes neither; the layer keeps its own timing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_files import ANGLES

#: Places that are compared at most, and how far apart in time two of them may be, as a share.
_MOST, _BAND = 200, 0.3
#: What moves less than so many degrees, by its standard deviation, does not move.
STILL = 0.05
#: A recorded layer is led over within so many seconds or beats where the change begins and ends.
_OVER = 0.1
_DECIMALS = 3

Values = NDArray[np.float64]


class MimicError(Exception):
    """Nothing can be fitted; the text says why."""


@dataclass(frozen=True, slots=True)
class Fit:
    """Each value `x` becomes `gain * x + offset`. `late`: how far the hand came behind."""

    gain: float
    offset: float
    late: float = 0.0

    def __str__(self) -> str:
        when = f", {abs(self.late):.2f} s {'late' if self.late > 0 else 'early'}"
        return f"{self.gain:.2f} times, {self.offset:+.1f} degrees" + (
            when if abs(self.late) >= 0.05 else ""
        )

    def of(self, value: float, weight: float = 1.0) -> float:
        """The value as it is then; `weight`: how much of the change counts."""
        changed = value + weight * ((self.gain - 1.0) * value + self.offset)
        return round(changed, _DECIMALS)


def fitted(there: Values, done: Values, step: float) -> Fit:
    """What makes of `there` what was `done`, both sampled each `step`. Raises `MimicError`."""
    if len(there) < 3 or len(done) < 3 or done.std() < STILL:
        raise MimicError("nothing was done with it in this time")
    if there.std() < STILL:
        return Fit(1.0, float(done.mean() - there.mean()))
    pairs = min((_warped(there, sign * done) for sign in (1.0, -1.0)), key=lambda found: found[0])
    first, second = pairs[1].T
    x, y = there[first], done[second]
    gain, offset = np.linalg.lstsq(np.column_stack([x, np.ones_like(x)]), y, rcond=None)[0]
    return Fit(float(gain), float(offset), float(np.median(second - first)) * step)


def _warped(one: Values, two: Values) -> tuple[float, NDArray[np.int64]]:
    """How far both differ when brought onto each other in time, and which places are pairs."""
    a, b = (((values - values.mean()) / values.std()).tolist() for values in (one, two))
    band = max(math.ceil(_BAND * max(len(a), len(b))), abs(len(a) - len(b)) + 1)
    cost = [[math.inf] * (len(b) + 1) for _ in range(len(a) + 1)]
    cost[0][0] = 0.0
    for i in range(1, len(a) + 1):
        above, row = cost[i - 1], cost[i]
        for j in range(max(1, i - band), min(len(b), i + band) + 1):
            row[j] = abs(a[i - 1] - b[j - 1]) + min(above[j], row[j - 1], above[j - 1])
    i, j = len(a), len(b)
    path = []
    while i > 0 and j > 0:
        path.append((i - 1, j - 1))
        _, i, j = min(
            (cost[i - 1][j - 1], i - 1, j - 1),
            (cost[i - 1][j], i - 1, j),
            (cost[i][j - 1], i, j - 1),
        )
    return cost[-1][-1] / len(path), np.array(path[::-1], dtype=np.int64)


# -- layers ---------------------------------------------------------------------------------------


def mimicked(
    layer: MoveLayer,
    row: str,
    take: MoveLayer,
    piece: tuple[float, float],
    shape: BodyShape,
) -> tuple[MoveLayer, Fit]:
    """The layer with one row as the take had it, within a piece of the time. Raises `MimicError`.

    Args:
        layer: What there is.
        row: A role or a joint of it.
        take: What was done, from the beginning of the move on.
        piece: From and to.
        shape: Whose joints.
    """
    begin, end = piece[0], min(piece[1], layer.length)
    step = max((end - begin) / _MOST, 0.02)
    places = begin + step * np.arange(max(0, math.floor((end - begin) / step + 1e-9)) + 1)
    alone = KeyframeMove("", "", (replace(layer, share=1.0, muted=False, mix="add"),))
    done = KeyframeMove("", "", (replace(take, share=1.0, muted=False),))
    postures = [alone.at(float(place)) for place in places]
    named = [
        posture.roles.get(row, posture.joints.get(row, posture.places.get(row)))
        for posture in postures
    ]
    there = np.array([value for value in named if value is not None])
    if len(there) < len(places) or not len(there):
        raise MimicError(f"this layer says nothing of {row}")
    shares = _shares(layer, row, shape)
    weight = sum(share * share for share in shares.values()) or 1.0
    did = np.array(
        [
            sum(share * done.at(float(at)).joints.get(joint, 0.0)
                for joint, share in shares.items())
            / weight
            for at in places
        ]
    )  # fmt: skip
    if row in shape.joints and not layer.relative:
        did += shape.joints[row].home
    fit = fitted(there, did, step)
    return _changed(layer, row, fit, (begin, end), shape), fit


def _shares(layer: MoveLayer, row: str, shape: BodyShape) -> Mapping[str, float]:
    """How much of a row each joint has."""
    joints = {name for frame in layer.frames for name in frame.joints}
    joints |= set(layer.samples.joints if layer.samples is not None else ())
    return {row: 1.0} if row in joints else shape.roles.get(row, {})


def _changed(
    layer: MoveLayer, row: str, fit: Fit, piece: tuple[float, float], shape: BodyShape
) -> MoveLayer:
    low, high = ANGLES.low or 0.0, ANGLES.high or 0.0
    if row in shape.joints and not layer.relative:
        low, high = shape.joints[row].min, shape.joints[row].max

    def of(value: float, weight: float = 1.0) -> float:
        if weight <= 0:
            return value
        return min(high, max(low, fit.of(value, weight)))

    def frame_of(frame: KeyFrame) -> KeyFrame:
        if not piece[0] - 1e-9 <= frame.at <= piece[1] + 1e-9:
            return frame
        if row in frame.joints:
            return replace(frame, joints={**frame.joints, row: of(frame.joints[row])})
        if row in frame.roles:
            return replace(frame, roles={**frame.roles, row: of(frame.roles[row])})
        return frame

    samples = layer.samples
    if samples is not None:
        rate = samples.rate

        def list_of(values: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(of(value, _weight(i / rate, piece)) for i, value in enumerate(values))

        if row in samples.joints:
            joints = {**samples.joints, row: list_of(samples.joints[row])}
            samples = LayerSamples(rate, samples.roles, joints, samples.face)
        elif row in samples.roles:
            roles = {**samples.roles, row: list_of(samples.roles[row])}
            samples = LayerSamples(rate, roles, samples.joints, samples.face)
    return replace(layer, frames=tuple(map(frame_of, layer.frames)), samples=samples)


def _weight(at: float, piece: tuple[float, float]) -> float:
    """How much of the change counts at a sample: none outside, all from a moment inside on."""
    return min(1.0, max(0.0, min(at - piece[0], piece[1] - at) / _OVER))
