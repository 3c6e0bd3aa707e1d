"""A session: experiment, drivers, bus, hub and recorder, and every request to them.

Used from one thread, the robot process's event loop. Nothing here waits for hardware or disk.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import msgspec

from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.experiment import Action, Call, Experiment
from woz_tui.config.keys.keymap import actions_on
from woz_tui.config.performers import ENGAGEMENT, SESSION, performers
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Ask, Driver, HandInput, Performer, RejectedError
from woz_tui.drivers.feeds import Feeds
from woz_tui.drivers.own_voice import ROBOT_SPEECH
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayAction, ReleaseStop, RequestOrigin, SendOwnVerb, SendVerb
from woz_tui.gate.table import features_judge_commands, why_not
from woz_tui.log.file_names import media_folder
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import OF_CONSOLES, is_by_hand
from woz_tui.protocol.description import Prediction
from woz_tui.protocol.refusal import Refusal, RequestError
from woz_tui.protocol.requesters import WIZARD
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_runner import ActionRunner, LastAct
from woz_tui.session.action_texts import (
    NOTHING_GIVEN,
    ActionTexts,
    ComposedCall,
    GivenValues,
    missing_value_error,
    utterances,
)
from woz_tui.session.driver_context import OnCompletion
from woz_tui.session.driver_faults import DriverFaults
from woz_tui.session.driver_manager import DriverManager, make_drivers, motionless
from woz_tui.session.engagement_control import EngagementController
from woz_tui.session.engagement_robot import EngagementRobot
from woz_tui.session.face_moods import FaceMoods
from woz_tui.session.participant_identity import SessionIdentity, check_not_withdrawn
from woz_tui.session.prediction import Forecaster, Kept, predicted
from woz_tui.session.recent_messages import RecentMessages, unlisted
from woz_tui.session.session_driver import VERBS, SessionPerformer
from woz_tui.session.session_features import SessionFeatures
from woz_tui.session.session_plan import study_settings
from woz_tui.session.session_start import publish_perception, publish_reload, publish_start
from woz_tui.session.typed_actions import with_sentence, with_typed
from woz_tui.session.variables import MissingValueError, VariableValues, with_condition
from woz_tui.session.verb_description import describe
from woz_tui.system.clock import Clock, Standstill, timestamp
from woz_tui.timeline import episodes as e
from woz_tui.timeline.feature_history import Owed
from woz_tui.timeline.session_state import SessionState

#: Seconds between two lines that tie the session's clock to the calendar.
CLOCK_TIE_S = 30.0
log = logging.getLogger(__name__)

#: A stamp that says that a stop is older is taken for a mistake, in microseconds.
OLDEST_STOP_US = 60_000_000
#: Seconds between two checkpoints of the log.
CHECKPOINT_S = 10.0


@dataclass
class Session:
    """One session.

    Args:
        experiment: What the file says.
        catalogue: Driver classes by type.
        identity: Codes of session, participant, condition and wizard.
        recorder: Takes every line first.
        clock: Time.
        withdrawn: Codes of participants who withdrew: nobody gets them again.
    """

    experiment: Experiment
    catalogue: Mapping[str, type[Driver]]
    identity: SessionIdentity
    recorder: Recorder
    clock: Clock
    withdrawn: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        self.feeds = Feeds()
        self.locked: dict[str, bool] = {}
        self.ended = False
        #: Sentences that were typed, as actions.
        self.typed: tuple[Action, ...] = ()
        #: Those of them that stand in a copy of the file, and which.
        self.saved_sentences: tuple[tuple[Action, ...], str] = ((), "")
        #: Called when consoles are to be shown other panels.
        self.on_panels: Callable[[], None] = lambda: None
        #: What the reason of the end tells (see `messages.RestrictedMessage`).
        self.end_tells: tuple[str, ...] = ()
        self._loop = asyncio.get_running_loop()
        #: Tells how old a request without a time stamp may be.
        self.standstill = Standstill(self.clock)
        self.hub = Hub(self.clock, self.recorder.record)
        self.state, self.recent = SessionState(), RecentMessages()
        #: Who follows what goes on in the session, by kind of episode.
        self._following: dict[type[e.Episode], tuple[Callable[[Any], object], ...]] = {}
        self.hub.listen(self._on_message)  # before all others: they find the state as of now
        self.hub.listen(self.recent.add, but=unlisted())
        publish_start(self.hub, self.identity, self.experiment, self.clock, self.recorder.spill)
        robot, folder = EngagementRobot(self), self.recorder.folder
        self.engagement = EngagementController(robot, self.state, self.locked, folder)
        self.state.study.settings = study_settings(self.experiment)
        self.faults = DriverFaults(self.hub, self.clock)
        self.drivers = make_drivers(
            self.experiment,
            self.catalogue,
            self.hub,
            self.clock,
            feeds=self.feeds,
            faults=self.faults,
            on_request=self._driver_request,
            media=lambda: media_folder(self.recorder.path),
        )
        self.locked |= {panel.title: True for panel in self.experiment.panels if panel.locked}
        performers: dict[str, Performer] = {
            **self.drivers,
            ENGAGEMENT: self.engagement,
            SESSION: SessionPerformer(self),
        }
        moods = FaceMoods(self.identity.seed)
        self.bus = Bus(
            self.hub,
            performers,
            {
                **{spec.name: spec.offer.verbs for spec in self.experiment.drivers},
                SESSION: VERBS,
                ENGAGEMENT: self.engagement.offered,
            },
            motionless=motionless(self.experiment, self.catalogue),
            unstopped=frozenset({ENGAGEMENT}),
            unrecorded=self.recorder.refusal,
            folder=self.experiment.path.parent,
            completed=moods.completed,
        )
        self.feeds.put_everywhere(ROBOT_SPEECH, self.state.said)
        self._driver_manager = DriverManager(self.drivers, self.hub, self.bus.disconnected)
        self.texts = ActionTexts(
            self.hub,
            self.identity.seed,
            lambda: self.experiment,
            self.values,
            self._calls_in,
        )
        self.features = SessionFeatures(self)
        if features_judge_commands():
            self.bus.features = self.features
        for name, performer in self.features.performing.items():
            self.bus.add(name, performer, performer.verbs)
        if any(verb.by_mood for verbs in self.bus.verbs.values() for verb in verbs.values()):
            moods.listen(self.hub)
        deadline = self.experiment.session.deadline
        self.runner = ActionRunner(self.hub, self.bus, self.texts, deadline, self.features)
        self.last_act = LastAct(self.state, self.bus, self.runner)
        self.hub.listen(self.last_act.on_dispatched, m.Dispatched)
        #: The last command of each control of a panel, by driver and control.
        self._held: dict[tuple[str, str], str] = {}
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._checkpointed = 0

    # -- beginning and ending ----------------------------------------------------------------

    async def open(self) -> None:
        """Let every driver look for its hardware; none of them can fail the session."""
        self.faults.begin(self.drivers)
        self.engagement.begin()
        perception = self.experiment.study.perception
        if perception.hide or perception.blur:
            publish_perception(self.hub, self.experiment)
        self.features.begin()
        await self._driver_manager.open()
        self.texts.publish_all()
        self._tie_clock()
        self._check_standstill()
        self._checkpoint()
        self._prepare()

    def _prepare(self) -> None:
        self._driver_manager.prepare(utterances(self.experiment, self.values(), self._calls_in))

    async def close(self, reason: str, rest: bool = True) -> None:
        """Rest, close the drivers, finish the log. Bounded in time; never raises."""
        if self.ended:
            return
        self.ended = True
        for timer in self._timers.values():
            timer.cancel()
        self.features.close()
        self.runner.stop_waiting(Sentence("session.ends", "the session ends"))
        await self.bus.drain(1.0)
        if rest and not self.bus.latched:
            await self._driver_manager.rest()
        await self._driver_manager.close()
        await self.engagement.finish()
        self.faults.end()
        await self.bus.settled()  # nothing may come between this and the last line
        digest, _ = self.recorder.digest()
        self.hub.publish(m.SessionEnd(reason=reason, sha256=digest, tells=self.end_tells))
        self.recorder.close()

    def recorder_moved(self, state: m.RecorderState) -> None:
        """The recorder's state changed; may be called from its thread."""
        with contextlib.suppress(RuntimeError):  # the loop has closed: the session is over
            self._loop.call_soon_threadsafe(self._publish_recorder, state)

    def _publish_recorder(self, state: m.RecorderState) -> None:
        if not self.ended:
            self.hub.publish(state)

    def _tie_clock(self) -> None:
        self.hub.publish(m.ClockTie(wall=timestamp(self.clock.wall())))
        self._timers["clock"] = self._loop.call_later(CLOCK_TIE_S, self._tie_clock)

    def _check_standstill(self) -> None:
        self.standstill.age_us()
        self._timers["look"] = self._loop.call_later(Standstill.EVERY_S, self._check_standstill)

    def _checkpoint(self) -> None:
        digest, lines = self.recorder.digest()
        if lines > self._checkpointed:
            self.hub.publish(m.Checkpoint(sha256=digest, lines=lines))
            self._checkpointed = lines + 1
        self._timers["checkpoint"] = self._loop.call_later(CHECKPOINT_S, self._checkpoint)

    # -- actions -----------------------------------------------------------------------------

    @property
    def logs(self) -> tuple[Path, Path]:
        """The folders with the logs of earlier sessions and with that of this one."""
        return self.recorder.folder, self.recorder.path.parent

    def own_values(self) -> VariableValues:
        """The variables' present values, without those that features bring along."""
        own = {**self.experiment.variables, **self.identity.values(), **self.engagement.values()}
        return with_condition(own, self.experiment.by_condition, self.identity.condition)

    def values(self) -> VariableValues:
        return self.features.values(self.own_values())

    def values_changed(self) -> None:
        """Variables of a feature have other values than before."""
        if not self.ended:
            self.texts.publish_changed()
            self._prepare()

    def idle_changed(self) -> None:
        """A feature is idle now, or is not any more, although no file was read."""
        self.features.look_for_idle()

    def play(
        self,
        name: str,
        origin: RequestOrigin,
        when_busy: str = "",
        stale: str = "",
        at: int = 0,
        *,
        text: str = "",
        tells: tuple[str, ...] = (),
        given: GivenValues = NOTHING_GIVEN,
    ) -> str:
        """Play the action `name`; its run id. Raises `RequestError`; the refusal is in the log too.

        `stale`: why the press is too old to be played (empty: it is not). `at`: when it is to
        begin, on the axis of `t`; 0: now. `text` is said in place of its first sentence, and tells
        `tells`. `given`: values of variables that came with the request.
        """
        if given.values:
            given = self.features.check_given(name, given)
        action = self.experiment.action(name)
        beside = action in self.experiment.beside_panels
        question = PlayAction(
            name, action, origin, stale, at, beside, given=given.values, text=text
        )
        if action and origin.source == "key" and origin.key and not (when_busy or action.when_busy):
            question = replace(question, under_way=self._under_way(action))
        if (refusal := why_not(self.facts(), question)) is not None:
            if refusal.code == "busy":  # a held key is no press
                raise RequestError.of(refusal)
            panel = action.panel if action else ""
            self.runner.refuse(name, panel, origin, refusal.reason)
            self.features.after_play()
            if refusal.code == "stale":
                raise RequestError(
                    Sentence(
                        "session.not_played",
                        "{name!r} not played ({stale})",
                        name=name,
                        stale=stale,
                    ),
                    refusal.remedy,
                )
            raise RequestError.of(refusal)
        assert action is not None
        if not action.steps and beside:
            return self.features.play(action, origin, when_busy, at)
        again = partial(self._why_no_action, name, origin, given.values, text)
        if text:
            action = self.texts.edited(action, text, tells)
        run, refused = self.runner.play(
            action, origin, when_busy, at=at, again=again, edited=bool(text), given=given
        )
        self.features.after_play()
        if refused is not None:
            raise refused
        return run

    def _under_way(self, action: Action) -> Literal["", "waits", "is running"]:
        """Whether an action waits or is running. What drives, or only streams, goes on with every
        press, and what goes in short steps takes each.
        """
        known = [self.bus.verb(call.driver, call.verb) for call in action.calls]
        verbs = [verb for verb in known if verb is not None]
        if any(verb.drives for verb in verbs) or all(verb.stream or verb.brief for verb in verbs):
            return ""
        if (found := self.runner.under_way(action.name)) is None:
            return ""
        return "waits" if found[1] else "is running"

    def _why_no_action(
        self, name: str, origin: RequestOrigin, given: Collection[str], text: str
    ) -> Refusal | None:
        """Why this hand may not play it at the moment; None: it may."""
        action = self.experiment.action(name)
        beside = action in self.experiment.beside_panels
        question = PlayAction(name, action, origin, beside_panels=beside, given=given, text=text)
        return why_not(self.facts(), question)

    def facts(self) -> Facts:
        """What holds now, for the gate."""
        return Facts(
            now=self.hub.now(),
            ended=self.ended,
            stopped=self.bus.latched,
            unconfirmed=self.bus.unconfirmed if self.bus.latched else (),
            unrecorded=self.recorder.refusal(),
            panels=self.experiment.panels,
            locked=self.locked,
            wizards=self.state.wizards,
            helpers=self._helpers(),
            scheduled=len(self.runner.scheduled),
            features=self.features.facts(),
            failed=self.features.failed,
        )

    def send(
        self,
        verb: str,
        args: Mapping[str, m.Json],
        on: str,
        origin: RequestOrigin,
        *,
        when_busy: str = "",
        stale: str = "",
        tells: tuple[str, ...] = (),
        unfilled: Mapping[str, m.Json] | None = None,
        at: int = 0,
    ) -> str:
        """Send one verb; the command's id. Raises `RequestError` if no driver can be named.

        `stale`: why the press is too old to be sent; the refusal is in the log too. `tells` and
        `unfilled` as in `messages.Command`. `at` as for `play`.
        """
        named = self._driver_offering(verb, on)
        nobody = named if isinstance(named, Refusal) else None
        driver = "" if isinstance(named, Refusal) else named
        call = Call(verb, dict(args), driver, tells=tells, unfilled=unfilled or {})
        wrong = self._wrong_arguments(call) if at else ""
        question = SendVerb(verb, call.args, driver, origin, stale, at, nobody, wrong)
        refusal = self._why_not_sent(question)
        again = partial(self.why_no_verb, call, origin)
        sent = self.runner.send(call, origin, when_busy or "queue", refusal, at=at, again=again)
        if refusal is not None:
            raise RequestError.of(refusal)
        return sent.command

    def _why_not_sent(self, question: SendVerb | SendOwnVerb) -> Refusal | None:
        """Why a verb may not be sent. Raises `RequestError` where no driver can be named, so that
        no command is refused in the log.
        """
        refusal = why_not(self.facts(), question)
        if refusal is not None and refusal.code in ("ended", "unknown"):
            raise RequestError.of(refusal)
        return refusal

    def _wrong_arguments(self, call: Call) -> str:
        """What is wrong with the arguments, which the bus would say only when they are due."""
        known = self.bus.verb(call.driver, call.verb)
        try:
            if known is not None:
                checked(known, call.args)
        except ArgumentError as error:
            return str(error)
        return ""

    async def predict_action(self, name: str, kept: Kept) -> Prediction:
        """How an action would go if it were played now. Raises `RequestError`."""
        action = self.experiment.action(name)
        if action is None:
            raise RequestError(
                Sentence("session.no_action", "there is no action {name!r}", name=name)
            )
        try:
            steps = self.texts.preview(action)
        except MissingValueError as error:
            raise missing_value_error(error) from error
        drivers: dict[str, Forecaster] = {**self.drivers, **self.features.performing}
        return await predicted(steps, self.bus.verb, drivers, kept)

    async def predict_verb(self, call: Call, kept: Kept) -> Prediction:
        """How one verb, filled in, would go if it were sent now. Raises `RequestError`."""
        call = replace(call, driver=self._driver_for(call.verb, call.driver))
        performing = self.features.performing
        if (performer := performing.get(call.driver)) is not None:
            try:
                foretold = await performer.foretell(call.verb, call.args)
            except RejectedError as error:
                raise RequestError(error.what, error.remedy) from error
            if foretold is not None:
                return foretold
        return await predicted([(call,)], self.bus.verb, {**self.drivers, **performing}, kept)

    def describe(self) -> m.Json:
        """What can be asked for: `protocol.description.Description` as plain JSON."""
        units = {name: reading.unit for name, reading in self.state.readings.items()}
        plain: m.Json = msgspec.to_builtins(describe(self.experiment, self.bus.verbs, units))
        return plain

    def add_typed_button(self, text: str, on: str) -> bool:
        """Make a button of a sentence that was typed; says whether it is a new one."""
        typed = with_sentence(self.experiment, self.typed, text, self._driver_for("say", on))
        if typed == self.typed:
            return False
        self.typed = typed
        self.experiment = with_typed(self.experiment, typed)
        self.texts.publish_all()
        return True

    def _calls_in(self, performer: str, file: str) -> Sequence[ComposedCall]:
        return self.features.calls_in(performer, file)

    def why_no_verb(self, call: Call, origin: RequestOrigin) -> Refusal | None:
        """Why this hand may not send it at the moment; None: it may."""
        return why_not(self.facts(), SendVerb(call.verb, call.args, call.driver, origin))

    def _helpers(self) -> dict[str, str]:
        """Programs and control panels that belong to a part, with it."""
        programs = (each for each in self.state.consoles.values() if each.role == "program")
        return {
            **{each.console: each.part for each in programs},
            **{spec.name: spec.offer.part for spec in self.experiment.drivers},
        }

    def _why_too_old(self, ask: Ask) -> str:
        """Why a hand's ask is too old: a driver reads late what waited while nobody read."""
        age_us = max(self.standstill.age_us(), ask.age_us)
        return self.too_old(age_us) if is_by_hand(ask.source, ask.key) else ""

    def too_old(self, age_us: int) -> str:
        """Why a press of this age is not played; empty if it may be."""
        if age_us > self.experiment.session.stale_after * 1_000_000:
            return Sentence(
                "session.too_late",
                "too late: the key was pressed {seconds:.1f} s ago",
                seconds=age_us / 1_000_000,
            )
        return ""

    def log_too_old(self, refusal: Refusal) -> None:
        """What is too old is in the log, also if it is neither an action nor a command."""
        if refusal.code == "stale":
            self.hub.publish(m.Notice(level="warning", text=refusal.reason))

    def _driver_for(self, verb: str, on: str) -> str:
        named = self._driver_offering(verb, on)
        if isinstance(named, Refusal):
            raise RequestError.of(named)
        return named

    def _driver_offering(self, verb: str, on: str) -> str | Refusal:
        """The driver that is meant, or why none can be named."""
        offering = [name for name, verbs in self.bus.verbs.items() if verb in verbs]
        if on:
            offering = [n for n in offering if n in (on, *performers()) or n.startswith(f"{on}.")]
        if len(offering) == 1:
            return offering[0]
        if offering:
            reason = Sentence(
                "session.several_offer",
                "{verb!r} is offered by {names}",
                verb=verb,
                names=" and ".join(offering),
            )
            return Refusal(
                "unknown",
                reason,
                Sentence("session.name_driver", "name one of them with `on`"),
            )
        verbs = sorted({known for offered in self.bus.verbs.values() for known in offered})
        if on:
            reason = Sentence(
                "session.driver_offers_not",
                "no driver {driver!r} offers {verb!r}",
                driver=on,
                verb=verb,
            )
        else:
            reason = Sentence("session.nobody_offers", "no driver offers {verb!r}", verb=verb)
        return Refusal(
            "unknown",
            reason,
            Sentence("gate.there_are", "there are {names}", names=", ".join(verbs)),
        )

    def _on_message(self, message: m.Message) -> None:
        """A message of this session: the state first, then who follows what goes on in it. Drivers
        that hear learn what the robots say.
        """
        said = self.state.said
        changes = self.state.apply(message)
        if self.state.said is not said:
            self.feeds.put_everywhere(ROBOT_SPEECH, self.state.said)
        for episode in changes:
            for call in self._following.get(type(episode), ()):
                call(episode)

    def follow(self, kind: type[e.Episode], call: Callable[[Any], object]) -> None:
        """Call it with each episode of the kind that begins or has ended, before anybody else hears
        of it.
        """
        self._following[kind] = (*self._following.get(kind, ()), call)

    def unfollow(self, kind: type[e.Episode], call: Callable[[Any], object]) -> None:
        """Undo `follow`."""
        self._following[kind] = tuple(each for each in self._following[kind] if each is not call)

    def cancel(self, run: str, by: str = WIZARD) -> None:
        """Cut one run short. `by`: who wants it."""
        if not self.runner.cancel(run, Sentence("session.cancelled", "cancelled by {by}", by=by)):
            raise RequestError(Sentence("session.not_running", "{run} is not running", run=run))

    def empty_queue(self, by: str) -> None:
        """End whatever waits for its turn; what runs goes on. `by`: who wants it."""
        if not self.runner.empty(Sentence("session.queue_emptied", "queue emptied by {by}", by=by)):
            raise RequestError(Sentence("session.nothing_queued", "nothing is queued"))

    # -- the stop ----------------------------------------------------------------------------

    def stop(self, source: str, sent_us: int | None = None) -> None:
        """Stop everything, now, also the way to the rest pose when the session ends.

        `sent_us`: what the request that asks for it is stamped with (0: with nothing); None: the
        robot process itself asks.
        """
        self.bus.stop(source, None if sent_us is None else self._when_pressed(sent_us))
        self._driver_manager.stop_resting()
        self.runner.stop_waiting(Sentence("session.stop_pressed", "stop pressed"))

    def _when_pressed(self, sent_us: int) -> int:
        """When a stop was pressed, on the axis of `t`; 0 where its stamp cannot be true."""
        age_us = self.clock.boot_us() - sent_us
        return self.hub.now() - age_us if 0 <= age_us <= OLDEST_STOP_US else 0

    def release(self, source: str, stale: str = "", known: Collection[str] = ()) -> None:
        """Take actions again. `stale`: why it is too old to be done. `known`: drivers of which
        whoever asks knows that they have not confirmed the stop. Raises `RequestError` if there
        are others.
        """
        refusal = why_not(self.facts(), ReleaseStop(stale, known))
        if refusal is not None:
            self.log_too_old(refusal)
            raise RequestError.of(refusal)
        self.bus.release(source)
        self._driver_manager.resume()

    # -- what drivers ask for ----------------------------------------------------------------

    def _driver_request(self, driver: str, ask: Ask, done: OnCompletion | None) -> None:
        """A driver asks for something; drivers are made before the session is whole."""
        self._loop.call_soon(
            self._answer_driver, driver, ask, done or (lambda carried_out, why: None)
        )

    def _answer_driver(self, driver: str, ask: Ask, done: OnCompletion) -> None:
        """Do what `driver` asks for, as if the wizard had pressed a key; `done` hears the end. No
        driver is a console.
        """
        if ask.source in OF_CONSOLES:
            ask = replace(ask, source="driver")
        try:
            if ask.what == "verb":
                self._send_verb_for(driver, ask, done)
                return
            self._carry_out_ask(ask, RequestOrigin(ask.source, ask.key, driver))
            done(True, "")
        except RequestError as error:
            done(False, error.reason)
        except Exception as error:  # a stranger's ask; a knob would wait for its answer for ever
            log.exception("what %s asked for failed: %s", driver, ask)
            done(False, f"{type(error).__name__}: {error}")

    def _carry_out_ask(self, ask: Ask, origin: RequestOrigin) -> None:
        match ask.what:
            case "action":
                self.play(ask.name, origin, stale=self._why_too_old(ask))
            case "key":
                self.play(self._action_on(ask.name), origin, stale=self._why_too_old(ask))
            case "stop":
                self.stop(origin.source, self.clock.boot_us() - max(0, ask.age_us))
            case "release":
                self.release(origin.source, self._why_too_old(ask))
            case "mark":
                self.mark(ask.name, origin.source)
            case "cancel":
                self.runner.cancel(self._held.pop((origin.console, ask.key), ""), ask.name)
            case "halt":
                self.bus.halt_driving(ask.name)
            case _:
                self.features.carry_out_ask(ask, origin, self._why_too_old(ask))

    def _send_verb_for(self, driver: str, ask: Ask, done: OnCompletion) -> None:
        named = self._driver_offering(ask.name, self._driver_of_same_robot(driver, ask.on))
        nobody = named if isinstance(named, Refusal) else None
        call = Call(ask.name, dict(ask.args), "" if isinstance(named, Refusal) else named)
        origin = RequestOrigin(ask.source, ask.key, driver)
        question: SendVerb | SendOwnVerb = SendOwnVerb(nobody)
        if is_by_hand(ask.source, ask.key):
            stale = self._why_too_old(ask)
            question = SendVerb(call.verb, call.args, call.driver, origin, stale, nobody=nobody)
        refusal = self._why_not_sent(question)

        def ended(end: m.End) -> None:
            done(isinstance(end, m.Done), end.reason)

        again = partial(self.why_no_verb, call, origin) if isinstance(question, SendVerb) else None
        when_busy = ask.when_busy or "queue"
        sent = self.runner.send(call, origin, when_busy, refusal, ended, again=again)
        if ask.key:
            self._held[driver, ask.key] = sent.command
        if refusal is not None:
            done(False, refusal.reason)

    def _action_on(self, key: str) -> str:
        """The action that the key `key` plays now: of several the one that is in front."""
        found = actions_on(key, self.experiment.actions, self.experiment.keyboard)
        ahead = self.features.front()
        front = [each for each in found if each.panel in ahead]
        if not found:
            raise RequestError(Sentence("session.no_key", "no action has the key {key!r}", key=key))
        return (front or found)[0].name

    def take_hand(self, panel: str, hand: HandInput) -> None:
        """Hand on what a hand does at the controls of the driver `panel`."""
        driver = self.drivers.get(panel)
        if driver is None:
            raise RequestError(
                Sentence("session.no_driver", "there is no driver {panel!r}", panel=panel)
            )
        try:
            driver.take_hand(hand)
        except RejectedError as error:
            raise RequestError(error.what, error.remedy) from error
        except Exception as error:
            self.faults.raised(error, panel)
            raise RequestError(f"{type(error).__name__}: {error}", IN_HOST_LOG) from error

    def lose_hands(self, client: str) -> None:
        """The connection `client` has ended: what it held is let go, its blocks end."""
        self.features.lose(client)
        for name, driver in self.drivers.items():
            try:
                driver.lose_hand(client)
            except Exception as error:  # noqa: BLE001 - the others let go all the same
                self.faults.raised(error, name)

    def _driver_of_same_robot(self, driver: str, on: str) -> str:
        """The full name of `on` beside `driver`: robots of an experiment keep to themselves."""
        robot, dot, _ = driver.rpartition(".")
        if not dot:
            return on
        beside = f"{robot}.{on}" if on else robot
        return beside if not on or beside in self.drivers else on

    # -- marks and settings ------------------------------------------------------------------

    def go_on_unrecorded(self) -> None:
        """The wizard goes on without a record until a folder takes the log. Raises `RequestError`
        if one does.
        """
        if not self.recorder.waive(self.hub.now()):
            raise RequestError(
                Sentence(
                    "session.recorded",
                    "the log is written: nothing is refused for it",
                )
            )
        self.hub.publish(m.RecordWaived())
        self.hub.publish(self.recorder.state())

    def mark(self, text: str, source: str, tells: tuple[str, ...] = (), at: int = -1) -> None:
        """A marker in the log, of the moment `at` on the axis of `t` (-1: now); `tells` as in
        `messages.RestrictedMessage`.
        """
        if not -1 <= at <= self.hub.now():
            raise RequestError(
                Sentence(
                    "session.marker_moment",
                    "a marker's moment lies between the beginning of the session and now",
                )
            )
        self.hub.publish(m.Marker(text=text, source=source, tells=tells, at=at))

    def note(self, text: str, tells: tuple[str, ...] = ()) -> None:
        if not text.strip():
            raise RequestError(Sentence("session.empty_note", "the note is empty"))
        self.hub.publish(m.Note(text=text, tells=tells))

    def mistake(self, run: str, text: str, tells: tuple[str, ...] = (), console: str = "") -> None:
        """Label a run or a single command as a mistake; an empty `run` is what was heard or seen
        last (see `LastAct`).
        """
        played = self.runner.played
        wrong = run or self.last_act.of(console)
        if not wrong:
            raise RequestError(Sentence("session.nothing_played", "nothing has been played yet"))
        if wrong not in played:
            raise RequestError(
                Sentence(
                    "session.no_run",
                    "there is no action with the id {wrong!r}",
                    wrong=wrong,
                )
            )
        self.hub.publish(m.Mistake(run=wrong, action=played[wrong], text=text, tells=tells))

    def set(
        self,
        participant: str | None = None,
        condition: str | None = None,
        trial: int | None = None,
    ) -> None:
        """Set participant, condition or trial; each is checked first, then all are set.

        For another participant or trial what features have begins anew.
        """
        before = self.identity.participant, self.identity.trial
        self.set_codes(participant, condition, trial)
        if (self.identity.participant, self.identity.trial) == before:
            return
        self.features.begin_anew(participant=self.identity.participant != before[0])

    def set_codes(self, participant: str | None, condition: str | None, trial: int | None) -> None:
        """The same; what features have goes on."""
        another = participant not in (None, self.state.study.participant)
        if another or trial not in (None, self.identity.trial):
            self.allow_next()
        if participant is not None and participant != self.identity.participant:
            check_not_withdrawn(participant, self.withdrawn)
        self.identity = self.identity.changed(self.experiment, participant, condition, trial)
        self.hub.publish(
            m.SessionChanged(participant=participant, condition=condition, trial=trial)
        )
        self._prepare()

    def allow_next(self) -> None:
        """Raise `RequestError` unless another participant or trial can begin now."""
        self.features.allow_next()

    def tell_owed(self, participant: str, owed: Owed) -> None:
        """Tell what a participant has yet to do from earlier sessions."""
        self.features.tell_owed(participant, owed)

    def lock(self, panel: str, locked: bool) -> None:
        if panel not in {known.title for known in self.experiment.panels}:
            raise RequestError(
                Sentence("session.no_panel", "there is no panel {panel!r}", panel=panel)
            )
        self.set_lock(panel, locked, "")

    def tick(self, check: str, ok: bool, text: str, source: str) -> None:
        """Tick a line of the file's preflight list, or take the tick away."""
        known = self.experiment.study.preflight
        if check not in known:
            raise RequestError(
                Sentence("session.no_check", "the preflight list has no {check!r}", check=check),
                Sentence("gate.there_are", "there are {names}", names=", ".join(known))
                if known
                else Sentence("session.no_checks", "the file has none: preflight: [...]"),
            )
        level = "ok" if ok else "warning"
        self.hub.publish(m.PreflightChecked(check=check, level=level, detail=text, source=source))

    def set_lock(self, panel: str, locked: bool, source: str) -> None:
        """The same of a panel that is there; `source`: what does it, where no hand does."""
        self.locked[panel] = locked
        self.hub.publish(m.PanelLocked(panel=panel, locked=locked, source=source))

    # -- the file ----------------------------------------------------------------------------

    def reread(self, experiment: Experiment, *, dry_run: bool) -> list[str]:
        """Have the drivers read what their settings name (moves); what is different, in words.

        May be called from any thread: it reads files.
        """
        settings = {spec.name: spec.settings for spec in experiment.drivers}
        return self._driver_manager.reread(settings, dry_run)

    def adopt(
        self, experiment: Experiment, changes: list[str], telling: Sequence[str] = ()
    ) -> None:
        """Go on with a changed file whose drivers are the same. `telling`: those of the changes
        that may tell which condition is which.

        Panels keep the lock that the wizard gave them, unless it is the lock that was edited.
        """
        before = {panel.title: panel.locked for panel in self.experiment.panels}
        self.experiment = experiment = with_typed(experiment, self.typed)
        for spec in experiment.drivers:
            self.bus.offer(spec.name, spec.offer.verbs)
        self.runner.deadline = experiment.session.deadline
        publish_reload(self.hub, experiment, changes, telling)
        old, study = self.state.study.settings, study_settings(experiment)
        self.state.study.settings = study
        if old.perception != study.perception:
            publish_perception(self.hub, experiment)
        self.texts.publish_all()
        for panel in experiment.panels:
            if before.get(panel.title) is not panel.locked:
                self.lock(panel.title, panel.locked)
        self.features.adopt(experiment)
        self._prepare()
