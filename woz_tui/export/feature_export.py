"""What becomes of the lines of features in exports and publications of a log."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache

from woz_tui.feature import pieces
from woz_tui.protocol.envelope import Message


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
    """

    label_and_text: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    points: Mapping[str, Collection[str]] = field(default_factory=dict)
    settings: Collection[str] = ()
    kept: Mapping[str, Collection[str]] = field(default_factory=dict)
    ids: Collection[str] = ()
    of_session: Collection[str] = ()
    parts: Collection[type[Message]] = ()


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
