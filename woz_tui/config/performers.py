"""Who carries out verbs beside the drivers."""

from __future__ import annotations

from functools import cache

from woz_tui.feature import PerformerName, features

#: The name under which calls of the session's verbs are addressed.
SESSION = "session"
#: The name under which calls of the engagement model's verbs are addressed.
ENGAGEMENT = "engagement"


@cache
def performers() -> tuple[str, ...]:
    """Who carries out verbs beside the drivers: no driver may have such a name."""
    return (SESSION, ENGAGEMENT, *(each.name for each in performers_of_features().values()))


@cache
def composers() -> frozenset[str]:
    """Those of them that carry out commands by commands of drivers."""
    return frozenset(each.name for each in performers_of_features().values() if each.composes)


@cache
def performers_of_features() -> dict[str, PerformerName]:
    """Those of them that features bring along, by the feature's name."""
    return {name: each.performer for name, each in features().items() if each.performer}
