"""What is queued: each lane with what runs in it and what waits, and for how long."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.key_caps import key_name
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.screens.dialog import LiveReportDialog
from woz_tui.console.state.command_text import command_words
from woz_tui.protocol.sentence import Sentence
from woz_tui.timeline.episodes import CommandEpisode


class QueueDialog(LiveReportDialog):
    """Follows the queues while it is open; the robot is played meanwhile."""

    heading = Sentence("queue.heading", "Queue")
    hint = Sentence("dialog.keys_play", "keys play · ctrl+q closes")
    size_class = "wide"
    indent = 12
    plays = True

    def lines(self) -> list[Row]:
        """A paragraph for each lane in which something waits."""
        lanes: dict[str, list[CommandEpisode]] = {}
        for command in self.state.runs.waiting:
            lanes.setdefault(self._lane(command), []).append(command)
        rows: list[Row] = []
        for lane, waiting in lanes.items():
            rows.append(((lane, "title"),))
            for command in self.state.session.commands.values():
                if command.started is not None and self._lane(command) == lane:
                    runs = say("queue.runs", "runs")
                    rows.append(((f"{runs:>10}  ", "run"), (self._what(command), "run")))
            for command in waiting:
                waited = seconds(self.now - command.begin)
                rows.append(((f"{waited:>10}  ", "wait"), (self._what(command), "plain")))
            rows.append(())
        if not rows:
            return [((say("queue.empty", "Nothing is queued."), "muted"),)]
        key = key_name(self.console_app.key_of("queue_empty"), self.glyphs)
        does = say("queue.empties", "empties the queue; what runs goes on")
        empties: Row = ((key, "strong"), (f" {does}", "muted"))
        return [*rows, empties] if key else rows

    def _lane(self, command: CommandEpisode) -> str:
        request = command.request
        lane = self.state.settings.lanes.get(request.driver, {}).get(request.verb, request.verb)
        return f"{request.driver} {lane}"

    def _what(self, command: CommandEpisode) -> str:
        request = command.request
        return self.state.label(request.action) if request.action else command_words(request)
