"""Runs the commands of another session's log again: when that begins and what ends it.

With a console it begins when a wizard is attached, because somebody has to have a hand on the stop;
headless at once. In both cases the drivers that it needs must be connected first.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from woz_tui.bus.bus import STOP_WAIT_S
from woz_tui.config.experiment import Call, Experiment
from woz_tui.gate.questions import RequestOrigin
from woz_tui.host.session_server import SessionServer
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.replay.rerun_plan import REPLAY, RerunPlan, fitted, plan_of
from woz_tui.replay.rerun_player import DONE, LEAD_US, STOPPED, RerunPlayer

#: How long the drivers that are needed may take to be connected, in seconds.
DRIVERS_WAIT_S = 20.0
#: With a console: from the notice that it begins to the first command, in microseconds.
WARNING_US = 3_000_000
#: What the end of a re-run's session is called in its log, where it ends by itself.
SESSION_END = Sentence("host.rerun_over", "the re-run is over")
#: Begins the reason of a re-run of which nothing was sent.
NOT_BEGUN = "not begun: "


@dataclass(frozen=True, slots=True)
class RerunOptions:
    """Which log is run again. `headless`: without a console, and the session ends with it.

    `wait_s`: how long the drivers may take to be connected.
    """

    log: Path
    headless: bool = False
    wait_s: float = DRIVERS_WAIT_S


def without_model(experiment: Experiment) -> Experiment:
    """The experiment as a re-run plays it: what the engagement model did is in the log, and it must
    not do it a second time by itself.
    """
    return replace(experiment, engagement=None)


def read_plan(options: RerunOptions, experiment: Experiment) -> RerunPlan:
    """The plan for this robot. Raises `RequestError` or `OSError` if nothing can be sent."""
    try:
        plan = fitted(plan_of(options.log), experiment)
    except ValueError as error:
        raise RequestError(str(error)) from error
    if not plan.sent:
        raise RequestError(
            Sentence(
                "host.nothing_to_send",
                "{log}: this log has no command that can be sent again",
                log=options.log,
            )
        )
    return plan


class RerunSession:
    """Begins the re-run, watches over it, and tells the wizard.

    Args:
        host: Whose session it is played in.
        plan: What is played.
        options: How.
    """

    def __init__(self, host: SessionServer, plan: RerunPlan, options: RerunOptions) -> None:
        self._host = host
        self._session = host.session
        self._plan = plan
        self._options = options
        host.for_program = options.headless
        self._deadline: asyncio.TimerHandle | None = None
        self._ending: asyncio.TimerHandle | None = None
        self._player = RerunPlayer(
            plan,
            self._session.hub,
            self._send,
            self._session.runner.cancel,
            self._on_over,
            lead_us=LEAD_US if options.headless else WARNING_US,
            stale_us=round(self._session.experiment.session.stale_after * 1_000_000),
        )
        self._session.hub.listen(
            self._on_message, m.DriverHealth, m.ConsoleAttached, m.ConsoleLost, m.StopConfirmed
        )

    def begin_when_ready(self) -> None:
        """Begin, if nothing is missing any more; the session must be open. Else it is looked again
        whenever a driver or a console has come.
        """
        if self._player.under_way or self._player.over is not None or self._session.ended:
            return
        if not self._options.headless and not self._host.wizards:
            return
        if missing := self._missing():
            if self._deadline is None:
                self._notice(
                    "info",
                    Sentence(
                        "host.rerun_waits",
                        "the re-run waits for {names}",
                        names=" and ".join(missing),
                    ),
                )
                self._deadline = asyncio.get_running_loop().call_later(
                    self._options.wait_s, self._give_up
                )
            return
        if self._deadline is not None:
            self._deadline.cancel()
        seconds = round((LEAD_US if self._options.headless else WARNING_US) / 1_000_000)
        drives = sum(step.drives for step in self._plan.sent)
        self._notice(
            "warning",
            f"the re-run of {self._plan.session or self._plan.name} begins in {seconds} s:"
            f" {counted(len(self._plan.sent), 'command')}, {counted(drives, 'drive')}",
            Sentence("host.escape_stops", "press escape to stop it"),
        )
        self._player.begin()

    def end(self, reason: str) -> None:
        """The session ends: nothing more is sent."""
        for timer in (self._deadline, self._ending):
            if timer is not None:
                timer.cancel()
        self._player.end(reason)

    # -- before ------------------------------------------------------------------------------

    def _on_message(self, message: m.Message) -> None:
        match message:
            case m.DriverHealth() | m.ConsoleAttached():
                asyncio.get_running_loop().call_soon(self.begin_when_ready)
            case m.ConsoleLost() if self._options.headless and self._host.alone:
                if self._player.under_way:
                    self._session.stop(
                        Sentence(
                            "host.wizard_gone",
                            "no wizard's console is attached any more",
                        )
                    )
            case m.StopConfirmed(scope="all") if self._ending is not None:
                self._end_session()

    def _missing(self) -> list[str]:
        drivers = self._session.state.drivers
        return [
            name
            for name in self._plan.drivers
            if name not in drivers or not isinstance(drivers[name].health, m.DriverConnected)
        ]

    def _give_up(self) -> None:
        drivers = self._session.state.drivers
        missing = []
        for name in self._missing():
            detail = drivers[name].health.detail if name in drivers else ""
            missing.append(f"{name} is not connected{f' ({detail})' if detail else ''}")
        self._player.end(NOT_BEGUN + "; ".join(missing))

    # -- on the way --------------------------------------------------------------------------

    def _send(self, command: m.Command, on_end: Callable[[m.End], None]) -> m.Command:
        """As it was asked for then. It waits for a lane that is still busy, whatever it did then:
        that it took another one's place is in the log as that one's end.
        """
        call = Call(command.verb, dict(command.args), command.driver)
        return self._session.runner.send(
            call, RequestOrigin(REPLAY), "queue", None, on_end, like=command
        )

    # -- after -------------------------------------------------------------------------------

    def _on_over(self, end: m.RerunEnded) -> None:
        if self._session.ended:
            return
        level = "info" if end.reason == DONE else "warning"
        if not self._options.headless:
            self._notice(level, self._summary(end), Sentence("host.end_session", "end the session"))
            return
        self._notice(level, self._summary(end))
        # The log shall say who has confirmed the stop.
        wait = STOP_WAIT_S + 0.5 if end.reason == STOPPED else 0.0
        loop = asyncio.get_running_loop()
        self._ending = loop.call_later(wait, self._end_session)

    def _summary(self, end: m.RerunEnded) -> str:
        if end.reason.startswith(NOT_BEGUN):
            return Sentence("host.rerun_has", "the re-run has {reason}", reason=end.reason)
        failed = {how: n for how, n in self._player.ends.items() if how not in _EXPECTED}
        parts = [
            f"{end.sent_again} sent",
            *(f"{count} {how.replace('_', ' ')}" for how, count in sorted(failed.items())),
            f"{end.skipped_commands} skipped",
        ]
        left = len(self._plan.sent) - end.sent_again
        if left > 0 and end.reason != DONE:
            parts.append(f"{left} not reached")
        how = "is over" if end.reason == DONE else f"has ended ({end.reason})"
        return (
            f"the re-run {how}: {', '.join(parts)}; lateness p50 {end.late_p50_us / 1000:.1f} ms,"
            f" max {end.late_max_us / 1000:.1f} ms"
        )

    def _end_session(self) -> None:
        over = self._player.over
        ended = over is None or over.reason == DONE
        self._host.end(SESSION_END if ended or over is None else f"the re-run: {over.reason}")

    def _notice(self, level: str, text: str, remedy: str = "") -> None:
        self._session.hub.publish(m.Notice(level=level, text=text, remedy=remedy))


#: Ends that need no mention: cut short is what was planned.
_EXPECTED = frozenset({"done", "stopped", "superseded"})


def counted(number: int, what: str) -> str:
    """`1 drive`, `2 drives`."""
    return f"{number} {what}{'' if number == 1 else 's'}"
