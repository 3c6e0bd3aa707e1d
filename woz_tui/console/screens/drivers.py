"""How every driver is."""

from __future__ import annotations

from woz_tui.console.cells import Row
from woz_tui.console.screens.dialog import LiveReportDialog

_LOOKS = {"connected": "good", "connecting": "warn", "lost": "bad", "faulted": "bad"}
_SIGNS = {"connected": "yes", "connecting": "driver", "lost": "error", "faulted": "warning"}


class DriversDialog(LiveReportDialog):
    """Health, detail and remedy; follows what happens while it is open."""

    heading = "Drivers"
    hint = "arrows scroll · ctrl+q closes"
    size_class = "wide"
    indent = 4

    def lines(self) -> list[Row]:
        """One paragraph for each driver."""
        rows: list[Row] = []
        for driver in self.state.drivers.values():
            sign = str(getattr(self.glyphs, _SIGNS.get(driver.health, "no")))
            look = _LOOKS.get(driver.health, "muted")
            rows.append(((f"{sign} {driver.name}  {driver.health}", look),))
            verbs = ", ".join(self.state.verbs.get(driver.name, []))
            for text, tone in ((driver.detail, "plain"), (driver.remedy, "run"), (verbs, "muted")):
                if text:
                    rows.append(((f"    {text}", tone),))
            rows.append(())
        return rows or [(("This session has no drivers.", "muted"),)]
