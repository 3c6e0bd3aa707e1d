"""What the screen shows, as plain data: a `Welcome` and the messages after it, reduced.

Nothing here draws, waits or looks at a clock. All times are microseconds on the session's `t`
axis; `Picture.now` turns a local clock into that axis, so that things can age between messages.
Messages may come in any order, twice or not at all: the picture takes what it can from each and
never raises.
"""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import msgspec

from woz_tui.console.bodies.outlines import Outline, outlines_of
from woz_tui.console.engagement.orders import done_words
from woz_tui.console.engagement.seen import Engaged
from woz_tui.console.feed import Incoming
from woz_tui.console.parts import (
    STALE_US,
    DriverPicture,
    KnobsPicture,
    LastRun,
    RecorderPicture,
    RobotPicture,
    SensorPicture,
    Standing,
    State,
    StopPicture,
)
from woz_tui.console.profiles import Profiles
from woz_tui.console.reducers import reduce
from woz_tui.console.replay.standing import ReplayPicture, following
from woz_tui.console.robot.outlines import robots_of
from woz_tui.console.runs import Failure, Run, Runs
from woz_tui.console.sentences import Event, event_of, explained
from woz_tui.console.study.picture import Study
from woz_tui.core import messages as m
from woz_tui.core import requests as r
from woz_tui.core.robots import RobotOutline
from woz_tui.core.settings import Settings, StudySettings
from woz_tui.core.views import ActionView, PanelView
from woz_tui.core.wire import WireError, decode_message
from woz_tui.session.redactor import Perception, eyeless, kind_of

#: How long an action that is over still shows how it ended.
DONE_US, REFUSED_US, STOPPED_US = 1_500_000, 5_000_000, 3_000_000
#: Events kept for the list; the log on disk has them all.
EVENTS = 400
#: Events that may tell what the wizard was not to see, when that changes in the middle.
_TELLING = ("info", "forced", "heard")
_LINGER = {"done": DONE_US, "refused": REFUSED_US, "stopped": STOPPED_US, "waits": STOPPED_US}


@dataclass(slots=True)
class Picture:
    """Everything the console knows. Fields are for reading; `take` changes them."""

    title: str = ""
    #: What the robot process calls this console, and whether it plays or watches.
    console: str = ""
    role: str = ""
    log: str = ""
    welcomed: bool = False
    session: str = ""
    participant: str = ""
    #: Who took part in the session before, if the robot process was lost meanwhile.
    before: str = ""
    condition: str = ""
    trial: int | None = None
    ended: str = ""
    panels: tuple[PanelView, ...] = ()
    script: tuple[str, ...] = ()
    position: int = 0
    #: Driver -> the verbs it offers.
    verbs: dict[str, list[str]] = field(default_factory=dict)
    variables: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    keyboard: str = "us"
    settings: Settings = field(default_factory=Settings)
    profiles: Profiles = field(default_factory=Profiles)
    #: What the wizard does not get to see.
    perception: Perception = field(default_factory=Perception)
    study: Study = field(default_factory=Study)
    locks: dict[str, bool] = field(default_factory=dict)
    drivers: dict[str, DriverPicture] = field(default_factory=dict)
    sensors: dict[str, SensorPicture] = field(default_factory=dict)
    recorder: RecorderPicture = field(default_factory=RecorderPicture)
    stop: StopPicture | None = None
    engagement: m.EngagementChanged | None = None
    engaged: Engaged = field(default_factory=Engaged)
    modes: dict[str, str] = field(default_factory=dict)
    #: What drivers look like, and what was shown last, by driver.
    outlines: dict[str, Outline] = field(default_factory=dict)
    faces: dict[str, m.FaceShown] = field(default_factory=dict)
    bodies: dict[str, dict[str, m.Json]] = field(default_factory=dict)
    knobs: dict[str, KnobsPicture] = field(default_factory=dict)
    #: A robot's settings as it told them last, by driver.
    robots: dict[str, RobotPicture] = field(default_factory=dict)
    robot_outlines: dict[str, RobotOutline] = field(default_factory=dict)
    #: How the last commands ended, by command.
    ends: dict[str, m.End] = field(default_factory=dict)
    runs: Runs = field(default_factory=Runs)
    last_run: LastRun | None = None
    mistakes: set[str] = field(default_factory=set)
    events: deque[Event] = field(default_factory=lambda: deque(maxlen=EVENTS))
    notice: m.Notice | None = None
    dropped: int = 0
    lost: str = ""
    #: Raised whenever panels or script are new, so that keys and layout follow.
    edition: int = 0
    #: How a replay stands, and its places to go to; None in a session.
    replay: ReplayPicture | None = None
    #: How fast the session's time goes on: 1, or the speed of a replay, which may stand still.
    rate: float = 1.0
    _t: int = 0
    _local: int = 0

    # -- time -------------------------------------------------------------------------------

    def now(self, local_us: int) -> int:
        """The session's `t` at the local clock's `local_us`."""
        return self._t + round(max(0, local_us - self._local) * self.rate)

    def _heard(self, t: int, local_us: int) -> None:
        """Tie the clocks: forward at once, back only if they are far apart (a paused feed)."""
        behind = self.now(local_us) - t
        if behind < 0 or behind > STALE_US:
            self._t, self._local = t, local_us

    def _pulse(self, pulse: r.Pulse, local_us: int) -> None:
        if pulse.rate != self.rate:
            self._t, self._local, self.rate = pulse.t, local_us, pulse.rate
        self._heard(pulse.t, local_us)
        self.dropped = pulse.dropped

    # -- reducing ---------------------------------------------------------------------------

    def take(self, batch: Iterable[Incoming], local_us: int) -> None:
        """Work a batch in, oldest first; `local_us` is the local clock's time of arrival."""
        for message in batch:
            if isinstance(message, r.Welcome):
                self._welcome(message, local_us)
            elif isinstance(message, r.PanelsChanged):
                self._panels(message)
            elif isinstance(message, r.Pulse):
                self._pulse(message, local_us)
            elif isinstance(message, r.Replaying):
                self.replay = following(self.replay, message)
            elif isinstance(message, m.Message):
                if message.t >= 0 and not isinstance(message, m.Reading):
                    self._heard(message.t, local_us)
                self._message(message, tell=True)

    def lose(self, why: str) -> None:
        """The connection to the robot process is gone."""
        self.lost = why or "the connection closed"

    def _welcome(self, welcome: r.Welcome, local_us: int) -> None:
        """Begin anew; what the wizard has seen stays seen."""
        before = self.participant or self.before
        fresh = Picture(edition=self.edition, runs=Runs(seen=self.runs.seen), before=before)
        for name in self.__slots__:
            setattr(self, name, getattr(fresh, name))
        self._t, self._local = welcome.t, local_us
        self.welcomed = True
        self.console, self.role, self.log = welcome.console, welcome.role, welcome.log
        self.variables = tuple(welcome.variables)
        self.settings = welcome.settings
        self.outlines = outlines_of(self.settings.outlines)
        self.robot_outlines = robots_of(self.settings.outlines)
        self.profiles = _profiles(welcome.settings)
        self.drivers = {name: DriverPicture(name) for name in welcome.drivers}
        self._study(self.settings.study)
        self._plan(welcome)
        self._recall(welcome)
        self.study.read_tidings()  # old ones
        self.study.next = self.settings.study.trial  # of messages only the last of each is there

    def _recall(self, welcome: r.Welcome) -> None:
        """What holds and the last lines, each once and in their order: only these are listed."""
        lines = [(message, True) for message in _decoded(welcome.recent)]
        listed = {message.seq for message, _ in lines}
        held = _decoded(welcome.state)
        lines += [(each, False) for each in held if each.seq < 0 or each.seq not in listed]
        for message, tell in sorted(lines, key=lambda line: line[0].seq):
            self._message(message, tell)
        # A lock among the last lines may be from before the file was read again.
        self.locks = {each.panel: each.locked for each in held if isinstance(each, m.PanelLocked)}

    def _panels(self, changed: r.PanelsChanged) -> None:
        self.locks = {}
        before = self.settings
        if before.engagement and not changed.engagement:
            self.engaged = Engaged()  # the file has no such section any more
        self.settings = msgspec.structs.replace(
            before,
            values=changed.values,
            profiles=changed.profiles,
            profile=changed.profile,
            steps=changed.steps or before.steps,
            allows=changed.allows,
            engagement=changed.engagement,
            study=changed.study or before.study,
        )
        self.profiles = _profiles(changed)
        if changed.study is not None:
            self._study(changed.study)
        self._plan(changed)

    def _study(self, study: StudySettings) -> None:
        self._perceive(Perception.of(study))
        self.study.tell(study)

    def _perceive(self, perception: Perception) -> None:
        """Keep this from the wizard from now on, also what is on the screen already."""
        if perception == self.perception:
            return
        self.perception = perception
        kept = [name for name in self.sensors if perception.keeps(kind_of(name))]
        for name in kept:
            del self.sensors[name]
        self.engaged, self.engagement = Engaged(), None
        if perception.hides("face"):
            self.faces.clear()
            self.bodies.clear()
            for driver, robot in self.robots.items():
                values, wanted = eyeless(robot.values), eyeless(robot.wanted)
                self.robots[driver] = replace(robot, values=values, wanted=wanted)
        told = [event for event in self.events if event.mark not in _TELLING]
        self.events = deque(told, maxlen=EVENTS)

    def _plan(self, plan: r.Welcome | r.PanelsChanged) -> None:
        self.title = plan.title
        self.panels, self.script = tuple(plan.panels), tuple(plan.script)
        self.verbs = dict(plan.verbs)
        self.conditions = tuple(plan.conditions)
        self.keyboard = plan.keyboard
        self.position = min(self.position, len(self.script))
        self.edition += 1

    def _message(self, message: m.Message, tell: bool) -> None:
        if isinstance(message, m.PerceptionChanged):
            self._perceive(Perception(message.hidden, message.blurred))
        reduce(self, message)
        self.engaged.take(message)
        self.study.take(message)
        failure = self.runs.take(message)
        if tell:
            if failure is not None:
                self.runs.failures.append(failure)
            self._tell(message)

    def _tell(self, message: m.Message) -> None:
        """Put it on the list of events, or its outcome behind the event that began it."""
        outcome = self.runs.told(message)
        if outcome is not None:
            for event in reversed(self.events):
                if event.run == outcome.run:
                    event.end(outcome)
                    event.text = done_words(message) or event.text
                    return
        if isinstance(message, m.DriverLost | m.DriverConnecting):
            kept = [event for event in self.events if not explained(event, message, self)]
            self.events = deque(kept, maxlen=EVENTS)
        told = event_of(message, self)
        if told is not None and not (self.events and self.events[-1].again(told)):
            self.events.append(told)

    # -- reading ----------------------------------------------------------------------------

    @property
    def keeps(self) -> bool:
        """Whether anything is kept from the wizard."""
        return bool(self.perception or self.settings.study.blind)

    def moves(self, now: int) -> bool:
        """Whether a figure on the screen changes by itself."""
        return bool(self.runs.active) or (not self.lost and self.engaged.moves(now))

    def label(self, name: str) -> str:
        """The label of the action called `name`, or the name itself."""
        action = self.action(name)
        return action.label if action is not None else name

    def filled(self, words: str) -> str:
        """An utterance with the variables whose values the console knows."""
        values: dict[str, str | int] = {**self.settings.values}
        trial = "" if self.trial is None else self.trial
        now = {"participant": self.participant, "condition": self.condition, "trial": trial}
        values |= {name: value for name, value in now.items() if value != ""}
        if self.settings.study.blind:
            values.pop("condition", None)  # a label, and not what is said
        for name, value in values.items():
            if value not in ("", None):
                words = words.replace(f"{{{name}}}", str(value))
        return words

    def action(self, name: str) -> ActionView | None:
        """The action called `name`, or None."""
        for panel in self.panels:
            for action in panel.actions:
                if action.name == name:
                    return action
        return None

    def is_locked(self, panel: PanelView) -> bool:
        """Whether the panel takes no input at the moment."""
        return self.locks.get(panel.title, panel.locked)

    def standing(self, panel: PanelView, action: ActionView, now: int) -> Standing:
        """How an action stands at `now`."""
        current = self.runs.of(action.name)
        if current is not None:
            return _under_way(current, now)
        outcome = self.runs.outcomes.get(action.name)
        if outcome is not None and now - outcome.t <= _LINGER.get(outcome.how, 0):
            return Standing(State(outcome.how), note=outcome.reason)
        failure = self.runs.failure_of(action.name)
        if failure is not None:
            return Standing(State.FAILED, note=failure.reason)
        if action.locked or self.is_locked(panel):
            return Standing(State.LOCKED)
        missing = self.missing_driver(action)
        if missing:
            return Standing(State.UNREACHABLE, note=missing)
        return Standing(State.READY)

    def missing_driver(self, action: ActionView) -> str:
        """A driver this action needs and that is lost, or an empty string.

        A verb that several drivers offer counts as missing only if all of them are lost.
        """
        for verb in action.verbs:
            drivers = [name for name, verbs in self.verbs.items() if verb in verbs]
            lost = [name for name in drivers if self.health(name) == "lost"]
            if lost and len(lost) == len(drivers):
                return lost[0]
        return ""

    def health(self, driver: str) -> str:
        """A driver's health, `unknown` if it was never heard of."""
        known = self.drivers.get(driver)
        return known.health if known is not None else "unknown"

    def is_stale(self, sensor: SensorPicture, now: int) -> bool:
        """Whether a sensor's value should look old."""
        return bool(self.lost) or sensor.is_stale(now, self.health(sensor.driver))

    def unseen(self) -> list[Failure]:
        """Failures the wizard has not acknowledged, oldest first."""
        return self.runs.unseen()

    def see_failures(self) -> None:
        """The wizard has seen all failures there are."""
        self.runs.see_all()


def _under_way(run: Run, now: int) -> Standing:
    """How an action stands that has been played and is not over."""
    if (held := run.held_for(now)) is not None:
        return Standing(State.HELD, *held)
    left_us, share = run.timing(now)
    return Standing(State.RUNNING if run.running else State.QUEUED, left_us, share)


def _profiles(told: Settings | r.PanelsChanged) -> Profiles:
    return Profiles(told.profile, tuple(told.profiles), told.allows)


def _decoded(lines: Iterable[msgspec.Raw]) -> list[m.Message]:
    found: list[m.Message] = []
    for raw in lines:
        with contextlib.suppress(WireError):  # a newer host's message: not for this version
            found.append(decode_message(bytes(raw)))
    return found
