"""What a wizard did by hand: actions, and commands on the spot that belong to none."""

from __future__ import annotations

from operator import attrgetter
from typing import NamedTuple

from woz_tui.experiment.verbs import PERFORMERS
from woz_tui.timeline.context import Context
from woz_tui.timeline.episodes import Action, Command, Episode
from woz_tui.timeline.timeline import Timeline

#: Sources that are no human at this session.
BY_MACHINE = frozenset({"engagement", "program", "replay"})


class Act(NamedTuple):
    """An act by hand. `name` is the action's, or the verb; `id` that of the run or command;
    `started` the time from the request to the first start of a driver, None without one.
    """

    t: int
    seq: int
    name: str
    id: str
    context: Context
    direct: bool
    started: int | None
    mistake: bool


def of_robot(command: Command) -> bool:
    """Whether it went to a robot, not to the session itself or the engagement model."""
    return command.request.driver not in PERFORMERS


def is_direct(command: Command) -> bool:
    """Whether it went to a robot and belonged to no action."""
    return not command.request.run and of_robot(command)


def acts_of(timeline: Timeline) -> list[Act]:
    """All of them in the order in which they were asked for."""
    actions = (_act(each, each.request.run) for each in timeline.of(Action) if by_hand(each))
    commands = (
        _act(each, each.request.command)
        for each in timeline.of(Command)
        if by_hand(each) and is_direct(each)
    )
    return sorted((*actions, *commands), key=attrgetter("t", "seq"))


def by_hand(episode: Episode) -> bool:
    """Whether a human asked for it."""
    return episode.source not in BY_MACHINE


def _act(each: Action | Command, name: str) -> Act:
    direct, wrong = isinstance(each, Command), each.mistake is not None
    return Act(each.begin, each.seq, each.label, name, each.context, direct, each.latency_us, wrong)
