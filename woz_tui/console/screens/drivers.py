"""How every driver is."""

from __future__ import annotations

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row
from woz_tui.console.robot_settings.status import is_stale
from woz_tui.console.screens.dialog import LiveReportDialog
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.console.widgets.status_rows import wellness
from woz_tui.protocol.sentence import Sentence

_LOOKS = {"connected": "good", "connecting": "warn", "lost": "bad", "faulted": "bad"}
_HEALTH = {
    "connected": Sentence("drivers.connected", "connected"),
    "connecting": Sentence("drivers.connecting", "connecting"),
    "lost": Sentence("drivers.lost", "lost"),
    "faulted": Sentence("drivers.faulted", "faulted"),
}
_SIGNS = {"connected": "yes", "connecting": "driver", "lost": "error", "faulted": "warning"}


class DriversDialog(LiveReportDialog):
    """Health, detail and remedy; follows what happens while it is open."""

    heading = Sentence("drivers.heading", "Drivers")
    hint = Sentence("dialog.scroll", "arrows scroll · ctrl+q closes")
    size_class = "wide"
    indent = 4

    def lines(self) -> list[Row]:
        """One paragraph for each driver; what is wrong comes first."""
        rows: list[Row] = []
        drivers = self.state.drivers.values()
        for driver in sorted(drivers, key=lambda each: wellness(self.state, each)):
            sign = str(getattr(self.glyphs, _SIGNS.get(driver.health, "no")))
            look = _LOOKS.get(driver.health, "muted")
            health = word(_HEALTH.get(driver.health, driver.health))
            rows.append(((f"{sign} {driver.name}  {health}", look),))
            verbs = ", ".join(self.state.verbs.get(driver.name, []))
            can = say("drivers.can", "can: {verbs}", verbs=verbs) if verbs else ""
            robot = self.state.session.robots.shown.get(driver.name)
            old = robot is None or is_stale(self.state, driver.name)
            conflicts = [] if robot is None or old else robot.conflicts
            texts = [
                (driver.detail, "plain"),
                (remedy_text(driver.remedy, self.state), "run"),
                *((remedy_text(conflict, self.state), "warn") for conflict in conflicts),
                (can, "muted"),
            ]
            rows += [((f"    {text}", tone),) for text, tone in texts if text]
            rows.append(())
        return rows or [((say("drivers.none", "This session has no drivers."), "muted"),)]
