"""A move while it is edited: what can be changed of it, and the way back.

A move is never changed: each change makes another one, and all of them are kept. So undoing is
going back in a list.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

from woz_tui.motion.body_shape import ROLES
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.easing import EASINGS
from woz_tui.motion.keyframes import PLACE_DECIMALS, KeyFrame, KeyframeMove, MoveLayer
from woz_tui.motion.move_files import ANGLES, LENGTHS, MAIN

T = TypeVar("T")

#: Rows of a layer beside its roles and joints.
EMOTION, INTENSITY = "emotion", "intensity"
#: Two frames of a layer are at least so far apart.
LEAST = 0.02
#: Between a frame and its copy.
_COPY_S = 0.2
#: How much of a layer counts, one after the other.
_SHARES = (1.0, 0.75, 0.5, 0.25)
#: Roles that a mirror turns round.
_SIDEWAYS = ("pan", "roll")
#: Decimals of an angle or a strength that was stepped to.
_DECIMALS = 3


class EditError(Exception):
    """It cannot be changed so; the text says why."""


@dataclass(frozen=True, slots=True)
class EditPlace:
    """Where the hand is: a layer, one of its rows, a moment."""

    layer: int = 0
    row: int = 0
    at: float = 0.0


class EditedMove:
    """One move, all that it was before, and where the hand is.

    Args:
        move: As it was read; one without layers gets an empty one.
    """

    def __init__(self, move: KeyframeMove) -> None:
        if not move.layers:
            move = replace(move, layers=(MoveLayer(MAIN),))
        self._moves = [move]
        self._now = 0
        self._saved = move
        self.place = EditPlace()

    # -- what there is ----------------------------------------------------------------------

    @property
    def move(self) -> KeyframeMove:
        """As it is now."""
        return self._moves[self._now]

    @property
    def unsaved(self) -> bool:
        """Whether it is another one than in the file."""
        return self.move != self._saved

    def saved(self) -> None:
        """The file holds what there is now."""
        self._saved = self.move

    @property
    def layer(self) -> MoveLayer:
        """The layer of the hand."""
        return self.move.layers[self.place.layer]

    def rows(self, layer: MoveLayer) -> list[str]:
        """What a layer's frames can say: roles, the joints that they name, the face."""
        named = dict.fromkeys(joint for frame in layer.frames for joint in frame.joints)
        named |= dict.fromkeys(layer.samples.joints if layer.samples is not None else ())
        return [*ROLES, *named, EMOTION, INTENSITY]

    @property
    def row(self) -> str:
        """The row of the hand."""
        return self.rows(self.layer)[self.place.row]

    @property
    def frame(self) -> int | None:
        """The frame at the hand's moment, counted from 0; None: there is none."""
        frames = self.layer.frames
        return next((n for n, one in enumerate(frames) if abs(one.at - self.place.at) < 1e-6), None)

    def value(self, frame: KeyFrame, row: str) -> float | str | None:
        """What a frame says of a row; None: nothing."""
        if row == EMOTION:
            return frame.emotion
        if row == INTENSITY:
            return frame.intensity
        return frame.roles[row] if row in frame.roles else frame.joints.get(row)

    # -- where the hand goes -----------------------------------------------------------------

    def go(self, at: float) -> None:
        """To a moment."""
        at = min(LENGTHS.high or at, max(0.0, at))
        self.place = replace(self.place, at=round(at, PLACE_DECIMALS))

    def next_frame(self, step: int) -> None:
        """To the next frame of the layer, or the one before (-1); at the ends nowhere."""
        places = [frame.at for frame in self.layer.frames]
        ahead = [at for at in places if (at - self.place.at) * step > 1e-6]
        if ahead:
            self.go(min(ahead) if step > 0 else max(ahead))

    def next_row(self, step: int) -> None:
        """To the next row; behind the last one is the next layer's first."""
        row = self.place.row + step
        if 0 <= row < len(self.rows(self.layer)):
            self.place = replace(self.place, row=row)
        elif 0 <= (layer := self.place.layer + step) < len(self.move.layers):
            rows = len(self.rows(self.move.layers[layer]))
            self.place = replace(self.place, layer=layer, row=0 if step > 0 else rows - 1)

    # -- the way back --------------------------------------------------------------------------

    def undo(self) -> bool:
        """As before the last change; whether there was one."""
        return self._step(-1)

    def redo(self) -> bool:
        """As before the last undoing."""
        return self._step(1)

    def _step(self, step: int) -> bool:
        there = 0 <= self._now + step < len(self._moves)
        self._now += step if there else 0
        self._stay_inside()
        return there

    def _change(self, move: KeyframeMove) -> None:
        if move == self.move:
            return
        self._moves = [*self._moves[: self._now + 1], move]
        self._now += 1
        self._stay_inside()

    def _stay_inside(self) -> None:
        layer = min(self.place.layer, len(self.move.layers) - 1)
        rows = len(self.rows(self.move.layers[layer]))
        self.place = replace(self.place, layer=layer, row=min(self.place.row, rows - 1))

    def _put(self, layer: MoveLayer) -> None:
        layers = list(self.move.layers)
        layers[self.place.layer] = layer
        self._change(replace(self.move, layers=tuple(layers)))

    def _frames(self, frames: list[KeyFrame]) -> None:
        self._put(replace(self.layer, frames=tuple(sorted(frames, key=_moment))))

    # -- frames --------------------------------------------------------------------------------

    def insert(self) -> None:
        """A frame at the moment, with the values that are there."""
        if self.frame is not None:
            raise EditError("there is a frame here")
        self._room(self.place.at)
        self._frames([*self.layer.frames, self._as_there()])

    def _as_there(self) -> KeyFrame:
        """What the layer alone says at the moment, of what its later frames still change."""
        at = self.place.at
        later = [frame for frame in self.layer.frames if frame.at > at]
        alone = replace(self.layer, share=1.0, muted=False, mix="add")
        there = KeyframeMove("", "", (alone,)).at(at)
        roles = {name for frame in later for name in frame.roles}
        joints = {name for frame in later for name in frame.joints}
        given = there.joints if self.layer.relative else there.places
        return KeyFrame(
            at,
            {name: round(there.roles.get(name, 0.0), _DECIMALS) for name in ROLES if name in roles},
            {name: round(given[name], _DECIMALS) for name in given if name in joints},
            easing=later[0].easing if later else KeyFrame(0.0).easing,
        )

    def _room(self, at: float) -> None:
        near = [frame for frame in self.layer.frames if abs(frame.at - at) < LEAST - 1e-9]
        if near:
            raise EditError(f"another frame is nearer than {LEAST:g}")

    def delete(self) -> None:
        """Without the frame at the moment."""
        number = self._need()
        frames = list(self.layer.frames)
        del frames[number]
        self._frames(frames)

    def copy(self) -> None:
        """The frame once more, a little later; those behind it go on by as much."""
        number = self._need()
        frame = self.layer.frames[number]
        before, behind = self.layer.frames[: number + 1], self.layer.frames[number + 1 :]
        again = replace(frame, at=_rounded(frame.at + _COPY_S), sound="")
        self._frames([*before, again, *(_moved(one, _COPY_S) for one in behind)])
        self.go(again.at)

    def shift(self, by: float, *, ripple: bool = False) -> None:
        """The frame earlier or later, but never past another one; `ripple`: with all behind it."""
        number = self._need()
        frames = list(self.layer.frames)
        low = frames[number - 1].at + LEAST if number else 0.0
        last = number == len(frames) - 1 or ripple
        high = (LENGTHS.high or 600.0) if last else frames[number + 1].at - LEAST
        wanted = min(high, max(low, frames[number].at + by))
        step = wanted - frames[number].at
        end = len(frames) if ripple else number + 1
        frames[number:end] = [_moved(frame, step) for frame in frames[number:end]]
        self._frames(frames)
        self.go(self.layer.frames[number].at)

    def ease(self) -> None:
        """The next way to the frame."""
        number = self._need()
        names = [*EASINGS]
        now = self.layer.frames[number].easing
        self._edit(number, lambda frame: replace(frame, easing=_after(names, now)))

    # -- values --------------------------------------------------------------------------------

    def step(self, by: float) -> None:
        """The row's value by so much more: degrees, tenths of an intensity, the next emotion. Where
        no frame is, one is made.
        """
        row, number = self.row, self._made()
        now = self.value(self.layer.frames[number], row)
        if row == EMOTION:
            names = ["", *EMOTIONS]
            known = str(now or "")
            name = names[(names.index(known) + (1 if by > 0 else -1)) % len(names)]
            strength = self.layer.frames[number].intensity
            seen = 1.0 if name and strength is None else strength  # without any nobody sees it
            self._edit(number, lambda frame: replace(frame, emotion=name or None, intensity=seen))
        else:
            grain = 0.1 if row == INTENSITY else 1.0
            self.enter((float(now) if isinstance(now, int | float) else 0.0) + by * grain)

    def enter(self, value: float) -> None:
        """The row's value."""
        row = self.row
        if row == EMOTION:
            raise EditError("an emotion is chosen with + and -")
        low, high = (0.0, 1.0) if row == INTENSITY else (ANGLES.low or 0.0, ANGLES.high or 0.0)
        value = round(min(high, max(low, value)), _DECIMALS)
        number = self._made()

        def given(frame: KeyFrame) -> KeyFrame:
            if row == INTENSITY:
                return replace(frame, intensity=value)
            if row in ROLES and row not in frame.joints:
                return replace(frame, roles={**frame.roles, row: value})
            return replace(frame, joints={**frame.joints, row: value})

        self._edit(number, given)

    def clear(self) -> None:
        """The frame says nothing of the row any more."""
        row = self.row

        def without(frame: KeyFrame) -> KeyFrame:
            if row == EMOTION:
                return replace(frame, emotion=None)
            if row == INTENSITY:
                return replace(frame, intensity=None)
            roles = {name: value for name, value in frame.roles.items() if name != row}
            joints = {name: value for name, value in frame.joints.items() if name != row}
            return replace(frame, roles=roles, joints=joints)

        self._edit(self._need(), without)

    def _edit(self, number: int, change: Callable[[KeyFrame], KeyFrame]) -> None:
        frames = list(self.layer.frames)
        frames[number] = change(frames[number])
        self._frames(frames)

    def _made(self) -> int:
        if self.frame is None:
            self.insert()
        return self._need()

    def _need(self) -> int:
        if self.frame is None:
            raise EditError("no frame is here: i makes one, left and right lead to others")
        return self.frame

    # -- layers --------------------------------------------------------------------------------

    def mute(self) -> None:
        """The layer off, or on again."""
        self._put(replace(self.layer, muted=not self.layer.muted))

    def share(self) -> None:
        """The next share that counts of the layer."""
        self._put(replace(self.layer, share=_after([*_SHARES], self.layer.share)))

    def add_layer(self) -> None:
        """An empty layer on top of all others."""
        names = {layer.name for layer in self.move.layers}
        name = next(n for n in (f"layer-{i}" for i in range(2, 1000)) if n not in names)
        self._change(replace(self.move, layers=(*self.move.layers, MoveLayer(name))))
        self.place = EditPlace(len(self.move.layers) - 1, 0, self.place.at)

    def add(self, layer: MoveLayer) -> None:
        """A layer that is made, on top of all others."""
        self._change(replace(self.move, layers=(*self.move.layers, layer)))
        self.place = EditPlace(len(self.move.layers) - 1, 0, self.place.at)

    def put(self, layer: MoveLayer) -> None:
        """Another one in the place of the layer of the hand."""
        self._put(layer)

    def trim(self) -> None:
        """Without all frames of the layer behind the moment."""
        self._frames([frame for frame in self.layer.frames if frame.at <= self.place.at + 1e-6])

    def mirror(self) -> None:
        """The layer's left to the right."""
        self._frames(
            [
                replace(
                    frame,
                    roles={
                        name: -value + 0.0 if name in _SIDEWAYS else value
                        for name, value in frame.roles.items()
                    },
                    x=None if frame.x is None else -frame.x + 0.0,
                )
                for frame in self.layer.frames
            ]
        )


def _moment(frame: KeyFrame) -> float:
    return frame.at


def _rounded(at: float) -> float:
    return round(at, PLACE_DECIMALS)


def _moved(frame: KeyFrame, by: float) -> KeyFrame:
    return replace(frame, at=_rounded(frame.at + by))


def _after(names: list[T], now: T) -> T:
    return names[(names.index(now) + 1) % len(names)] if now in names else names[0]
