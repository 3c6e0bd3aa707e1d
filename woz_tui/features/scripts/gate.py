"""What becomes of requests about the script."""

from __future__ import annotations

from woz_tui.features.scripts.kinds import AskScript
from woz_tui.gate.table import FeatureGate


def _undone(request: AskScript) -> str:
    """A line that is too old is refused as an action is, and then in the log as one."""
    return "Script not moved" if request.to is not None or request.by else ""


GATE = FeatureGate(while_ending=(AskScript,), undone={AskScript: _undone})
