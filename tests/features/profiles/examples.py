"""Examples of what is said and asked of profiles, for the golden files of the protocol."""

from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.profiles.console import profiles_of
from woz_tui.features.profiles.kinds import AskProfile, ProfileChanged

MESSAGES = (ProfileChanged(profile="child", source="palette"),)
REQUESTS = (AskProfile(ref=21, profile="child", source="palette"),)


def shown(state: ConsoleState) -> str:
    """What a console knows."""
    return profiles_of(state).current


SHOWN = (shown,)
