"""Begins and ends phases, and locks the panels of other phases."""

from __future__ import annotations

from collections.abc import Callable

from woz_tui.config.experiment import Experiment, Phase
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.timeline.study_history import StudyState


class PhaseController:
    """The phases of a session.

    Args:
        publish: Publishes that another one holds.
        state: What holds in the study.
        read: Gives the experiment as its file was read last.
        lock: Locks or unlocks a panel.
        is_locked: Whether a panel is locked.
    """

    def __init__(
        self,
        publish: Callable[[m.PhaseChanged], object],
        state: StudyState,
        *,
        read: Callable[[], Experiment],
        lock: Callable[[str, bool], None],
        is_locked: Callable[[str], bool],
    ) -> None:
        self._publish, self._state, self._read = publish, state, read
        self._lock, self._is_locked = lock, is_locked
        #: Panels that are locked because another phase holds.
        self.locked: set[str] = set()

    @property
    def name(self) -> str:
        """The phase that holds; empty: none."""
        return self._state.phase.label if self._state.phase is not None else ""

    @property
    def current(self) -> Phase | None:
        """The same as the file has it."""
        return self._read().phase(self.name)

    # -- going on ----------------------------------------------------------------------------------

    def phase_to_begin(self, name: str) -> Phase:
        """The phase `name`, or the next one if empty. Raises `RequestError` if it cannot begin."""
        phases = self._read().phases
        if not phases:
            raise RequestError(
                "the experiment has no phases", "add them to the file: phases: [...]"
            )
        self.check_trial()
        if not name:
            following = self._state.next_phase(phases)
            if following is None:
                raise RequestError("no later phase can begin now", "choose one", command="phases")
            return following
        phase = self._read().phase(name)
        if phase is None:
            listed = ", ".join(each.name for each in phases)
            raise RequestError(f"there is no phase {name!r}", f"there are {listed}")
        if name == self.name:
            raise RequestError(f"{phase.heading} is the present phase")
        if not self._state.can_begin(phase, phases):
            before = [each.heading for each in phases if each.name in phase.after]
            raise RequestError(f"{phase.heading} comes after {' or '.join(before)}")
        return phase

    def check_trial(self) -> None:
        """Raises `RequestError` where phases are parts of trials and no trial is under way."""
        if self._state.between_trials:
            raise RequestError("phases begin with a trial", "begin one", command="trial")

    def enter(self, phase: Phase | None, source: str) -> None:
        """Begin this phase; None: no phase holds."""
        self._publish(
            m.PhaseChanged(
                phase=phase.name if phase is not None else "",
                source=source,
                planned_us=round(phase.planned * 1_000_000) if phase is not None else 0,
            )
        )
        self._lock_others(phase)

    def begin_anew(self, source: str) -> Phase | None:
        """Begin with the first one: with a trial, or else where the file has no design. In a study
        with trials no phase holds until one begins.
        """
        experiment = self._read()
        first = experiment.first_phase
        if source == "trial":
            first = next(iter(experiment.phases), None)
        if first is not None or self.name:
            self.enter(first, source)
        return first

    def adopt(self) -> None:
        """Go on with a changed file: with the same phase, if it is still there."""
        if self.name and self.current is None:
            self.enter(None, "reload")
        else:
            self._lock_others(self.current)

    def end(self) -> None:
        """No phase holds any more, as the stream has said."""
        self._lock_others(None)

    def why_locked(self, panel: str) -> str:
        """The phase that has locked a panel, as the end of a sentence; empty: none has."""
        phase = self.current
        return f" in the phase {phase.heading}" if phase and panel in self.locked else ""

    # -- locks -------------------------------------------------------------------------------------

    def _lock_others(self, phase: Phase | None) -> None:
        """Lock the panels of other phases where this one wants it; unlock what another has locked.
        What a hand has locked stays so.
        """
        experiment = self._read()
        others = experiment.locked_by(phase)
        there = {panel.title for panel in experiment.panels}
        for panel in sorted((self.locked - others) & there):
            self._lock(panel, False)
        self.locked &= others
        for panel in sorted(others - self.locked):
            if not self._is_locked(panel):
                self._lock(panel, True)
                self.locked.add(panel)
