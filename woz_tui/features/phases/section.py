"""Phases of an experiment: what is in front, what Space plays, which may follow.

phases:
  - {name: opening, title: Opening, panels: [Greeting], script: [Hello, Sit], planned: 2 min}
  - {name: whales, panels: [Whales], after: opening, on_enter: Show the whale}
  - {name: closing, panels: [Bye], after: opening, lock_others: true}
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import msgspec

from woz_tui.config.action_names import check_actions
from woz_tui.config.annotated_decoder import read_entries
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents, plans_trials
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.yaml_cursor import Cursor, check_different, texts_of
from woz_tui.config.yaml_nodes import ListNode
from woz_tui.drivers.fields import (
    Doc,
    Entry,
    NotBlank,
    NotEmpty,
    OneOrMore,
    ReadApart,
    Seconds,
    Unique,
)
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class Phase(Entry):
    """A part of a session or of a trial: what is in front in it, and what Space plays.

    A panel that other phases name and this one does not is folded away; without `panels` all are
    in front. Without a script of its own the experiment's goes on.
    """

    what = Sentence("phases.a_phase", "a phase")
    example = "{name: opening, panels: [...]}"
    either = ("name", "title")
    name: Annotated[str, NotBlank(), Doc("what logs and tables call it (default: the title)")] = ""
    title: Annotated[str, NotBlank(), Doc("what the screen shows (default: the name)")] = ""
    panels: Annotated[tuple[str, ...], Unique(), Doc("titles of the panels in front")] = ()
    script: Annotated[tuple[str, ...], Doc("names of actions; space plays the next one")] = ()
    on_enter: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("check.action_name", "the name of an action")),
        Doc("names of actions played when it begins"),
    ] = ()
    after: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("phases.phase_name", "the name of a phase")),
        Doc("phases, one of which must have begun in the trial before this one"),
    ] = ()
    planned: Annotated[float, Seconds(1.0, 86_400.0), Doc("planned duration")] = 0.0
    lock_others: Annotated[bool, Doc("panels of other phases are locked, not only folded")] = False

    @property
    def heading(self) -> str:
        """Its title, or its name."""
        return self.title or self.name


@dataclass(frozen=True, slots=True)
class PresentPhase:
    """The phase that holds: what the screen calls it, the panels in front (none: all), and those
    that are locked because they belong to others.
    """

    heading: str
    front: tuple[str, ...] = ()
    locked: frozenset[str] = frozenset()


@dataclass(frozen=True, kw_only=True)
class PhaseKeys:
    """The key `phases`."""

    phases: Annotated[
        tuple[Phase, ...],
        ReadApart(),
        NotEmpty(),
        Doc("parts of a trial: panels in front, and which phase may follow"),
    ] = ()


class PhaseSection(FeatureSection[tuple[Phase, ...]]):
    """Phases in the order in which one follows the other, unless the wizard chooses otherwise."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> tuple[Phase, ...]:
        cursor = table.get("phases")
        if cursor is not None and isinstance(cursor.node, ListNode) and not cursor.node.nodes:
            cursor.error(
                Sentence("phases.none_listed", "the list has no phase; add one, or remove phases")
            )
        found = [
            (entry, replace(phase, name=phase.name or phase.title))
            for entry, phase in read_entries(
                cursor, Sentence("phases.list", "a list of phases"), Phase
            )
        ]
        names = [(entry, phase.name) for entry, phase in found]
        check_different(names, Sentence("phases.a_phase", "a phase"), ("name", "title"))
        for entry, phase in found:
            keys = dict(entry.entries())
            _check_panels(keys.get("panels"), [panel.title for panel in contents.panels])
            _check_phases(keys.get("after"), [name for _, name in names])
            for key in ("script", "on_enter"):
                _check_actions(keys.get(key), contents.actions, phase)
        _check_reachable(found)
        return tuple(phase for _, phase in found)

    def trained(self, section: tuple[Phase, ...]) -> tuple[Phase, ...]:
        return ()  # cues want answers of all phases

    def changes(self, old: tuple[Phase, ...], new: tuple[Phase, ...]) -> Iterable[str]:
        before, after = ({phase.name: phase for phase in each} for each in (old, new))
        yield from changed_entries(Sentence("reload.a_phase", "phase"), before, after)
        if [name for name in before if name in after] != [name for name in after if name in before]:
            yield Sentence("reload.phase_order", "phases are in another order")

    # -- which holds -------------------------------------------------------------------------------

    def called(self, experiment: Experiment, name: str) -> Phase | None:
        """The phase called `name`, or None."""
        return next((phase for phase in self.of(experiment) if phase.name == name), None)

    def first(self, experiment: Experiment) -> Phase | None:
        """The phase that holds when a session begins; in a study with trials none does until one
        begins.
        """
        return next(iter(self.of(experiment) if not plans_trials(experiment) else ()), None)

    def at_first(self, experiment: Experiment) -> PresentPhase | None:
        phases, first = self.of(experiment), self.first(experiment)
        if first is None:
            return None
        of_file = [panel.title for panel in experiment.panels if panel.locked]
        return _present(first, phases, of_file)

    def moments(self, experiment: Experiment) -> Iterable[tuple[str, PresentPhase]]:
        phases = self.of(experiment)
        of_file = [panel.title for panel in experiment.panels if panel.locked]
        return (
            (f"in the phase {each.heading}", _present(each, phases, of_file)) for each in phases
        )

    def locks(self, fact: PresentPhase) -> Collection[str]:
        return fact.locked

    # -- what `woz check` says ---------------------------------------------------------------------

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        return (("phase", _in_words(phase, section)) for phase in section)

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        return {"phases": msgspec.to_builtins(self.of(experiment))}


PHASES = PhaseSection(PhaseKeys, ())


def locked_by(phase: Phase | None, phases: Iterable[Phase]) -> frozenset[str]:
    """Panels that are locked while a phase holds, because they belong to others of the `phases`."""
    if phase is None or not phase.lock_others or not phase.panels:
        return frozenset()
    others = {panel for each in phases for panel in each.panels}
    return frozenset(others - {*phase.panels})


def _present(phase: Phase, phases: Iterable[Phase], of_file: Collection[str]) -> PresentPhase:
    """As it holds in a session, where a panel that the file itself locks is not the phase's."""
    return PresentPhase(phase.heading, phase.panels, locked_by(phase, phases) - {*of_file})


def _in_words(phase: Phase, phases: Iterable[Phase]) -> str:
    after = [each.heading for each in phases if each.name in phase.after]
    lines = len(phase.script)
    parts = [
        f"after {' or '.join(after)}" if after else "",
        f"{phase.planned / 60:g} min" if phase.planned else "",
        f"panels {', '.join(phase.panels)}" if phase.panels else "all panels",
        f"{lines} line{'s' if lines > 1 else ''}" if lines else "",
    ]
    return f"{phase.heading}: {'; '.join(part for part in parts if part)}"


def _check_panels(cursor: Cursor | None, known: Collection[str]) -> None:
    for entry, name in texts_of(cursor):
        if name not in known:
            near = entry.report.hint(
                name, known, or_list=Sentence("check.panels_are", "panels are")
            )
            entry.error(
                Sentence(
                    "check.no_panel", "there is no panel {name}{near}", name=quoted(name), near=near
                )
            )


def _check_phases(cursor: Cursor | None, known: Collection[str]) -> None:
    for entry, name in texts_of(cursor):
        if name not in known:
            near = entry.report.hint(
                name, known, or_list=Sentence("phases.phases_are", "phases are")
            )
            entry.error(
                Sentence(
                    "phases.no_such_phase",
                    "there is no phase {name}{near}",
                    name=quoted(name),
                    near=near,
                )
            )


def _check_actions(cursor: Cursor | None, actions: Mapping[str, Action], phase: Phase) -> None:
    for entry, action in check_actions(cursor, actions):
        if phase.panels and action.panel not in phase.panels:
            entry.warning(
                Sentence(
                    "phases.panel_not_in_front",
                    "the panel {panel} is not in front in this phase; add it to panels: [...]",
                    panel=quoted(action.panel),
                )
            )


def _check_reachable(found: Sequence[tuple[Cursor, Phase]]) -> None:
    """Warn of phases that can never begin; the first one begins by itself."""
    reached = {phase.name for _, phase in found[:1]}
    reached |= {phase.name for _, phase in found if not phase.after}
    more = True
    while more:
        new = {phase.name for _, phase in found if reached.intersection(phase.after)} - reached
        reached |= new
        more = bool(new)
    for number, (entry, phase) in enumerate(found):
        after = dict(entry.entries()).get("after")
        if after is not None and not number and phase.after:
            after.warning(
                Sentence(
                    "phases.first_begins",
                    "the first phase begins by itself; after has no effect here",
                )
            )
        elif after is not None and phase.name not in reached:
            after.warning(
                Sentence(
                    "phases.never_begins",
                    "{name} can never begin: none of these phases can",
                    name=quoted(phase.name),
                )
            )
