"""Begins and ends phases, and locks the panels of other phases."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, ClassVar

from woz_tui.config.experiment import Experiment
from woz_tui.features.phases.history import can_begin, next_phase
from woz_tui.features.phases.kinds import AskPhase, PhaseChanged
from woz_tui.features.phases.section import PHASES, Phase, PresentPhase, locked_by
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

#: What has locked a panel, or played an action, where a phase did.
SOURCE = "phase"


class PhaseController(SessionFeature):
    """The phases of a session."""

    requests = (AskPhase,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        #: The phase that holds; empty: none.
        self.name = ""
        #: Panels that are locked because another phase holds.
        self.locked: set[str] = set()

    @property
    def current(self) -> Phase | None:
        """The same as the file has it."""
        return PHASES.called(self.session.experiment, self.name) if self.name else None

    def idle(self) -> bool:
        return not (PHASES.of(self.session.experiment) or self.name or self.locked)

    # -- going on ----------------------------------------------------------------------------------

    def begin(self) -> None:
        self._begin_with(PHASES.first(self.session.experiment), "session")

    def begin_anew(self, *, participant: bool) -> None:
        """With another trial phases begin as soon as that does, in a session with trials."""
        study = self.session.state.study
        if participant or (study.last_started is None and study.trial is None):
            self.begin()

    def _trial_began(self, message: m.TrialStarted) -> None:
        phase = next(iter(PHASES.of(self.session.experiment)), None)
        self._begin_with(phase, "trial")
        self._play_on_enter(phase, RequestOrigin(SOURCE))

    def _begin_with(self, phase: Phase | None, source: str) -> None:
        """Begin with the first one; None: no phase holds until a trial begins."""
        if phase is not None or self.name:
            self.enter(phase, source)

    def carry_out(self, request: AskPhase, client: Client) -> str:
        self.go_on(request.phase, RequestOrigin(request.source, request.key, client.console))
        return ""

    def go_on(self, name: str, origin: RequestOrigin) -> None:
        """Go on to the phase `name`, or with an empty one to the next, and play what it begins
        with.
        """
        phase = self._phase_to_begin(name)
        self.enter(phase, origin.source)
        self._play_on_enter(phase, origin)

    def _phase_to_begin(self, name: str) -> Phase:
        """The phase `name`, or the next one if empty. Raises `RequestError` if it cannot begin."""
        experiment = self.session.experiment
        phases = PHASES.of(experiment)
        if not phases:
            raise RequestError(
                Sentence("phases.none", "the experiment has no phases"),
                Sentence("phases.add", "add them to the file: phases: [...]"),
            )
        if self.session.state.study.between_trials:
            raise RequestError(
                Sentence("phases.with_trial", "phases begin with a trial"),
                Sentence("study.begin_one", "begin one"),
                command="trial",
            )
        if not name:
            following = next_phase(self.session.state, phases)
            if following is None:
                raise RequestError(
                    Sentence("phases.no_later", "no later phase can begin now"),
                    Sentence("phases.choose", "choose one"),
                    command="phases",
                )
            return following
        phase = PHASES.called(experiment, name)
        if phase is None:
            listed = ", ".join(each.name for each in phases)
            raise RequestError(
                Sentence("phases.unknown", "there is no phase {name!r}", name=name),
                Sentence("gate.there_are", "there are {names}", names=listed),
            )
        if name == self.name:
            raise RequestError(
                Sentence(
                    "phases.present",
                    "{heading} is the present phase",
                    heading=phase.heading,
                )
            )
        if not can_begin(self.session.state, phase, phases):
            before = [each.heading for each in phases if each.name in phase.after]
            raise RequestError(
                Sentence(
                    "phases.comes_after",
                    "{heading} comes after {names}",
                    heading=phase.heading,
                    names=" or ".join(before),
                )
            )
        return phase

    def enter(self, phase: Phase | None, source: str) -> None:
        """Begin this phase; None: no phase holds."""
        self.name = phase.name if phase is not None else ""
        planned_us = round(phase.planned * 1_000_000) if phase is not None else 0
        self.session.hub.publish(
            PhaseChanged(phase=self.name, source=source, planned_us=planned_us)
        )
        self._lock_others(phase)

    def _play_on_enter(self, phase: Phase | None, origin: RequestOrigin) -> None:
        """What is refused is in the log, and on every screen."""
        for name in phase.on_enter if phase is not None else ():
            with contextlib.suppress(RequestError):
                self.session.play(name, replace(origin, source=SOURCE))

    def adopt(self, experiment: Experiment) -> None:
        """With the same phase, if it is still there."""
        if self.name and self.current is None:
            self.enter(None, "reload")
        else:
            self._lock_others(self.current)

    def _trial_ended(self, message: m.TrialEnded) -> None:
        """No phase holds any more: with a trial its phase ends."""
        if not self.session.ended:
            self.name = ""
            self._lock_others(None)

    # -- what follows from it ----------------------------------------------------------------------

    def front(self) -> tuple[str, ...]:
        return phase.panels if (phase := self.current) is not None else ()

    def fact(self) -> PresentPhase | None:
        if (phase := self.current) is None:
            return None
        locked = frozenset(panel for panel in self.locked if self.session.locked.get(panel))
        return PresentPhase(phase.heading, phase.panels, locked)

    # -- locks -------------------------------------------------------------------------------------

    def _panel_locked(self, message: m.PanelLocked) -> None:
        """What a hand has locked no phase unlocks."""
        if message.locked and message.source != SOURCE:
            self.locked.discard(message.panel)

    def _lock_others(self, phase: Phase | None) -> None:
        """Lock the panels of other phases where this one wants it; unlock what another has locked.
        What a hand has locked stays so.
        """
        experiment, session = self.session.experiment, self.session
        others = locked_by(phase, PHASES.of(experiment))
        there = {panel.title for panel in experiment.panels}
        for panel in sorted((self.locked - others) & there):
            session.set_lock(panel, False, SOURCE)
        self.locked &= others
        for panel in sorted(others - self.locked):
            if not session.locked.get(panel):
                session.set_lock(panel, True, SOURCE)
                self.locked.add(panel)

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {
        m.TrialStarted: _trial_began,
        m.TrialEnded: _trial_ended,
        m.PanelLocked: _panel_locked,
    }
