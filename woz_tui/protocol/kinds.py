"""All kinds of messages, requests and answers that there are: the core's, then the features'."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from woz_tui.feature import leave_out, pieces
from woz_tui.protocol.envelope import Answer, Message, RestrictedMessage
from woz_tui.protocol.messages import MESSAGES
from woz_tui.protocol.requests import ANSWERS, REQUESTS, Request

if TYPE_CHECKING:  # a console needs none of it
    from woz_tui.protocol.description import Prediction


@dataclass(frozen=True, slots=True)
class EndedKind:
    """A message that is followed by exactly one of its `ends`; all name it in the field `id`."""

    begin: type[Message]
    ends: tuple[type[Message], ...]
    id: str


@dataclass(frozen=True, slots=True)
class FeatureKinds:
    """What a feature adds to the protocol.

    `open`: those of its messages that tell nothing of the condition, the visitor or what somebody
    said. Any other reaches those alone who may know everything, unless it is a `RestrictedMessage`,
    which says itself what it tells. `unlisted`: those of which no list of events has a line.
    `for_participants`: those that a participant's terminal gets; `put_to_participants`: those of
    them that are what it is to show, so that it gets all their words. `ended`: those that have an
    end, which `woz replay --verify` looks for.
    """

    messages: tuple[type[Message], ...] = ()
    requests: tuple[type[Request], ...] = ()
    answers: tuple[type[Answer], ...] = ()
    open: tuple[type[Message], ...] = ()
    unlisted: tuple[type[Message], ...] = ()
    for_participants: tuple[type[Message], ...] = ()
    put_to_participants: tuple[type[Message], ...] = ()
    ended: tuple[EndedKind, ...] = ()


@cache
def _of_features() -> tuple[FeatureKinds, ...]:
    """Those of all features; one whose words mean something else already is left out."""
    known = {
        sort: {str(kind.__struct_config__.tag) for kind in core}
        for sort, core in (("messages", MESSAGES), ("requests", REQUESTS), ("answers", ANSWERS))
    }
    fitting = []
    for name, each in pieces("kinds", FeatureKinds).items():
        own = {
            sort: [str(kind.__struct_config__.tag) for kind in getattr(each, sort)]
            for sort in known
        }
        twice = [tag for sort, tags in own.items() for tag in tags if tag in known[sort]]
        if twice:
            leave_out(name, ValueError(f"there is a kind {twice[0]!r} already"))
            continue
        for sort, tags in own.items():
            known[sort] |= {*tags}
        fitting.append(each)
    return tuple(fitting)


@cache
def message_kinds() -> tuple[type[Message], ...]:
    """Every message that may stand in a log or on the stream."""
    of_features = _of_features()
    return (*MESSAGES, *(kind for each in of_features for kind in each.messages))


@cache
def request_kinds() -> tuple[type[Request], ...]:
    """Everything that a client may ask for."""
    of_features = _of_features()
    return (*REQUESTS, *(kind for each in of_features for kind in each.requests))


@cache
def answer_kinds() -> tuple[type[Answer], ...]:
    """Lines from the host that are no messages of the session."""
    of_features = _of_features()
    return (*ANSWERS, *(kind for each in of_features for kind in each.answers))


@cache
def closed_kinds() -> frozenset[type[Message]]:
    """Messages of features that do not say what they tell."""
    return frozenset(
        kind
        for each in _of_features()
        for kind in each.messages
        if kind not in each.open and not issubclass(kind, RestrictedMessage)
    )


@cache
def unlisted_kinds() -> tuple[type[Message], ...]:
    """Messages of features of which no list of events has a line."""
    of_features = _of_features()
    return tuple(kind for each in of_features for kind in each.unlisted)


@cache
def participant_kinds() -> tuple[type[Message], ...]:
    """Messages of features that a participant's terminal gets."""
    of_features = _of_features()
    return tuple(kind for each in of_features for kind in each.for_participants)


@cache
def participant_words() -> tuple[type[Message], ...]:
    """Messages of features that a participant's terminal gets with all their words."""
    of_features = _of_features()
    return tuple(kind for each in of_features for kind in each.put_to_participants)


@cache
def ended_kinds() -> tuple[EndedKind, ...]:
    """Messages of features that have exactly one end each."""
    of_features = _of_features()
    return tuple(kind for each in of_features for kind in each.ended)


@cache
def prediction_kinds() -> Mapping[str, type[Prediction]]:
    """What replies to `predict` hold where that is more than a `Prediction`, by verb."""
    return {
        verb: kind for each in pieces("predictions", dict).values() for verb, kind in each.items()
    }
