"""Plays blocks of BML: those on keys of the experiment file, and those of planners.

A block is a command, `bml`, and what it consists of are commands, too: recorded, stopped, cut short
and refused like all others. A planner is a guest: the wizard's hand takes from its block what both
need.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import msgspec

from woz_tui.config.experiment import Call
from woz_tui.config.file_text import SourceFileError, read_source
from woz_tui.config.performers import performers
from woz_tui.drivers.contract import Forecast, Job, RejectedError
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls, UnplayableError, VerbCall
from woz_tui.features.blocks.block_plan import BlockPlan, first_calls, plan, problem_of
from woz_tui.features.blocks.bml_block import (
    Behaviour,
    BmlBlock,
    BmlError,
    BmlWarning,
    SyncRef,
    read_block,
)
from woz_tui.features.blocks.kinds import BML, BlockPlanned, BlockTrouble
from woz_tui.features.blocks.robot_tables import robot_calls
from woz_tui.features.blocks.section import BLOCKS
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import HANDS, weakest
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.prediction import forecast
from woz_tui.session.session_features import FeatureSession

#: Whose blocks are a guest's.
GUEST = "program"
#: From the plan to the beginning, in seconds: so that nothing of it begins late.
LEAD_S = 0.05
#: A sync point of another block counts as one of now for so long, in seconds: the end of the block
#: that was waited for.
_JUST_S = 0.2
#: Blocks that were played and whose times others may refer to.
REMEMBERED = 100


class _BehaviourError(Exception):
    """A behaviour did not go as planned; the text says why."""


@dataclass(eq=False, slots=True)
class _Played:
    """A block on its way. `begin`: in seconds on the axis of `t`; 0: not yet known."""

    request: m.Command
    block: BmlBlock
    plan: BlockPlan | None = None
    #: What its behaviours stand for, once it is played.
    calls: BehaviourCalls | None = None
    begin: float = 0.0
    over: asyncio.Event = field(default_factory=asyncio.Event)
    #: What goes on or is still to come, by behaviour; the calls that have begun, and those that are
    #: not to begin any more (both by `id`); the lanes that something of it has used.
    tasks: dict[str, asyncio.Task[None]] = field(default_factory=dict)
    begun: set[int] = field(default_factory=set)
    dropped: set[int] = field(default_factory=set)
    lanes: set[tuple[str, str]] = field(default_factory=set)
    #: Of the commands that were done (`messages.Done`).
    evidence: set[str] = field(default_factory=set)
    #: Why a behaviour is taken from it.
    taken: dict[str, str] = field(default_factory=dict)

    @property
    def is_guest(self) -> bool:
        """Whether a planner or another program asked for it; what an action plays is the wizard's,
        and was allowed as that.
        """
        return not self.request.run

    @property
    def owner_and_id(self) -> tuple[str, str]:
        """The planner, or the wizard (empty), and the id: one of them is played at a time."""
        return self.request.console if self.is_guest else "", self.block.id


class BlockPlayer:
    """Plays the blocks of a session."""

    def __init__(self, session: FeatureSession) -> None:
        self.session = session
        #: Those under way, and the last of those that are over; as they came.
        self._blocks: list[_Played] = []

    @property
    def _under_way(self) -> list[_Played]:
        """Those that are not over, as they came."""
        return [each for each in self._blocks if not each.over.is_set()]

    # -- what the performer is asked ---------------------------------------------------------------

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Play a block, to its end."""
        request = self.session.state.commands[job.command].request
        block = self._block(job.args)
        played = _Played(request, block)
        before = self._admit(played)
        try:
            for other in before:
                await other.over.wait()
            played.plan = await self._plan(block)
            if waits := self._waits_for(played):
                for other in waits:
                    await other.over.wait()
                if any(each.first.block or each.second.block for each in block.constraints):
                    played.plan = await self._plan(block)  # other blocks' times, counted from now
            await self._play(played, job)
            if evidence := weakest(played.evidence):
                job.evidence(evidence)
        finally:
            played.over.set()
        return {"block": block.id}

    async def foretell(self, args: Mapping[str, Json]) -> BlockPlanned:
        """What a block would do if it began now. Raises `RejectedError`."""
        return (await self._plan(self._block(args))).message()

    def calls_in(self, file: str) -> list[VerbCall]:
        """What a file that was read with the experiment plays, the earliest first; nothing if it
        cannot be played.
        """
        try:
            block = read_block(BLOCKS.of(self.session.experiment).texts[file])
            made = plan(block, self._calls_of(block.character))
        except (BmlError, KeyError):
            return []
        found = [
            (call.span(made.schedule.points(name))[0], call)
            for name, calls in made.calls.items()
            for call in calls
        ]
        return [call for _, call in sorted(found, key=lambda each: each[0])]

    def lose(self, console: str) -> None:
        """A guest's blocks end with its connection."""
        for played in self._under_way:
            if played.is_guest and played.request.console == console:
                self._cut(played, "the program that asked for it has gone")

    # -- what is played, and when ------------------------------------------------------------------

    def _block(self, args: Mapping[str, Json]) -> BmlBlock:
        file, text = args.get("file"), args.get("block")
        if (file is None) == (text is None):
            raise RejectedError("name either a file with a block, or the block itself")
        try:
            return read_block(self._text_of(str(file)) if text is None else str(text))
        except (BmlError, SourceFileError) as error:
            raise RejectedError(f"{file}: {error}" if text is None else str(error)) from error

    def _admit(self, played: _Played) -> list[_Played]:
        """Take a block in; what of the same name has to end before it."""
        request, block = played.request, played.block
        same = [old for old in self._under_way if old.owner_and_id == played.owner_and_id]
        if same and (played.is_guest or request.when_busy == "refuse"):
            raise RejectedError(f"block {block.id} is still under way")
        ending = same if request.when_busy == "replace" else []
        if block.composition == "REPLACE":  # a guest does not reach the wizard's
            ending = [each for each in self._under_way if each.is_guest or not played.is_guest]
        for other in ending:
            self._cut(other, f"replaced by block {block.id}")
        for old in [old for old in self._blocks if old.over.is_set()][:-REMEMBERED]:
            self._blocks.remove(old)
        self._blocks.append(played)
        return same

    def _waits_for(self, played: _Played) -> list[_Played]:
        """What has to end before a block begins; blocks that came later do not count."""
        going = self._under_way
        older = going[: going.index(played)]
        match played.block.composition:
            case "APPEND":
                return older
            case "APPEND-AFTER":
                return [other for other in older if other.block.id in played.block.after]
        return []

    def _cut(self, played: _Played, reason: str) -> None:
        self.session.runner.cancel(played.request.run or played.request.command, reason)

    async def _plan(self, block: BmlBlock) -> BlockPlan:
        try:
            calls = self._calls_of(block.character)
            forecasts: dict[str, Forecast | UnplayableError] = {}
            for name, call in first_calls(block, calls).items():
                try:
                    forecasts[name] = await forecast(
                        Call(call.verb, call.args, call.driver),
                        self.session.bus.verb(call.driver, call.verb),
                        self.session.drivers,
                    )
                except RequestError as error:
                    forecasts[name] = UnplayableError(str(error), "IMPOSSIBLE_TO_SCHEDULE")
            return plan(block, calls, forecasts, self._elsewhere)
        except BmlError as error:
            raise RejectedError(str(error)) from error

    def _elsewhere(self, ref: SyncRef) -> float | None:
        """When a sync point of another block is, in seconds from the beginning of one that is
        planned now; None: nobody knows.
        """
        for played in reversed(self._blocks):
            if played.block.id == ref.block and played.plan is not None and played.begin:
                time = played.plan.schedule.times.get((ref.behaviour, ref.point))
                if time is None:
                    return None
                left = played.begin + time - self._now() - LEAD_S
                return 0.0 if -_JUST_S < left < 0 else left
        return None

    def _calls_of(self, character: str) -> BehaviourCalls:
        """What behaviours stand for on the robot that a block names. Raises `BmlError`."""
        experiment = self.session.experiment
        return robot_calls(
            experiment.drivers,
            BLOCKS.of(experiment).tables,
            self.session.catalogue,
            experiment.path.parent,
            character,
            offered=lambda spec: self.session.bus.verbs[spec.name].values(),
        )

    def _text_of(self, file: str) -> str:
        """What a file with a block holds, as it was read with the experiment if it was. Raises
        `SourceFileError`.
        """
        experiment = self.session.experiment
        if (text := BLOCKS.of(experiment).texts.get(file)) is not None:
            return text
        return read_source(experiment.path.parent / Path(file).expanduser(), file).text

    # -- playing -----------------------------------------------------------------------------------

    async def _play(self, played: _Played, job: Job) -> None:
        assert played.plan is not None
        made = played.plan.schedule
        played.begin = self._now() + LEAD_S
        begin_us = round(played.begin * 1e6)
        request = played.request
        planned = played.plan.message(request.command, BML, begin_us)
        self.session.hub.publish(_telling(planned, request))
        job.expects(made.seconds + LEAD_S)
        await self._until(played.begin)
        job.mark("sync")
        calls = played.calls = self._calls_of(played.block.character)
        async with asyncio.TaskGroup() as group:
            for behaviour in made.block.behaviours:
                played.tasks[behaviour.id] = group.create_task(
                    self._behave(played, behaviour, calls, job)
                )

    async def _behave(
        self, played: _Played, behaviour: Behaviour, calls: BehaviourCalls, job: Job
    ) -> None:
        """All of one behaviour; what goes wrong ends it alone, and is published."""
        assert played.plan is not None
        times = played.plan.schedule.points(behaviour.id)
        name = behaviour.id
        try:
            try:
                async with asyncio.TaskGroup() as group:
                    group.create_task(self._pass_points(played, name, times, job))
                    group.create_task(self._begin_calls(group, played, name, calls, times))
            except* _BehaviourError as errors:
                self._trouble(played, name, "; ".join(map(str, errors.exceptions)))
        except asyncio.CancelledError:
            if name not in played.taken:
                raise
            self._trouble(played, name, played.taken[name])
        finally:
            del played.tasks[name]

    async def _begin_calls(
        self,
        group: asyncio.TaskGroup,
        played: _Played,
        name: str,
        calls: BehaviourCalls,
        times: Mapping[str, float],
    ) -> None:
        """Begin each call at its moment; those of one moment in the order of their list."""
        assert played.plan is not None
        for call in sorted(played.plan.calls[name], key=lambda each: each.span(times)[0]):
            await self._until(played.begin + call.span(times)[0])
            if id(call) not in played.dropped:
                group.create_task(self._call(played, name, call, calls, times))

    async def _call(
        self,
        played: _Played,
        name: str,
        call: VerbCall,
        calls: BehaviourCalls,
        times: Mapping[str, float],
    ) -> None:
        assert played.plan is not None
        _, seconds = call.span(times)
        _, usual = call.span(played.plan.schedule.timings[name].offsets)
        stretched = calls.stretched(call, seconds, usual)
        request, lane = played.request, calls.lane(call)
        # What has the lane of its own block before it waits for that, and does not cut it off.
        when_busy = "queue" if lane in played.lanes else request.when_busy
        played.lanes.add(lane)
        played.begun.add(id(call))
        part = Call(stretched.verb, stretched.args, stretched.driver)
        refusal = None
        if played.is_guest:
            origin = RequestOrigin(request.source, request.key, request.console)
            refusal = self.session.why_no_verb(part, origin)
        ended: asyncio.Future[m.End] = asyncio.get_running_loop().create_future()

        def end(message: m.End) -> None:
            if not ended.done():
                ended.set_result(message)

        runner = self.session.runner
        command = runner.send_part(request, part, when_busy, refusal, end)
        try:
            over = await ended
        except asyncio.CancelledError:
            runner.cancel(command, f"block {played.block.id} was ended")
            raise
        stopped = isinstance(over, m.Stopped) and self.session.bus.latched  # so is the whole block
        if not isinstance(over, m.Done) and not stopped:
            raise _BehaviourError(f"{over.driver}: {over.reason}".strip(": "))
        if isinstance(over, m.Done):
            played.evidence.add(over.evidence)

    async def _pass_points(
        self, played: _Played, name: str, times: Mapping[str, float], job: Job
    ) -> None:
        for point, time in sorted(times.items(), key=lambda each: each[1]):
            await self._until(played.begin + time)
            job.mark("sync", f"{name}:{point}")

    def _trouble(self, played: _Played, name: str, reason: str) -> None:
        problem = problem_of(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", reason, (name,)))
        request = played.request
        self.session.hub.publish(
            _telling(
                BlockTrouble(
                    command=request.command, driver=BML, block=played.block.id, problem=problem
                ),
                request,
            )
        )

    # -- the wizard's hand -------------------------------------------------------------------------

    def give_way(self, message: m.Command) -> None:
        """What the wizard does now comes before what a block still has to do in the same lane, and
        before what a guest's block does there.
        """
        if message.driver in performers() or message.source not in HANDS or message.source == GUEST:
            return
        run = message.run or message.command
        for played in self._under_way:
            if run != (played.request.run or played.request.command):
                self._end_for(played, message)

    def _end_for(self, played: _Played, message: m.Command) -> None:
        if (calls := played.calls) is None:
            return  # nothing of it has begun
        assert played.plan is not None
        verb = self.session.bus.verb(message.driver, message.verb)
        lane = (message.driver, "" if verb is None else verb.lane)
        why = f'replaced by "{message.action or message.verb}"'
        for name, task in played.tasks.items():
            own = played.plan.calls[name]
            there = [call for call in own if calls.lane(call) == lane]
            left = {id(call) for call in there} - played.begun - played.dropped
            if there and (played.is_guest or not played.begun & {id(call) for call in own}):
                played.taken[name] = why
                task.cancel()
            elif left:  # what has begun goes on, and what it would do there later is left out
                played.dropped |= left
                self._trouble(played, name, why)

    # -- time --------------------------------------------------------------------------------------

    def _now(self) -> float:
        return self.session.hub.now() / 1e6

    async def _until(self, moment: float) -> None:
        await asyncio.sleep(max(0.0, moment - self._now()))


M = TypeVar("M", BlockPlanned, BlockTrouble)


def _telling(message: M, request: m.Command) -> M:
    """The message, kept from whom the block itself is kept."""
    return msgspec.structs.replace(message, tells=request.tells)
