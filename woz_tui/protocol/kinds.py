"""All kinds of messages, requests and answers that there are: the core's, then the features'."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from woz_tui.feature import pieces
from woz_tui.protocol.envelope import Answer, Message, RestrictedMessage
from woz_tui.protocol.messages import MESSAGES
from woz_tui.protocol.requests import ANSWERS, REQUESTS, Request

if TYPE_CHECKING:  # a console needs none of it
    from woz_tui.protocol.description import Prediction


@dataclass(frozen=True, slots=True)
class FeatureKinds:
    """What a feature adds to the protocol.

    `open`: those of its messages that tell nothing of the condition, the visitor or what somebody
    said. Any other reaches those alone who may know everything, unless it is a `RestrictedMessage`,
    which says itself what it tells. `unlisted`: those of which no list of events has a line.
    """

    messages: tuple[type[Message], ...] = ()
    requests: tuple[type[Request], ...] = ()
    answers: tuple[type[Answer], ...] = ()
    open: tuple[type[Message], ...] = ()
    unlisted: tuple[type[Message], ...] = ()


@cache
def message_kinds() -> tuple[type[Message], ...]:
    """Every message that may stand in a log or on the stream."""
    of_features = pieces("kinds", FeatureKinds).values()
    return (*MESSAGES, *(kind for each in of_features for kind in each.messages))


@cache
def request_kinds() -> tuple[type[Request], ...]:
    """Everything that a client may ask for."""
    of_features = pieces("kinds", FeatureKinds).values()
    return (*REQUESTS, *(kind for each in of_features for kind in each.requests))


@cache
def answer_kinds() -> tuple[type[Answer], ...]:
    """Lines from the host that are no messages of the session."""
    of_features = pieces("kinds", FeatureKinds).values()
    return (*ANSWERS, *(kind for each in of_features for kind in each.answers))


@cache
def closed_kinds() -> frozenset[type[Message]]:
    """Messages of features that do not say what they tell."""
    return frozenset(
        kind
        for each in pieces("kinds", FeatureKinds).values()
        for kind in each.messages
        if kind not in each.open and not issubclass(kind, RestrictedMessage)
    )


@cache
def unlisted_kinds() -> tuple[type[Message], ...]:
    """Messages of features of which no list of events has a line."""
    of_features = pieces("kinds", FeatureKinds).values()
    return tuple(kind for each in of_features for kind in each.unlisted)


@cache
def prediction_kinds() -> Mapping[str, type[Prediction]]:
    """What replies to `predict` hold where that is more than a `Prediction`, by verb."""
    return {
        verb: kind for each in pieces("predictions", dict).values() for verb, kind in each.items()
    }
