"""What the wizard may use at the moment: everything, or what a profile of the experiment names.

The stop, its release, marks, notes and whatever drivers do by themselves are no affair of profiles.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.config.experiment import Action, Experiment, Profile
from woz_tui.config.profiles import CONTROL
from woz_tui.config.session_verbs import BML
from woz_tui.drivers.robot_verbs import takes_hands_off
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import covers_verb
from woz_tui.session.action_runner import CommandRefusal
from woz_tui.session.participant_identity import RequestError

#: Verbs that count in every profile. What a block consists of is looked at verb by verb.
_ALWAYS = frozenset({"mark", "note", BML})


class ProfileLimits:
    """Knows the profile in use and what it does not allow.

    Args:
        publish: Publishes that another one is in use.
    """

    def __init__(self, publish: Callable[[m.ProfileChanged], object]) -> None:
        self._publish = publish
        self.current: Profile | None = None

    def use(self, name: str, experiment: Experiment, source: str) -> None:
        """Use the profile `name` of `experiment`, or none if it is empty.

        Raises `RequestError` if there is no such profile.
        """
        known = experiment.profiles
        if name and name not in known:
            raise RequestError(
                f"there is no profile {name!r}",
                f"there are {', '.join(known)}" if known else "the file has no profiles",
            )
        self.current = known[name] if name else None
        self._publish(m.ProfileChanged(profile=name, source=source))

    def adopt(self, experiment: Experiment) -> str:
        """Go on with a file that was read again. A profile that has gone from it holds on, because
        nobody said that everything may be used now; a sentence then says so.
        """
        if self.current is None:
            return ""
        name = self.current.name
        if name not in experiment.profiles:
            return f"the profile {name} was removed from the file, but is still in use"
        self.current = experiment.profiles[name]
        return ""

    def no_action(self, action: Action) -> str:
        """Why it may not be played; empty if it may."""
        if self.current is None or self.current.plays(action):
            return ""
        return f"{action.name!r} is not in the profile {self.current.name}"

    def no_verb(self, verb: str, args: Mapping[str, m.Json]) -> CommandRefusal | None:
        """Why it may not be sent by itself; None if it may."""
        profile, what = self.current, repr(verb)
        if profile is None or verb in _ALWAYS or verb in profile.verbs:
            return None
        if takes_hands_off(verb, args):
            return None
        if verb == CONTROL:
            control = args.get(CONTROL)
            if control in profile.controls:
                return None
            what = f"the control {control!r}"
        return CommandRefusal("profile", f"{what} is not in the profile {profile.name}")


def panel_refusal(
    experiment: Experiment, locked: Mapping[str, bool], verb: str, driver: str
) -> CommandRefusal | None:
    """Why nobody may send `verb` to `driver` by itself while panels are locked (by title); None:
    they may.
    """
    for panel in experiment.panels:
        if covers_verb(panel.covers, verb, driver) and locked.get(panel.title, panel.locked):
            reason = f"the panel {panel.title!r} is locked, and with it {verb!r}"
            return CommandRefusal("locked", reason, *_unlocks(panel.title))
    return None


def lock_on(action: Action, locked: Mapping[str, bool], why: str) -> CommandRefusal | None:
    """The lock on an action or its panel (by title); None: there is none. `why`: how the sentence
    about the panel goes on.
    """
    if action.locked:
        return CommandRefusal(
            "locked", f"{action.name!r} is locked", "the experiment file locks it"
        )
    if locked.get(action.panel, False):
        reason = f"the panel {action.panel!r} is locked{why}"
        return CommandRefusal("locked", reason, *_unlocks(action.panel))
    return None


def _unlocks(panel: str) -> tuple[str, str]:
    """What a wizard looks for to unlock it, and with which of the console's keys."""
    return f"find 'Unlock {panel}'", "find"
