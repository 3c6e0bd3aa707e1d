"""Examples of what is said and asked of phases, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.phases.kinds import AskPhase, PhaseChanged
from woz_tui.features.phases.section import PHASES, Phase

MESSAGES = (PhaseChanged(phase="opening", source="trial", planned_us=120_000_000),)
REQUESTS = (
    AskPhase(ref=36, phase="whales", source="palette"),
    AskPhase(ref=37, source="key", key=")", age_us=4_000_000, stale=True),
)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, PHASES, (Phase("Open"),))
