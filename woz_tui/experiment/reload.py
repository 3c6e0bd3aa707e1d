"""What changed between two readings of an experiment file, in words."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.experiment.shape import Action, Experiment


@dataclass(frozen=True, slots=True)
class Difference:
    """`changes` can be adopted while the session runs; `drivers` cannot."""

    changes: tuple[str, ...]
    drivers: tuple[str, ...]


def compare(old: Experiment, new: Experiment) -> Difference:
    """Every difference between two readings, panels and actions in the file's order."""
    return Difference(
        changes=(
            *_words("title", old.title, new.title),
            *_panels(old, new),
            *_actions(old, new),
            *_words("script", old.script, new.script),
            *_words("conditions", old.conditions, new.conditions),
            *_words("participants", old.participant_pattern, new.participant_pattern),
            *_words("variables", dict(old.variables), dict(new.variables)),
            *_words("keyboard", old.keyboard, new.keyboard),
            *_words("session settings", old.session, new.session),
            *_words("engagement", dict(old.sections), dict(new.sections)),
        ),
        drivers=_drivers(old, new),
    )


def _words(what: str, old: object, new: object) -> list[str]:
    if old == new:
        return []
    if isinstance(old, str) and isinstance(new, str):
        return [f"{what}: {old!r} is now {new!r}"]
    return [f"{what} changed"]


def _panels(old: Experiment, new: Experiment) -> list[str]:
    before = {panel.title: panel for panel in old.panels}
    after = {panel.title: panel for panel in new.panels}
    words = [f"panel {title!r} is new" for title in after if title not in before]
    words += [f"panel {title!r} is gone" for title in before if title not in after]
    words += [
        f"panel {title!r} is now {'locked' if panel.locked else 'unlocked'} at the start"
        for title, panel in after.items()
        if title in before and before[title].locked != panel.locked
    ]
    if not words and list(before) != list(after):
        words.append("the panels are in another order")
    return words


def _actions(old: Experiment, new: Experiment) -> list[str]:
    before = {action.name: action for panel in old.panels for action in panel.actions}
    after = {action.name: action for panel in new.panels for action in panel.actions}
    words = [
        f"{name!r} is new ({_key(action)})" for name, action in after.items() if name not in before
    ]
    words += [f"{name!r} is gone" for name in before if name not in after]
    for name, action in after.items():
        if name in before:
            words += [f"{name!r}: {change}" for change in _changes(before[name], action)]
    if not words and list(before) != list(after):
        words.append("the actions are in another order")
    return words


def _changes(old: Action, new: Action) -> list[str]:
    words = []
    if old.key != new.key:
        words.append(f"{_key(old)} is now {_key(new)}")
    if old.label != new.label:
        words.append(f"its label is now {new.label!r}")
    if old.panel != new.panel:
        words.append(f"it moved to the panel {new.panel!r}")
    if _content(old) != _content(new):
        words.append("it does something else")
    if old.locked != new.locked:
        words.append("it is now locked" if new.locked else "it is no longer locked")
    if old.help != new.help:
        words.append("its help changed")
    return words


def _key(action: Action) -> str:
    return f"key {action.key}" if action.key else "no key"


def _content(action: Action) -> tuple[object, ...]:
    """What the action does, without the places in the file, which shift with every edit."""
    steps: list[object] = []
    for step in action.steps:
        calls = getattr(step, "calls", None)
        if calls is None:
            steps.append(step)
        else:
            steps.append([(call.verb, dict(call.args), call.driver) for call in calls])
    return (steps, action.when_busy)


def _drivers(old: Experiment, new: Experiment) -> tuple[str, ...]:
    before = {spec.name: (spec.type, spec.settings) for spec in old.drivers}
    after = {spec.name: (spec.type, spec.settings) for spec in new.drivers}
    words = [f"{name!r} is new" for name in after if name not in before]
    words += [f"{name!r} is gone" for name in before if name not in after]
    words += [
        f"{name!r} has other settings"
        for name in after
        if name in before and before[name] != after[name]
    ]
    return tuple(words)
