"""A pass of puppeteering: an engine, the layers that play meanwhile, and the take of the hand."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.core.messages import Json
from woz_tui.motion.builtin import BUILT_IN
from woz_tui.motion.engine import Engine
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move import Move
from woz_tui.motion.recording import Looks, Take, laid, muted, rest, trimmed
from woz_tui.motion.shapes import BodyShape
from woz_tui.motion.ticks import Answer, Tick

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
        backing = muted(move, layer)
        self._plays = any(not known.muted for known in backing.layers) and backing.length > 0
        self._engine = Engine(shape, {**moves, move.name: backing}, seed=seed)
        self._mood = self._seen_mood()
        self._began: float | None = None
        self._pace = 1.0
        self._take: Take | None = None
        self._t = 0.0
        #: Whether an input took the place of the layers that played; they stopped then.
        self.interrupted = False

    @property
    def held(self) -> Mapping[str, float]:
        """Where the hand has put each joint, in degrees."""
        return self._engine.held

    @property
    def backing_s(self) -> float:
        """How long the layers before play, in seconds at the tempo of now."""
        return self._move.length / self._tempo if self._plays else 0.0

    @property
    def _tempo(self) -> float:
        tempo = self._engine.values()["tempo"]
        return float(tempo) if self._move.beats and isinstance(tempo, int | float) else 1.0

    def apply(self, verb: str, args: Mapping[str, Json]) -> Answer:
        """An input of the hand. Raises `Rejected`."""
        answer = self._engine.apply(verb, args)
        control = args.get("control") if verb == "control" else None
        if verb in ("emotion", "affect") or control in _MOODY:
            self._mood = self._seen_mood()
        return answer

    def freeze(self) -> None:
        """The stop."""
        self._engine.freeze()

    def resume(self) -> None:
        """The stop was released."""
        self._engine.resume()

    def begin(self) -> None:
        """The take begins at the moment of the last tick, and with it the layers before.

        Their speed and size are as written, or what is recorded would not fit them later.
        """
        self._engine.apply("personality", {"speed": 1.0, "amplitude": 1.0})
        if self._plays:
            self._engine.apply("play", {"move": self._move.name})
        self._pace = self._tempo
        self._began = self._t
        self._take = Take(self._rate / self._pace)
        self._take.moment(0.0, self._engine.held, self._looks())

    def tick(self, t: float) -> Tick:
        """The body at `t`, in seconds."""
        tick = self._engine.tick(t)
        self._t = tick.t
        if self._take is not None and self._began is not None:
            place = (tick.t - self._began) * self._pace
            self._take.moment(place, self._engine.held, self._looks())
            playing = tick.move == self._move.name
            if self._plays and not playing and place < self._move.length - 1e-6:
                self.interrupted = True
        return tick

    def _looks(self) -> Looks:
        """What the hand wants of the face, whatever the layers before show."""
        places = self._engine.state().controls
        return Looks(*self._mood, 2 * places["eye-x"] - 1, 2 * places["eye-y"] - 1)

    def _seen_mood(self) -> tuple[str, float]:
        """What is seen; just after an input of the hand, what the hand wants."""
        values = self._engine.values()
        emotion, intensity = values["emotion"], values["intensity"]
        return str(emotion), float(intensity) if isinstance(intensity, int | float) else 0.0

    def recorded(self, *, trim: bool = True) -> KeyframeMove:
        """The move with the new layer.

        `trim`: rest at both ends is left out; rest at the beginning stays if there are other
        layers, with which the new one would fall out of step.
        """
        take = self._take or Take(self._rate)
        layer = take.layer(self._layer)
        if trim:
            start, end = rest(layer)
            alone = all(known.name == self._layer for known in self._move.layers)
            layer = trimmed(layer, start if alone else 0.0, end)
        return laid(self._move, layer)
