"""Examples of what is said and asked of profiles, for the golden files of the protocol."""

from woz_tui.features.profiles.kinds import AskProfile, ProfileChanged

MESSAGES = (ProfileChanged(profile="child", source="palette"),)
REQUESTS = (AskProfile(ref=21, profile="child", source="palette"),)
