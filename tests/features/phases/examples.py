"""Examples of what is said and asked of phases, for the golden files of the protocol."""

from woz_tui.features.phases.kinds import AskPhase, PhaseChanged

MESSAGES = (PhaseChanged(phase="opening", source="trial", planned_us=120_000_000),)
REQUESTS = (
    AskPhase(ref=36, phase="whales", source="palette"),
    AskPhase(ref=37, source="key", key=")", age_us=4_000_000, stale=True),
)
