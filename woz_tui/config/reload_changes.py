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
from woz_tui.protocol.sentence import Sentence


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
    yield from _came_and_went(Sentence("reload.a_driver", "driver"), before, after)
    for name, spec in after.items():
        was = before.get(name)
        if was is None:
            continue
        if was.type != spec.type:
            yield Sentence(
                "reload.driver_type",
                "driver {name!r} is of type {now}, it was {was}",
                name=name,
                now=spec.type,
                was=was.type,
            )
        elif was.at != spec.at:
            yield Sentence(
                "reload.driver_place", "driver {name!r} is at another computer", name=name
            )
        elif was.process != spec.process:
            yield Sentence(
                "reload.driver_process", "driver {name!r} runs in another process", name=name
            )
        elif was.settings != spec.settings:
            changed = [
                setting
                for setting in getattr(spec.settings, "__dataclass_fields__", {})
                if getattr(was.settings, setting) != getattr(spec.settings, setting)
            ]
            yield Sentence(
                "reload.driver_settings",
                "driver {name!r} has other settings: {settings}",
                name=name,
                settings=", ".join(changed),
            )


def _other_changes(old: Experiment, new: Experiment) -> Iterable[str]:
    if old.title != new.title:
        yield Sentence(
            "reload.title", "title is {now!r}, it was {was!r}", now=new.title, was=old.title
        )
    for what in (*("participant_pattern", "language", "keyboard", "session", "sensors", "steps"),):
        if getattr(old, what) != getattr(new, what):
            yield section_changed(what.replace("_", " "))
    yield from _conditions(old, new)
    if old.engagement is not None and new.engagement is not None:
        yield from _engagement(old.engagement, new.engagement)
    elif old.engagement is not new.engagement:
        yield came_or_went("engagement", new=old.engagement is None)
    was, now = old.study, new.study
    yield from changed_entries(
        Sentence("reload.a_variable", "variable"),
        {**old.variables, **old.by_condition},
        {**new.variables, **new.by_condition},
    )
    yield from changed_entries(
        "preflight", dict.fromkeys(was.preflight), dict.fromkeys(now.preflight)
    )
    yield from changed_settings("perception", was.perception, now.perception)
    if was.answers != now.answers:
        yield section_changed("answers")
    yield from _panels(old, new)
    yield from _actions(old, new)
    for name, section in pieces("section", FeatureSection).items():
        yield from answers_of(name, section.changes, section.of(old), section.of(new))


def _conditions(old: Experiment, new: Experiment) -> Iterable[str]:
    if old.conditions != new.conditions:
        yield (
            Sentence("reload.conditions", "conditions are {names}", names=", ".join(new.conditions))
            if new.conditions
            else Sentence("reload.no_conditions", "conditions are none")
        )


def _engagement(old: Engagement, new: Engagement) -> Iterable[str]:
    for what in _settings(old.settings, new.settings):
        yield Sentence(
            "reload.setting_of", "{section}: {change}", section="engagement", change=what
        )
    before = {action.name: action for action in old.effects.values()}
    after = {action.name: action for action in new.effects.values()}
    yield from _came_and_went(Sentence("reload.an_effect", "effect"), before, after)
    for name, action in after.items():
        if name in before and essences(before[name]) != essences(action):
            yield Sentence("reload.effect", "effect {name!r} does something else", name=name)
    for state in dict.fromkeys([*old.plays, *new.plays]):
        was, now = old.plays.get(state, ()), new.plays.get(state, ())
        if was != now:
            yield Sentence(
                "reload.effect_plays",
                "on {state} plays {now}, it was {was}",
                state=state,
                now=_listed(now),
                was=_listed(was),
            )


def changed_settings(what: str, old: object | None, new: object | None) -> Iterable[str]:
    """Whether a section came or went, or which of its settings changed."""
    if old is None or new is None:
        yield from () if old is new else (came_or_went(what, new=old is None),)
    else:
        for changed in _settings(old, new):
            yield Sentence("reload.setting_of", "{section}: {change}", section=what, change=changed)


def section_changed(name: str) -> Sentence:
    """That something is not what it was in a section whose settings are not compared."""
    return Sentence("reload.section", "{section} changed", section=name)


def came_or_went(name: str, *, new: bool) -> Sentence:
    """That a section is `new`, or not there any more."""
    if new:
        return Sentence("reload.section_new", "{section} is new", section=name)
    return Sentence("reload.section_removed", "{section} is removed", section=name)


def _settings(old: object, new: object, prefix: str = "") -> Iterable[str]:
    """`gaze.samples 9, it was 8`: each setting that differs, those of its parts included."""
    for item in dataclasses.fields(new) if dataclasses.is_dataclass(new) else ():
        was, now = getattr(old, item.name), getattr(new, item.name)
        if dataclasses.is_dataclass(now):
            yield from _settings(was, now, f"{prefix}{item.name}.")
        elif was != now:
            yield Sentence(
                "reload.setting",
                "{name} {now}, it was {was}",
                name=f"{prefix}{item.name}",
                now=_as_written(now),
                was=_as_written(was),
            )


def _as_written(value: object) -> str:
    """A setting's value as a file would have it."""
    match value:
        case None:
            return Sentence("reload.not_set", "not set")
        case bool():
            return "on" if value else "off"
        case float():
            return f"{value:g}"
        case tuple():
            return _listed(value)
        case Mapping():
            return _listed([f"{name} {each}" for name, each in value.items()])
        case _:
            return str(value) or Sentence("reload.not_set", "not set")


def _listed(values: Sequence[object]) -> str:
    return ", ".join(map(str, values)) or Sentence("reload.nothing", "nothing")


def _panels(old: Experiment, new: Experiment) -> Iterable[str]:
    before = {panel.title: panel for panel in old.panels}
    after = {panel.title: panel for panel in new.panels}
    yield from _came_and_went(Sentence("reload.a_panel", "panel"), before, after)
    for title, panel in after.items():
        if title in before and before[title].locked != panel.locked:
            yield (
                Sentence("reload.panel_locked", "panel {panel!r} is locked", panel=title)
                if panel.locked
                else Sentence("reload.panel_unlocked", "panel {panel!r} is unlocked", panel=title)
            )
        if title in before and before[title].covers != panel.covers:
            yield Sentence(
                "reload.panel_covers",
                "the lock of panel {panel!r} covers {verbs}",
                panel=title,
                verbs=", ".join(panel.covers) or Sentence("reload.no_verbs", "no verbs"),
            )
        if title in before and before[title].parts != panel.parts:
            yield Sentence(
                "reload.panel_for",
                "panel {panel!r} is for {parts}",
                panel=title,
                parts=", ".join(panel.parts) or Sentence("reload.no_part", "no part in particular"),
            )
    common = [title for title in before if title in after]
    if common != [title for title in after if title in before]:
        yield Sentence("reload.panel_order", "panels are in another order")


def _actions(old: Experiment, new: Experiment) -> Iterable[str]:
    before = {action.name: action for panel in old.panels for action in panel.actions}
    after = {action.name: action for panel in new.panels for action in panel.actions}
    yield from _came_and_went(Sentence("reload.an_action", "action"), before, after)
    for name, action in after.items():
        if name in before:
            parts = list(_action(before[name], action))
            if parts:
                yield Sentence(
                    "reload.action", "action {name!r}: {changes}", name=name, changes=_row(parts)
                )
    for title in dict.fromkeys(panel.title for panel in new.panels):
        kept = [action.name for action in before.values() if _stayed(action, after, title)]
        now = [action.name for action in after.values() if _stayed(action, before, title)]
        if kept != now:
            yield Sentence(
                "reload.action_order",
                "panel {panel!r} has its actions in another order",
                panel=title,
            )


def _row(changes: Sequence[str]) -> str:
    """Several changes of one thing, each in its words."""
    first, *others = changes
    for other in others:
        first = Sentence("reload.row", "{first}, {other}", first=first, other=other)
    return first


def _stayed(action: Action, others: Mapping[str, Action], title: str) -> bool:
    other = others.get(action.name)
    return other is not None and action.panel == title == other.panel


def _action(old: Action, new: Action) -> Iterable[str]:
    if old.key != new.key:
        none = Sentence("reload.no_key", "none")
        yield Sentence(
            "reload.key", "key {now}, was {was}", now=new.key or none, was=old.key or none
        )
    if old.label != new.label:
        yield Sentence("reload.label", "label {label!r}", label=new.label)
    if old.panel != new.panel:
        yield Sentence("reload.in_panel", "panel {panel!r}", panel=new.panel)
    if old.when_busy != new.when_busy:
        yield Sentence(
            "reload.when_busy", "when busy {does!r}", does=str(new.when_busy or "as usual")
        )
    if old.locked != new.locked:
        yield (
            Sentence("reload.locked", "locked")
            if new.locked
            else Sentence("reload.unlocked", "unlocked")
        )
    if old.then != new.then:
        yield Sentence("reload.then", "then {actions}", actions=_listed(new.then))
    if old.help != new.help:
        yield Sentence("reload.help", "help changed")
    was, now = _sentences(old), _sentences(new)
    if was and now and was != now:
        yield Sentence(
            "reload.says", "says: {was} -> {now}", was=" / ".join(was), now=" / ".join(now)
        )
        old, new = _without_words(old), _without_words(new)
    if essences(old) != essences(new):
        yield Sentence("reload.does_else", "does something else")


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
    """Which named entries came, went or changed; `what`: what each of them is."""
    yield from _came_and_went(what, old, new)
    for name in new:
        if name in old and old[name] != new[name]:
            yield Sentence("reload.entry", "{what} {name!r} changed", what=what, name=name)


def _came_and_went(
    what: str, old: Mapping[str, object], new: Mapping[str, object]
) -> Iterable[str]:
    for name in old:
        if name not in new:
            yield Sentence(
                "reload.entry_removed", "{what} {name!r} was removed", what=what, name=name
            )
    for name in new:
        if name not in old:
            yield Sentence("reload.entry_new", "{what} {name!r} is new", what=what, name=name)
