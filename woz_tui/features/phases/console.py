"""Phases on the wizard's screen."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import (
    FeatureCommand,
    FeatureConsole,
    FoundRequest,
    KeyHint,
)
from woz_tui.features.phases.kinds import AskPhase


def _can_begin(state: ConsoleState) -> bool:
    return bool(state.settings.phases) and not state.session.study.between_trials


def _next(press: KeyPress) -> AskPhase:
    return AskPhase(source="key", **press.fields)


def _finds(state: ConsoleState) -> Iterator[FoundRequest]:
    for phase in state.settings.phases:
        request = AskPhase(phase=phase.name, source="palette")
        yield FoundRequest(f"Phase {phase.heading}", "phase", request)


CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand("phase_next", sends=_next, hint=KeyHint(2.5, "phase", _can_begin)),
        FeatureCommand("phases", f"{__package__}.dialog:PhasesDialog", watchers=True),
    ),
    finds=_finds,
)
