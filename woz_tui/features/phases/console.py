"""Phases on the wizard's screen."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, fit_most
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine, other_console
from woz_tui.console.widgets.feature_console import (
    FeatureCommand,
    FeatureConsole,
    FoundRequest,
    KeyHint,
    NextStep,
)
from woz_tui.features.phases.history import next_phase
from woz_tui.features.phases.kinds import AskPhase, PhaseChanged
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed


def _can_begin(state: ConsoleState) -> bool:
    return bool(state.settings.phases) and not state.session.study.between_trials


def _next(press: KeyPress) -> AskPhase:
    return AskPhase(source="key", **press.fields)


def _present(state: ConsoleState, frame: PaintFrame, cells: int) -> Row:
    """The phase with its time; its title has so many cells at the most."""
    if not state.settings.phases:
        return ()
    present = state.session.study.stage
    if present is None:
        return ((f"{say('phases.no_phase', 'no phase')} ", "muted"),)
    name = fit_most(state.heading(present.name), cells, frame.glyphs.ellipsis)
    planned, passed = present.planned_us, frame.now - present.begin
    limit = f"/{elapsed(planned)}" if planned else ""
    late = "warn" if 0 < planned < passed else "plain"
    return (f"{name} ", "title"), (f"{elapsed(passed)}{limit} ", late)


def _following(state: ConsoleState) -> NextStep | None:
    phases = state.settings.phases
    if not phases or (following := next_phase(state.session, phases)) is None:
        return None
    return NextStep("phase_next", following.heading, state.session.study.stage is None)


def _finds(state: ConsoleState) -> Iterator[FoundRequest]:
    for phase in state.settings.phases:
        request = AskPhase(phase=phase.name, source="palette")
        name = say("phases.named", "Phase {phase}", phase=phase.heading)
        yield FoundRequest(name, say("phases.found", "phase"), request)


def _changed(message: PhaseChanged, shown: EventContext) -> EventLine:
    heading = shown.heading(message.phase)
    asker = other_console(message.console, shown)
    named = say("phases.named", "Phase {phase}", phase=heading)
    return EventLine("info", named if heading else say("phases.over", "No phase holds"), asker)


SENTENCES = {PhaseChanged: _changed}

CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand(
            "phase_next",
            sends=_next,
            hint=KeyHint(2.5, Sentence("phases.hint", "phase"), _can_begin),
        ),
        FeatureCommand("phases", f"{__package__}.dialog:PhasesDialog", watchers=True),
    ),
    present=_present,
    following=_following,
    finds=_finds,
)
