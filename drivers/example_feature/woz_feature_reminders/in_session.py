"""Tells when a reminder is due."""

from __future__ import annotations

import asyncio

from woz_feature_reminders.kinds import ReminderDue
from woz_feature_reminders.section import REMINDERS, Reminder
from woz_tui.config.experiment import Experiment
from woz_tui.session.session_features import FeatureSession, SessionFeature


class DueReminders(SessionFeature):
    """One timer for each reminder that is still to come."""

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._timers: list[asyncio.TimerHandle] = []

    def begin(self) -> None:
        self._wait_for(REMINDERS.of(self.session.experiment))

    def adopt(self, experiment: Experiment) -> None:
        self.close()
        self._wait_for(REMINDERS.of(experiment))

    def close(self) -> None:
        for timer in self._timers:
            timer.cancel()
        self._timers.clear()

    def _wait_for(self, reminders: tuple[Reminder, ...]) -> None:
        passed = self.session.hub.now() / 1_000_000
        loop = asyncio.get_running_loop()
        self._timers = [
            loop.call_later(each.after - passed, self._remind, each.text)
            for each in reminders
            if each.after >= passed
        ]

    def _remind(self, text: str) -> None:
        self.session.hub.publish(ReminderDue(text=text))
