"""The script that Space plays, as a console knows it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.scripts.history import ScriptHistory


@dataclass(frozen=True, slots=True)
class ShownScript:
    """A script, and where it stands.

    `name`: of the phase whose it is; empty: the file's. `position`: the next line, from 0; the
    number of lines at the end. `played`: lines that were played. `halted`: how the next line ended
    when it was played: the script stands still at it.
    """

    name: str
    lines: Sequence[str]
    position: int = 0
    played: Collection[int] = ()
    halted: str = ""

    @property
    def next(self) -> str:
        """The action that is played next; empty at the end."""
        return self.lines[self.position] if self.position < len(self.lines) else ""


def shown_script(state: ConsoleState) -> ShownScript:
    """That of the phase, or the file's."""
    phase = state.phase
    own = phase is not None and bool(phase.script)
    name, lines = (phase.name, phase.script) if phase and own else ("", state.plan.script)
    moved = state.session.history(ScriptHistory).moved.get(name)
    if moved is None:
        return ShownScript(name, lines)
    position = max(0, min(moved.position, len(lines)))
    played = moved.played if moved.played is not None else range(position)
    return ShownScript(name, lines, position, played, moved.halted)


def has_script(state: ConsoleState) -> bool:
    """Whether there is any, the file's own or that of a phase."""
    return bool(state.plan.script) or any(phase.script for phase in state.settings.phases)
