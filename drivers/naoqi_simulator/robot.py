"""The whole robot: all services around one world, what goes on by itself, what can be looked at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from types import MappingProxyType
from typing import Any

from naoqi_simulator.animations import AnimationLibrary, AnimationPlayer, BehaviorManager
from naoqi_simulator.audio import AudioDevice
from naoqi_simulator.body_sensors import BodySensors, BodyTemperature
from naoqi_simulator.camera import VideoDevice
from naoqi_simulator.leds import Leds
from naoqi_simulator.life import Ability, AutonomousLife, Awareness
from naoqi_simulator.memory import MemoryService
from naoqi_simulator.motion import MotionService
from naoqi_simulator.posture import RobotPosture
from naoqi_simulator.recognition import SpeechRecognition
from naoqi_simulator.senses import Mood, SensorKeys
from naoqi_simulator.service_table import Service
from naoqi_simulator.sounds import AudioPlayer, AudioRecorder, RobotDisk
from naoqi_simulator.speech import AnimatedSpeech, SpeechVoice, TextToSpeech
from naoqi_simulator.system import Battery, System
from naoqi_simulator.tablet import TabletService
from naoqi_simulator.test_service import TestService
from naoqi_simulator.world import SimulatedWorld

#: Seconds of the robot between two looks at what has changed.
TICK_S = 0.1
#: Chance in a second that a moody robot changes something of its autonomy.
MOOD_PER_S = 0.1


class NaoqiSimulator:
    def __init__(self, world: SimulatedWorld) -> None:
        self.world = world
        self.animations = AnimationLibrary(world)
        self.voice = SpeechVoice(world)
        self.motion = MotionService(world)
        self.leds = Leds(world)
        self.senses = SensorKeys(world)
        self.recognition = SpeechRecognition(world)
        self.battery = Battery(world)
        self.awareness = Awareness(world)
        self.tablet = TabletService(world) if world.options.robot == "pepper" else None
        self.sensors = BodySensors(world) if world.options.robot == "nao" else None
        self.disk = RobotDisk(world)
        self.player = AudioPlayer(world, self.disk)
        self.recorder = AudioRecorder(world, self.disk)
        self.audio = AudioDevice(world)
        self.camera = VideoDevice(world)
        abilities: dict[str, Ability] = {"ALBasicAwareness": self.awareness}
        for name in ("ALAutonomousBlinking", "ALListeningMovement", "ALSpeakingMovement"):
            abilities[name] = Ability(name, world)
        self.life = AutonomousLife(world, self.motion, abilities)
        touch = self.tablet.touch if self.tablet else None
        self.standin = TestService(world, self.seen, self._changes(), touch)
        own: tuple[Service, ...] = ()
        if self.tablet:
            own = (self.tablet,)
        if self.sensors:
            own = (BodyTemperature(self.sensors),)
        everything: tuple[Service, ...] = (
            *(self.motion, RobotPosture(world), self.leds, self.battery, System(world), self.life),
            *(TextToSpeech(self.voice, self.animations), MemoryService(world)),
            *(AnimatedSpeech(self.voice, self.animations), *abilities.values()),
            *(AnimationPlayer(self.animations, world), BehaviorManager(self.animations, world)),
            *(*self.senses.extractors.values(), Mood(world), self.recognition),
            *(*own, self.player, self.recorder, self.audio, self.camera),
            self.standin,
        )
        self.services: Mapping[str, Service] = MappingProxyType(
            {service.name: service for service in everything}
        )
        self.life.become(world.options.life)
        if world.options.life != "disabled":
            world.body.wake()
            world.body.take("StandInit", 0.0)
            world.body.posture = "Stand"

    async def live(self) -> None:
        """What goes on by itself, until cancelled."""
        while True:
            await self.world.time.sleep(TICK_S)
            self.tick()

    def tick(self) -> None:
        """One look at what has changed, and what the robot does about it."""
        self.senses.tick()
        self.awareness.follow()
        moody = self.world.options.moody or self.world.faults.active("moody")
        if moody and self.world.random.random() < MOOD_PER_S * TICK_S:
            self._drift()

    # -- what can be looked at and changed, by name ------------------------------------------------

    def seen(self) -> dict[str, Any]:
        """How the robot is now."""
        body, color = self.world.body, self.leds.color
        found: dict[str, Any] = {
            "awake": body.awake,
            "posture": body.posture,
            "pose": body.pose(),
            "velocity": body.velocity(),
            "angles": self.angles(),
            "front": body.front,
            "side": body.side,
            "going": [(one.kind, one.about) for one in self.world.going],
            "faults": self.world.faults.names(),
            "notes": self.world.notes,
            "said": self.voice.said,
            "animations": self.animations.done,
            "life": self.life.state,
            "tracking": self.awareness.tracking,
            "awareness.paused": self.awareness.paused,
            "drift": "",
            "eyes": color("RightFaceLed1"),
            "eyes.animation": self.leds.animation(),
            "battery": self.battery.get_battery_charge(),
            "breathing": body.breathing,
            "now": self.world.time.now(),
            "sounds": self.disk.table,
            "sounds.loaded": self.player.state(),
            "sounds.streamed": self.player.streamed,
            "says": self.recognition.vocabulary,
            "recording": self.recorder.path,
            "sound.subscribers": self.audio.subscribers(),
            "sound.output": self.audio.output(),
            "camera.subscribers": self.camera.get_subscribers(),
        }
        if self.tablet:
            found["tablet"] = self.tablet.state()
            found["tablet.fetched"] = [asdict(one) for one in self.tablet.fetched]
            found["tablet.video_seconds"] = self.tablet.video_s
        if self.sensors:
            found["touched"] = self.sensors.touched
            found["temperatures"] = self.sensors.temperatures
            found["ears"] = color("LeftEarLed1")
            found["chest"] = color("ChestLed")
            found["feet"] = color("LeftFootLed")
        return found

    def _changes(self) -> dict[str, Callable[[Any], object]]:
        changes: dict[str, Callable[[Any], object]] = {
            "posture": self._put,
            "front": self._front,
            "side": self._side,
            "life": self.life.become,
            "tracking": self.awareness.set_tracking_mode,
            "drift": self._drift,
            "battery": self.battery.fill,
            "sounds": self.disk.table.update,
            "says": self.recognition.say,
        }
        if self.tablet:
            changes["tablet.video_seconds"] = self.tablet.let_videos_last
        if self.sensors:
            changes |= {"touched": self.sensors.touch, "temperatures": self.sensors.heat}
        return changes

    def _drift(self, _: object = None) -> None:
        self.world.note(f"by itself: {self.life.drift()}")

    def _put(self, posture: str) -> None:
        """Somebody puts it into a posture. Raises KeyError."""
        self.world.body.plan.postures[posture]
        self.world.body.posture = posture

    def _front(self, metres: float | None) -> None:
        self.world.body.front = None if metres is None else float(metres)

    def _side(self, metres: float | None) -> None:
        self.world.body.side = None if metres is None else float(metres)

    def angles(self) -> dict[str, float]:
        """Every joint's angle in radians."""
        return dict(
            zip(
                names := self.motion.get_body_names("Body"),
                self.motion.get_angles(names, True),
                strict=True,
            )
        )
