"""What becomes of the lines of features in exports and publications of a log."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache

from woz_tui.feature import pieces
from woz_tui.protocol.envelope import Message
from woz_tui.timeline.episodes import Episode


@dataclass(frozen=True, slots=True)
class ExportedEpisode:
    """How an episode of a feature is an event with an interval.

    Attributes:
        kind, meaning: Of the event, and what it is.
        tier: The tier on which these events are.
        first, last: Attributes of the episode with its first line and its last.
        outcome: The field of the last line that has the event's outcome.
        used: Fields of the first line that are told elsewhere.
    """

    kind: str
    meaning: str
    tier: str
    first: str = "started"
    last: str = "ended"
    outcome: str = ""
    used: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FeatureExport:
    """What becomes of a feature's lines, by the kind of line.

    Attributes:
        label_and_text: The field that becomes an event's label and the one that becomes its text.
        points: Tiers of moments, each with its kinds.
        settings: Kinds that change how the session is run: they share a tier.
        kept: Fields whose texts stay in a redacted log, because they are codes, words of the
            program or labels of the experiment file; any other text does not.
        ids: Fields by whose value lines belong together, as by a run's.
        of_session: Kinds that say nothing of a participant, so that a withdrawal leaves them.
        parts: Messages that begin an event which has an interval, and are none by themselves.
        episodes: How its episodes are events.
        kept_at: Texts that stay in these kinds, each by its place, if they are such texts.
        private: Fields that a line loses which says that it is `private`, unless somebody asks for
            them.
        begun: What lines begin that others end without an id: the words before the dot of both.
    """

    label_and_text: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    points: Mapping[str, Collection[str]] = field(default_factory=dict)
    settings: Collection[str] = ()
    kept: Mapping[str, Collection[str]] = field(default_factory=dict)
    ids: Collection[str] = ()
    of_session: Collection[str] = ()
    parts: Collection[type[Message]] = ()
    episodes: Mapping[type[Episode], ExportedEpisode] = field(default_factory=dict)
    kept_at: Mapping[str, Mapping[str, re.Pattern[str]]] = field(default_factory=dict)
    begun: Collection[str] = ()
    private: Mapping[str, Collection[str]] = field(default_factory=dict)


def exports() -> Iterable[FeatureExport]:
    """Of all features."""
    return pieces("export", FeatureExport).values()


@cache
def labels_and_texts() -> dict[str, tuple[str, str]]:
    """`label_and_text` of all features."""
    return {kind: fields for each in exports() for kind, fields in each.label_and_text.items()}


@cache
def settings_kinds() -> frozenset[str]:
    """`settings` of all features."""
    return frozenset(kind for each in exports() for kind in each.settings)


@cache
def kept_fields() -> dict[str, frozenset[str]]:
    """`kept` of all features."""
    return {kind: frozenset(fields) for each in exports() for kind, fields in each.kept.items()}


@cache
def kinds_of_session() -> frozenset[str]:
    """`of_session` of all features."""
    return frozenset(kind for each in exports() for kind in each.of_session)


@cache
def id_fields() -> tuple[str, ...]:
    """`ids` of all features."""
    return tuple(name for each in exports() for name in each.ids)


@cache
def parts_of_events() -> tuple[type[Message], ...]:
    """`parts` of all features."""
    return tuple(kind for each in exports() for kind in each.parts)


@cache
def exported_episodes() -> dict[type[Episode], ExportedEpisode]:
    """`episodes` of all features."""
    return {kind: how for each in exports() for kind, how in each.episodes.items()}


@cache
def kept_places() -> dict[str, dict[str, re.Pattern[str]]]:
    """`kept_at` of all features."""
    found: dict[str, dict[str, re.Pattern[str]]] = {}
    for each in exports():
        for kind, places in each.kept_at.items():
            found.setdefault(kind, {}).update(places)
    return found


@cache
def private_fields() -> dict[str, frozenset[str]]:
    """`private` of all features."""
    return {kind: frozenset(fields) for each in exports() for kind, fields in each.private.items()}


@cache
def begun_subjects() -> frozenset[str]:
    """`begun` of all features."""
    return frozenset(subject for each in exports() for subject in each.begun)
