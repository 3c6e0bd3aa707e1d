"""Moves made of key frames and recordings, in layers that play in sync.

A frame is a moment at which something is reached. It moves what it names, from the frame before to
its own moment; what it does not name stays. Angles are relative to the pose held when the move
began, or absolute. A layer has frames, dense samples or both; layers lie on each other in their
order, each added to what is below or taking its place, with a share from 0 to 1.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from woz_tui.motion.easing import EASINGS
from woz_tui.motion.move_types import FaceChange, Posture, SoundCue

# -- tracks ---------------------------------------------------------------------------------------
# One value over time: from key to key by an easing, or through dense samples.


@dataclass(frozen=True, slots=True)
class KeyTrack:
    """From key to key; `easings[i]` leads to key `i`, so the first one leads nowhere.

    `places` rise; a key at the place of the one before takes its place at once.
    """

    places: tuple[float, ...]
    values: tuple[float, ...]
    easings: tuple[str, ...]

    @property
    def begins(self) -> float:
        """Place of the first key."""
        return self.places[0]

    def at(self, place: float) -> float:
        """The value; beyond an end as there."""
        after = bisect_right(self.places, place)
        if after == 0:
            return self.values[0]
        if after == len(self.places):
            return self.values[-1]
        start, value = self.places[after - 1], self.values[after - 1]
        share = (place - start) / (self.places[after] - start)
        return value + (self.values[after] - value) * EASINGS[self.easings[after]](share)


@dataclass(frozen=True, slots=True)
class SampleTrack:
    """Straight from sample to sample, `rate` of them each second or beat; the first is at 0."""

    rate: float
    values: tuple[float, ...]
    begins: float = 0.0

    def at(self, place: float) -> float:
        """The value; beyond an end as there."""
        position = place * self.rate
        index = int(max(0.0, position))
        if index >= len(self.values) - 1:
            return self.values[-1]
        value = self.values[index]
        return value + (self.values[index + 1] - value) * max(0.0, position - index)


#: A value over the places (seconds or beats) of a move; at its place `begins` it begins to count.
Track = KeyTrack | SampleTrack


@dataclass(slots=True)
class KeyTrackBuilder:
    """Keys of a track while they are being collected, in the order of their places."""

    places: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    easings: list[str] = field(default_factory=list)

    def key(self, place: float, value: float, easing: str) -> None:
        """The next key; at the place of the last one it replaces that one."""
        if self.places and place <= self.places[-1]:
            self.values[-1] = value
            return
        self.places.append(place)
        self.values.append(value)
        self.easings.append(easing)

    def leg(self, start: float, end: float, value: float, easing: str, first: float) -> None:
        """To `value` between `start` and `end`; until `start` it stays where it is, at `first`
        if it was nowhere.
        """
        here = self.values[-1] if self.values else first
        if not self.places or start > self.places[-1]:
            self.key(start, here, "linear")
        self.key(end, value, easing)

    def keyed(self) -> KeyTrack:
        """The finished track."""
        return KeyTrack(tuple(self.places), tuple(self.values), tuple(self.easings))


@dataclass(frozen=True, slots=True)
class WordTrack:
    """A word that changes from one moment to the next; nothing before the first."""

    places: tuple[float, ...]
    words: tuple[str, ...]

    @classmethod
    def of(cls, steps: Iterable[tuple[float, str]]) -> WordTrack:
        """From places and words, in order."""
        pairs = tuple(steps)
        return cls(tuple(place for place, _ in pairs), tuple(word for _, word in pairs))

    def at(self, place: float) -> str | None:
        """The word that counts at `place`."""
        before = bisect_right(self.places, place)
        return self.words[before - 1] if before else None


# --------------------------------------------------------------------------------------------------

#: How a layer lies on those below: its values are added, or take the place of theirs.
MIXES = ("add", "replace")
#: What a face has that is a number, and where it is while nobody says otherwise.
FEATURES: Mapping[str, float] = {"intensity": 0.0, "x": 0.0, "y": 0.0, "lid": 1.0}
NEUTRAL = "neutral"

#: Places are kept to a microsecond, so that adding up times and taking them apart agree.
PLACE_DECIMALS = 6


@dataclass(frozen=True, slots=True)
class KeyFrame:
    """What is reached at the place `at` (seconds or beats from the beginning), by `easing`.

    Angles are degrees; `joints` are relative or absolute as the layer is, `roles` always relative.
    An emotion comes on over the way to the frame, from no intensity; without one an intensity is
    that of the emotion before. The `sound` (absolute path) begins when the frame is reached.
    """

    at: float
    roles: Mapping[str, float] = field(default_factory=dict)
    joints: Mapping[str, float] = field(default_factory=dict)
    easing: str = "smooth"
    emotion: str | None = None
    intensity: float | None = None
    x: float | None = None
    y: float | None = None
    lid: float | None = None
    sound: str = ""
    volume: float = 1.0


@dataclass(frozen=True, slots=True)
class LayerSamples:
    """Values at equal distances, `rate` a second or beat, the first at the beginning.

    `face` has lists for x, y, lid and intensity.
    """

    rate: float
    roles: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    joints: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    face: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Place of the last sample of the longest list."""
        lists = [*self.roles.values(), *self.joints.values(), *self.face.values()]
        return max((len(values) - 1 for values in lists), default=0) / self.rate


@dataclass(frozen=True, slots=True)
class MoveLayer:
    """A part of a move that is made, muted and redone by itself."""

    name: str
    frames: tuple[KeyFrame, ...] = ()
    samples: LayerSamples | None = None
    #: Whether joints are added to the pose held before, or are angles themselves.
    relative: bool = True
    mix: str = "add"
    #: How much of it counts: 0 nothing, 1 all.
    share: float = 1.0
    muted: bool = False

    @property
    def length(self) -> float:
        """Where it ends."""
        frames = self.frames[-1].at if self.frames else 0.0
        return max(frames, self.samples.length if self.samples is not None else 0.0)


@dataclass(frozen=True)
class KeyframeMove:
    """A move of layers. Muted layers count for its length, so muting changes nobody's timing."""

    name: str
    summary: str
    layers: tuple[MoveLayer, ...]
    beats: bool = False
    stays: bool = False

    def __post_init__(self) -> None:
        self.at(0.0)  # the tracks are worked out now, and not in a body's first tick

    @cached_property
    def length(self) -> float:
        """Where the longest layer ends, in seconds or beats."""
        return max((layer.length for layer in self.layers), default=0.0)

    @cached_property
    def cues(self) -> tuple[SoundCue, ...]:
        """The sounds of all layers that are heard, in order."""
        cues = (
            SoundCue(frame.at, frame.sound, frame.volume * layer.share)
            for layer in self._audible_layers
            for frame in layer.frames
            if frame.sound
        )
        return tuple(sorted(cues, key=lambda cue: cue.at))

    @property
    def _audible_layers(self) -> list[MoveLayer]:
        return [layer for layer in self.layers if not layer.muted and layer.share > 0]

    @cached_property
    def _tracks(self) -> tuple[_LayerTracks, ...]:
        return tuple(_LayerTracks.of(layer) for layer in self._audible_layers)

    def at(self, place: float) -> Posture:
        """What it wants at `place`; before the beginning and after the end as there."""
        place = min(self.length, max(0.0, place))
        mixed = _LayerMix()
        for layer in self._tracks:
            layer.onto(mixed, place)
        return mixed.posture()


# -- playing ------------------------------------------------------------------------------------


@dataclass(slots=True)
class _LayerMix:
    """Layers as far as they have been laid on each other."""

    roles: dict[str, float] = field(default_factory=dict)
    joints: dict[str, float] = field(default_factory=dict)
    places: dict[str, float] = field(default_factory=dict)
    features: dict[str, float] = field(default_factory=dict)
    emotion: str | None = None

    def posture(self) -> Posture:
        face = None
        if self.features or self.emotion is not None:
            face = FaceChange(emotion=self.emotion, **self.features)
        return Posture(self.roles, self.joints, self.places, face)


@dataclass(frozen=True, slots=True)
class _LayerTracks:
    """A layer made ready."""

    relative: bool
    replaces: bool
    share: float
    roles: Mapping[str, Track]
    joints: Mapping[str, Track]
    features: Mapping[str, Track]
    emotions: WordTrack

    @classmethod
    def of(cls, layer: MoveLayer) -> _LayerTracks:
        dense = layer.samples or LayerSamples(1.0)
        drawn = _TrackBuilder(layer.relative)
        before = 0.0
        for frame in layer.frames:
            drawn.frame(frame, before)
            before = frame.at
        return cls(
            layer.relative,
            layer.mix == "replace",
            layer.share,
            {**_sampled(dense, dense.roles), **_keyed(drawn.roles)},
            {**_sampled(dense, dense.joints), **_keyed(drawn.joints)},
            {**_keyed(drawn.features), **_sampled(dense, dense.face)},
            WordTrack.of(drawn.emotions),
        )

    def onto(self, mixed: _LayerMix, place: float) -> None:
        for role, track in self.roles.items():
            mixed.roles[role] = self._over(mixed.roles.get(role, 0.0), track.at(place))
        for joint, track in self.joints.items():
            value = track.at(place)
            if self.relative:
                mixed.joints[joint] = self._over(mixed.joints.get(joint, 0.0), value)
            else:
                below = mixed.places.get(joint, value)
                mixed.places[joint] = _blended(below, value, self.share)
        emotion = self.emotions.at(place)
        if emotion is not None:
            mixed.emotion = emotion
        for feature, track in self.features.items():
            if place >= track.begins:
                below = mixed.features.get(feature, FEATURES[feature])
                mixed.features[feature] = _blended(below, track.at(place), self.share)

    def _over(self, below: float, value: float) -> float:
        if self.replaces:
            return _blended(below, value, self.share)
        return below + self.share * value


def _blended(below: float, value: float, share: float) -> float:
    """Between both; exactly one of them at 0 and 1."""
    return below * (1 - share) + value * share


def _keyed(drawings: Mapping[str, KeyTrackBuilder]) -> dict[str, Track]:
    return {name: drawing.keyed() for name, drawing in drawings.items()}


def _sampled(dense: LayerSamples, lists: Mapping[str, tuple[float, ...]]) -> dict[str, Track]:
    return {name: SampleTrack(dense.rate, values) for name, values in lists.items()}


@dataclass(slots=True)
class _TrackBuilder:
    """A layer's frames, taken apart into tracks."""

    relative: bool
    roles: dict[str, KeyTrackBuilder] = field(default_factory=dict)
    joints: dict[str, KeyTrackBuilder] = field(default_factory=dict)
    features: dict[str, KeyTrackBuilder] = field(default_factory=dict)
    emotions: list[tuple[float, str]] = field(default_factory=list)

    def frame(self, frame: KeyFrame, before: float) -> None:
        """The next frame; the one before it is at `before`."""
        for name, angle in frame.roles.items():
            track = self.roles.setdefault(name, KeyTrackBuilder())
            track.leg(before, frame.at, angle, frame.easing, 0.0)
        for name, angle in frame.joints.items():
            # Where an absolute joint comes from nobody knows here: the engine leads it over.
            track = self.joints.setdefault(name, KeyTrackBuilder())
            first = 0.0 if self.relative else angle
            track.leg(before, frame.at, angle, frame.easing, first)
        self._mood(frame, before)
        for name in ("x", "y", "lid"):
            value = getattr(frame, name)
            if value is not None:
                track = self.features.setdefault(name, KeyTrackBuilder())
                track.leg(before, frame.at, value, frame.easing, FEATURES[name])

    def _mood(self, frame: KeyFrame, before: float) -> None:
        """One emotion goes, in half the time, before another comes; neutral is no intensity."""
        if frame.emotion is None and frame.intensity is None:
            return
        track = self.features.setdefault("intensity", KeyTrackBuilder())
        was = self.emotions[-1][1] if self.emotions else None
        now = frame.emotion or was
        wanted = 1.0 if frame.intensity is None else frame.intensity
        goal = 0.0 if now == NEUTRAL else wanted
        visible = was not in (None, NEUTRAL) and bool(track.values) and track.values[-1] > 0
        if now == was or not visible:
            switch = before
        elif now == NEUTRAL:
            switch = frame.at
        else:
            switch = (before + frame.at) / 2
            track.leg(before, switch, 0.0, frame.easing, 0.0)
        if now is not None and now != was:
            self.emotions.append((switch, now))
        track.leg(max(before, switch) if switch < frame.at else before, frame.at, goal,
                  frame.easing, 0.0)  # fmt: skip
