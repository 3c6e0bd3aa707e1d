"""Plays blocks of BML in a session, as a program that is connected to it, and tells how it goes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from xml.sax.saxutils import quoteattr

from woz_tui.bml.behaviour_calls import BehaviourCalls, UnplayableError, VerbCall
from woz_tui.bml.bml_block import (
    NAMESPACE,
    Behaviour,
    BmlBlock,
    BmlError,
    BmlWarning,
    SyncRef,
    read_block,
)
from woz_tui.bml.bml_schedule import (
    BehaviourTiming,
    BlockSchedule,
    Moment,
    schedule,
    speech_timing,
    typical_timing,
    without_behaviour,
)
from woz_tui.client import WozClient, WozError, WozRefusedError
from woz_tui.protocol.description import PredictedCommand
from woz_tui.system.tasks import end_tasks

#: From the plan to the beginning, in seconds: so that all requests are there in time.
LEAD_S = 0.15
#: Blocks that were played and whose times others may refer to.
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
        inside = _escaped(self.text) + "".join(each.xml(top=False) for each in self.inner)
        return f"<{self.name}{said}>{inside}</{self.name}>" if inside else f"<{self.name}{said}/>"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


@dataclass(eq=False, slots=True)
class _Played:
    """A block on its way: when it began (session time in seconds), its task, what it plays."""

    block: BmlBlock
    begin: float = 0.0
    plan: BlockSchedule | None = None
    task: asyncio.Task[None] | None = None
    over: asyncio.Event = field(default_factory=asyncio.Event)


class BmlRealizer:
    """Plays one block after the other, or several together, as their composition says.

    Args:
        client: The session.
        tell: Gets each feedback.
        calls: What the behaviours stand for; None: the usual, with what the session describes.
    """

    def __init__(
        self,
        client: WozClient,
        tell: Callable[[Feedback], None],
        calls: BehaviourCalls | None = None,
    ) -> None:
        self._client = client
        self._tell = tell
        self._calls = calls or BehaviourCalls(client.description.verbs)
        self._blocks: dict[str, _Played] = {}

    # -- for the planner -------------------------------------------------------------------------

    async def perform(self, text: str) -> str:
        """Plan a block and begin it when its composition says so; returns its id, or nothing if
        it was refused (the feedback says why).
        """
        try:
            block = read_block(text)
            if self._going(block.id):
                raise BmlError(f"block {block.id} is still under way", block.id)
            plan = await self.plan(block)
        except BmlError as error:
            self._warn(error.block or "bml", BmlWarning("PARSING_FAILURE", str(error)))
            return ""
        for warning in plan.warnings:
            self._warn(":".join((block.id, *warning.about[:1])), warning)
        played = _Played(block, plan=plan)
        waits = await self._make_room(block)
        self._blocks[block.id] = played
        while len(self._blocks) > REMEMBERED:
            self._blocks.pop(next(iter(self._blocks)))
        played.task = asyncio.create_task(self._play(played, plan, waits), name=f"block {block.id}")
        return block.id

    async def plan(self, block: BmlBlock) -> BlockSchedule:
        """When everything would happen, by what the robot foretells. Raises `BmlError`."""
        warnings, playable = list(block.warnings), block
        timings: dict[str, BehaviourTiming] = {}
        for behaviour in block.behaviours:
            try:
                timings[behaviour.id] = await self._timing(behaviour)
            except UnplayableError as error:
                if behaviour.required:
                    raise BmlError(f"{behaviour.id}: {error}", block.id) from error
                warnings.append(BmlWarning(error.kind, f"{behaviour.id}: {error}", (behaviour.id,)))
                playable = without_behaviour(playable, behaviour.id, warnings)
        block = replace(playable, warnings=tuple(warnings))
        return schedule(block, lambda behaviour: timings[behaviour.id], self._elsewhere)

    async def until_over(self, block: str) -> None:
        """Return when a block has ended; at once if there is none of this id."""
        played = self._blocks.get(block)
        if played is not None:
            await played.over.wait()

    async def cut(self, block: str) -> None:
        """End a block now; what it plays is cut short."""
        played = self._blocks.get(block)
        if played is not None and played.task is not None:
            await end_tasks(played.task)
            self._end(played)  # its task may not have begun

    async def close(self) -> None:
        """End all blocks."""
        for block in [*self._blocks]:
            await self.cut(block)

    # -- planning --------------------------------------------------------------------------------

    async def _timing(self, behaviour: Behaviour) -> BehaviourTiming:
        """What the robot foretells, or what is usual. Raises `UnplayableError`."""
        usual = typical_timing(behaviour)
        calls = self._calls.calls(behaviour)
        if not calls:
            return usual
        try:
            foretold = await self._client.predict(calls[0].verb, calls[0].args)
        except WozRefusedError as error:
            raise UnplayableError("IMPOSSIBLE_TO_SCHEDULE", str(error)) from error
        command = foretold.commands[0] if foretold.commands else None
        if command is None or command.duration_us is None or len(calls) > 1:
            return usual
        seconds = command.duration_us / 1e6
        if behaviour.kind == "speech":
            return _with_words(behaviour, speech_timing(behaviour, seconds), command)
        scale = seconds / usual.offsets["end"] if usual.offsets["end"] else 1.0
        offsets = {point: at * scale for point, at in usual.offsets.items()}
        for mark in command.marks or ():
            if mark.sort == "stroke" and "stroke" in offsets:
                offsets = _with_stroke(offsets, mark.at_us / 1e6)
        return BehaviourTiming(offsets)

    def _elsewhere(self, ref: SyncRef) -> float | None:
        played = self._blocks.get(ref.block)
        if played is None or played.plan is None or not played.begin:
            return None
        moment: Moment = (ref.behaviour, ref.point)
        time = played.plan.times.get(moment)
        return None if time is None else played.begin + time - self._client.now() - LEAD_S

    def _going(self, block: str) -> bool:
        played = self._blocks.get(block)
        return played is not None and not played.over.is_set()

    async def _make_room(self, block: BmlBlock) -> list[_Played]:
        """What has to end before the block begins; a block that replaces ends it."""
        going = [played for name, played in self._blocks.items() if self._going(name)]
        match block.composition:
            case "MERGE":
                return []
            case "APPEND":
                return going
            case "REPLACE":
                for played in going:
                    await self.cut(played.block.id)
                return []
        return [played for played in going if played.block.id in block.after]

    # -- playing ---------------------------------------------------------------------------------

    async def _play(self, played: _Played, plan: BlockSchedule, waits: list[_Played]) -> None:
        name, client = played.block.id, self._client
        try:
            for other in waits:
                await other.over.wait()
            played.begin = client.now() + LEAD_S
            self._foretell(played, plan)
            await self._until(played.begin)
            self._tell(_progress("block", f"{name}:start", client.now()))
            async with asyncio.TaskGroup() as group:
                for behaviour in plan.block.behaviours:
                    group.create_task(self._behave(played, plan, behaviour))
        finally:
            self._end(played)

    def _end(self, played: _Played) -> None:
        if not played.over.is_set():
            played.over.set()
            self._tell(_progress("block", f"{played.block.id}:end", self._client.now()))

    async def _behave(self, played: _Played, plan: BlockSchedule, behaviour: Behaviour) -> None:
        """All of one behaviour; what goes wrong ends it alone, and the planner is told."""
        times = plan.points(behaviour.id)
        points = asyncio.create_task(self._pass_points(played, behaviour.id, times))
        try:
            async with asyncio.TaskGroup() as group:
                for call in self._calls.calls(behaviour):
                    usual = plan.timings[behaviour.id].offsets[call.until]
                    usual -= plan.timings[behaviour.id].offsets[call.point]
                    group.create_task(self._call(played, call, times, usual))
            await points
        except* WozError as errors:
            points.cancel()
            text = "; ".join(str(error) for error in errors.exceptions)
            self._warn(
                f"{played.block.id}:{behaviour.id}",
                BmlWarning("IMPOSSIBLE_TO_SCHEDULE", text, (behaviour.id,)),
            )
        finally:
            await end_tasks(points)

    async def _call(
        self, played: _Played, call: VerbCall, times: Mapping[str, float], usual: float
    ) -> None:
        begin, seconds = times[call.point], times[call.until] - times[call.point]
        stretched = self._calls.stretched(call, seconds, usual) if call.verb != "say" else call
        await self._until(played.begin + begin - LEAD_S)
        at = max(played.begin + begin, self._client.now() + LEAD_S / 10)
        await self._client.perform(stretched.verb, stretched.args, at=at)

    async def _pass_points(self, played: _Played, name: str, times: Mapping[str, float]) -> None:
        for point, time in sorted(times.items(), key=lambda each: each[1]):
            await self._until(played.begin + time)
            ident = f"{played.block.id}:{name}:{point}"
            self._tell(_progress("syncPoint", ident, self._client.now(), time))

    async def _until(self, moment: float) -> None:
        await asyncio.sleep(max(0.0, moment - self._client.now()))

    # -- feedback --------------------------------------------------------------------------------

    def _foretell(self, played: _Played, plan: BlockSchedule) -> None:
        begin = played.begin
        block = Feedback(
            "bml",
            {
                "id": played.block.id,
                "globalStart": f"{begin:.3f}",
                "globalEnd": f"{begin + plan.seconds:.3f}",
            },
        )
        behaviours = tuple(
            Feedback(
                behaviour.kind,
                {
                    "id": f"{played.block.id}:{behaviour.id}",
                    **{point: f"{at:.3f}" for point, at in plan.points(behaviour.id).items()},
                },
            )
            for behaviour in plan.block.behaviours
        )
        self._tell(Feedback("predictionFeedback", {}, inner=(block, *behaviours)))

    def _warn(self, about: str, warning: BmlWarning) -> None:
        self._tell(Feedback("warningFeedback", {"id": about, "type": warning.kind}, warning.text))


def _progress(what: str, ident: str, now: float, time: float | None = None) -> Feedback:
    """How far a block or a behaviour is; `time` counts from the block's start, in seconds."""
    own = {} if time is None else {"time": f"{time:.3f}"}
    return Feedback(f"{what}Progress", {"id": ident, **own, "globalTime": f"{now:.3f}"})


def _with_words(
    behaviour: Behaviour, timing: BehaviourTiming, command: PredictedCommand
) -> BehaviourTiming:
    """Marks where the word behind them begins, if the voice foretells its words."""
    words = [mark.at_us / 1e6 for mark in command.marks or () if mark.sort == "word"]
    offsets = dict(timing.offsets)
    for mark, at in behaviour.marks.items():
        before = len(behaviour.text[:at].split())
        if before < len(words):
            offsets[mark] = words[before]
    return BehaviourTiming(offsets, rigid=True)


def _with_stroke(offsets: Mapping[str, float], stroke: float) -> dict[str, float]:
    """The same with its stroke there; the phases before and after keep their shares."""
    usual, end = offsets["stroke"], offsets["end"]
    if not 0 < usual < end or not 0 < stroke < end:
        return dict(offsets)
    return {
        point: at * stroke / usual
        if at <= usual
        else end - (end - at) * (end - stroke) / (end - usual)
        for point, at in offsets.items()
    }
