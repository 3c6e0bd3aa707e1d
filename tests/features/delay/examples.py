"""Examples of what is said of the delay of answers, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.features.delay.section import SHAPING, ResponseShaping

SETTINGS = (ShapingChanged(floor_us=800_000, jitter_us=400_000, cues=["speech"]),)
HELD = (ActionHeld(run="a00007", action="Hello", sort="speech", cued=9_000_000, until=9_950_000),)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, SHAPING, ResponseShaping(0.8, 0.4))
