"""What is not in the profile that is in use."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from woz_tui.config.performers import composers
from woz_tui.features.profiles.kinds import AskProfile
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayAction, SendVerb
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

if TYPE_CHECKING:  # the console needs none of it for its first paint
    from woz_tui.features.profiles.section import Profile

#: Verbs that count in every profile.
IN_EVERY_PROFILE = frozenset({"mark", "note"})


def profile_without_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """What is beside the panels counts in every profile."""
    profile, action = _in_use(facts), asked.action
    if action is None or asked.beside_panels:
        return None
    if action.panel in profile.panels or asked.name in profile.actions:
        return None
    return Refusal("profile", _lacks(profile, repr(asked.name)), command="profile")


def profile_without_verb(facts: Facts, asked: SendVerb) -> Refusal | None:
    """What only takes hands off the robot counts in every profile. What a block consists of is
    looked at verb by verb.
    """
    profile, verb = _in_use(facts), asked.verb
    what: str = repr(verb)
    if verb in IN_EVERY_PROFILE or asked.driver in composers():
        return None
    if verb in profile.verbs or takes_hands_off(verb, asked.args):
        return None
    if verb == "control":
        control = asked.args.get("control")
        if control in profile.controls:
            return None
        what = Sentence("profiles.control", "the control {control!r}", control=str(control))
    return Refusal("profile", _lacks(profile, what))


def _lacks(profile: Profile, what: str) -> Sentence:
    return Sentence(
        "profiles.lacks", "{what} is not in the profile {profile}", what=what, profile=profile.name
    )


def _in_use(facts: Facts) -> Profile:
    return cast("Profile", facts.features["profiles"])


GATE = FeatureGate(
    rows=(
        FeatureRow(Row("profile", (SendVerb,), profile_without_verb), before=locked_verb),
        FeatureRow(Row("profile", (PlayAction,), profile_without_action), before=no_moment),
    ),
    while_ending=(AskProfile,),
    undone={AskProfile: Sentence("profiles.not_changed", "Profile not changed")},
)
