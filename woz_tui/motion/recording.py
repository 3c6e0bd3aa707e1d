"""Puppeteering into layers of a move: a pass is recorded while the passes before it play.

What is recorded is the hand, not the body: how far it has led each joint from the pose in which
the take began, and what it did with emotion and eyes. So the same hand on the same layers gives
the same movement again, whatever the personality adds on top of it. A take does not begin with a
jump, because it begins with nothing.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from woz_tui.motion.keyframes import PLACE_DECIMALS, KeyFrame, KeyframeMove, Layer, Samples

#: Decimals of a recorded degree: finer than any servo, and short in a file.
DECIMALS = 2
#: A joint that strays less than this from where it began was not moved, in degrees.
STILL = 0.05
#: Samples of rest that a trimmed take keeps at each end.
MARGIN = 1


@dataclass(frozen=True, slots=True)
class Looks:
    """What the hand wants of the face: emotion and eyes (-1..1)."""

    emotion: str = "neutral"
    intensity: float = 0.0
    x: float = 0.0
    y: float = 0.0


@dataclass(slots=True)
class Take:
    """One pass, sampled at `rate` for each second (or beat) of the move.

    Moments may come as they like; what lies between them is interpolated, so the samples do not
    depend on when exactly the engine ticked.
    """

    rate: float
    _samples: list[dict[str, float]] = field(default_factory=list)
    _looks: list[Looks] = field(default_factory=list)
    _last: tuple[float, Mapping[str, float], Looks] | None = None

    def moment(self, place: float, joints: Mapping[str, float], looks: Looks) -> None:
        """What the hand wants at `place`, in degrees; places do not go back."""
        before = self._last or (place, joints, looks)
        self._last = (place, dict(joints), looks)
        while (due := len(self._samples) / self.rate) <= place + 1e-9:
            start, was, was_looks = before
            share = 1.0 if place <= start else min(1.0, max(0.0, (due - start) / (place - start)))
            self._samples.append(
                {name: was[name] + share * (angle - was[name]) for name, angle in joints.items()}
            )
            self._looks.append(looks if share >= 1.0 - 1e-6 else was_looks)

    @property
    def length(self) -> float:
        """Place of the last sample."""
        return max(0, len(self._samples) - 1) / self.rate

    def layer(self, name: str) -> Layer:
        """The pass as a relative layer: joints that moved, and what became of the face."""
        joints = {}
        for joint, start in (self._samples[0] if self._samples else {}).items():
            values = tuple(round(sample[joint] - start, DECIMALS) for sample in self._samples)
            if any(abs(value) >= STILL for value in values):
                joints[joint] = values
        return Layer(name, self._frames(), Samples(self.rate, joints=joints) if joints else None)

    def _frames(self) -> tuple[KeyFrame, ...]:
        """A frame for each change of the face, and one before it, so that nothing comes early."""
        frames: list[KeyFrame] = []
        for index in range(1, len(self._looks)):
            was, now = self._looks[index - 1], self._looks[index]
            if was == now:
                continue
            before = round((index - 1) / self.rate, PLACE_DECIMALS)
            if not frames or frames[-1].at < before:
                frames.append(KeyFrame(before))
            at = round(index / self.rate, PLACE_DECIMALS)
            moody = (was.emotion, was.intensity) != (now.emotion, now.intensity)
            frames.append(
                KeyFrame(
                    at,
                    easing="linear",
                    emotion=now.emotion if moody else None,
                    intensity=round(now.intensity, DECIMALS) if moody else None,
                    x=round(now.x, DECIMALS) if was.x != now.x else None,
                    y=round(now.y, DECIMALS) if was.y != now.y else None,
                )
            )
        return tuple(frames)


# -- what can be done with layers ---------------------------------------------------------------


def laid(move: KeyframeMove, layer: Layer) -> KeyframeMove:
    """With `layer` on top, or in the place of the one of its name."""
    names = [known.name for known in move.layers]
    if layer.name not in names:
        return replace(move, layers=(*move.layers, layer))
    return _each(move, layer.name, lambda known: replace(layer, mix=known.mix, share=known.share))


def without(move: KeyframeMove, name: str) -> KeyframeMove:
    """Without the layer `name`."""
    return replace(move, layers=tuple(layer for layer in move.layers if layer.name != name))


def muted(move: KeyframeMove, name: str, quiet: bool = True) -> KeyframeMove:
    """With the layer `name` left out, or heard again."""
    return _each(move, name, lambda layer: replace(layer, muted=quiet))


def blended(move: KeyframeMove, name: str, share: float) -> KeyframeMove:
    """With so much of the layer `name`, 0 to 1."""
    return _each(move, name, lambda layer: replace(layer, share=min(1.0, max(0.0, share))))


def _each(move: KeyframeMove, name: str, change: Callable[[Layer], Layer]) -> KeyframeMove:
    layers = (change(layer) if layer.name == name else layer for layer in move.layers)
    return replace(move, layers=tuple(layers))


def rest(layer: Layer) -> tuple[float, float]:
    """Where something first begins to change in a recorded layer, and where nothing does any more.

    One sample of rest is left at each end.
    """
    places = [frame.at for frame in layer.frames]
    if layer.samples is not None:
        rate = layer.samples.rate
        for values in layer.samples.joints.values():
            steps = [i for i, (a, b) in enumerate(itertools.pairwise(values)) if a != b]
            places += [max(0, steps[0] - MARGIN) / rate, (steps[-1] + 1 + MARGIN) / rate]
    start, end = min(places, default=0.0), max(places, default=0.0)
    return start, min(end, layer.length)


def trimmed(layer: Layer, start: float, end: float) -> Layer:
    """What lies from `start` to `end`, which begins at 0 then; times are those of samples.

    A joint begins where it is at `start`, and so does the face.
    """
    samples = layer.samples
    if samples is not None:
        first, last = round(start * samples.rate), round(end * samples.rate)
        cut = {
            group: {name: values[first : last + 1] for name, values in lists.items()}
            for group, lists in (
                ("roles", samples.roles),
                ("joints", samples.joints),
                ("face", samples.face),
            )
        }
        samples = Samples(samples.rate, cut["roles"], cut["joints"], cut["face"])
    frames = [
        replace(frame, at=round(max(0.0, frame.at - start), PLACE_DECIMALS))
        for frame in layer.frames
        if frame.at <= end
    ]
    early = [frame for frame in frames if frame.at <= 0.0]
    kept = (*early[-1:], *(frame for frame in frames if frame.at > 0.0))
    return replace(layer, frames=kept, samples=samples)
