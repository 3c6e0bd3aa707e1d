"""Rules across the parts of an experiment: names, keys, the script.

Keys are compared in their normal form, across panels. Two actions whose keys are different but
look alike on a plain terminal (ctrl+i and tab) are no error here: the key map of that terminal
gives one of them a reserve key. What nobody can tell apart, or what would mean stop, is one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from woz_tui.core.fields import Port
from woz_tui.experiment.actions import Drafted
from woz_tui.experiment.builtins import BUILTIN
from woz_tui.experiment.keymap import typeable
from woz_tui.experiment.report import Report, quoted
from woz_tui.experiment.settings import noted
from woz_tui.experiment.shape import Action, Experiment
from woz_tui.experiment.terminals import STOPS, is_stop


def across(experiment: Experiment, drafts: Sequence[Drafted], report: Report) -> None:
    """Check what no single entry can know of; `drafts` are all actions with their paths."""
    _ports(experiment, report)
    _panel_titles(experiment, report)
    _names(drafts, report)
    _Keys(experiment.keyboard, report).check(drafts)
    _script(experiment, report)


def _ports(experiment: Experiment, report: Report) -> None:
    """A serial port has one owner; two would read half of each other's bytes."""
    owner: dict[str, str] = {}
    for spec in experiment.drivers:
        for name, port in noted(spec.settings, Port):
            if port in owner:
                report.error(
                    spec.place,
                    f"drivers.{spec.name}.{name}",
                    f"{quoted(port)} is the port of {quoted(owner[port])} already",
                )
            owner.setdefault(port, spec.name)


def _panel_titles(experiment: Experiment, report: Report) -> None:
    first: dict[str, int] = {}
    for index, panel in enumerate(experiment.panels):
        if not panel.title:
            continue
        if panel.title in first:
            path = f"panels[{index}].title"
            place = report.place(path)
            report.error(
                place,
                path,
                f"{quoted(panel.title)} is already a panel's title (line {first[panel.title]})",
            )
        first.setdefault(panel.title, panel.place.line)


def _names(drafts: Sequence[Drafted], report: Report) -> None:
    first: dict[str, Action] = {}
    for draft in drafts:
        name = draft.action.name
        if not name:
            continue
        if name in first:
            path = f"{draft.path}.name"
            place = report.place(path)
            if place == draft.action.place:  # no name of its own: the label counts as one
                path = f"{draft.path}.label"
            report.error(
                report.place(path),
                path,
                f"{quoted(name)} is already the name of an action (line {first[name].place.line});"
                " give one of them another name: ...",
            )
        first.setdefault(name, draft.action)


def covers(experiment: Experiment, verbs: Collection[str] | None, report: Report) -> None:
    """Verbs that a panel's lock covers are offered by somebody; None: not all are known."""
    for index, panel in enumerate(experiment.panels):
        for number, verb in enumerate(panel.covers):
            if verbs is not None and verb not in verbs:
                path = f"panels[{index}].covers[{number}]"
                near = report.hint(verb, verbs)
                report.error(report.place(path), path, f"no driver offers {quoted(verb)}{near}")


class _Keys:
    """Finds two things on one key, in the file's order."""

    def __init__(self, layout: str, report: Report) -> None:
        self._layout = layout
        self._report = report
        self._builtin = {item.chord: item for item in BUILTIN if not item.yields}
        self._played: dict[str, Drafted] = {}
        self._begun: dict[str, Drafted] = {}

    def check(self, drafts: Sequence[Drafted]) -> None:
        for draft in drafts:
            if draft.action.key:
                self._one(draft, draft.action.key)

    def _one(self, draft: Drafted, key: str) -> None:
        first, _, second = key.partition(" ")
        if is_stop(key, self._layout):
            where = "" if key in STOPS else " on some terminals"
            self._error(draft, f"{key!r} means stop{where}; choose another key")
        elif (item := self._builtin.get(first)) is not None:
            self._error(
                draft, f"{first!r} is the console's own key: {item.description}; choose another key"
            )
        elif (other := self._played.get(key)) is not None:
            self._error(draft, f"{key!r} already plays {_shown(other)}")
        elif second and (other := self._played.get(first)) is not None:
            self._error(draft, f"{key!r} can never be finished: {first!r} plays {_shown(other)}")
        elif not second and (other := self._begun.get(key)) is not None:
            self._error(draft, f"{key!r} begins {other.action.key!r}, which plays {_shown(other)}")
        else:
            self._take(draft, key, first if second else "")

    def _take(self, draft: Drafted, key: str, first: str) -> None:
        self._played[key] = draft
        if first:
            self._begun.setdefault(first, draft)
        if not typeable(key, self._layout):
            path = f"{draft.path}.key"
            self._report.warning(
                self._report.place(path),
                path,
                f"the {self._layout} keyboard has no key for {key!r}; it gets a reserve key"
                " (keyboard: sets another layout)",
            )

    def _error(self, draft: Drafted, message: str) -> None:
        path = f"{draft.path}.key"
        self._report.error(self._report.place(path), path, message)


def _shown(draft: Drafted) -> str:
    return f"{quoted(draft.action.label)} (line {draft.action.place.line})"


def _script(experiment: Experiment, report: Report) -> None:
    actions = {action.name: action for panel in experiment.panels for action in panel.actions}
    for index, name in enumerate(experiment.script):
        path = f"script[{index}]"
        if name not in actions:
            near = report.hint(name, actions)
            report.error(report.place(path), path, f"there is no action {quoted(name)}{near}")
        elif actions[name].locked:
            report.warning(report.place(path), path, f"{quoted(name)} is locked, it will not play")
