"""A pass of puppeteering: an engine, the layers that play meanwhile, and the take of the hand."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import InputResult, Tick
from woz_tui.motion.keyframes import PLACE_DECIMALS, KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_types import Move
from woz_tui.protocol.messages import Json

# -- recording ------------------------------------------------------------------------------------
# Puppeteering into layers of a move: a pass is recorded while the passes before it play.
#
# What is recorded is the hand, not the body: how far it has led each joint from the pose in which
# the take began, and what it did with emotion and eyes. So the same hand on the same layers gives
# the same movement again, whatever the personality adds on top of it. A take does not begin with a
# jump, because it begins with nothing.

#: Decimals of a recorded degree: finer than any servo, and short in a file.
DECIMALS = 2
#: A joint that strays less than this from where it began was not moved, in degrees.
STILL_DEGREES = 0.05
#: Samples of rest that a trimmed take keeps at each end.
REST_SAMPLES = 1


@dataclass(frozen=True, slots=True)
class FaceTarget:
    """The face as the hand has set it: emotion and eyes (-1..1)."""

    emotion: str = "neutral"
    intensity: float = 0.0
    x: float = 0.0
    y: float = 0.0


@dataclass(slots=True)
class RecordedTake:
    """One pass, sampled at `rate` for each second (or beat) of the move.

    Moments may come as they like; what lies between them is interpolated, so the samples do not
    depend on when exactly the engine ticked.
    """

    rate: float
    _samples: list[dict[str, float]] = field(default_factory=list)
    _looks: list[FaceTarget] = field(default_factory=list)
    _last: tuple[float, Mapping[str, float], FaceTarget] | None = None

    def moment(self, place: float, joints: Mapping[str, float], looks: FaceTarget) -> None:
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

    def layer(self, name: str) -> MoveLayer:
        """The pass as a relative layer: joints that moved, and what became of the face."""
        joints = {}
        for joint, start in (self._samples[0] if self._samples else {}).items():
            values = tuple(round(sample[joint] - start, DECIMALS) for sample in self._samples)
            if any(abs(value) >= STILL_DEGREES for value in values):
                joints[joint] = values
        return MoveLayer(
            name, self._frames(), LayerSamples(self.rate, joints=joints) if joints else None
        )

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


def with_layer(move: KeyframeMove, layer: MoveLayer) -> KeyframeMove:
    """With `layer` on top, or in the place of the one of its name."""
    if layer.name not in [known.name for known in move.layers]:
        return replace(move, layers=(*move.layers, layer))
    layers = (
        replace(layer, mix=known.mix, share=known.share) if known.name == layer.name else known
        for known in move.layers
    )
    return replace(move, layers=tuple(layers))


def without_layer(move: KeyframeMove, name: str) -> KeyframeMove:
    return replace(move, layers=tuple(layer for layer in move.layers if layer.name != name))


def with_muted(move: KeyframeMove, name: str, quiet: bool = True) -> KeyframeMove:
    """With the layer `name` left out, or heard again."""
    return _with_changed(move, name, muted=quiet)


def with_share(move: KeyframeMove, name: str, share: float) -> KeyframeMove:
    """With so much of the layer `name`, 0 to 1."""
    return _with_changed(move, name, share=min(1.0, max(0.0, share)))


def _with_changed(move: KeyframeMove, name: str, **changes: Any) -> KeyframeMove:
    layers = (replace(one, **changes) if one.name == name else one for one in move.layers)
    return replace(move, layers=tuple(layers))


def active_span(layer: MoveLayer) -> tuple[float, float]:
    """Where something first begins to change in a recorded layer, and where nothing does any more.

    One sample of rest is left at each end.
    """
    places = [frame.at for frame in layer.frames]
    if layer.samples is not None:
        rate = layer.samples.rate
        for values in layer.samples.joints.values():
            steps = [i for i, (a, b) in enumerate(itertools.pairwise(values)) if a != b]
            places += [
                max(0, steps[0] - REST_SAMPLES) / rate,
                (steps[-1] + 1 + REST_SAMPLES) / rate,
            ]
    start, end = min(places, default=0.0), max(places, default=0.0)
    return start, min(end, layer.length)


def trim_layer(layer: MoveLayer, start: float, end: float) -> MoveLayer:
    """What lies from `start` to `end`, which begins at 0 then; times are those of samples.

    A joint begins where it is at `start`, and so does the face.
    """
    samples = layer.samples
    if samples is not None:
        first, last = round(start * samples.rate), round(end * samples.rate)
        roles, joints, face = (
            {name: values[first : last + 1] for name, values in lists.items()}
            for lists in (samples.roles, samples.joints, samples.face)
        )
        samples = LayerSamples(samples.rate, roles, joints, face)
    frames = [
        replace(frame, at=round(max(0.0, frame.at - start), PLACE_DECIMALS))
        for frame in layer.frames
        if frame.at <= end
    ]
    early = [frame for frame in frames if frame.at <= 0.0]
    kept = (*early[-1:], *(frame for frame in frames if frame.at > 0.0))
    return replace(layer, frames=kept, samples=samples)


# --------------------------------------------------------------------------------------------------

#: Controls that change the emotion or how strong it is.
_MOODY = frozenset({"intensity", "valence", "arousal"})


class Puppeteer:
    """Records one layer of `move`.

    Args:
        shape: The body.
        move: As it is so far; a layer called `layer` does not play, it is being redone.
        layer: What the new layer is called.
        rate: Samples a second.
        moves: What the hand can play besides.
        seed: Of blinks and the like.
    """

    def __init__(
        self,
        shape: BodyShape,
        move: KeyframeMove,
        layer: str,
        rate: float,
        *,
        moves: Mapping[str, Move] = BUILT_IN,
        seed: int = 0,
    ) -> None:
        self._move = move
        self._layer = layer
        self._rate = rate
        backing = with_muted(move, layer)
        self._plays = any(not known.muted for known in backing.layers) and backing.length > 0
        #: The body: its pose, the stop. Inputs of the hand go through `apply`.
        self.engine = Engine(shape, {**moves, move.name: backing}, seed=seed)
        self._mood = self._seen_mood()
        self._began: float | None = None
        self._pace = 1.0
        self._take: RecordedTake | None = None
        self._t = 0.0
        #: Whether an input took the place of the layers that played; they stopped then.
        self.interrupted = False

    @property
    def backing_s(self) -> float:
        """How long the layers before play, in seconds at the tempo of now."""
        return self._move.length / self._tempo if self._plays else 0.0

    @property
    def _tempo(self) -> float:
        tempo = self.engine.values()["tempo"]
        return float(tempo) if self._move.beats and isinstance(tempo, int | float) else 1.0

    def apply(self, verb: str, args: Mapping[str, Json]) -> InputResult:
        """An input of the hand. Raises `RejectedError`."""
        answer = self.engine.apply(verb, args)
        control = args.get("control") if verb == "control" else None
        if verb in ("emotion", "affect") or control in _MOODY:
            self._mood = self._seen_mood()
        return answer

    def begin(self) -> None:
        """The take begins at the moment of the last tick, and with it the layers before.

        Their speed and size are as written, or what is recorded would not fit them later.
        """
        self.engine.apply("personality", {"speed": 1.0, "amplitude": 1.0})
        if self._plays:
            self.engine.apply("play", {"move": self._move.name})
        self._pace = self._tempo
        self._began = self._t
        self._take = RecordedTake(self._rate / self._pace)
        self._take.moment(0.0, self.engine.held, self._looks())

    def tick(self, t: float) -> Tick:
        """The body at `t`, in seconds."""
        tick = self.engine.tick(t)
        self._t = tick.t
        if self._take is not None and self._began is not None:
            place = (tick.t - self._began) * self._pace
            self._take.moment(place, self.engine.held, self._looks())
            playing = tick.move == self._move.name
            if self._plays and not playing and place < self._move.length - 1e-6:
                self.interrupted = True
        return tick

    def _looks(self) -> FaceTarget:
        """What the hand wants of the face, whatever the layers before show."""
        places = self.engine.state().controls
        return FaceTarget(*self._mood, 2 * places["eye-x"] - 1, 2 * places["eye-y"] - 1)

    def _seen_mood(self) -> tuple[str, float]:
        """What is seen; just after an input of the hand, what the hand wants."""
        values = self.engine.values()
        emotion, intensity = values["emotion"], values["intensity"]
        return str(emotion), float(intensity) if isinstance(intensity, int | float) else 0.0

    def recorded(self, *, trim: bool = True) -> KeyframeMove:
        """The move with the new layer.

        `trim`: rest at both ends is left out; rest at the beginning stays if there are other
        layers, with which the new one would fall out of step.
        """
        take = self._take or RecordedTake(self._rate)
        layer = take.layer(self._layer)
        if trim:
            start, end = active_span(layer)
            alone = all(known.name == self._layer for known in self._move.layers)
            layer = trim_layer(layer, start if alone else 0.0, end)
        return with_layer(self._move, layer)
