"""Which phases have begun, and which may follow."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar, Protocol, TypeVar

from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, StageEpisode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment

#: Sources of a change with which the phases begin anew.
RESTARTING_SOURCES = ("trial", "session")


class PhaseLike(Protocol):
    """A phase of the experiment file, or what a console is shown of it."""

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def after(self) -> Sequence[str]:
        """It can begin once one of these has begun; none: at any time."""
        ...


P = TypeVar("P", bound=PhaseLike)


class PhaseHistory(FeatureHistory):
    """The phases that have begun. Which one holds is said by the study: it is the present stage."""

    deeds = (PhaseChanged,)

    def __init__(self) -> None:
        #: Since the trial or the participant's session began, by name: the first line of each.
        self.begun: dict[str, PhaseChanged] = {}

    def _change(self, message: PhaseChanged, state: SessionState) -> Iterable[Episode]:
        """Another phase holds, or none; with a trial or a session all of them begin anew."""
        if message.source in RESTARTING_SOURCES:
            self.begun = {}
        stage = None
        if name := message.phase:
            stage = StageEpisode(
                begin=state.t,
                seq=message.seq,
                name=name,
                by=message.source,
                planned_us=message.planned_us,
                began=message,
            )
            if name not in self.begun:
                keep_latest(self.begun, name, message)
        return [*state.study.change_stage(stage, message, state.t)] or moment(message, state.t)

    def _begin_anew(self, message: m.TrialStarted | m.TrialEnded, state: SessionState) -> None:
        self.begun = {}

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        PhaseChanged: _change,
        m.TrialStarted: _begin_anew,
        m.TrialEnded: _begin_anew,
    }


def can_begin(state: SessionState, phase: PhaseLike, phases: Sequence[PhaseLike]) -> bool:
    """Whether this one of the file's `phases` can begin now; in a trial whatever has begun once
    can.
    """
    begun = state.history(PhaseHistory).begun
    follows = not phase.after or phase is phases[0] or begun.keys() & {*phase.after}
    return bool(follows) and not state.study.between_trials


def next_phase(state: SessionState, phases: Sequence[P]) -> P | None:
    """The first of the file's `phases` behind the present one that can begin now."""
    present = state.study.stage.name if state.study.stage is not None else ""
    places = [place for place, each in enumerate(phases) if each.name == present]
    behind = phases[places[0] + 1 :] if places else phases
    return next((each for each in behind if can_begin(state, each, phases)), None)
