"""What a wizard did by hand: actions, and commands on the spot that belong to none."""

from __future__ import annotations

from woz_tui.config.session_verbs import PERFORMERS
from woz_tui.timeline.episodes import ActionEpisode, CommandEpisode
from woz_tui.timeline.timeline import Timeline

#: Sources that are no human at this session.
BY_MACHINE = frozenset({"engagement", "program", "replay"})
WizardAct = ActionEpisode | CommandEpisode


def of_robot(command: CommandEpisode) -> bool:
    """Whether it went to a robot, not to the session itself or the engagement model."""
    return command.request.driver not in PERFORMERS


def is_direct(command: CommandEpisode) -> bool:
    """Whether it went to a robot and belonged to no action."""
    return not command.request.run and of_robot(command)


def acts_of(timeline: Timeline) -> list[WizardAct]:
    """All wizard actions in the order in which they were asked for."""
    return [
        each
        for each in timeline.episodes
        if (type(each) is ActionEpisode or (type(each) is CommandEpisode and is_direct(each)))
        and each.request.source not in BY_MACHINE
    ]


def id_of(act: WizardAct) -> str:
    """The id of its run, or of the command."""
    return act.request.run if isinstance(act, ActionEpisode) else act.request.command
