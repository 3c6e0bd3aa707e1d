"""Which lines of a log are events by themselves, and what of them is the label and the text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.export.course import Event

#: Kinds of line that are no events by themselves: about the log, parts of something longer (see
#: `settings`), or state that is told so often that it belongs to the samples.
NO_EVENTS = frozenset(
    {
        *("session.start", "session.end", "clock", "checkpoint", "segment", "recorder.state"),
        *("experiment.files", "session.plan", "engagement.settings"),
        *("sample", "engagement.shown", "face.shown", "body.changed", "controls.moved"),
        "settings.shown",
    }
)
#: Kind -> the field that becomes the label and the one that becomes the text.
_LABEL_AND_TEXT: Mapping[str, tuple[str, str]] = {
    "marker": ("", "text"),
    "note": ("", "text"),
    "mistake": ("action", "text"),
    "notice": ("level", "text"),
    "sensor.changed": ("state", "why"),
    "mode.changed": ("now", "why"),
    "visitor.changed": ("what", ""),
    "driver.connecting": ("driver", "detail"),
    "driver.connected": ("driver", "detail"),
    "driver.lost": ("driver", "detail"),
    "driver.faulted": ("driver", "detail"),
    "lane.faulted": ("lane", ""),
    "lane.recovered": ("lane", ""),
    "panel.locked": ("panel", ""),
    "profile.changed": ("profile", ""),
    "console.attached": ("role", ""),
    "console.lost": ("role", "why"),
    "condition.assigned": ("method", "why"),
    "preflight.checked": ("level", "detail"),
    "action.held": ("sort", ""),
    "cue.given": ("sort", "text"),
    "cue.answered": ("judged", ""),
    "rerun.started": ("original_session", ""),
    "rerun.skipped": ("original_command", "reason"),
    "rerun.ended": ("reason", ""),
}
#: Fields that have a column of their own in every event.
COLUMNS = ("panel", "action", "verb", "driver", "source", "key", "outcome", "reason", "run")
_ENVELOPE = frozenset({"seq", "t", "ts", "kind"})


def moment(seq: int, t: int, kind: str, fields: Mapping[str, Any]) -> Event:
    """A line as an event without a duration. What has no column is among its details."""
    label, text = _LABEL_AND_TEXT.get(kind, ("", ""))
    event = Event(seq=seq, begin=t, kind=kind, label=_text(fields, label), text=_text(fields, text))
    used = {label, text} if label not in COLUMNS else {text}
    for name in (*COLUMNS, "command"):
        if isinstance(fields.get(name), str):
            setattr(event, name, fields[name])
            used.add(name)
    event.details = details(fields, used)
    return event


def details(fields: Mapping[str, Any], used: set[str]) -> dict[str, Any]:
    """The fields of a line that are not `used` elsewhere."""
    return {name: value for name, value in fields.items() if name not in used | _ENVELOPE}


def _text(fields: Mapping[str, Any], name: str) -> str:
    value = fields.get(name, "")
    return value if isinstance(value, str) else ""
