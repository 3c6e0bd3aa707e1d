"""The section `reminders` of an experiment file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.fields import Doc, Entry, NotBlank, Seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class Reminder(Entry):
    """What the wizard is reminded of, so many seconds after the session has begun."""

    what = "a reminder"
    example = "{after: 10 min, text: Offer a break}"
    after: Annotated[float, Seconds(0.0, 86_400.0), Doc("time since the beginning")]
    text: Annotated[str, NotBlank(), Doc("what the wizard is reminded of")]


@dataclass(frozen=True, kw_only=True)
class ReminderKeys:
    """The key `reminders`."""

    reminders: Annotated[tuple[Reminder, ...], Doc("what the wizard is reminded of")] = ()


class ReminderSection(FeatureSection[tuple[Reminder, ...]]):
    """Reminders in the order of the file."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> tuple[Reminder, ...]:
        reminders: tuple[Reminder, ...] = file.reminders
        return reminders

    def changes(self, old: tuple[Reminder, ...], new: tuple[Reminder, ...]) -> Iterable[str]:
        if old != new:
            yield "reminders changed"


REMINDERS = ReminderSection(ReminderKeys, ())
