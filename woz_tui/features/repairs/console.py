"""Keys of repairs; the screen has a row for all actions beside the panels."""

from __future__ import annotations

from woz_tui.console.widgets.feature_console import FeatureCommand, FeatureConsole

CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand("repair_repeat"),
        FeatureCommand("repair_reword"),
        FeatureCommand("repair_filler"),
        FeatureCommand("repair_yes"),
        FeatureCommand("repair_no"),
        FeatureCommand("repair_dont_know"),
        FeatureCommand("repair_please_repeat"),
        # What is being said ends, and one types what is said instead.
        FeatureCommand("repair_interrupt", "woz_tui.console.screens.say:SayDialog"),
    ),
)
