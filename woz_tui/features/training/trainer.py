"""A training: one cue after the other, and verdicts on what the wizard answers."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from woz_tui.bus.hub import Hub
from woz_tui.features.training.cue_plan import APPROACH, LEAVE, PlannedCue
from woz_tui.features.training.kinds import (
    MISSED,
    RIGHT,
    UNCALLED,
    VOID,
    WRONG,
    CueAnswered,
    CueGiven,
)
from woz_tui.features.training.training_visitor import (
    DRIVER,
    PERIOD_S,
    TrainingVisitor,
    seconds_to_say,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence

#: Whoever does these did not answer anybody.
_NO_ANSWERS = frozenset({"engagement", "replay", "program"})

log = logging.getLogger(__name__)


@dataclass
class _OpenCue:
    """A cue that waits for its answer."""

    id: str
    cue: PlannedCue
    since: int
    answered: asyncio.Event = field(default_factory=asyncio.Event)


class Trainer:
    """Gives the cues of one training and judges the answers.

    Args:
        hub: Where cues and verdicts are published, and presses are heard.
        cues: What is to be given.
        visitor: Who gives them.
        acts: Whether the action of this name makes the robot do something; other presses (markers,
            locks) are no answers.
        over: Called once all cues have been given, or the training was ended.
    """

    def __init__(
        self,
        hub: Hub,
        cues: Sequence[PlannedCue],
        visitor: TrainingVisitor,
        acts: Callable[[str], bool],
        over: Callable[[], None],
    ) -> None:
        self._hub = hub
        self._cues = cues
        self._visitor = visitor
        self._acts = acts
        self._over = over
        self._open: _OpenCue | None = None
        self._busy: set[str] = set()
        self._idle = asyncio.Event()
        self._idle.set()
        self._arrived = asyncio.Event()
        self._stopped = False
        self._running = False
        self._segment = 0
        self._tasks: list[asyncio.Task[None]] = []
        hub.listen(self._on_message, m.ActionRequested, m.ActionEnd, m.StopPressed, m.StopReleased)

    def begin(self) -> None:
        """Let the visitor live and give the first cue after its pause."""
        loop = asyncio.get_running_loop()
        self._running = True
        self._tasks = [loop.create_task(self._run_visitor()), loop.create_task(self._give_cues())]
        for task in self._tasks:
            task.add_done_callback(self._report_failure)

    def end(self) -> None:
        """No more cues; the one that waits for an answer does not count, nor does what is pressed
        from now on.
        """
        self._running = False
        for task in self._tasks:
            task.cancel()
        self._judge(VOID)

    def _report_failure(self, task: asyncio.Task[None]) -> None:
        """A wizard must not wait for a visitor who does not come any more."""
        error = None if task.cancelled() else task.exception()
        if error is None:
            return
        log.error("the training failed", exc_info=error)
        self.end()
        text = Sentence(
            "training.failed",
            "the training has failed: {name}: {error}",
            name=type(error).__name__,
            error=error,
        )
        self._hub.publish(
            m.Notice(
                level="error", text=text, remedy=Sentence("host.end_session", "end the session")
            )
        )

    # -- the course ----------------------------------------------------------------------------

    async def _run_visitor(self) -> None:
        while True:
            for reading in self._visitor.step():
                self._hub.publish(reading)
            if self._visitor.arrived:
                self._arrived.set()
            await asyncio.sleep(PERIOD_S)

    async def _give_cues(self) -> None:
        for number, cue in enumerate(self._cues, 1):
            await asyncio.sleep(cue.pause_us / 1_000_000)
            await self._wait_until_idle()
            await self._position_visitor(cue)
            await self._wait_until_idle()
            await self._give(f"q{number:04d}", cue)
        self._running = False
        self._over()

    async def _wait_until_idle(self) -> None:
        """Until the robot does nothing and the stop is released."""
        while self._stopped or self._busy:
            self._idle.clear()
            await self._idle.wait()

    async def _position_visitor(self, cue: PlannedCue) -> None:
        """The visitor stands where the cue can happen; that they go there is no cue."""
        if cue.sort == APPROACH:
            self._visitor.leave()
        elif not self._visitor.near:
            self._visitor.approach()
        else:
            self._visitor.turn(away=False)
        if not self._visitor.arrived:
            self._arrived.clear()
            await self._arrived.wait()

    async def _give(self, name: str, cue: PlannedCue) -> None:
        if cue.text:
            await self._speak(cue.text)
        self._act(cue.sort)
        given = self._hub.publish(
            CueGiven(
                cue=name,
                sort=cue.sort,
                text=cue.text,
                expects=[*cue.expects],
                window_us=cue.window_us,
            )
        )
        self._open = waiting = _OpenCue(name, cue, given.t)
        if self._stopped:  # pressed while the visitor spoke: nobody can answer
            self._judge(VOID)
        try:
            async with asyncio.timeout(cue.window_us / 1_000_000):
                await waiting.answered.wait()
        except TimeoutError:
            self._judge(MISSED)

    def _act(self, sort: str) -> None:
        """What can be seen of a cue begins with its moment."""
        if sort == APPROACH:
            self._visitor.approach()
        elif sort == LEAVE:
            self._visitor.leave()
        elif sort == "turn-away":
            self._visitor.turn(away=True)

    async def _speak(self, text: str) -> None:
        """The visitor speaks: the cue is the end of it."""
        self._segment += 1
        began = self._hub.now()
        self._visitor.speaks = True
        self._hub.publish(m.SpeechStarted(driver=DRIVER, segment=self._segment, began=began))
        try:
            await asyncio.sleep(seconds_to_say(text))
        finally:
            self._visitor.speaks = False
        ended = self._hub.now()
        self._hub.publish(
            m.SpeechEnded(driver=DRIVER, segment=self._segment, began=began, ended=ended)
        )
        self._hub.publish(m.SpeechText(driver=DRIVER, segment=self._segment, text=text, took_us=0))

    # -- the answers -----------------------------------------------------------------------------

    def _on_message(self, message: m.Message) -> None:
        match message:
            case m.ActionRequested(run=run, action=action, source=source):
                self._busy.add(run)
                if source not in _NO_ANSWERS and self._acts(action):
                    self._answer(message)
            case m.ActionEnd(run=run):
                self._busy.discard(run)
            case m.StopPressed(scope="all"):
                self._stopped = True
                self._judge(VOID)
            case m.StopReleased():
                self._stopped = False
        if not self._stopped and not self._busy:
            self._idle.set()

    def _answer(self, press: m.ActionRequested) -> None:
        waiting = self._open
        if waiting is None:
            if self._running and not self._stopped:
                self._hub.publish(
                    CueAnswered(cue="", judged=UNCALLED, action=press.action, run=press.run)
                )
            return
        right = press.action in waiting.cue.expects
        self._judge(RIGHT if right else WRONG, press)

    def _judge(self, judged: str, press: m.ActionRequested | None = None) -> None:
        """Close the cue that waits, if one does."""
        waiting, self._open = self._open, None
        if waiting is None:
            return
        waiting.answered.set()
        self._hub.publish(
            CueAnswered(
                cue=waiting.id,
                judged=judged,
                action=press.action if press else "",
                run=press.run if press else "",
                reaction_us=press.t - waiting.since if press else -1,
            )
        )
