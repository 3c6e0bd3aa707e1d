"""What there is to read in a replay: its keys, and what its log is."""

from __future__ import annotations

from woz_tui.console.cells import Row, clean, fit
from woz_tui.console.number_text import elapsed
from woz_tui.console.replay.replay_state import wall_time
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.console.screens.help import HelpDialog
from woz_tui.protocol.welcome import ReplayedLog

NAME = 14


class ReplayHelp(HelpDialog):
    """The keys of the replay, then those of the session as they were."""

    heading = "Keys of the replay"

    def lines(self) -> list[Row]:
        """Key and meaning, one a line."""
        first, *others = super().lines()
        del first
        return [(("Replay: the keys of the panels play nothing", "title"),), *others]

    def _by_hand(self) -> list[Row]:
        """Nothing is steered by hand here."""
        return []


class AboutDialog(ReportDialog):
    """The log: which session, which experiment, how whole it is."""

    heading = "This log"
    hint = "ctrl+q closes"
    wide = True

    def lines(self) -> list[Row]:
        """One fact a line; what is missing in full sentences."""
        picture, told = self.picture, self.picture.settings.replay or ReplayedLog()
        began = wall_time(picture.settings, 0)
        start = picture.session.start
        length = elapsed(picture.replay.length_us) if picture.replay is not None else ""
        facts = {
            "log": picture.log,
            "began": f"{began:%Y-%m-%d %H:%M:%S} UTC" if began is not None else "",
            "length": length,
            "session": start.session if start is not None else "",
            "participant": picture.participant,
            "condition": picture.condition,
            **{name: getattr(told, name) for name in ("wizard", "experiment", "software")},
        }
        rows: list[Row] = [
            ((fit(name, NAME), "muted"), (clean(str(value)), "plain"))
            for name, value in facts.items()
            if value not in ("", None)
        ]
        return [*rows, (), *self._state()]

    def _state(self) -> list[Row]:
        told = self.picture.settings.replay or ReplayedLog()
        if not told.notes:
            return [((f"{self.glyphs.yes} ", "good"), ("The log is complete.", "plain"))]
        mark = (f"{self.glyphs.warning} ", "warn")
        return [(mark, (clean(note), "plain")) for note in told.notes]
