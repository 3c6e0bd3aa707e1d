"""What a program does not do without the wizard."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from woz_tui.features.proposals.rights import ACTIONS, ProgramRights
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayAction, RequestOrigin, SendVerb
from woz_tui.gate.table import (
    FeatureGate,
    FeatureRow,
    Row,
    locked_verb,
    no_moment,
    takes_hands_off,
)
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class ApprovalFact:
    """What programs may do by themselves, by their connection. `approved`: the one of which the
    wizard lets something happen at this moment. `waiting`: connections, and the actions and verbs
    of theirs that were approved and have not ended: they may wait for their robot.
    """

    rights: Mapping[str, ProgramRights]
    approved: str = ""
    waiting: Collection[tuple[str, str]] = ()


def unapproved_verb(facts: Facts, asked: SendVerb) -> Refusal | None:
    """A verb that the program may only propose."""
    if takes_hands_off(asked.verb, asked.args):
        return None
    return _unapproved(facts, asked.origin, asked.verb, asked.verb)


def unapproved_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """An action that the program may only propose."""
    return _unapproved(facts, asked.origin, ACTIONS, asked.name)


def _unapproved(facts: Facts, origin: RequestOrigin, what: str, name: str) -> Refusal | None:
    fact = cast("ApprovalFact", facts.features["proposals"])
    rights = fact.rights.get(origin.console)
    if rights is None and "proposals" in facts.failed and origin.source == "program":
        # Who came later is not known, and nobody asks the wizard any more.
        return Refusal(
            "approval",
            Sentence(
                "proposals.nobody_approves", "nobody can approve what programs propose any more"
            ),
        )
    if rights is None or origin.console == fact.approved or not rights.asks(what):
        return None
    if (origin.console, name) in fact.waiting:
        return None
    return Refusal(
        "approval",
        Sentence(
            "proposals.unapproved", "this program only proposes: the wizard has not approved it"
        ),
    )


GATE = FeatureGate(
    rows=(
        FeatureRow(Row("approval", (SendVerb,), unapproved_verb, host=True), before=locked_verb),
        FeatureRow(Row("approval", (PlayAction,), unapproved_action, host=True), before=no_moment),
    ),
)
