"""What changed between two readings of an experiment, in words."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.experiment import (
    Action,
    Call,
    Engagement,
    Experiment,
    ParallelCalls,
    Wait,
)
from woz_tui.config.feature_section import FeatureSection
from woz_tui.feature import answers_of, pieces


@dataclass(frozen=True, slots=True)
class ReloadChanges:
    """`changes`: every difference in words, those of the drivers first; `telling`: those of them
    that may tell which condition is which.

    `drivers`: the differences of the drivers alone. They cannot be swapped in a running session,
    so a reload is possible only if there are none.
    """

    changes: tuple[str, ...]
    drivers: tuple[str, ...]
    telling: tuple[str, ...] = ()


def compare(old: Experiment, new: Experiment) -> ReloadChanges:
    """The differences between two readings."""
    drivers = tuple(_drivers(old, new))
    telling = [*_conditions(old, new)]
    for name, section in pieces("section", FeatureSection).items():
        if section.tells_condition:
            telling += answers_of(name, section.changes, section.of(old), section.of(new))
    return ReloadChanges((*drivers, *_other_changes(old, new)), drivers, tuple(telling))


def _drivers(old: Experiment, new: Experiment) -> Iterable[str]:
    before = {spec.name: spec for spec in old.drivers}
    after = {spec.name: spec for spec in new.drivers}
    yield from _came_and_went("driver", before, after)
    for name, spec in after.items():
        was = before.get(name)
        if was is None:
            continue
        if was.type != spec.type:
            yield f"driver {name!r} is of type {spec.type}, it was {was.type}"
        elif was.at != spec.at:
            yield f"driver {name!r} is at another computer"
        elif was.process != spec.process:
            yield f"driver {name!r} runs in another process"
        elif was.settings != spec.settings:
            changed = [
                setting
                for setting in getattr(spec.settings, "__dataclass_fields__", {})
                if getattr(was.settings, setting) != getattr(spec.settings, setting)
            ]
            yield f"driver {name!r} has other settings: {', '.join(changed)}"


def _other_changes(old: Experiment, new: Experiment) -> Iterable[str]:
    if old.title != new.title:
        yield f"title is {new.title!r}, it was {old.title!r}"
    for what in (*("participant_pattern", "language", "keyboard", "session", "sensors", "steps"),):
        if getattr(old, what) != getattr(new, what):
            yield f"{what.replace('_', ' ')} changed"
    yield from _conditions(old, new)
    if old.engagement is not None and new.engagement is not None:
        yield from _engagement(old.engagement, new.engagement)
    elif old.engagement is not new.engagement:
        yield f"engagement is {'new' if old.engagement is None else 'removed'}"
    was, now = old.study, new.study
    yield from changed_entries(
        "variable",
        {**old.variables, **old.by_condition},
        {**new.variables, **new.by_condition},
    )
    yield from changed_entries(
        "preflight", dict.fromkeys(was.preflight), dict.fromkeys(now.preflight)
    )
    yield from changed_settings("perception", was.perception, now.perception)
    if was.answers != now.answers:
        yield "answers changed"
    yield from _panels(old, new)
    yield from _actions(old, new)
    for name, section in pieces("section", FeatureSection).items():
        yield from answers_of(name, section.changes, section.of(old), section.of(new))


def _conditions(old: Experiment, new: Experiment) -> Iterable[str]:
    if old.conditions != new.conditions:
        yield f"conditions are {', '.join(new.conditions) or 'none'}"


def _engagement(old: Engagement, new: Engagement) -> Iterable[str]:
    for what in _settings(old.settings, new.settings):
        yield f"engagement: {what}"
    before = {action.name: action for action in old.effects.values()}
    after = {action.name: action for action in new.effects.values()}
    yield from _came_and_went("effect", before, after)
    for name, action in after.items():
        if name in before and essences(before[name]) != essences(action):
            yield f"effect {name!r} does something else"
    for state in dict.fromkeys([*old.plays, *new.plays]):
        was, now = old.plays.get(state, ()), new.plays.get(state, ())
        if was != now:
            yield f"on {state} plays {_listed(now)}, it was {_listed(was)}"


def changed_settings(what: str, old: object | None, new: object | None) -> Iterable[str]:
    """Whether a section came or went, or which of its settings changed."""
    if old is None or new is None:
        yield from () if old is new else (f"{what} is {'new' if old is None else 'removed'}",)
    else:
        yield from (f"{what}: {changed}" for changed in _settings(old, new))


def _settings(old: object, new: object, prefix: str = "") -> Iterable[str]:
    """`gaze.samples 9, it was 8`: each setting that differs, those of its parts included."""
    for item in dataclasses.fields(new) if dataclasses.is_dataclass(new) else ():
        was, now = getattr(old, item.name), getattr(new, item.name)
        if dataclasses.is_dataclass(now):
            yield from _settings(was, now, f"{prefix}{item.name}.")
        elif was != now:
            yield f"{prefix}{item.name} {_as_written(now)}, it was {_as_written(was)}"


def _as_written(value: object) -> str:
    """A setting's value as a file would have it."""
    match value:
        case None:
            return "not set"
        case bool():
            return "on" if value else "off"
        case float():
            return f"{value:g}"
        case tuple():
            return _listed(value)
        case Mapping():
            return _listed([f"{name} {each}" for name, each in value.items()])
        case _:
            return str(value) or "not set"


def _listed(values: Sequence[object]) -> str:
    return ", ".join(map(str, values)) or "nothing"


def _panels(old: Experiment, new: Experiment) -> Iterable[str]:
    before = {panel.title: panel for panel in old.panels}
    after = {panel.title: panel for panel in new.panels}
    yield from _came_and_went("panel", before, after)
    for title, panel in after.items():
        if title in before and before[title].locked != panel.locked:
            yield f"panel {title!r} is {'locked' if panel.locked else 'unlocked'}"
        if title in before and before[title].covers != panel.covers:
            yield f"the lock of panel {title!r} covers {', '.join(panel.covers) or 'no verbs'}"
        if title in before and before[title].parts != panel.parts:
            yield f"panel {title!r} is for {', '.join(panel.parts) or 'no part in particular'}"
    common = [title for title in before if title in after]
    if common != [title for title in after if title in before]:
        yield "panels are in another order"


def _actions(old: Experiment, new: Experiment) -> Iterable[str]:
    before = {action.name: action for panel in old.panels for action in panel.actions}
    after = {action.name: action for panel in new.panels for action in panel.actions}
    yield from _came_and_went("action", before, after)
    for name, action in after.items():
        if name in before:
            parts = list(_action(before[name], action))
            if parts:
                yield f"action {name!r}: {', '.join(parts)}"
    for title in dict.fromkeys(panel.title for panel in new.panels):
        kept = [action.name for action in before.values() if _stayed(action, after, title)]
        now = [action.name for action in after.values() if _stayed(action, before, title)]
        if kept != now:
            yield f"panel {title!r} has its actions in another order"


def _stayed(action: Action, others: Mapping[str, Action], title: str) -> bool:
    other = others.get(action.name)
    return other is not None and action.panel == title == other.panel


def _action(old: Action, new: Action) -> Iterable[str]:
    if old.key != new.key:
        yield f"key {new.key or 'none'}, was {old.key or 'none'}"
    for what in ("label", "panel"):
        if getattr(old, what) != getattr(new, what):
            yield f"{what} {getattr(new, what)!r}"
    if old.when_busy != new.when_busy:
        yield f"when busy {new.when_busy or 'as usual'!r}"
    if old.locked != new.locked:
        yield "locked" if new.locked else "unlocked"
    if old.then != new.then:
        yield f"then {_listed(new.then)}"
    if old.help != new.help:
        yield "help changed"
    was, now = _sentences(old), _sentences(new)
    if was and now and was != now:
        yield f"says: {' / '.join(was)} -> {' / '.join(now)}"
        old, new = _without_words(old), _without_words(new)
    if essences(old) != essences(new):
        yield "does something else"


def _sentences(action: Action) -> list[str]:
    """What it says, as the file has it; nothing where it is chosen when it is played, as the
    condition may decide.
    """
    said = [call.args.get("text") for call in action.calls if call.verb == "say"]
    return [str(text) for text in said if text]


def _without_words(action: Action) -> Action:
    """The same, saying the same as every other one."""

    def silent(call: Call) -> Call:
        said = call.verb == "say" and "text" in call.args
        return dataclasses.replace(call, args={**call.args, "text": ""}) if said else call

    steps = [
        dataclasses.replace(step, calls=tuple(map(silent, step.calls)))
        if isinstance(step, ParallelCalls)
        else step
        for step in action.steps
    ]
    return dataclasses.replace(action, steps=tuple(steps))


def essences(action: Action) -> list[object]:
    """What an action does, without the places in the file, which move with every line above."""
    return [
        step.seconds
        if isinstance(step, Wait)
        else [
            (call.driver, call.verb, call.until, {**call.args, **call.choices})
            for call in step.calls
        ]
        for step in action.steps
    ]


def changed_entries(
    what: str, old: Mapping[str, object], new: Mapping[str, object]
) -> Iterable[str]:
    """Which named entries came, went or changed."""
    yield from _came_and_went(what, old, new)
    yield from (
        f"{what} {name!r} changed" for name in new if name in old and old[name] != new[name]
    )


def _came_and_went(
    what: str, old: Mapping[str, object], new: Mapping[str, object]
) -> Iterable[str]:
    yield from (f"{what} {name!r} was removed" for name in old if name not in new)
    yield from (f"{what} {name!r} is new" for name in new if name not in old)
