"""Runs the engagement model in the robot process: gives it every message, publishes its states.

A session has one such object, also if its experiment has no section `engagement`: then it does
nothing, until a reload brings the section. The model itself is in `woz_tui.sensing`; here it meets
the hub, the clock and the robot.

Its verbs (`toggle: gaze`) are commands to a performer of their own, `engagement`. They are taken
while the stop is pressed too: nothing moves because of them then, and what happens to a visitor
meanwhile is just what a wizard has to put right.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import settings_to_json
from woz_tui.config.experiment import Engagement
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.session_verbs import engagement_verbs
from woz_tui.config.utterance_template import OF_VISITOR
from woz_tui.drivers.contract import Job, Performer, RejectedError, Scope, Verb
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing import engagement_commands
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.engagement_stream import READ, EngagementFollower
from woz_tui.session.attention_control import AttentionController
from woz_tui.session.engagement_robot import EngagementRobot, WakeUpTimer
from woz_tui.session.state_effects import StateEffects
from woz_tui.session.visitor_recognition import VisitorRecognition
from woz_tui.timeline.session_state import SessionState

#: Microseconds between two looks at the signs, while no state changes.
SHOWN_EVERY_US = 200_000
#: So many different failures are told; who has more has a bug that these show already.
FAILURES = 20

#: What is heard always, and what while the file has the section.
_OF_FILE = m.ExperimentReloaded, m.EngagementAdopted
_OF_MODEL = tuple(
    {*READ, m.StopPressed, m.StopReleased, m.End, m.ActionEnd, m.DriverConnected} - {*_OF_FILE}
)

log = logging.getLogger(__name__)


@dataclass
class _Model:
    """The parts that exist while the experiment has the section `engagement`."""

    follower: EngagementFollower
    visitors: VisitorRecognition
    attention: AttentionController


class EngagementController(Performer):
    """Connects the engagement model with the hub, the clock and the robot.

    Args:
        robot: What it has to do with; bus and runner of its session count from `begin` on.
        state: What holds in the session.
        locked: Panels by title: whether they are locked.
        logs: The folder where the log belongs.
    """

    def __init__(
        self, robot: EngagementRobot, state: SessionState, locked: Mapping[str, bool], logs: Path
    ) -> None:
        self._robot, self._state, self._logs = robot, state, logs
        self._hub = robot.session.hub
        self._loop = asyncio.get_running_loop()
        self._model: _Model | None = None
        self._effects = StateEffects(robot, locked)
        self._timer = WakeUpTimer(robot.session.hub, self._on_timer)
        self._show_timer: asyncio.TimerHandle | None = None
        self._shown: m.EngagementShown | None = None
        self._shown_us = -SHOWN_EVERY_US
        self._failed: set[str] = set()
        self._opened = False
        #: Verbs under way, by command.
        self._verbs: dict[str, str] = {}
        #: Verbs as the bus has them; none without the section.
        self.offered: tuple[Verb, ...] = ()
        #: The settings as the log has them; none without the section.
        self._published_settings: dict[str, m.Json] = {}
        self._hub.listen(self._on_message, *_OF_FILE)
        self._publish_settings()

    # -- what the session asks ---------------------------------------------------------------------

    def begin(self) -> None:
        """The session is open: publish the model's state and show it on the robots."""
        self._opened = True
        self._show()
        self._show_robots()
        self._set_timer()

    def close(self) -> None:
        """Stop listening. Until this call the model gets the session's last messages too, so that
        the log holds what it saw; no command comes of them.
        """
        model, self._model = self._model, None
        self._timer.cancel()
        if self._show_timer is not None:
            self._show_timer.cancel()
            self._show_timer = None
        if model is not None:
            self._hub.ignore(self._on_message, *_OF_MODEL)
            model.visitors.close()
            model.attention.close()

    async def finish(self) -> None:
        """Close the model and save what was learnt of visitors. Bounded in time."""
        model = self._model
        self.close()
        if model is not None:
            await model.visitors.finish()

    def values(self) -> dict[str, str]:
        """Variables for utterances: `{visitor}`, empty while nobody is known, and what is known of
        them.
        """
        if (model := self._model) is None:
            return {}
        label = model.follower.model.visitor
        known = model.visitors.visitors.called(label) if label else None
        of_them = (known.age_group, known.address) if known is not None else ("", "")
        return dict(zip(OF_VISITOR, (model.visitors.name(label), *of_them), strict=True))

    # -- a performer on the bus --------------------------------------------------------------------

    async def perform(self, job: Job) -> Mapping[str, m.Json]:
        """Understand a verb; it is obeyed when `command.done` is heard, as in the log."""
        if self._model is None:
            raise RejectedError(
                Sentence("hand.no_section", "the experiment has no engagement model")
            )
        try:
            arguments = engagement_commands.resolved_arguments(
                self._model.follower.model, job.verb, job.args
            )
        except ValueError as error:
            what = next(iter(error.args), "")
            raise RejectedError(what if isinstance(what, Sentence) else str(error)) from error
        if isinstance(name := arguments.get("code"), str):
            arguments["code"] = self._model.visitors.name(name)
        self._verbs[job.command] = job.verb
        return arguments

    async def stop(self, scope: Scope) -> None:
        """Do nothing: the model moves nothing."""

    # -- hearing -----------------------------------------------------------------------------------

    def _on_message(self, message: m.Message) -> None:
        """A listener of the hub: whatever goes wrong in here, the others still hear."""
        try:
            self._handle(message)
        except Exception as error:
            if self._report_failure(error):
                log.exception("the engagement model failed at %s", type(message).__name__)

    def _report_failure(self, error: Exception) -> bool:
        """Whether it is news: a sensor may bring the same failure fifty times a second."""
        reason = f"{type(error).__name__}: {error}"
        if reason in self._failed or len(self._failed) >= FAILURES:
            return False
        self._failed.add(reason)
        self._hub.publish(
            m.Notice(
                level="error",
                text=Sentence(
                    "session.engagement_failed",
                    "the engagement model failed: {reason}",
                    reason=reason,
                ),
                remedy=IN_HOST_LOG,
            )
        )
        return True

    def _handle(self, message: m.Message) -> None:
        # New settings count once all have heard of them; what the robot shows changes at once.
        if isinstance(message, m.EngagementAdopted):
            self._apply_settings(
                self._robot.session.experiment.engagement if message.settings else None
            )
        elif isinstance(message, m.ExperimentReloaded) and not self._publish_settings():
            self._apply_settings(self._robot.session.experiment.engagement)
        if self._model is None:
            return
        follower, visitors, attention = (
            self._model.follower,
            self._model.visitors,
            self._model.attention,
        )
        if isinstance(message, m.End):
            verb = self._verbs.pop(message.command, "")
            if isinstance(message, m.Done):
                visitors.introduced(verb, message.sent)
        was = follower.model.run
        if follower.reads(message):
            self._publish_transitions(follower.apply(message))
        elif isinstance(message, m.Reading):
            attention.on_message(message)
            return
        visitors.on_message(message)
        attention.on_message(message)
        match message:
            case m.Done() | m.EngagementAdopted():
                attention.attend(follower.mode)
                if was == "off":
                    self._show_robots()
            case m.ActionEnd():
                self._effects.ended(message)
            case m.DriverConnected(driver=driver):
                self._connected(driver)
            case m.StopReleased():
                if follower.model.run != "off":
                    self._effects.released()
                visitors.resume(follower.model.state)

    def _connected(self, driver: str) -> None:
        if self._opened and self._model is not None and self._model.follower.model.run != "off":
            self._effects.connected(driver)

    def _show_robots(self) -> None:
        """Show the state on all robots that are connected."""
        for name, driver in [*self._state.drivers.items()]:
            if isinstance(driver.health, m.DriverConnected):
                self._connected(name)

    def _publish_settings(self) -> bool:
        """Publish the settings if they are others than before; whether they are.

        They count from this message on: who reads the log later uses them from the same place.
        """
        engagement = self._robot.session.experiment.engagement
        settings = settings_to_json(engagement.settings) if engagement else {}
        if settings == self._published_settings:
            return False
        self._published_settings = settings
        self._hub.publish(m.EngagementAdopted(settings=settings))
        return True

    def _apply_settings(self, engagement: Engagement | None) -> None:
        """Take the section as it is now in the file."""
        had_one = self._model is not None
        self.offered = engagement_verbs() if engagement else ()
        if self._opened:
            self._robot.session.bus.offer(ENGAGEMENT, self.offered)
        if engagement is None:
            self.close()
        else:
            self._use_settings(engagement.settings)
        self._effects.adopt()
        if self._model is None:
            self._effects.model_removed()
            self._shown = None
        elif not had_one:
            self._model.follower.catch_up(self._state.messages())
            self._show_robots()
        self._show()
        self._set_timer()

    def _use_settings(self, settings: EngagementSettings) -> None:
        """Give the settings to all parts but the follower, which reads them from the messages."""
        model = self._model
        if model is None:
            follower = EngagementFollower(settings)
            visitors = VisitorRecognition(self._robot, settings, self._logs)
            self._model = _Model(follower, visitors, self._attention(follower, settings))
            self._hub.listen(self._on_message, *_OF_MODEL)
            return
        model.visitors.adopt(settings)
        if not model.attention.fits(settings):
            model.attention.close()
            model.attention = self._attention(model.follower, settings)

    def _attention(
        self, follower: EngagementFollower, settings: EngagementSettings
    ) -> AttentionController:
        attention = AttentionController(self._robot, follower, settings, self._show_later)
        attention.entered(follower.model.state)
        attention.attend(follower.mode)
        return attention

    # -- what comes of it --------------------------------------------------------------------------

    def _publish_transitions(self, changes: Sequence[Transition]) -> None:
        for change in changes:
            self._hub.publish(
                m.EngagementChanged(
                    was=change.was,
                    now=change.now,
                    outcome=change.outcome,
                    why=change.why,
                    verdicts=change.verdicts,
                    visitor=change.visitor,
                    forced=change.forced,
                )
            )
            try:
                self._effects.entered(change)
                if self._model is not None:
                    self._model.visitors.entered(change)
                    self._model.attention.entered(change.now)
            except Exception as error:  # the next change belongs into the log all the same
                if self._report_failure(error):
                    log.exception("the effects of %s failed", change.now)
        if changes:
            self._show()
        else:
            self._show_later()
        self._set_timer()

    def _set_timer(self) -> None:
        """Set the timer to when the model changes by itself."""
        self._timer.set(self._model.follower.due() if self._model else None)

    def _on_timer(self) -> None:
        if self._model is None:
            return
        try:
            self._publish_transitions(self._model.follower.until(self._hub.now()))
        except Exception as error:
            if self._report_failure(error):
                log.exception("the engagement model failed by itself")

    # -- what is shown -----------------------------------------------------------------------------

    def _show_later(self) -> None:
        if self._show_timer is None:
            wait = self._shown_us + SHOWN_EVERY_US - self._hub.now()
            if wait <= 0:
                self._show()
            else:
                self._show_timer = self._loop.call_later(wait / 1_000_000, self._show)

    def _show(self) -> None:
        """Publish the model's state if it differs from what was published last."""
        if self._show_timer is not None:
            self._show_timer.cancel()
            self._show_timer = None
        if self._model is None or not self._opened:
            return
        if attempt := self._model.visitors.attempt:
            self._model.follower.model.attempt = attempt
        shown = self._model.follower.shown()
        if shown == self._shown:
            return
        self._shown = shown
        self._shown_us = self._hub.now()
        self._hub.publish(shown)
        if shown.run != "off":  # the signs are shown all the same, and the robot shows nothing
            self._effects.nearly_engaged(shown)
