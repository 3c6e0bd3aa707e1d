"""What the robot shows of the engagement model by itself: eyes, screen and a beep, by state.

After the table of nonverbal signals of U. Maniscalco, P. Storniolo and A. Messina (Int. J. of
Social Robotics 14, 2022, doi 10.1007/s12369-021-00855-w). Their text gives two accounts of waiting;
here the eyes are off in Wait and white from PersonDetected on. Pictures (800 x 480) and sound come
with woz-tui (`drivers.bundled_media`); `tools/signal_pictures.py` draws them.

Every robot that offers one of the verbs `eyes`, `screen` and `sound` shows what it can.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.config.experiment import Action, Call, Experiment, ParallelCalls
from woz_tui.config.file_position import FilePosition
from woz_tui.drivers.bundled_media import name_of
from woz_tui.drivers.contract import Verb
from woz_tui.protocol.messages import Json

#: Not a state but a moment within PersonDetected: somebody looks but stands too far away.
NEARLY = "nearly"

#: How the lids move: not at all, as if blinking, or the light itself coming and going.
STEADY, BLINK, INTERMITTENT = "steady", "blink", "intermittent"


@dataclass(frozen=True, slots=True)
class StateSignal:
    """What is shown in one situation; what is empty stays as it is."""

    eyes: str = ""
    animation: str = STEADY
    screen: str = ""
    sound: str = ""

    def verbs(self) -> Iterator[tuple[str, dict[str, Json]]]:
        """Verbs with their arguments; files by their names."""
        if self.eyes:
            yield "eyes", {"color": self.eyes, "animation": self.animation}
        if self.screen:
            yield "screen", {"file": name_of(self.screen)}
        if self.sound:
            yield "sound", {"file": name_of(self.sound)}


#: By situation. Where the paper is silent (the screen of strangers), what is near is used.
SIGNALS: Mapping[str, StateSignal] = {
    "Wait": StateSignal("off", STEADY, "waiting.gif"),
    "PersonDetected": StateSignal("white", BLINK, "detected.gif"),
    NEARLY: StateSignal("green", INTERMITTENT),
    "EngagedWithUnknown": StateSignal("green", BLINK, "microphone.gif"),
    "Handshake": StateSignal("green", BLINK, "microphone.gif"),
    "EngagedWithKnown": StateSignal("green", BLINK, "microphone.gif"),
    "UserSpeaks": StateSignal("green", BLINK, "recording.gif"),
    "RobotThinks": StateSignal("white", BLINK, "thinking.gif", "beep.wav"),
    "RobotReplies": StateSignal("blue", BLINK, "talking.gif"),
    "RobotSpeaks": StateSignal("blue", BLINK, "talking.gif"),
    "stop": StateSignal("off", STEADY, "waiting.gif"),
}


def default_signals(experiment: Experiment) -> dict[str, tuple[Call, ...]]:
    """What to send by situation (a state's name, or `NEARLY`), for all robots of the experiment.

    Where the experiment says itself what a driver shows with a verb on entering a state, by
    `on_enter` or by an action named there, the default of that driver and verb steps back.
    """
    engagement = experiment.engagement
    if engagement is None or engagement.settings.signals == "none":
        return {}
    place = FilePosition(str(experiment.path), 1, 1)
    return {
        situation: tuple(
            Call(verb.name, fitting, driver, place)
            for name, args in signal.verbs()
            for driver, verb in _offering(experiment, name)
            if (driver, name) not in _own_calls(experiment, situation)
            for fitting in _fitting(verb, args)
        )
        for situation, signal in SIGNALS.items()
    }


def nearly(verdicts: Mapping[str, Json], uses: tuple[str, ...] | list[str]) -> bool:
    """All that engagement needs is there, but they stand too far away."""
    if "distance" not in uses or verdicts.get("distance") != 0 or not verdicts.get("presence"):
        return False
    return all(verdicts.get(sign) for sign in uses if sign != "distance")


class StateSignals:
    """What is to be sent now. Asked after every change of state and every look at the signs."""

    def __init__(self, experiment: Experiment) -> None:
        self._calls = default_signals(experiment)
        self._state = ""
        self._nearly = False

    def entered(self, state: str) -> tuple[Call, ...]:
        """A state was entered, also again: all of its signals."""
        self._state, self._nearly = state, False
        return self._calls.get(state, ())

    def nearly_engaged(self, near: bool) -> tuple[Call, ...]:
        """Whether they are `nearly` engaged now; calls only where that makes a difference."""
        near = near and self._state == "PersonDetected"
        if near is self._nearly:
            return ()
        self._nearly = near
        shown = self._calls.get(NEARLY, ())
        if near:
            return shown
        touched = {(call.driver, call.verb) for call in shown}
        return tuple(
            call for call in self._calls.get(self._state, ()) if (call.driver, call.verb) in touched
        )


def _offering(experiment: Experiment, name: str) -> Iterator[tuple[str, Verb]]:
    for spec in experiment.drivers:
        for verb in spec.offer.verbs:
            if verb.name == name:
                yield spec.name, verb


def _own_calls(experiment: Experiment, situation: str) -> set[tuple[str, str]]:
    """Driver and verb of all that the experiment itself does on entering a state."""
    engagement = experiment.engagement
    if engagement is None:
        return set()
    actions: list[Action | None] = [engagement.effects.get(situation)]
    actions += [experiment.action(name) for name in engagement.plays.get(situation, ())]
    return {
        (call.driver, call.verb)
        for action in actions
        if action is not None
        for step in action.steps
        if isinstance(step, ParallelCalls)
        for call in step.calls
    }


def _fitting(verb: Verb, args: Mapping[str, Json]) -> Iterator[dict[str, Json]]:
    """The arguments that this driver's verb takes; nothing where it cannot show it at all."""
    known = {argument.name: argument for argument in verb.arguments}
    main = next(iter(args))
    if main not in known:
        return
    fitting = {
        name: value
        for name, value in args.items()
        if name in known and (not known[name].choices or value in known[name].choices)
    }
    if main in fitting and all(
        argument.name in fitting for argument in verb.arguments if argument.required
    ):
        yield fitting
