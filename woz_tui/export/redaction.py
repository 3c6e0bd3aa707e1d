"""Replaces whatever people said, typed or wrote in a log, so that the log can be published.

The rule is what stays, not what goes: codes and labels in the fields that `KEPT` names, numbers
and truth values. Any other text becomes `[redacted]`, that of fields and kinds which this version
does not know included. Dates go as well.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from woz_tui.config.engagement_words import RUNS
from woz_tui.config.study_words import CUES
from woz_tui.export.feature_export import kept_fields, kept_places, private_fields
from woz_tui.protocol.messages import Json
from woz_tui.protocol.panels import TYPED_NAME

PLACEHOLDER = "[redacted]"
#: Objects within objects; what is deeper is none of ours.
_DEEPEST = 30

#: Fields whose texts (or lists of texts) stay: codes, ids, words of the program, and the labels
#: that the experiment file gives to actions, panels, conditions and the like.
KEPT = frozenset(
    {
        *("kind", "format", "session", "participant", "condition", "wizard"),
        *("experiment_sha256", "file_sha256", "sha256", "original_sha256", "original_session"),
        *("run", "action", "panel", "source", "key", "console", "role", "phase"),
        *("command", "original_command", "verb", "driver", "when_busy", "code", "by", "lane"),
        *("scope", "confirmed", "missing", "unreached", "sensor", "unit", "bad", "state", "level"),
        *("evidence", "unable"),
        *("halted", "now", "outcome", "emotion", "rows", "waiting", "lit", "trail", "uses", "next"),
        *("method", "order", "cues", "sort", "hidden", "blurred", "what", "without"),
        *("tells", "sees"),
        *("script", "conditions", "keyboard", "drivers", "simulated", "variables"),
    }
)
#: Fields that stay in these kinds only: elsewhere they hold something else.
KEPT_IN: Mapping[str, frozenset[str]] = {
    "console.attached": frozenset({"part"}),
    "console.lost": frozenset({"part"}),
    "engagement.changed": frozenset({"was"}),
    "sensor.changed": frozenset({"was"}),
    "mode.changed": frozenset({"was"}),
}
#: Texts within objects that stay: field -> names inside of it.
KEPT_INSIDE: Mapping[str, frozenset[str]] = {
    "software": frozenset({"name", "version", "commit", "python", "machine", "libraries"}),
    "clock": frozenset({"source", "unit"}),
    "items": frozenset({"name"}),
    "panels": frozenset({"title", "name", "key", "verbs", "without"}),
    "signs": frozenset({"filter"}),
}
#: A lone word or a colour, as a robot's settings; its address is none.
WORD = re.compile(r"[A-Za-z]{1,20}|#[0-9a-f]{6}|", re.ASCII)
#: Whatever the experiment file says there: verbs, titles of panels.
LABEL = re.compile(r".*", re.DOTALL)


def _one_of(*words: str) -> re.Pattern[str]:
    return re.compile("|".join(words))


#: Texts that stay in these kinds only, each by its place, if they are such texts: what a robot had
#: set, and words of the program and labels that decide the figures of a session.
KEPT_AT: Mapping[str, Mapping[str, re.Pattern[str]]] = {
    "addressed.changed": {"chosen": _one_of("rule", "hand")},
    "command.done": {"sent.run": _one_of(*RUNS)},
    "console.lost": {"why": _one_of("left", "closed", "silent", "taken over")},
    "engagement.settings": {"settings.start": _one_of(*RUNS)},
    "session.plan": {
        **{f"settings.study.answers.{cue}": LABEL for cue in CUES},
    },
    "settings.shown": {
        f"{field}.{name}": WORD
        for field in ("values", "wanted")
        for name in ("engagement", "eyes", "state", "tracking")
    },
}


@cache
def kept_at() -> dict[str, Mapping[str, re.Pattern[str]]]:
    """`KEPT_AT`, with what features keep."""
    found: dict[str, Mapping[str, re.Pattern[str]]] = dict(KEPT_AT)
    for kind, places in kept_places().items():
        found[kind] = {**found.get(kind, {}), **places}
    return found


#: What a robot guesses of people's looks and moods: of these sensors no value stays.
_LOOKS = re.compile(r"(.*\.)?looks\..*", re.DOTALL)
#: Objects that stay as they are: names of drivers and of what they can do.
VOCABULARY = frozenset({"verbs"})
#: Fields with a visitor's code. Visitors can get a name instead, so only given codes stay.
VISITORS = frozenset({"visitor"})
_GIVEN_CODE = re.compile(r"V\d{1,15}|", re.ASCII)
#: Names within objects; anything else in their place may be somebody's words.
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}", re.ASCII)


def without_private(fields: Mapping[str, Any]) -> Mapping[str, Any]:
    """A line's fields without what is private in it: the same, if nothing is."""
    lost = private_fields().get(str(fields.get("kind")), frozenset())
    if fields.get("private") is not True or not lost & fields.keys():
        return fields
    return {name: value for name, value in fields.items() if name not in lost}


def redacted(fields: Mapping[str, Any]) -> dict[str, Any]:
    """A line's fields without anybody's words, in the same JSON types, and without `ts`."""
    kind, clock = fields.get("kind"), fields.get("clock")
    if isinstance(clock, Mapping):  # like a sum of the log, it would tell which one that is
        fields = {**fields, "clock": {n: v for n, v in clock.items() if n != "monotonic_us"}}
    kind_name = kind if isinstance(kind, str) else ""
    if kind_name == "sample" and _LOOKS.fullmatch(str(fields.get("sensor"))):
        fields = {**fields, "value": None, "raw": None, "text": ""}
    kept = KEPT | KEPT_IN.get(kind_name, frozenset()) | kept_fields().get(kind_name, frozenset())
    places = kept_at().get(kind_name, {})
    return {
        _name(name): _placed(value, name, places)
        if name in places or _leads(name, places)
        else _field(name, value, kept)
        for name, value in fields.items()
        if name != "ts"
    }


def _leads(place: str, places: Iterable[str]) -> bool:
    """Whether one of the `places` is within this one."""
    return any(each.startswith(f"{place}.") for each in places)


def _placed(value: Any, place: str, places: Mapping[str, re.Pattern[str]]) -> Json:
    """What stands at `place`, of whose texts those at the `places` stay."""
    match value:
        case str() if place in places:
            kept = places[place].fullmatch(value) is not None
            return value if kept else _without_words(value, frozenset())
        case list() if places.get(place) == LABEL and _flat(value):
            return value
        case list() if _leads(place, places):
            return [
                _placed(item, place, places)
                if isinstance(item, dict)
                else _without_words(item, frozenset())
                for item in value
            ]
        case dict() if _leads(place, places):
            return {
                _name(name): _placed(item, f"{place}.{_name(name)}", places)
                for name, item in value.items()
            }
    return _without_words(value, frozenset())


def _field(name: str, value: Any, kept: frozenset[str]) -> Any:
    if name in VISITORS and isinstance(value, str):
        return value if _GIVEN_CODE.fullmatch(value) else PLACEHOLDER
    if name == "experiment" and isinstance(value, str):
        return value.replace("\\", "/").rpartition("/")[2]
    if name in kept and _flat(value):
        return _untyped(value)
    if name in VOCABULARY and isinstance(value, dict) and all(map(_flat, value.values())):
        return value
    return _without_words(value, KEPT_INSIDE.get(name, frozenset()))


def _flat(value: Any) -> bool:
    """Whether it is a text, a number or a list of them: an object in its place is none of ours."""
    items = value if isinstance(value, list) else [value]
    return not any(isinstance(item, dict | list) for item in items)


def _untyped(value: Any) -> Any:
    """Labels as they are; what is called by a sentence that the wizard typed has no words left."""
    match value:
        case str() if value.startswith(TYPED_NAME):
            return f"{TYPED_NAME}{PLACEHOLDER}"
        case list():
            return [_untyped(item) for item in value]
    return value


def _without_words(value: Any, kept: frozenset[str], depth: int = 0) -> Json:
    match value:
        case list() | dict() if depth >= _DEEPEST:
            return PLACEHOLDER
        case str():
            return PLACEHOLDER if value else ""
        case list():
            return [_without_words(item, kept, depth + 1) for item in value]
        case dict():
            return {
                _name(name): _untyped(item)
                if name in kept and _flat(item)
                else _without_words(item, kept, depth + 1)
                for name, item in value.items()
            }
        case None | bool() | int() | float():
            return value
    return PLACEHOLDER


def _name(name: str) -> str:
    return name if _NAME.fullmatch(name) else PLACEHOLDER
