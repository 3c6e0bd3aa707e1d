"""Which phase holds, which can begin now, and how long each was and should be."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rich.cells import cell_len
from textual.content import Content

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.features.phases.history import PhaseHistory, can_begin, next_phase
from woz_tui.features.phases.kinds import AskPhase
from woz_tui.protocol.panels import PhaseView
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed

#: Cells of a phase's title at the most.
TITLE = 26


class PhasesDialog(ChoiceDialog):
    """The next one is chosen at first."""

    heading = Sentence("phases.heading", "Phase")
    hint = Sentence("phases.keys", "arrows choose · enter begins it · ctrl+q closes")

    def lines(self) -> list[Row]:
        """Where none can begin, why."""
        if not self._phases:
            none = say(
                "phases.file_has_none",
                "The experiment file has no phases. phases: [...] adds them.",
            )
            return [((none, "muted"),)]
        if self.state.session.study.between_trials:
            return [((say("phases.begin_with_trial", "Phases begin with a trial."), "muted"),)]
        return []

    @property
    def _phases(self) -> Sequence[PhaseView]:
        return self.state.settings.phases

    def choices(self) -> Sequence[ListChoice]:
        """All phases of the file, in its order; a refusal is shown above the hints."""
        state, phases = self.state, self._phases
        width = min(TITLE, max((cell_len(clean(each.heading)) for each in phases), default=1))
        following = next_phase(state.session, phases)
        self.first = phases.index(following) if following is not None else None
        stage, begun = state.session.study.stage, state.session.history(PhaseHistory).begun
        found = []
        for phase in phases:
            mark = self.glyphs.done if phase.name in begun else " "
            parts = []
            if stage is not None and stage.name == phase.name:
                mark = self.glyphs.here
                parts.append(say("phases.is_present", "present"))
            elif phase.after and not can_begin(state.session, phase, phases):
                first, *others = map(state.heading, phase.after)
                for name in others:
                    first = say("phases.or", "{phase} or {other}", phase=first, other=name)
                parts.append(say("phases.after", "after {phases}", phases=first))
            if phase.planned:
                planned = elapsed(round(phase.planned * 1_000_000))
                parts.append(say("phases.planned", "planned {time}", time=planned))
            if phase.panels:
                parts.append(", ".join(phase.panels))
            line = Content.assemble(
                (f"{mark} ", "bold"),
                fit(clean(phase.heading), width, self.glyphs.ellipsis),
                (f"  {clean('; '.join(parts))}", "$woz-muted"),
            )
            asks = partial(self.requests.ask, AskPhase(phase=phase.name, source="key"))
            found.append(ListChoice(line, asks))
        return found
