"""What the screen shows, as plain data: what holds in the session, and what only a screen needs.

Nothing here draws, waits or looks at a clock. All times are microseconds on the session's `t`
axis; `ConsoleState.now` turns a local clock into that axis, so that things can age between
messages. Messages may come in any order, twice or not at all: the state takes what it can from each
and never raises.
"""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import itemgetter

import msgspec

from woz_tui.config.screen_language import inner_text, say, word, worded
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.link.message_feed import Incoming, Loss
from woz_tui.console.state.command_text import spoken_text
from woz_tui.console.state.driver_outlines import Outline, outlines_of, robots_of
from woz_tui.console.state.engagement import EngagementView
from woz_tui.console.state.event_sentences import EventLine, end_word, event_line, explained
from woz_tui.console.state.replay import ReplayState, updated
from woz_tui.console.state.running_actions import RunningActions, RunOutcome
from woz_tui.console.state.stop_confirmation import short_names
from woz_tui.console.state.study import StudyView
from woz_tui.console.state.view_models import (
    STALE_US,
    ButtonState,
    ButtonView,
    DriverView,
    SensorView,
)
from woz_tui.console.state.wizard_overrides import toggled_text
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import GatedCall, PlayAction, RequestOrigin
from woz_tui.gate.table import why_not
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.action_messages import HANDS
from woz_tui.protocol.codec import WireError, decode_message
from woz_tui.protocol.markup import sentence
from woz_tui.protocol.panel_players import panel_players, part_names, verb_players
from woz_tui.protocol.panels import TYPED, TYPED_NAME, ActionView, PanelView, PhaseView
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.session.redactor import PerceptionFilter, Redactor
from woz_tui.timeline.episodes import LostDriverEpisode, keep_latest
from woz_tui.timeline.session_state import SessionState

#: That of a console that has heard nothing yet.
_NO_PLAN = m.SessionPlan(
    title="",
    panels=[],
    verbs={},
    variables=[],
    conditions=[],
    keyboard="us",
    drivers=[],
    settings=WelcomeSettings(),
)
#: How long an action that is over still shows how it ended.
DONE_US, REFUSED_US, STOPPED_US = 1_500_000, 5_000_000, 3_000_000
#: Events kept for the list; the log on disk has them all.
EVENTS, SECOND_US = 400, 1_000_000
#: Commands whose end is remembered: of those that a dialog waits for there are a few at a time.
ENDS = 64
#: Events that may tell what the wizard was not to see, when that changes in the middle.
_TELLING = ("info", "forced", "heard")
_LINGER = {"done": DONE_US, "sent": DONE_US, "refused": REFUSED_US} | dict.fromkeys(
    ("stopped", "replaced", "waits", "left_out"), STOPPED_US
)


def _no_events() -> deque[EventLine]:
    return deque(maxlen=EVENTS)


@dataclass(slots=True)
class ConsoleState:
    """Everything the console knows. Fields are for reading; `apply` changes them."""

    #: What holds, as far as the wizard may know it.
    session: SessionState = field(default_factory=SessionState)
    #: What the robot process calls this console, and whether it plays or watches.
    console: str = ""
    role: str = ""
    #: The part that it plays, or would if it played; empty: none in particular.
    part: str = ""
    log: str = ""
    welcomed: bool = False
    #: Who took part in the session before, if the robot process was lost meanwhile.
    before: str = ""
    #: What the wizard does not get to see.
    perception: PerceptionFilter = field(default_factory=PerceptionFilter)
    #: What drivers look like.
    outlines: dict[str, Outline] = field(default_factory=dict)
    robot_outlines: dict[str, RobotOutline] = field(default_factory=dict)
    #: What only a screen needs of study, engagement model and actions.
    study: StudyView = field(init=False)
    engaged: EngagementView = field(init=False)
    runs: RunningActions = field(init=False)
    #: How the last commands ended, by command.
    ends: dict[str, m.End] = field(default_factory=dict)
    events: deque[EventLine] = field(default_factory=_no_events)
    #: The last act of the wizard or of a program; once it is done, what is likely to follow.
    act: str = ""
    _then: tuple[str, ...] = ()
    lost: Loss | None = None
    #: Action -> its key, as a cap shows it.
    keys: Mapping[str, str] = field(default_factory=dict)
    #: The console's own keys by id, as caps show them.
    own_keys: Mapping[str, str] = field(default_factory=dict)
    #: Raised whenever panels are new, so that keys and layout follow.
    edition: int = 0
    #: How a replay stands, and its places to go to; None in a session.
    replay: ReplayState | None = None
    #: How fast the session's time goes on: 1, or the speed of a replay, which may stand still.
    rate: float = 1.0
    _t: int = 0
    _local: int = 0

    def __post_init__(self) -> None:
        session = self.session
        self.study, self.engaged, self.runs = (
            StudyView(session),
            EngagementView(session),
            RunningActions(session),
        )

    # -- what holds -------------------------------------------------------------------------

    @property
    def plan(self) -> m.SessionPlan:
        """What the experiment offers; nothing before the robot process has told."""
        return self.session.plan or _NO_PLAN

    @property
    def panels(self) -> list[PanelView]:
        """All of the experiment's."""
        return self.plan.panels

    @property
    def verbs(self) -> dict[str, list[str]]:
        """Driver -> the verbs it offers."""
        return self.plan.verbs

    @property
    def settings(self) -> WelcomeSettings:
        return self.plan.settings

    @property
    def line(self) -> str:
        """What stands between this console and its terminal: tmux, screen or mosh, or nothing."""
        attached = self.session.consoles.get(self.console)
        return attached.line if attached is not None else ""

    @property
    def ended(self) -> str:
        """Why the session has ended; empty: it goes on."""
        end = self.session.end
        if end is None:
            return ""
        return end_word(end.reason) or say("engagement.ended", "ended")

    @property
    def phase(self) -> PhaseView | None:
        """The phase that holds, as the file has it."""
        stage = self.session.study.stage
        phases = self.settings.phases if stage is not None else ()
        return next((each for each in phases if stage and each.name == stage.name), None)

    @property
    def front(self) -> Sequence[PanelView]:
        """The panels in front: without those that only other phases have there."""
        phase = self.phase
        if phase is None or not phase.panels:
            return self.panels
        others = {title for each in self.settings.phases for title in each.panels}
        others -= {*phase.panels}
        return [panel for panel in self.panels if panel.title not in others]

    @property
    def drivers(self) -> dict[str, DriverView]:
        """Those of the robot file, and whoever else was heard of."""
        views = {name: DriverView(name) for name in self.plan.drivers}
        for name, driver in self.session.drivers.items():
            health = driver.health
            views[name] = DriverView(
                name, driver.state, health.detail, health.remedy, driver.since.t
            )
        return views

    @property
    def short_names(self) -> dict[str, str]:
        """Driver -> what the screen calls it where room is short."""
        return short_names(self.drivers)

    @property
    def sensors(self) -> list[str]:
        """Names of those that have given a reading, or of which a state is known."""
        return sorted({*self.session.readings, *self.session.sensors})

    def sensor(self, name: str) -> SensorView | None:
        """The sensor of this name, if it was heard of."""
        session = self.session
        reading, changed = session.readings.get(name), session.sensors.get(name)
        state = session.sensor_state(name) if changed is not None else ""
        if reading is None:
            return SensorView(name, changed.t, state=state) if changed is not None else None
        known = (reading.t, reading.value, reading.text, reading.unit, reading.driver)
        every = round(changed.every_s * 1_000_000) if changed is not None else 0
        return SensorView(name, *known, state, every)

    # -- time -------------------------------------------------------------------------------

    def now(self, local_us: int) -> int:
        """The session's `t` at the local clock's `local_us`."""
        return self._t + round(max(0, local_us - self._local) * self.rate)

    def _tie_clocks(self, t: int, local_us: int) -> None:
        """Tie the clocks: forward at once, back only if they are far apart (a paused feed)."""
        behind = self.now(local_us) - t
        if behind < 0 or behind > STALE_US:
            self._t, self._local = t, local_us

    # -- reducing ---------------------------------------------------------------------------

    def apply(self, batch: Iterable[Incoming], local_us: int) -> None:
        """Work a batch in, oldest first; `local_us` is the local clock's time of arrival."""
        for message in batch:
            match message:
                case r.Welcome():
                    self._welcome(message, local_us)
                case r.PanelsChanged():
                    self._panels(message)
                case r.Pulse(t=t, rate=rate):
                    if rate != self.rate:
                        self._t, self._local, self.rate = t, local_us, rate
                    self._tie_clocks(t, local_us)
                case r.Replaying():
                    self.replay = updated(self.replay, message)
                case m.Message():
                    if message.t >= 0 and not isinstance(message, m.Reading):
                        self._tie_clocks(message.t, local_us)
                    self._message(message, tell=True)

    def lose(self, loss: Loss) -> None:
        """The connection to the robot process is gone."""
        self.lost = loss

    def _welcome(self, welcome: r.Welcome, local_us: int) -> None:
        """Begin anew; what the wizard has seen of this session stays seen."""
        session, seen, notes = self.session, self.runs.seen, self.study.notes
        fresh = ConsoleState(edition=self.edition, before=session.study.participant or self.before)
        for name in self.__slots__:
            setattr(self, name, getattr(fresh, name))
        self._t, self._local = welcome.t, local_us
        self.welcomed = True
        self.console, self.role, self.log = welcome.console, welcome.role, welcome.log
        self.runs.console = self.console
        settings = welcome.settings
        self.outlines = outlines_of(settings.outlines)
        self.robot_outlines = robots_of(settings.outlines)
        self.perception = PerceptionFilter.of(settings.study)
        self._plan(welcome, settings, welcome.variables, welcome.drivers)
        self._recall(welcome)
        if self.session.start == session.start:  # else the numbers of runs have begun anew
            self.runs.seen = seen
            self.study.notes.keep(notes)
        self.role, self.part = welcome.role, welcome.part  # whatever old lines say of it
        self.study.read_news()  # old ones

    def _recall(self, welcome: r.Welcome) -> None:
        """What holds and the last lines, each once and in their order: only these are listed."""
        held, recent = _decoded(welcome.state), _decoded(welcome.recent)
        listed = {message.seq for message in recent if message.seq >= 0}
        lines = [(each.seq, each, each.seq in listed) for each in held]
        known = {each.seq for each in held}
        place = -1
        for each in recent:  # a code of a replay has no number: it comes behind the line before it
            place = each.seq if each.seq >= 0 else place
            if each.seq < 0 or each.seq not in known:
                lines.append((place, each, True))
        for _, message, tell in sorted(lines, key=itemgetter(0)):
            self._message(message, tell)
        # The last lines begin in the middle, so what holds is what the robot process says.
        self._go_by(held)
        self.study.follow()

    def _go_by(
        self,
        lines: Iterable[m.Message],
        see: Callable[[m.Message], m.Message | None] | None = None,
    ) -> None:
        """Begin anew with what `lines` say that holds, each as `see` gives it; which steps of an
        action are over, they do not say.
        """
        session, fresh = self.session, SessionState()
        if session.plan is not None:
            fresh.apply(session.plan)
        for line in lines:
            seen = line if see is None else see(line)
            if seen is not None and not isinstance(line, m.SessionPlan):
                fresh.apply(seen)
        fresh.t, fresh.actions, fresh.commands = session.t, session.actions, session.commands
        session.become(fresh)

    def _panels(self, changed: r.PanelsChanged) -> None:
        before = self.settings
        if before.engagement and not changed.engagement:
            self.engaged.forget()  # the file has no such section any more
        news = {name: getattr(changed, name) for name in r.PANEL_SETTINGS}
        news = {name: value for name, value in news.items() if value is not None}
        settings = msgspec.structs.replace(before, **news)
        if settings.study.blind and not before.study.blind:
            self._go_by(self.session.messages(), Redactor(settings.study).message)
            self._unsay()
            if (given := self.session.study.assigned) is not None:
                order = [*settings.study.assigned]  # by its labels
                self.session.study.assigned = msgspec.structs.replace(given, order=order)
        self._perceive(PerceptionFilter.of(settings.study))
        plan = self.plan
        variables = plan.variables if changed.variables is None else changed.variables
        self._plan(changed, settings, variables, plan.drivers)

    def _perceive(self, perception: PerceptionFilter) -> None:
        """Keep this from the wizard from now on, also what is on the screen already."""
        if perception == self.perception:
            return
        self.perception = perception
        redactor = Redactor()
        redactor.perception = perception
        self._go_by(self.session.messages(), redactor.message)
        self.engaged.forget()
        told = [event for event in self.events if event.mark not in _TELLING]
        self.events = deque(told, maxlen=EVENTS)
        self._unsay()

    def _unsay(self) -> None:
        """Take what was said from the list of events: it may tell what is kept from now on."""
        for event in self.events:
            event.utterance = ""

    def _plan(
        self,
        plan: r.Welcome | r.PanelsChanged,
        settings: WelcomeSettings,
        variables: list[str],
        drivers: list[str],
    ) -> None:
        self.edition += 1
        settings = msgspec.structs.replace(settings, repairs=[*map(_worded, settings.repairs)])
        shown = m.SessionPlan(
            title=plan.title,
            panels=plan.panels,
            verbs=plan.verbs,
            variables=variables,
            conditions=plan.conditions,
            keyboard=plan.keyboard,
            drivers=drivers,
            settings=settings,
            script=plan.script,
        )
        self.session.apply(shown)

    def _message(self, message: m.Message, tell: bool) -> None:
        if isinstance(message, m.SessionPlan):
            return  # the console is told of it otherwise
        if isinstance(message, m.PerceptionChanged):
            self._perceive(PerceptionFilter(message.hidden, message.blurred))
        if isinstance(message, m.Reading):  # hundreds a second, of which only the last are shown
            self.session.apply(message)
            if message.text:
                self.engaged.apply(message)
            return
        recorder = self.session.recorder
        lost = (
            self.session.lost.get(message.driver)
            if isinstance(message, m.DriverConnected)
            else None
        )
        outcome = self.runs.apply(self.session.apply(message))
        self.engaged.apply(message)
        self.study.apply(message)
        self._follow_up(message)
        match message:
            case m.End():
                keep_latest(self.ends, message.command, message, ENDS)
            case m.ActionRequested(run=run, action=name) if self.session.filled is not None:
                self.runs.expect(run, self.sentence(name))
            case m.Mistake():
                for event in self.events:
                    event.mistake = event.mistake or event.run == message.run != ""
            case m.ConsoleLost(console=self.console):
                self.role = "watcher"  # a console that gets the news of its own loss lives on
            case m.ConsoleAttached(console=self.console):
                self.role, self.part = message.role, message.part  # it has taken over
            case m.RecorderState() if recorder is not None:
                # Only how far it lags is different: no news.
                tell = tell and (message.level, message.detail) != (
                    recorder.level,
                    recorder.detail,
                )
        if tell:
            self._add_event(message, outcome, lost)
        if isinstance(message, m.Command):  # what is said stands behind the event that began it
            run = message.run or message.command
            begun = next((event for event in reversed(self.events) if event.run == run), None)
            if begun is not None:
                if message.run:
                    begun.say(spoken_text(message))
                begun.untimed = begun.untimed or self._untold(message)

    def _follow_up(self, message: m.Message) -> None:
        """What an action brings within reach, from its end to the next act."""
        match message:
            case m.ActionRequested() | m.Command() if message.console in self.others:
                pass  # another wizard's
            case m.ActionRequested(run=run, source=source) if source in HANDS:
                self.act, self._then = run, ()
            case m.Command(run="", passing=False, source=source) if source in HANDS:
                self.act, self._then = message.command, ()
            case m.StopPressed(scope="all") | m.TrialStarted() | m.TrialEnded():
                self.act, self._then = "", ()
            case m.ActionDone(run=self.act, action=name) if self.act:
                action = self.action(name)
                self._then = tuple(action.then) if action is not None else ()

    def _add_event(
        self,
        message: m.Message,
        outcome: RunOutcome | None,
        lost: LostDriverEpisode | None,
    ) -> None:
        """Put it on the list of events, or its outcome behind the event that began it. `lost`: how
        the driver had been lost that is connected now.
        """
        if outcome is not None:
            for event in reversed(self.events):
                if event.run == outcome.run:
                    event.end(outcome)
                    event.text = toggled_text(message) or event.text
                    return
        if isinstance(message, m.DriverLost | m.DriverConnecting):
            kept = [event for event in self.events if not explained(event, message, self)]
            self.events = deque(kept, maxlen=EVENTS)
        told = event_line(message, self)
        if told is None or (self.events and self.events[-1].again(told)):
            return
        if outcome is not None:  # its beginning was not on the list
            told.t = outcome.begin
            told.end(outcome)
        if lost is not None:  # as important as the loss, which stands on the list
            told.machine = False
            away = seconds(message.t - lost.begin)
            told.detail = say(
                "events.back_after", "after {time}, {why}", time=away, why=told.detail
            )
        if told.model:  # one line says where the model is: the last one
            kept = [event for event in self.events if not event.model]
            self.events = deque(kept, maxlen=EVENTS)
        at = len(self.events)
        # A line that comes late has its place in time, of which the list shows whole seconds.
        while at and self.events[at - 1].t // SECOND_US > told.t // SECOND_US:
            at -= 1
        if len(self.events) == EVENTS:
            self.events.popleft()
            at -= 1
        if at >= 0:  # else it is older than all that are kept
            self.events.insert(at, told)

    # -- reading ----------------------------------------------------------------------------

    def untimed(self, action: str) -> bool:
        """Whether something an action does is kept from the wizard: then its length is, too."""
        return self.keeps and any(map(self._untold, self.calls(action)))

    def _untold(self, command: m.Command | m.FilledCall) -> bool:
        blind = bool(self.settings.study.blind)
        return (blind and "condition" in command.tells) or self.perception.keeps(*command.tells)

    @property
    def keeps(self) -> bool:
        """Whether anything is kept from the wizard."""
        return bool(self.perception or self.settings.study.blind)

    @property
    def unrecorded(self) -> bool:
        """Whether actions are refused because no folder takes the log."""
        recorder = self.session.recorder
        return recorder is not None and recorder.level == "failed" and not recorder.waived

    @property
    def nobody_plays(self) -> bool:
        """Whether this console watches and no other one plays the robot, or this one's part."""
        watches = self.role == "watcher" and not self.lost and not self.ended
        parts = self.session.wizards.values()
        vacant = bool(self.part) and self.part not in parts
        return watches and (vacant or not parts)

    @property
    def then(self) -> tuple[str, ...]:
        """Names of the actions that are likely to follow the last one, of those that may be played
        now.
        """
        there = {name: self.action(name) for name in self._then}
        return tuple(name for name, view in there.items() if view is not None and not view.locked)

    def moves(self, now: int) -> bool:
        """Whether a figure on the screen changes by itself."""
        under_way = self.session.actions or self.session.commands
        return bool(under_way) or (not self.lost and self.engaged.moves(now))

    def event_of(self, run: str) -> EventLine | None:
        """The line of a run or a command, as long as the list has it."""
        return next((event for event in reversed(self.events) if event.run == run != ""), None)

    def label(self, name: str) -> str:
        """The label of the action called `name`, or the name itself."""
        action = self.action(name)
        return action.label if action is not None else name

    def title(self, panel: PanelView) -> str:
        """What the screen calls a panel."""
        typed = all(each.name.startswith(TYPED_NAME) for each in panel.actions)
        return say("panels.typed", "Typed") if panel.title == TYPED and typed else panel.title

    def heading(self, phase: str) -> str:
        """What the screen calls a phase."""
        return next((each.heading for each in self.settings.phases if each.name == phase), phase)

    def steps(self, name: str) -> Sequence[Sequence[m.FilledCall] | float]:
        """What the action called `name` would do if it were played now, as far as the wizard may
        know it; nothing where no log line says so.
        """
        filled = self.session.filled
        return filled.actions.get(name, ()) if filled is not None else ()

    def calls(self, name: str) -> list[m.FilledCall]:
        """The verbs of its steps, without the pauses."""
        steps = self.steps(name)
        return [call for step in steps if not isinstance(step, float | int) for call in step]

    @property
    def home_action(self) -> str:
        """The action that does nothing but take the home pose; empty: there is none."""
        actions = (action for panel in self.panels for action in panel.actions)
        return next((each.name for each in actions if each.verbs == ["home"]), "")

    def sentence(self, name: str) -> str:
        """What the action called `name` would say now; empty: nothing."""
        if not self.steps(name) and (action := self.action(name)) is not None:
            return " ".join(sentence(self.filled(words)) for words in action.utterances)
        return " ".join(filter(None, dict.fromkeys(map(spoken_text, self.calls(name)))))

    def words_on(self, name: str, standing: ButtonView) -> str:
        """What the run of an action says of which its button tells how it stands; where it tells of
        none, what the action would say now.
        """
        run, over = self.runs.of(name), self.runs.outcomes.get(name)
        said = ""
        if run is not None:
            said = self.runs.utterance(run.id)
        elif over is not None and standing.of_run:
            said = over.utterance
        return said or self.sentence(name)

    def filled(self, words: str) -> str:
        """An utterance with the variables whose values the console knows; of a robot process, or a
        log, that does not say itself what actions would do.
        """
        values: dict[str, str | int] = {**self.settings.values}
        study = self.session.study
        trial = "" if study.number is None else study.number
        now = {"participant": study.participant, "condition": study.condition, "trial": trial}
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
        return next((action for action in self.settings.beside_panels if action.name == name), None)

    def is_locked(self, panel: PanelView) -> bool:
        """Whether the panel takes no input at the moment."""
        changed = self.session.locks.get(panel.title)
        return panel.locked if changed is None else changed.locked

    @property
    def others(self) -> dict[str, str]:
        """The other consoles that play the robot, where several do, each with its part."""
        return self.session.other_wizards(self.console)

    def played_by(self, panel: PanelView) -> str:
        """Who plays a panel, where several wizards play and this one does not play it."""
        wizards = self.session.wizards
        if len(wizards) < 2:
            return ""
        found = panel_players(panel, self.panels, wizards)
        return "" if self.console in found else part_names(found, wizards)

    @property
    def own_verbs(self) -> Mapping[str, Sequence[str]]:
        """Driver -> its verbs, without those that another wizard plays on this driver and this one
        on another.
        """
        wizards = self.session.wizards
        if self.role != "wizard" or len(wizards) < 2:
            return self.verbs
        own = {
            driver: [
                verb
                for verb in verbs
                if self.console in verb_players(verb, self.panels, wizards, driver)
            ]
            for driver, verbs in self.verbs.items()
        }
        found = {verb for verbs in own.values() for verb in verbs}
        return {
            driver: [verb for verb in verbs if verb in own[driver] or verb not in found]
            for driver, verbs in self.verbs.items()
        }

    def is_of_others(self, panel: PanelView) -> bool:
        """Whether this wizard's keys of the panel are refused, because another one plays it."""
        return self.role == "wizard" and self.played_by(panel) != ""

    def why_not(self, panel: PanelView, action: ActionView) -> Refusal | None:
        """Why the gate would not let an action be played, as far as this console knows; the status
        line says that of a stop, and of a log that nobody takes.
        """
        wizards = self.session.wizards
        facts = Facts(
            panels=self.panels,
            locked={panel.title: self.is_locked(panel)},
            wizards=wizards if self.role == "wizard" and len(wizards) > 1 else {},
        )
        button = _Button(action.label, panel.title, action.locked)
        origin = RequestOrigin("key", "", self.console)
        return why_not(facts, PlayAction(action.name, button, origin))

    def button_view(self, panel: PanelView, action: ActionView, now: int) -> ButtonView:
        """How an action stands at `now`."""
        current = self.runs.of(action.name)
        if current is not None:
            if (held := current.held_for(now)) is not None:
                return ButtonView(ButtonState.HELD, *held)
            timing = (None, None) if self.untimed(action.name) else current.timing(now)
            return ButtonView(
                ButtonState.RUNNING if current.running else ButtonState.QUEUED, *timing
            )
        outcome = self.runs.outcomes.get(action.name)
        if outcome is not None and now - outcome.t <= _LINGER.get(outcome.how, 0):
            return ButtonView(ButtonState(outcome.how), note=outcome.reason)
        failure = self.runs.failure_of(action.name)
        if failure is not None:
            return ButtonView(ButtonState.FAILED, note=failure.reason)
        if (refusal := self.why_not(panel, action)) is not None:
            return ButtonView(ButtonState.LOCKED, note=word(refusal.reason))
        missing = self.missing_driver(action)
        if missing:
            return ButtonView(ButtonState.UNREACHABLE, note=missing)
        return ButtonView(ButtonState.READY)

    def missing_driver(self, action: ActionView) -> str:
        """A driver this action needs and that is lost, or cannot do its verb now (a servo without
        torque); empty: none.

        A verb that several drivers offer counts as missing only if none of them can.
        """
        for verb in action.verbs:
            drivers = [name for name, verbs in self.verbs.items() if verb in verbs]
            lost = []
            for name in drivers:
                told = self.session.unable.get(name)
                if self.health(name) == "lost" or (told is not None and verb in told.unable):
                    lost.append(name)
            if lost and len(lost) == len(drivers):
                return lost[0]
        return ""

    def health(self, driver: str) -> str:
        """A driver's health, `unknown` if it was never heard of."""
        known = self.session.drivers.get(driver)
        return known.state if known is not None else "unknown"

    def is_stale(self, sensor: SensorView, now: int) -> bool:
        """Whether a sensor's value should look old."""
        return bool(self.lost) or sensor.is_stale(now, self.health(sensor.driver))


@dataclass(frozen=True, slots=True)
class _Button:
    """An action, as the gate wants to know it. What a profile does not allow is locked here."""

    label: str
    panel: str
    locked: bool
    calls: Sequence[GatedCall] = ()


def _worded(action: ActionView) -> ActionView:
    """An action whose label stands in no file, in the language of the screen."""
    if not action.code:
        return action
    label = inner_text({"code": action.code, "text": action.label})
    return msgspec.structs.replace(action, label=str(label))


def _decoded(lines: Iterable[msgspec.Raw]) -> list[m.Message]:
    found: list[m.Message] = []
    for raw in lines:
        with contextlib.suppress(WireError):  # a newer host's message: not for this version
            found.append(worded(decode_message(bytes(raw))))
    return found
