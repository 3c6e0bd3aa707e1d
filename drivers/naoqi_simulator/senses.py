"""The robot's perception as keys of ALMemory, and the services that switch it on.

As on the real robot a key has a value only while somebody is subscribed to the service that
fills it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from typing import Any

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.visitor import SimulatedPerson
from naoqi_simulator.world import SimulatedWorld

SONAR = "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value"
SONAR_BACK = "Device/SubDeviceList/Platform/Back/Sonar/Sensor/Value"
SONAR_LEFT, SONAR_RIGHT = (
    f"Device/SubDeviceList/US/{side}/Sensor/Value" for side in ("Left", "Right")
)
#: What the sonar says when nothing is there, in metres: its range.
SONAR_M = 5.0
#: A NAO's sonars look this far to the side, in radians, and see so much around that.
NAO_SONAR_TURN, NAO_SONAR_HALF = math.radians(20), math.radians(30)
VISIBLE = "PeoplePerception/VisiblePeopleList"
PEOPLE = "PeoplePerception/PeopleList"
PERSON = "PeoplePerception/Person/"
LOOKING = "GazeAnalysis/PeopleLookingAtRobot"
FACES = "FaceDetected"
SOUND = "ALSoundLocalization/SoundLocated"
#: ALPeoplePerception's own range of numbers begins here in this stand-in.
FIRST_ID = 26000
#: How long it looks at a face to learn it.
LEARNING_S = 2.0


class ExtractorService(Service):
    """A service that fills keys while somebody is subscribed to it."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.subscribers: dict[str, list[float]] = {}

    @offers("subscribe(s)v")
    def subscribe(self, who: str) -> None:
        """Begin, or go on, for this subscriber."""
        self.subscribers[who] = []

    @offers("subscribe(sif)v")
    def subscribe_with(self, who: str, period: int, precision: float) -> None:
        """As subscribe(s); period and precision are only kept."""
        self.subscribers[who] = [period, precision]

    @offers("unsubscribe(s)v")
    def unsubscribe(self, who: str) -> None:
        """Not for this subscriber any more."""
        if self.subscribers.pop(who, None) is None:
            raise CallRefusedError(f"{self.name}::unsubscribe\n\t{who} is not subscribed")

    @offers("getSubscribersInfo()m")
    def get_subscribers_info(self) -> list[Any]:
        """Name, period, precision of each."""
        return [[who, *how] for who, how in self.subscribers.items()]

    @property
    def on(self) -> bool:
        return bool(self.subscribers)


class FaceDetection(ExtractorService):
    """ALFaceDetection with its database of names, by the number of whoever has that face."""

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__("ALFaceDetection")
        self._world = world
        self._learnt: dict[int, str] = {}

    @offers("learnFace(s)b")
    async def learn_face(self, name: str) -> bool:
        """Learn the face that is seen; False where none is, or nobody looks."""
        await self._world.time.sleep(LEARNING_S)
        person = self._world.person()
        if not name or person is None or not person.looking:
            return False
        self._learnt[person.number] = name
        return True

    @offers("forgetPerson(s)b")
    def forget_person(self, name: str) -> bool:
        """Forget all faces of this name; False where there is none."""
        numbers = [number for number, known in self._learnt.items() if known == name]
        for number in numbers:
            del self._learnt[number]
        return bool(numbers)

    @offers("getLearnedFacesList()[s]")
    def get_learned_faces_list(self) -> list[str]:
        return list(self._learnt.values())

    def whose(self, person: SimulatedPerson) -> str:
        """Whose face that is, or nothing: those whom the robot was taught, and who came so."""
        return self._learnt.get(person.number, person.name)


class Mood(Service):
    """ALMood: what it makes of whoever is there; nothing while nobody is subscribed."""

    name = "ALMood"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self.subscribers: dict[str, str] = {}

    @offers("subscribe(ss)b")
    def subscribe(self, who: str, how: str) -> bool:
        """Active or Passive: whether it has other extractors run, too."""
        if how not in ("Active", "Passive"):
            raise CallRefusedError(f"ALMood::subscribe\n\tunknown mode {how}")
        self.subscribers[who] = how
        return True

    @offers("unsubscribe(s)v")
    def unsubscribe(self, who: str) -> None:
        """Not for this subscriber any more."""
        if self.subscribers.pop(who, None) is None:
            raise CallRefusedError(f"ALMood::unsubscribe\n\t{who} is not subscribed")

    @offers("currentPersonState()m")
    def current_person_state(self) -> list[Any]:
        """Valence, attention, and so on, each with how sure it is; empty without anybody."""
        person = self._world.person() if self.subscribers else None
        if person is None:
            return []
        smile = guessed(person, "SmileProperties")
        valence = round(smile[0] * 2 - 1, 3)
        attention = 0.9 if person.looking else 0.2
        ease = [[0.5, 0.5]]
        expressions = [[share, 0.5] for share in guessed(person, "ExpressionProperties")]
        return [
            [valence, 0.6],
            [attention, 0.8],
            ease,
            smile,
            [*expressions, [0.0, 0.5], [0.0, 0.5]],
        ]


#: What ALFaceCharacteristics guesses of a face.
GUESSED = ("AgeProperties", "GenderProperties", "SmileProperties", "ExpressionProperties")


def guessed(person: SimulatedPerson, what: str) -> list[float]:
    """As ALFaceCharacteristics writes it: a guess and how sure it is, or a share for each of
    neutral, happy, surprised, angry and sad. The same person looks the same each time.
    """
    draw = random.Random(person.number)
    age, gender = float(draw.randint(18, 70)), float(draw.randint(0, 1))
    smile = round(draw.uniform(0.0, 1.0), 3)
    rest = round((1 - smile) / 4, 3)
    return {
        "AgeProperties": [age, 0.7],
        "GenderProperties": [gender, 0.8],
        "SmileProperties": [smile, 0.6],
        "ExpressionProperties": [rest, smile, rest, rest, rest],
    }[what]


class SensorKeys:
    """Fills ALMemory from the world."""

    def __init__(self, world: SimulatedWorld) -> None:
        self._world = world
        names = (
            *("ALSonar", "ALPeoplePerception", "ALGazeAnalysis"),
            *("ALSoundLocalization", "ALEngagementZones", "ALSoundDetection"),
            "ALFaceCharacteristics",
        )
        self._database = FaceDetection(world)
        self.extractors = {name: ExtractorService(name) for name in names}
        self.extractors[self._database.name] = self._database
        self._last: dict[str, Any] = {}
        store = world.store
        # Written by the body's own loop, whether anybody is subscribed or not; the sonar itself
        # sends only while somebody is.
        if world.options.robot == "nao":
            store.provide(SONAR_LEFT, lambda: self.nao_sonar(1))
            store.provide(SONAR_RIGHT, lambda: self.nao_sonar(-1))
        else:
            store.provide(SONAR, self.sonar)
            store.provide(SONAR_BACK, lambda: SONAR_M)
        store.provide(VISIBLE, self.visible)
        store.provide(PEOPLE, self.visible)
        store.provide_all(PERSON, self.of_person)
        store.provide(LOOKING, self.looking)
        store.provide(FACES, self.faces)
        store.provide(SOUND, self.sound)

    def _on(self, *names: str) -> bool:
        return any(self.extractors[name].on for name in names)

    def sonar(self) -> float:
        """Metres to what is in front."""
        ahead = self._world.nearest() if self._on("ALSonar") else None
        return SONAR_M if ahead is None else min(SONAR_M, round(ahead, 3))

    def nao_sonar(self, side: int) -> float:
        """Metres to the nearest thing on one side: 1 is left, -1 is right."""
        if not self._on("ALSonar"):
            return SONAR_M
        person, ahead = self._world.person(), self._world.body.front
        seen = [] if ahead is None else [ahead]
        if person and abs(person.angle - side * NAO_SONAR_TURN) <= NAO_SONAR_HALF:
            seen.append(person.distance)
        return min([SONAR_M, *(round(one, 3) for one in seen)])

    def visible(self) -> list[int]:
        """Numbers of the people seen."""
        watching = self._on("ALPeoplePerception", "ALGazeAnalysis", "ALFaceDetection")
        person = self._world.person() if watching else None
        return [FIRST_ID + person.number] if person else []

    def of_person(self, key: str) -> Any:
        """One thing about one person; None for anybody who is not there."""
        number, _, what = key.removeprefix(PERSON).partition("/")
        person = self._world.person()
        if person is None or [int(number) if number.isdigit() else -1] != self.visible():
            return None
        if what == "IsLookingAtRobot" and not self._on("ALGazeAnalysis"):
            return None
        if what in GUESSED:
            return guessed(person, what) if self._on("ALFaceCharacteristics") else None
        values = {
            "Distance": round(person.distance, 3),
            "IsVisible": True,
            "AnglesYawPitch": [person.angle, -0.1],
            "IsLookingAtRobot": person.looking,
            "LookingAtRobotScore": 0.9 if person.looking else 0.1,
        }
        return values.get(what)

    def looking(self) -> list[int]:
        """Numbers of the people who look at the robot."""
        person = self._world.person()
        on = self._on("ALGazeAnalysis") and person is not None and person.looking
        return self.visible() if on else []

    def faces(self) -> list[Any]:
        """As ALFaceDetection writes it: time, faces and who was recognised, where the camera was.

        Empty without a face. Angles in radians.
        """
        person = self._world.person() if self._on("ALFaceDetection") else None
        if person is None or not person.looking:
            return []
        body = self._world.body
        size = 0.16 / max(0.3, person.distance)
        shape = [0, person.angle - body.angle("HeadYaw"), 0.0, size, size]
        name = self._database.whose(person)
        extra = [person.number, 0.7 if name else 0.0, name, *([[0.0, 0.0]] * 6)]
        filtered = [2, [name]] if name else [4, []]
        pose = [0.0, 0.0, 1.2, 0.0, body.angle("HeadPitch"), body.angle("HeadYaw")]
        return [self.stamp(), [[shape, extra], filtered], pose, pose, 0]

    def sound(self) -> list[Any]:
        """As ALSoundLocalization writes it: time, [azimuth, elevation, confidence, energy], head.

        Azimuth in radians from the head, left positive; empty while nobody has been heard.
        """
        person = self._world.person() if self._on("ALSoundLocalization") else None
        if person is None or not person.talking:
            return list(self._last.get(SOUND, []))
        yaw = self._world.body.angle("HeadYaw")
        located = [person.angle - yaw, 0.0, 0.8, 0.6]
        sound_value = [self.stamp(), located, [0.0, 0.0, 1.2, 0.0, 0.0, yaw], [0.0] * 6]
        self._last[SOUND] = sound_value
        return sound_value

    def stamp(self) -> list[int]:
        """Seconds and microseconds of the robot's clock."""
        now = self._world.time.now()
        return [int(now), int(now % 1 * 1_000_000)]

    def tick(self) -> None:
        """Tell those who listen to events of what has changed."""
        self._changed(VISIBLE, self.visible())
        self._changed(LOOKING, self.looking())
        faces, sound = self.faces(), self.sound()
        if faces or self._last.get(FACES):
            self._world.store.notify(FACES, faces)
        self._last[FACES] = faces
        person = self._world.person()
        if sound and person is not None and person.talking:
            self._world.store.notify(SOUND, sound)

    def _changed(self, key: str, value: Sequence[int]) -> None:
        if self._last.get(key, []) != value:
            self._last[key] = value
            self._world.store.notify(key, value)
