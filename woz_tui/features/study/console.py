"""Orders of conditions and trials on the wizard's screen."""

from __future__ import annotations

from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import FeatureConsole


def _start_dialog(state: ConsoleState) -> str | None:
    """Where the file has a design the order is proposed with the participant."""
    designed = state.session.study.designed
    return f"{__package__}.order_dialog:OrderDialog" if designed else None


CONSOLE = FeatureConsole(instead={"start": _start_dialog})
