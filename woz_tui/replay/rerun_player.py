"""Runs a plan again: every command at its moment, on the session's own clock.

Each moment is counted from the beginning, never from the command before, so that no delay adds up.
A stop ends the re-run for good: what comes after its release is the wizard's alone.
"""

from __future__ import annotations

import asyncio
import statistics
from collections import Counter
from collections.abc import Callable
from functools import partial
from operator import itemgetter

from woz_tui.bus.hub import Hub
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import REPLAY, RerunPlan, RerunStep
from woz_tui.timeline.episodes import OUTCOMES

#: From the beginning to the first command, in microseconds.
LEAD_US = 1_000_000
#: A command that is later than this is left out: a process that stood still for a minute must not
#: make the robot do a minute's worth at once.
STALE_US = 1_500_000
#: How a re-run ends that comes to its end.
DONE = "done"
STOPPED = "stopped"

#: Sends a command of the original again and tells how it ended, maybe before it returns.
Send = Callable[[m.Command, Callable[[m.End], None]], m.Command]
#: Cuts a command short that was sent: its id here, and why.
Cut = Callable[[str, str], object]


class RerunPlayer:
    """One re-run. Used from one thread, the event loop that runs when it is made.

    Args:
        plan: What to do, fitted to the robot.
        hub: Where it is told, and whose clock counts.
        send: Sends a command to the bus.
        cut: Cuts it short.
        ended: Called once, when it is over.
        lead_us: From `begin` to the first command.
        stale_us: A command that is later than this is not sent any more.
    """

    def __init__(
        self,
        plan: RerunPlan,
        hub: Hub,
        send: Send,
        cut: Cut,
        ended: Callable[[m.RerunEnded], object] | None = None,
        *,
        lead_us: int = LEAD_US,
        stale_us: int = STALE_US,
    ) -> None:
        self._plan = plan
        self._hub = hub
        self._send = send
        self._cut = cut
        self._ended = ended
        self._lead_us = lead_us
        self._stale_us = stale_us
        self._acts = self._all_acts()
        self._next = 0
        self._zero = 0
        self._timer: asyncio.TimerHandle | None = None
        self._ids: dict[str, str] = {}
        self._open: set[str] = set()
        self._lates: list[int] = []
        self._skipped = 0
        self._acting = False
        #: How the commands that were sent have ended, by the end's kind (done, failed ...).
        self.ends: Counter[str] = Counter()
        self.under_way = False
        self.over: m.RerunEnded | None = None
        hub.listen(self._on_stop, m.StopPressed)

    @property
    def sent(self) -> int:
        """How many commands were sent so far."""
        return len(self._lates)

    # -- beginning and ending ----------------------------------------------------------------

    def begin(self) -> None:
        """Tell of it, and send the first command after the lead."""
        if self.under_way or self.over is not None:
            return
        self.under_way = True
        self._hub.publish(
            m.RerunStarted(
                original=self._plan.name,
                original_session=self._plan.session,
                original_sha256=self._plan.sha256,
                commands=len(self._plan.sent),
            )
        )
        self._zero = self._hub.now() + self._lead_us
        self._go_on()

    def end(self, reason: str) -> None:
        """Send nothing more. What is under way goes on, unless whoever calls this ends it."""
        if self.over is not None:
            return
        if self._timer is not None:
            self._timer.cancel()
        self.under_way = False
        self.over = self._hub.publish(
            m.RerunEnded(
                reason=reason,
                sent_again=self.sent,
                skipped_commands=self._skipped,
                late_p50_us=round(statistics.median(self._lates)) if self._lates else 0,
                late_max_us=max(self._lates, default=0),
            )
        )
        if self._ended is not None:
            self._ended(self.over)

    def _on_stop(self, message: m.StopPressed) -> None:
        if message.scope == "all":
            self.end(STOPPED)

    # -- in time -----------------------------------------------------------------------------

    def _all_acts(self) -> list[tuple[int, Callable[[int], None]]]:
        """What is to be done, each so many microseconds after the first command."""
        acts: list[tuple[int, int, Callable[[int], None]]] = []
        for step in self._plan.steps:
            if step.skip:
                acts.append((step.at, 1, partial(self._skip, step, step.skip)))
                continue
            acts.append((step.at, 1, partial(self._send_again, step)))
            if step.cut >= 0:  # what makes way goes before what comes
                rank = 0 if step.cut > step.at else 2
                acts.append((max(step.cut, step.at), rank, partial(self._cut_short, step)))
        acts += [(mark.t, 1, partial(self._mark, mark)) for mark in self._plan.marks]
        return [(t - self._plan.start, act) for t, _, act in sorted(acts, key=itemgetter(0, 1))]

    def _go_on(self) -> None:
        """Do all that is due, then sleep until the next moment, counted from the beginning."""
        self._timer = None
        while self.under_way and self._next < len(self._acts):
            offset, act = self._acts[self._next]
            due = self._zero + offset
            wait = due - self._hub.now()
            if wait > 0:
                loop = asyncio.get_running_loop()
                self._timer = loop.call_later(wait / 1_000_000, self._go_on)
                return
            self._next += 1
            self._acting = True
            try:
                act(due)
            except Exception as error:
                # What does not go on must not seem to: a headless one would wait for its end.
                self.end(f"it failed: {type(error).__name__}: {error}")
                raise
            finally:
                self._acting = False
        self._finish()

    def _finish(self) -> None:
        """It is done when the last command has ended, not when it has been sent."""
        over = self._next >= len(self._acts) and not self._open
        # A command may be refused, and so have ended, while it is being sent.
        if self.under_way and over and not self._acting:
            self.end(DONE)

    # -- what is due -------------------------------------------------------------------------

    def _send_again(self, step: RerunStep, due: int) -> None:
        late = max(0, self._hub.now() - due)
        if late > self._stale_us:
            self._skip(step, f"it would have been {late / 1_000_000:.1f} s late", due)
            return
        original = step.command.command
        self._open.add(original)
        self._lates.append(late)
        again = self._send(step.command, partial(self._end_of, original))
        self._ids[original] = again.command
        self._hub.publish(
            m.RerunSent(command=again.command, original_command=original, due=due, late_us=late)
        )

    def _end_of(self, original: str, end: m.End) -> None:
        self.ends[OUTCOMES[type(end)]] += 1
        self._open.discard(original)
        self._finish()

    def _cut_short(self, step: RerunStep, due: int) -> None:
        original = step.command.command
        if original in self._open:
            why = f"cut short as in the log: {step.why_cut}".removesuffix(": ")
            self._cut(self._ids[original], why)

    def _mark(self, mark: m.Marker, due: int) -> None:
        self._hub.publish(m.Marker(text=mark.text, source=REPLAY, tells=mark.tells))

    def _skip(self, step: RerunStep, reason: str, due: int) -> None:
        self._skipped += 1
        command = step.command
        self._hub.publish(
            m.RerunSkipped(original_command=command.command, reason=reason, tells=command.tells)
        )
