"""A planner's side of a session: blocks go in, BML's feedback comes out.

The robot process plays them (`player`); this follows its messages.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar
from xml.sax.saxutils import escape, quoteattr

from woz_tui.client import WozClient, WozError, WozRefusedError
from woz_tui.features.blocks.bml_block import NAMESPACE, Behaviour, BmlError, read_block
from woz_tui.features.blocks.kinds import BML, BlockPlanned, BlockTrouble
from woz_tui.features.blocks.prediction import BlockPrediction
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.system.tasks import end_tasks, until_first_ends

T = TypeVar("T")

#: Blocks that are over and whose end somebody may still ask for.
REMEMBERED = 100


@dataclass(frozen=True, slots=True)
class Feedback:
    """One line to the planner: an XML element. `attributes` in their order; `text` inside it."""

    name: str
    attributes: Mapping[str, str]
    text: str = ""
    inner: tuple[Feedback, ...] = ()

    def xml(self, *, top: bool = True) -> str:
        """As XML; `top`: with the namespace."""
        given = {"xmlns": NAMESPACE, **self.attributes} if top else self.attributes
        said = "".join(f" {name}={quoteattr(value)}" for name, value in given.items())
        inside = escape(self.text) + "".join(each.xml(top=False) for each in self.inner)
        return f"<{self.name}{said}>{inside}</{self.name}>" if inside else f"<{self.name}{said}/>"


@dataclass(eq=False, slots=True)
class _Requested:
    """A block that the session has taken. `plan`: once it is in time."""

    block: str
    behaviours: Mapping[str, Behaviour]
    command: str
    tell: Callable[[Feedback], None]
    plan: BlockPlanned | None = None
    over: asyncio.Event = field(default_factory=asyncio.Event)


class BmlRealizer:
    """Hands blocks to a session, as a program that is connected to it, and tells how they go.

    Args:
        client: The session.
        tell: Gets each feedback, unless `perform` names somebody else.
    """

    def __init__(
        self, client: WozClient, tell: Callable[[Feedback], None] = lambda feedback: None
    ) -> None:
        self._client = client
        self._tell = tell
        #: By command; of each id the latest.
        self._requested: dict[str, _Requested] = {}
        self._latest: dict[str, _Requested] = {}
        #: Requests whose reply is still on its way, and what came of commands meanwhile.
        self._asking = 0
        self._early: list[m.Ack] = []
        self._stream = client.messages(m.Ack)
        self._task = asyncio.create_task(self._follow(), name="bml feedback")

    # -- for the planner -------------------------------------------------------------------------

    async def perform(self, text: str, tell: Callable[[Feedback], None] | None = None) -> str:
        """Hand a block over; returns its id, or nothing if the session did not take it. What is
        wrong with the block itself comes as feedback. `tell` gets the feedback of this block.
        """
        tell = tell or self._tell
        try:
            block = read_block(text)
        except BmlError as error:
            tell(_warning(error.block or "bml", "PARSING_FAILURE", str(error)))
            return ""
        name = block.id
        behaviours = {behaviour.id: behaviour for behaviour in block.behaviours}
        self._asking += 1
        try:
            run = await self._client.begin(BML, _args(text))
        except WozRefusedError as error:
            tell(_warning(name, "IMPOSSIBLE_TO_SCHEDULE", str(error)))
            return ""
        finally:
            self._asking -= 1
        requested = _Requested(name, behaviours, run.id, tell)
        self._requested[run.id] = requested
        before = self._latest.get(name)
        if before is None or before.over.is_set():  # else the session refuses this one
            self._latest[name] = requested
        early = [each for each in self._early if each.command == run.id]
        if not self._asking:
            self._early.clear()
        for message in early:
            self._take(requested, message)
        return name

    async def predict(self, text: str) -> BlockPlanned:
        """What a block would do if it began now. Raises `WozRefusedError`."""
        prediction = await self._client.predict(BML, _args(text))
        assert isinstance(prediction, BlockPrediction)  # of this verb the session says it
        return prediction.block

    async def until_over(self, block: str) -> None:
        """Return when a block has ended; at once if there is none of this id."""
        if (requested := self._latest.get(block)) is not None:
            await requested.over.wait()

    async def cut(self, block: str) -> None:
        """End a block now; what it plays is cut short."""
        requested = self._latest.get(block)
        if requested is not None and not requested.over.is_set():
            with contextlib.suppress(WozRefusedError):  # it is over
                await self._client.request(r.AskCancel(run=requested.command))
            await requested.over.wait()

    async def while_session_lasts(self, work: Coroutine[Any, Any, None]) -> None:
        """Do `work`. Raises `WozConnectionError` as soon as the session has ended."""

        async def follow() -> None:
            async for _ in self._client.messages(BlockPlanned):
                pass

        await until_first_ends(work, follow())

    async def close(self) -> None:
        """End all blocks; nothing is told any more."""
        try:
            for requested in [*self._requested.values()]:
                with contextlib.suppress(WozError):
                    await self._client.request(r.AskCancel(run=requested.command))
        finally:
            await end_tasks(self._task)

    # -- what the session says -------------------------------------------------------------------

    async def _follow(self) -> None:
        with contextlib.suppress(WozError):
            async for message in self._stream:
                requested = self._requested.get(message.command)
                if requested is not None:
                    self._take(requested, message)
                elif self._asking and message.driver == BML:
                    self._early.append(message)
        for requested in self._latest.values():  # the session is gone
            requested.over.set()

    def _take(self, requested: _Requested, message: m.Ack) -> None:
        tell = requested.tell
        match message:
            case BlockPlanned():
                requested.plan = message
                for problem in message.problems:
                    about = ":".join(filter(None, (message.block, problem.about)))
                    tell(_warning(about, problem.sort, problem.text))
                tell(_prediction(message, requested.behaviours))
            case BlockTrouble(problem=problem):
                tell(_warning(f"{message.block}:{problem.about}", problem.sort, problem.text))
            case m.CommandMark(sort="sync", text=""):
                tell(_progress("block", f"{requested.block}:start", message.t))
            case m.CommandMark(sort="sync", text=point):
                ident = f"{requested.block}:{point}"
                tell(_progress("syncPoint", ident, message.t, _time(requested.plan, point)))
            case m.End():
                self._end(requested, message)

    def _end(self, requested: _Requested, end: m.End) -> None:
        del self._requested[requested.command]
        over = [name for name, each in self._latest.items() if each.over.is_set()]
        for name in over[:-REMEMBERED]:
            del self._latest[name]
        if requested.plan is None:
            wrong = isinstance(end, m.Failed) or (isinstance(end, m.Refused) and end.code == "args")
            sort = "PARSING_FAILURE" if wrong else "IMPOSSIBLE_TO_SCHEDULE"
            requested.tell(_warning(requested.block, sort, end.reason or "it was not begun"))
        else:
            if not isinstance(end, m.Done):
                requested.tell(_warning(requested.block, "IMPOSSIBLE_TO_SCHEDULE", end.reason))
            requested.tell(_progress("block", f"{requested.block}:end", end.t))
        requested.over.set()


def _warning(about: str, sort: str, text: str) -> Feedback:
    return Feedback("warningFeedback", {"id": about, "type": sort}, text)


def _args(text: str) -> dict[str, m.Json]:
    """The block as an argument, in which braces would stand for variables."""
    return {"block": text.replace("{", "{{").replace("}", "}}")}


def _time(plan: BlockPlanned | None, point: str) -> float | None:
    """When a sync point is planned, in seconds from the beginning of its block."""
    name, _, point = point.partition(":")
    for behaviour in plan.behaviours if plan is not None else ():
        if behaviour.id == name and point in behaviour.points:
            return behaviour.points[point] / 1e6
    return None


def _progress(what: str, ident: str, now_us: int, time: float | None = None) -> Feedback:
    """How far a block or a behaviour is; `time` counts from the block's start, in seconds."""
    own = {} if time is None else {"time": f"{time:.3f}"}
    return Feedback(f"{what}Progress", {"id": ident, **own, "globalTime": f"{now_us / 1e6:.3f}"})


def _prediction(plan: BlockPlanned, behaviours: Mapping[str, Behaviour]) -> Feedback:
    """The block and its behaviours as the planner wrote them, with the times of all points."""
    begin, end = plan.begin / 1e6, (plan.begin + plan.duration_us) / 1e6
    block = Feedback(
        "bml", {"id": plan.block, "globalStart": f"{begin:.3f}", "globalEnd": f"{end:.3f}"}
    )
    foretold = []
    for each in plan.behaviours:
        written = behaviours[each.id]
        attributes = {"id": f"{plan.block}:{each.id}", **_core(written.attributes)}
        attributes |= {point: f"{at / 1e6:.3f}" for point, at in each.points.items()}
        inner = [Feedback(name, _core(at)) for name, at in _core(written.inner).items()]
        if written.text:
            inner.append(Feedback("text", {}, written.text))
        foretold.append(Feedback(each.sort, attributes, inner=tuple(inner)))
    return Feedback("predictionFeedback", {}, inner=(block, *foretold))


def _core(names: Mapping[str, T]) -> Mapping[str, T]:
    """Without what is of another namespace."""
    return {name: value for name, value in names.items() if name.isidentifier()}
