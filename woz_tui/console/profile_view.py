"""Profiles as the console knows them: which there are, what each allows, which is in use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from woz_tui.protocol.welcome import Allowance

#: What may be used where no profile is in use.
EVERYTHING = "everything"
#: What a profile names -> before the names; in this order.
_KINDS = {"panels": "panels", "actions": "actions", "controls": "knobs", "verbs": "by themselves"}


@dataclass(frozen=True, slots=True)
class ProfileList:
    """Names in the file's order; `current` is empty where everything may be used. `allows` has
    what each profile names, as far as the robot process tells.
    """

    current: str = ""
    names: tuple[str, ...] = ()
    allows: Mapping[str, Allowance] = field(default_factory=dict)

    @property
    def offered(self) -> tuple[str, ...]:
        """What can be chosen: everything (an empty name), the file's profiles, and the one in use
        if it has gone from the file.
        """
        return tuple(dict.fromkeys(("", *self.names, self.current)))

    def words(self, name: str) -> str:
        """What the profile allows; empty where nobody has told."""
        if not name:
            return "no profile: every panel, knob and verb"
        if name not in self.names:
            return "not in the file any more"
        told = self.allows.get(name)
        if told is None:
            return ""
        parts = [
            f"{word}: {', '.join(map(str, names))}"
            for kind, word in _KINDS.items()
            if (names := getattr(told, kind))
        ]
        return "; ".join([*parts, "the rest is hidden"] if told.hide else parts)
