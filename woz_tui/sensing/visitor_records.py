"""Named visitors, the changes of their list, and its text in a file.

A change is a function that fits onto a list or does not (`VisitorRefusedError`). So a change that
could not be written down can be made again on whatever the file holds by then.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from datetime import date
from typing import Any

import msgspec
from msgspec.structs import replace

from woz_tui.config.visitor_names import (
    VisitorNameError,
    key_of,
    label_of,
    name_of,
    quoted_name,
    word_of,
)

FORMAT = "woz-tui visitors"
VERSION = 1
#: What to do about a damaged file.
MEND = "mend it by hand or move it away; it was left as it is"


class VisitorsError(Exception):
    """Something about the store; `reason` says what, `remedy` what to do about it."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(f"{reason}; {remedy}")
        self.reason = reason
        self.remedy = remedy


class VisitorRefusedError(VisitorsError):
    """The change does not fit: nothing was changed anywhere."""


class VisitorFileError(VisitorsError):
    """The file cannot be used as it is; it was left as it is."""


class UnsavedError(VisitorsError):
    """The change was made, but only here, in memory: the file could not be written."""


class Visitor(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """One visitor. Only `name` is always there.

    `labels` are what recognisers call the face. `first_met` and `last_met` are days
    (2026-03-01), empty if unknown; `meetings` counts how often they came.
    """

    name: str
    age_group: str = ""
    address: str = ""
    labels: tuple[str, ...] = ()
    first_met: str = ""
    last_met: str = ""
    meetings: int = 0

    @property
    def about(self) -> dict[str, str]:
        """What is known of them beside the name, for messages and templates."""
        facts = {"age_group": self.age_group, "address": self.address}
        return {name: value for name, value in facts.items() if value}


#: Visitors by `key_of` their names.
People = Mapping[str, Visitor]
Change = Callable[[People], dict[str, Visitor]]


# -- changes ------------------------------------------------------------------------------------


def added(visitor: Visitor) -> Change:
    """Somebody new. Refused if the name, or a label, is taken."""

    def change(people: People) -> dict[str, Visitor]:
        _free(people, visitor.name)
        for label in visitor.labels:
            _free(people, label, label=True)
        return {**people, key_of(visitor.name): visitor}

    return change


def met(name: str, on: date) -> Change:
    """A visitor came again on that day."""

    def change(visitor: Visitor) -> Visitor:
        day = on.isoformat()
        return replace(
            visitor,
            first_met=min(visitor.first_met or day, day),
            last_met=max(visitor.last_met, day),
            meetings=visitor.meetings + 1,
        )

    return _changed(name, change)


def labelled(name: str, label: str) -> Change:
    """A recogniser calls the visitor's face `label`. Refused if somebody else has it."""

    def change(people: People) -> dict[str, Visitor]:
        visitor = _visitor_named(people, name)
        if key_of(label) in map(key_of, visitor.labels):
            return dict(people)
        if key_of(label) != key_of(name):
            _free(people, label, label=True)
        return {**people, key_of(name): replace(visitor, labels=(*visitor.labels, label))}

    return change


def profiled(name: str, facts: Mapping[str, str], *, anew: bool) -> Change:
    """Facts about a visitor. Where another value stands already: refused unless `anew`."""

    def change(visitor: Visitor) -> Visitor:
        for fact, value in facts.items():
            old: str = getattr(visitor, fact)
            if old and value != old and not anew:
                raise VisitorRefusedError(
                    f"{visitor.name} has {fact} {quoted_name(old)}, not {quoted_name(value)}",
                    f"woz visitors profile {visitor.name} changes it",
                )
        return replace(
            visitor,
            age_group=facts.get("age_group", visitor.age_group),
            address=facts.get("address", visitor.address),
        )

    return _changed(name, change)


def renamed(old: str, new: str) -> Change:
    """Another name for a visitor; labels stay. Refused if somebody else has it."""

    def change(people: People) -> dict[str, Visitor]:
        visitor = _visitor_named(people, old)
        rest = {key: one for key, one in people.items() if key != key_of(old)}
        _free(rest, new)
        return {**rest, key_of(new): replace(visitor, name=new)}

    return change


def forgotten(*names: str) -> Change:
    """Nothing is left of these visitors."""

    def change(people: People) -> dict[str, Visitor]:
        keys = {key_of(_visitor_named(people, name).name) for name in names}
        return {key: one for key, one in people.items() if key not in keys}

    return change


def both(first: Change, second: Change) -> Change:
    """Two changes, of which none is made if one does not fit."""
    return lambda people: second(first(people))


def _changed(name: str, change: Callable[[Visitor], Visitor]) -> Change:
    return lambda people: {**people, key_of(name): change(_visitor_named(people, name))}


def _visitor_named(people: People, name: str) -> Visitor:
    visitor = people.get(key_of(name))
    if visitor is None:
        raise VisitorRefusedError(
            f"there is no visitor {quoted_name(name)}", "woz visitors list shows them all"
        )
    return visitor


def _free(people: People, name: str, *, label: bool = False) -> None:
    owner = owner_of(people, name)
    if owner is not None:
        raise _taken(name, owner, label=label)


def _taken(name: str, owner: Visitor, *, label: bool) -> VisitorRefusedError:
    what = f"{'the face label' if label else 'the name'} {quoted_name(name)} is taken"
    if key_of(owner.name) == key_of(name):
        return VisitorRefusedError(
            f"{what}: there is a visitor {quoted_name(owner.name)}",
            "take another one, or rename or forget that visitor first",
        )
    return VisitorRefusedError(
        f"{what}: it is a face label of {quoted_name(owner.name)}",
        "take another one, or forget that visitor first",
    )


def owner_of(people: People, text: str) -> Visitor | None:
    """Whose label or name this is."""
    key = key_of(text)
    for visitor in people.values():
        if key in map(key_of, visitor.labels):
            return visitor
    return people.get(key)


# -- the file -----------------------------------------------------------------------------------


class _File(msgspec.Struct, forbid_unknown_fields=True):
    format: str
    version: int
    visitors: list[Visitor]


def file_text(people: People) -> str:
    """The file's text: JSON, two blanks deep, visitors by name."""
    file = msgspec.to_builtins(_File(FORMAT, VERSION, sorted_by_name(people.values())))
    return json.dumps(file, indent=2, ensure_ascii=False) + "\n"


def sorted_by_name(visitors: Iterable[Visitor]) -> list[Visitor]:
    """Visitors in the order in which people look for them."""
    return sorted(visitors, key=lambda one: (key_of(one.name), one.name))


def visitors_in(text: str, place: str) -> dict[str, Visitor]:
    """The visitors in a file's text. `place` names the file in `VisitorFileError`."""
    try:
        content = json.loads(text, object_pairs_hook=_without_double_keys)
    except json.JSONDecodeError as error:
        where = f"{place}:{error.lineno}:{error.colno}"
        raise _unreadable(f"{where}: not JSON: {error.msg}") from None
    except (ValueError, RecursionError) as error:
        raise _unreadable(f"{place}: not JSON of visitors: {error}") from None
    _check_kind(content, place)
    try:
        file = msgspec.convert(content, _File)
    except msgspec.ValidationError as error:
        raise _unreadable(f"{place}: {str(error).replace('$.', '')}") from None
    people: dict[str, Visitor] = {}
    owners: dict[str, Visitor] = {}
    for number, visitor in enumerate(file.visitors):
        try:
            _check(visitor)
            _claim(owners, visitor)
        except (VisitorNameError, VisitorRefusedError, ValueError) as error:
            reason = getattr(error, "reason", str(error))
            raise _unreadable(f"{place}: visitors[{number}]: {reason}") from None
        people[key_of(visitor.name)] = visitor
    return people


def _claim(owners: dict[str, Visitor], visitor: Visitor) -> None:
    """Note whose the name and the labels are; `VisitorRefusedError` if they are somebody else's."""
    for text in (visitor.name, *visitor.labels):
        owner = owners.setdefault(key_of(text), visitor)
        if owner is not visitor:
            raise _taken(text, owner, label=text != visitor.name)


def _check_kind(content: Any, place: str) -> None:
    """Whether it is a file of visitors at all, and none of a later program."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise VisitorFileError(
            f'{place}: not a file of visitors: it has no "format": "{FORMAT}"',
            "name another file; this one was left as it is",
        )
    version = content.get("version")
    if isinstance(version, int) and version > VERSION:
        raise VisitorFileError(
            f"{place}: version {version} is newer than this program, which knows {VERSION}",
            "take the woz-tui that wrote it; the file was left as it is",
        )
    if version != VERSION or isinstance(version, bool):
        raise _unreadable(
            f"{place}: version: {quoted_name(str(version))} is none that there ever was"
        )


def _check(visitor: Visitor) -> None:
    """Raise `VisitorNameError` or `ValueError` unless it is written as this program does it."""
    tidy = replace(
        visitor,
        name=name_of(visitor.name),
        age_group=word_of(visitor.age_group, "an age group"),
        address=word_of(visitor.address, "a form of address"),
        labels=tuple(map(label_of, visitor.labels)),
    )
    if tidy != visitor:
        raise ValueError(
            f"{quoted_name(visitor.name)} has blanks too many, or letters that are not composed"
        )
    for day in filter(None, (visitor.first_met, visitor.last_met)):
        if date.fromisoformat(day).isoformat() != day:
            raise ValueError(f"{quoted_name(day)} is not written like 2026-03-01")
    if visitor.meetings < 0:
        raise ValueError(f"meetings: {visitor.meetings} is less than none")


def _unreadable(reason: str) -> VisitorFileError:
    return VisitorFileError(reason, MEND)


def _without_double_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON in which no key stands twice: one of the two would be lost."""
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(key for key, _ in pairs if [one for one, _ in pairs].count(key) > 1)
        raise ValueError(f"the key {quoted_name(twice)} stands twice")
    return found
