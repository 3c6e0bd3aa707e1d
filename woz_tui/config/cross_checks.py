"""Rules across the parts of an experiment: names, keys, the script.

Keys are compared in their normal form, across panels. Two actions whose keys are different but
look alike on a plain terminal (ctrl+i and tab) are no error here: the key map of that terminal
gives one of them a reserve key. What nobody can tell apart, or what would mean stop, is one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from woz_tui.config.actions import ActionDraft
from woz_tui.config.annotated_decoder import values_with_note
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.keys.keymap import FileKeys, typeable
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.drivers.fields import Port


def check_across(
    experiment: Experiment, drafts: Sequence[ActionDraft], report: ProblemReport
) -> None:
    """Check what no single entry can know of; `drafts` are all actions with their paths."""
    _ports(experiment, report)
    _panel_titles(experiment, report)
    _names(drafts, report)
    _keys(drafts, experiment.keyboard, report)
    _script(experiment, report)
    _then(drafts, report)


def _ports(experiment: Experiment, report: ProblemReport) -> None:
    """A serial port has one owner; two would read half of each other's bytes."""
    owner: dict[str, str] = {}
    for spec in experiment.drivers:
        for name, port in values_with_note(spec.settings, Port):
            if port in owner:
                report.error(
                    spec.place,
                    f"drivers.{spec.name}.{name}",
                    f"{quoted(port)} is already the port of {quoted(owner[port])}",
                )
            owner.setdefault(port, spec.name)


def _panel_titles(experiment: Experiment, report: ProblemReport) -> None:
    first: dict[str, int] = {}
    for index, panel in enumerate(experiment.panels):
        if not panel.title:
            continue
        if panel.title in first:
            report.error_at(
                f"panels[{index}].title",
                f"{quoted(panel.title)} is already a panel's title (line {first[panel.title]})",
            )
        first.setdefault(panel.title, panel.place.line)


def _names(drafts: Sequence[ActionDraft], report: ProblemReport) -> None:
    first: dict[str, Action] = {}
    for draft in drafts:
        name = draft.action.name
        if not name:
            continue
        if name in first:
            path = f"{draft.path}.name"
            if (
                report.place(path) == draft.action.place
            ):  # no name of its own: the label counts as one
                path = f"{draft.path}.label"
            report.error_at(
                path,
                f"{quoted(name)} is already the name of an action (line {first[name].place.line});"
                " give one of them another name: ...",
            )
        first.setdefault(name, draft.action)


def check_covers(
    experiment: Experiment, verbs: Collection[str] | None, report: ProblemReport
) -> None:
    """Verbs that a panel's lock covers are offered by somebody; None: not all are known."""
    for index, panel in enumerate(experiment.panels):
        for number, verb in enumerate(panel.covers):
            if verbs is not None and verb not in verbs:
                path = f"panels[{index}].covers[{number}]"
                report.error_at(path, f"no driver offers {quoted(verb)}{report.hint(verb, verbs)}")


def _keys(drafts: Sequence[ActionDraft], layout: str, report: ProblemReport) -> None:
    """Two things on one key, in the file's order."""
    keys = FileKeys(layout)
    for draft in drafts:
        key, path = draft.action.key, f"{draft.path}.key"
        if not key:
            continue
        if forbidden := keys.forbidden(key):
            report.error_at(path, f"{forbidden}; choose another key")
        elif taken := keys.taken(key):
            report.error_at(path, taken)
        else:
            keys.take(key, draft.action.label, draft.action.place)
            if not typeable(key, layout):
                report.warning_at(
                    path,
                    f"the {layout} keyboard has no key for {key!r}; it gets a reserve key"
                    " (set your layout with keyboard:)",
                )


def _script(experiment: Experiment, report: ProblemReport) -> None:
    actions = {action.name: action for panel in experiment.panels for action in panel.actions}
    for index, name in enumerate(experiment.script):
        path = f"script[{index}]"
        if name not in actions:
            near = report.hint(name, actions)
            report.error_at(path, f"there is no action {quoted(name)}{near}")
        elif actions[name].locked:
            report.warning_at(path, f"{quoted(name)} is locked and cannot be played")


def _then(drafts: Sequence[ActionDraft], report: ProblemReport) -> None:
    actions = {draft.action.name: draft.action for draft in drafts}
    for draft in drafts:
        for name in draft.action.then:
            path = f"{draft.path}.then"
            if name not in actions:
                near = report.hint(name, actions)
                report.error_at(path, f"there is no action {quoted(name)}{near}")
            elif actions[name].locked:
                report.warning_at(path, f"{quoted(name)} is locked and cannot be played")
