"""The whole robot: all services around one world, what goes on by itself, what can be looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from types import MappingProxyType

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
from naoqi_simulator.senses import SensorKeys
from naoqi_simulator.service_table import Service
from naoqi_simulator.sounds import AudioPlayer, AudioRecorder, RobotDisk
from naoqi_simulator.speech import AnimatedSpeech, SpeechVoice, TextToSpeech
from naoqi_simulator.system import Battery, System
from naoqi_simulator.tablet import TabletService
from naoqi_simulator.test_service import TestCalls, TestService
from naoqi_simulator.world import SimulatedWorld

#: Seconds of the robot between two looks at what has changed.
TICK_S = 0.1
#: Chance in a second that a moody robot changes something of its autonomy.
MOOD_PER_S = 0.1


class NaoqiSimulator:
    """One robot."""

    def __init__(self, world: SimulatedWorld) -> None:
        self.world = world
        self.knobs = TestCalls()
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
        self.standin = TestService(world, self.knobs, self.tablet.touch if self.tablet else None)
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
            *(*self.senses.extractors.values(), self.recognition),
            *(*own, self.player, self.recorder, self.audio, self.camera),
            self.standin,
        )
        self._knobs()
        self.services: Mapping[str, Service] = MappingProxyType(
            {service.name: service for service in everything}
        )
        self._switch_on()

    def _switch_on(self) -> None:
        self.life.become(self.world.options.life)
        if self.world.options.life != "disabled":
            self.world.body.wake()
            self.world.body.take("StandInit", 0.0)
            self.world.body.posture = "Stand"

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
            self.world.note(f"by itself: {self.life.drift()}")

    def _knobs(self) -> None:
        world, add = self.world, self.knobs.add
        add("awake", lambda: world.body.awake)
        add("posture", lambda: world.body.posture, self._put)
        add("pose", world.body.pose)
        add("velocity", world.body.velocity)
        add("angles", self.angles)
        add("front", lambda: world.body.front, self._front)
        add("side", lambda: world.body.side, self._side)
        add("going", lambda: [(one.kind, one.about) for one in world.going])
        add("faults", world.faults.names)
        add("notes", lambda: list(world.notes))
        add("said", lambda: self.voice.said)
        add("animations", lambda: self.animations.done)
        add("life", lambda: self.life.state, self.life.become)
        add("drift", lambda: "", lambda _: world.note(f"by itself: {self.life.drift()}"))
        add("eyes", lambda: self.leds.color("RightFaceLed1"))
        add("eyes.animation", self.leds.animation)
        add("battery", self.battery.get_battery_charge, lambda p: self.battery.fill(float(p)))
        add("breathing", lambda: world.body.breathing)
        add("now", world.time.now)
        add("sounds", lambda: self.disk.table, self.disk.table.update)
        add("sounds.loaded", self.player.state)
        add("sounds.streamed", lambda: self.player.streamed)
        add("says", lambda: self.recognition.vocabulary, self.recognition.say)
        add("recording", lambda: self.recorder.path)
        add("sound.subscribers", self.audio.subscribers)
        add("sound.output", self.audio.output)
        add("camera.subscribers", self.camera.get_subscribers)

        if self.tablet:
            self._knobs_of_tablet(self.tablet)
        if self.sensors:
            self._knobs_of_sensors(self.sensors)

    def _knobs_of_tablet(self, tablet: TabletService) -> None:
        def video_seconds(seconds: float) -> None:
            tablet.video_s = float(seconds)

        add = self.knobs.add
        add("tablet", tablet.state)
        add("tablet.fetched", lambda: [asdict(one) for one in tablet.fetched])
        add("tablet.video_seconds", lambda: tablet.video_s, video_seconds)

    def _knobs_of_sensors(self, sensors: BodySensors) -> None:
        leds, add = self.leds.color, self.knobs.add
        add("touched", lambda: sensors.touched, sensors.touch)
        add("temperatures", lambda: sensors.temperatures, sensors.heat)
        add("ears", lambda: leds("LeftEarLed1"))
        add("chest", lambda: leds("ChestLed"))
        add("feet", lambda: leds("LeftFootLed"))

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
