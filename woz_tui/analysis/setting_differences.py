"""How long settings of robots were other than asked for, by trial."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from woz_tui.analysis.event_rows import SettingRow, value_text

#: Values of one setting that are named in a row of a table; beyond, there were more.
_VALUES = 3


@dataclass(frozen=True, slots=True)
class Differed:
    """All differences of one setting in one trial of one condition; `first` is when they began.

    `values` is what the robot had, `wanted` what was asked for, each once and at most three.
    """

    name: str
    participant: str
    condition: str
    trial: int
    counted: bool
    first: int
    us: int
    values: str
    wanted: str


def by_trial(rows: Iterable[SettingRow]) -> list[Differed]:
    """In the order in which they began; a setting is named with its driver if there are several."""
    found: dict[tuple[object, ...], list[SettingRow]] = {}
    for row in rows:
        key = (row.driver, row.setting, row.participant, row.condition, row.trial, row.counted)
        found.setdefault(key, []).append(row)
    several = len({same[0].driver for same in found.values()}) > 1
    return [_differed(same, several=several) for same in found.values()]


def _differed(same: list[SettingRow], *, several: bool) -> Differed:
    first = same[0]
    return Differed(
        name=f"{first.driver} {first.setting}" if several else first.setting,
        participant=first.participant,
        condition=first.condition,
        trial=first.trial,
        counted=first.counted,
        first=first.begin,
        us=sum(row.end - row.begin for row in same),
        values=_listed(value_text(row.value) for row in same),
        wanted=_listed(value_text(row.wanted) for row in same),
    )


def _listed(values: Iterable[str]) -> str:
    told = list(dict.fromkeys(values))
    return ", ".join(told[:_VALUES] + ["..."] * (len(told) > _VALUES))
