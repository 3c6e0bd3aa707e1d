"""What a re-run has done so far, as lines for a terminal without a console."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from woz_tui.analysis.text_format import exact_clock
from woz_tui.protocol import messages as m
from woz_tui.session.redactor import Redactor
from woz_tui.system.text_cleaning import clean
from woz_tui.timeline.episodes import OUTCOMES

#: Ends of commands that are as planned.
_EXPECTED = (m.Done, m.Stopped, m.Superseded)


@dataclass
class RerunLines:
    """The messages of a re-run so far; `lines` returns what is printed for the next one.

    `streams`: driver and verb of setpoints that get no line each. `redactor`: hides what the
    wizard of then was not to know.
    """

    streams: frozenset[tuple[str, str]] = frozenset()
    redactor: Redactor = field(default_factory=Redactor)
    commands: dict[str, m.Command] = field(default_factory=dict)
    began: int = 0
    failed: int = 0
    ended: m.RerunEnded | None = None

    def lines(self, message: object) -> Iterator[str]:
        """Lines for `message`; usually one or none."""
        if isinstance(message, m.Message):
            message = self.redactor.message(message)
        match message:
            case m.RerunStarted():
                self.began = message.t
                yield f"{message.commands} commands of {clean(message.original)}"
            case m.Command(source="replay"):
                self.commands[message.command] = message
            case m.RerunSent():
                yield from self._sent(message)
            case m.RerunSkipped():
                yield f"{self._time(message.t)}  {message.original_command} is left out:" + (
                    f" {clean(message.reason)}"
                )
            case m.RerunEnded():
                self.ended = message
            case m.Notice(level=level, text=text):
                yield f"{self._time(message.t)}  {level}: {clean(text)}"
            case m.DriverLost() | m.DriverFaulted():
                yield f"{self._time(message.t)}  {message.driver}: {clean(message.detail)}"
            case m.End():
                yield from self._end(message)

    def _sent(self, sent: m.RerunSent) -> Iterator[str]:
        command = self.commands.get(sent.command)
        if command is None or (command.driver, command.verb) in self.streams:
            return
        args = clean(", ".join(f"{name} {value}" for name, value in command.args.items()))
        what = clean(f"{command.driver}.{command.verb}")
        yield f"{self._time(sent.due)}  {what} {args[:80]}  ({sent.late_us / 1000:.1f} ms late)"

    def _end(self, end: m.End) -> Iterator[str]:
        command = self.commands.pop(end.command, None)
        if command is None or isinstance(end, _EXPECTED):
            return
        self.failed += 1
        how = OUTCOMES[type(end)].replace("_", " ")
        what = clean(f"{command.driver}.{command.verb}")
        yield f"{self._time(end.t)}  {what} {how}: {clean(end.reason)}"

    def _time(self, t: int) -> str:
        return f"{exact_clock(t - self.began):>10}"
