"""Puts a block in time on one robot, and says in words what is to be done when."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from textwrap import shorten

from woz_tui.drivers.contract import Forecast
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls, UnplayableError, VerbCall
from woz_tui.features.blocks.bml_block import Behaviour, BmlBlock, BmlError, BmlWarning, SyncRef
from woz_tui.features.blocks.bml_schedule import (
    BehaviourTiming,
    BlockSchedule,
    no_other_block,
    schedule,
    speech_timing,
    typical_timing,
    without_behaviour,
)
from woz_tui.features.blocks.kinds import BlockPlanned, BlockProblem, PlannedBehaviour

#: What a robot foretells of each behaviour, by its id, or why it would refuse it.
Forecasts = Mapping[str, Forecast | UnplayableError]


@dataclass(frozen=True, slots=True)
class BlockPlan:
    """A block in time, and the calls of each of its behaviours."""

    schedule: BlockSchedule
    calls: dict[str, list[VerbCall]]

    def message(self, command: str = "", driver: str = "", begin_us: int = 0) -> BlockPlanned:
        """What is told of it."""
        behaviours = [
            PlannedBehaviour(
                id=behaviour.id,
                sort=behaviour.kind,
                does=shorten(_words(behaviour, self.calls[behaviour.id]), 100, placeholder=" ..."),
                points={
                    point: round(at * 1e6)
                    for point, at in self.schedule.points(behaviour.id).items()
                },
            )
            for behaviour in self.schedule.block.behaviours
        ]
        return BlockPlanned(
            command=command,
            driver=driver,
            block=self.schedule.block.id,
            begin=begin_us,
            duration_us=round(self.schedule.seconds * 1e6),
            behaviours=behaviours,
            problems=[problem_of(warning) for warning in self.schedule.warnings],
        )


def problem_of(warning: BmlWarning) -> BlockProblem:
    """A warning as it is told."""
    about = warning.about[0] if warning.about else ""
    return BlockProblem(sort=warning.kind, text=warning.text, about=about)


def first_calls(block: BmlBlock, calls: BehaviourCalls) -> dict[str, VerbCall]:
    """By behaviour the call whose duration is that of the behaviour."""
    found = {}
    for behaviour in block.behaviours:
        with contextlib.suppress(UnplayableError):
            if called := calls.calls(behaviour):
                found[behaviour.id] = called[0]
    return found


def plan(
    block: BmlBlock,
    calls: BehaviourCalls,
    forecasts: Forecasts | None = None,
    elsewhere: Callable[[SyncRef], float | None] = no_other_block,
) -> BlockPlan:
    """When everything of `block` would happen on this robot; what it does not foretell takes as
    long as usual. Raises `BmlError`.
    """
    warnings, playable = list(block.warnings), block
    timings: dict[str, BehaviourTiming] = {}
    called: dict[str, list[VerbCall]] = {}
    for behaviour in block.behaviours:
        try:
            called[behaviour.id] = calls.calls(behaviour)
            forecast = (forecasts or {}).get(behaviour.id, Forecast())
            if isinstance(forecast, UnplayableError):
                raise forecast
            timings[behaviour.id] = _timing(behaviour, called[behaviour.id], forecast)
        except UnplayableError as error:
            if behaviour.required:
                raise BmlError(f"{behaviour.id}: {error}", block.id) from error
            warnings.append(BmlWarning(error.kind, f"{behaviour.id}: {error}", (behaviour.id,)))
            playable = without_behaviour(playable, behaviour.id, warnings)
    block = replace(playable, warnings=tuple(warnings))
    made = schedule(block, lambda behaviour: timings[behaviour.id], elsewhere)
    return BlockPlan(made, {each.id: called[each.id] for each in made.block.behaviours})


def _timing(behaviour: Behaviour, calls: list[VerbCall], forecast: Forecast) -> BehaviourTiming:
    """What the robot foretells, or what is usual."""
    usual = typical_timing(behaviour)
    if not calls or forecast.seconds is None or calls[0].until != "end":
        return usual
    if behaviour.kind == "speech":
        return _with_words(behaviour, speech_timing(behaviour, forecast.seconds), forecast)
    seconds = forecast.seconds * calls[0].turns
    scale = seconds / usual.offsets["end"] if usual.offsets["end"] else 1.0
    offsets = {point: at * scale for point, at in usual.offsets.items()}
    for at, sort, _ in forecast.marks or ():
        if sort == "stroke" and "stroke" in offsets:
            offsets = _with_stroke(offsets, at)
    return BehaviourTiming(offsets)


def _with_words(
    behaviour: Behaviour, timing: BehaviourTiming, forecast: Forecast
) -> BehaviourTiming:
    """Marks where the word behind them begins, if the voice foretells its words."""
    words = [at for at, sort, _ in forecast.marks or () if sort == "word"]
    offsets = dict(timing.offsets)
    for mark, at in behaviour.marks.items():
        before = len(behaviour.text[:at].split())
        if before < len(words):
            offsets[mark] = words[before]
    return BehaviourTiming(offsets, rigid=True)


def _with_stroke(offsets: dict[str, float], stroke: float) -> dict[str, float]:
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


def _words(behaviour: Behaviour, calls: list[VerbCall]) -> str:
    """`play nod, 2 times`, or `emotion happy, then emotion neutral`."""
    words = ", then ".join(dict.fromkeys(call.words for call in calls))
    if behaviour.repetitions > 1 and calls:
        words += f", {calls[0].turns} times"
    return words
