"""What the robots' faces express, for what shall sound like them.

A verb `by_mood` is recorded with the mood and the seed with which it is carried out, so that its
log says what was heard, and a re-run sounds the same.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.motion.emotions import affect_emotion, emotion_affect
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

#: Verbs that tell a face what to express.
_FACES = frozenset({"emotion", "affect"})
#: Arguments that are filled in, and what stands for them where a wizard may not know them.
_MOOD = {"valence": "{mood}", "arousal": "{mood}"}
#: Decimals of a mood in the log.
_DECIMALS = 3


@dataclass(frozen=True, slots=True)
class Mood:
    """A place on Russell's circle, both from -1 to 1; `tells` as in `messages.Command`."""

    valence: float = 0.0
    arousal: float = 0.0
    tells: tuple[str, ...] = ()


class FaceMoods:
    """What each driver with a face was told last, or shows since: by a move, by knobs.

    Args:
        seed: The session's, from which those of sounds come.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._sounds = 0
        #: By driver; the face that changed last comes last.
        self._shown: dict[str, Mood] = {}
        #: What a driver is being told, by the command of that id, and what it showed before.
        self._being_told: dict[str, tuple[str, Mood]] = {}
        #: Those that tell their mood, and not only the emotion that it looks like.
        self._exact: set[str] = set()

    def listen(self, hub: Hub) -> None:
        """From here on it knows, where a verb is `by_mood`."""
        hub.listen(self._on_command, m.Command)
        hub.listen(self._on_end, m.End)
        hub.listen(self._on_face, m.FaceShown)
        hub.listen(self._on_body, m.BodyChanged)

    def completed(self, command: m.Command) -> m.Command:
        """The command of a verb `by_mood` as it is to be recorded: with mood and seed."""
        args, tells, unfilled = dict(command.args), command.tells, dict(command.unfilled)
        if any(args.get(name) is None for name in _MOOD):
            mood = _named(args) if args.get("emotion") else self._face_of(command.driver)
            tells = (*tells, *(each for each in mood.tells if each not in tells))
            for name in [name for name in _MOOD if args.get(name) is None]:
                args[name] = round(getattr(mood, name), _DECIMALS)
                if tells:
                    unfilled[name] = _MOOD[name]
        if args.get("seed") is None:
            self._sounds += 1
            args["seed"] = random.Random(f"{self._seed} {self._sounds}").randrange(2**31)
        return msgspec.structs.replace(command, args=args, tells=tells, unfilled=unfilled)

    def _face_of(self, driver: str) -> Mood:
        """What the face of the same robot expresses; nothing where it has none."""
        robot = driver.rpartition(".")[0]
        moods = [mood for name, mood in self._shown.items() if name.rpartition(".")[0] == robot]
        return moods[-1] if moods else Mood()

    def _show(self, driver: str, mood: Mood) -> None:
        self._shown.pop(driver, None)
        self._shown[driver] = mood

    def _tells(self, driver: str) -> tuple[str, ...]:
        """What the face tells, by whatever it was told last."""
        return self._shown.get(driver, Mood()).tells

    def _on_command(self, command: m.Command) -> None:
        """A face is told something: that counts for what is asked for in the same moment."""
        if command.verb not in _FACES:
            return
        mood = _named(command.args) if command.verb == "emotion" else _placed(command.args)
        if mood is not None:
            before = self._shown.get(command.driver, Mood())
            self._being_told[command.driver] = (command.command, before)
            self._show(command.driver, Mood(mood.valence, mood.arousal, command.tells))

    def _on_end(self, end: m.End) -> None:
        """It was done, maybe at another strength; or else the face is as it was."""
        command, before = self._being_told.get(end.driver, ("", Mood()))
        if command != end.command:
            return
        del self._being_told[end.driver]
        if not isinstance(end, m.Done):
            self._show(end.driver, before)
        elif end.sent.get("emotion") and "valence" not in end.sent:
            mood = _named(end.sent)
            self._show(end.driver, Mood(mood.valence, mood.arousal, self._tells(end.driver)))

    def _on_face(self, face: m.FaceShown) -> None:
        if face.driver not in self._being_told and face.driver not in self._exact:
            place = emotion_affect(face.emotion, face.intensity)
            self._show(face.driver, Mood(*place, self._tells(face.driver)))

    def _on_body(self, body: m.BodyChanged) -> None:
        """Its mood, unless a move shows another emotion on top of that."""
        place = _placed(body.values)
        if place is None or body.driver in self._being_told:
            return
        self._exact.add(body.driver)
        if affect_emotion(place.valence, place.arousal)[0] != body.values.get("emotion"):
            place = _named(body.values)
        shown = self._shown.get(body.driver, Mood())
        if (place.valence, place.arousal) != (shown.valence, shown.arousal):
            self._show(body.driver, Mood(place.valence, place.arousal, self._tells(body.driver)))


def _named(args: Mapping[str, Json]) -> Mood:
    """The mood of a named emotion; in the middle if it has no place on the circle."""
    strength = args.get("intensity")
    given = float(strength) if isinstance(strength, int | float) else 1.0
    return Mood(*emotion_affect(str(args.get("emotion")), given))


def _placed(values: Mapping[str, Json]) -> Mood | None:
    """The mood that is given in numbers, if it is."""
    valence, arousal = values.get("valence"), values.get("arousal")
    if isinstance(valence, int | float) and isinstance(arousal, int | float):
        return Mood(float(valence), float(arousal))
    return None
