"""Examples of what is said of the delay of answers, for the golden files of the protocol."""

from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged

SETTINGS = (ShapingChanged(floor_us=800_000, jitter_us=400_000, cues=["speech"]),)
HELD = (ActionHeld(run="a00007", action="Hello", sort="speech", cued=9_000_000, until=9_950_000),)
