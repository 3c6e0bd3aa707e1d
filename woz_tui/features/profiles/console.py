"""Profiles on the wizard's screen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, fit_most
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine, other_console
from woz_tui.console.widgets.feature_console import FeatureCommand, FeatureConsole
from woz_tui.features.profiles.history import ProfileHistory
from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import Allowance

#: Cells of a profile's name on a narrow screen, and columns from which it has a quarter of them and
#: its word stands before it.
NAME, WORDY = 14, 100
#: What may be used where no profile is in use.
EVERYTHING = Sentence("profiles.everything", "everything")
#: What a profile names -> before the names; in this order.
_KINDS = {
    "panels": Sentence("profiles.panels", "panels"),
    "actions": Sentence("profiles.actions", "actions"),
    "controls": Sentence("profiles.knobs", "knobs"),
    "verbs": Sentence("profiles.verbs", "by themselves"),
}


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
            return say("profiles.all", "no profile: every panel, knob and verb")
        if name not in self.names:
            return say("profiles.not_in_file", "not in the file any more")
        told = self.allows.get(name)
        if told is None:
            return ""
        parts = [
            f"{word(heading)}: {', '.join(map(str, names))}"
            for kind, heading in _KINDS.items()
            if (names := getattr(told, kind))
        ]
        hidden = [say("profiles.rest_hidden", "the rest is hidden")] if told.hide else []
        return "; ".join([*parts, *hidden])


def profiles_of(state: ConsoleState) -> ProfileList:
    """What can be chosen in a session, and what is in use."""
    settings, changed = state.settings, state.session.history(ProfileHistory).changed
    told = ProfileList(settings.profile, tuple(settings.profiles), settings.allows)
    return told if changed is None else replace(told, current=changed.profile)


def _in_use(state: ConsoleState, frame: PaintFrame) -> Row:
    """At the right, where it takes nothing else's place."""
    name = clean(profiles_of(state).current)
    if not name:
        return ()
    wide = frame.width >= WORDY
    shown = fit_most(name, frame.width // 4 if wide else NAME, frame.glyphs.ellipsis)
    told = say("profiles.in_use_here", "profile {profile}", profile=shown) if wide else shown
    return (("  ", "plain"), (f"{frame.glyphs.locked} {told}", "wait"))


def _changed(message: ProfileChanged, shown: EventContext) -> EventLine:
    name = message.profile
    what = (
        say("profiles.named", "Profile {profile}", profile=name)
        if name
        else say("profiles.none_in_use", "No profile: everything may be used")
    )
    return EventLine("info", what, other_console(message.console, shown))


SENTENCES = {ProfileChanged: _changed}

CONSOLE = FeatureConsole(
    commands=(FeatureCommand("profile", f"{__package__}.dialog:ProfileDialog", watchers=True),),
    status=_in_use,
)
