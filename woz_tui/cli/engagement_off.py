"""When an engagement model was switched off, or was not there: time that belongs to no state."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from woz_tui.config.engagement import RUNS
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.protocol import messages as m

OFF = "off"


@dataclass(frozen=True, slots=True)
class OffPeriod:
    """From `since` to `until`, in microseconds; `gone`: there was no model, and the next one begins
    anew.
    """

    since: int
    until: int
    gone: bool


@dataclass(slots=True)
class OffPeriods:
    """Stretches in which a model was off, oldest first. It begins with a model that is there."""

    stretches: list[OffPeriod] = field(default_factory=list)
    _since: int | None = None
    _gone: bool = False

    def see(self, t: int, *, there: bool, on: bool) -> None:
        """How it stands from `t` on, in microseconds; `on` is of a model that is there."""
        gone = not there
        if self._since is not None and ((there and on) or gone != self._gone):
            self.close(t)
        if self._since is None and (gone or not on):
            self._since, self._gone = t, gone

    def close(self, t: int) -> None:
        """The stretch that is open, if one is, ends here."""
        if self._since is not None:
            self.stretches.append(OffPeriod(self._since, max(self._since, t), self._gone))
        self._since = None

    @property
    def us(self) -> int:
        """All of it, in microseconds."""
        return sum(each.until - each.since for each in self.stretches)

    def within(self, since: int, until: int) -> int:
        """How much of the time from `since` to `until` it was off, in microseconds."""
        overlaps = (
            min(until, each.until) - max(since, each.since)
            for each in self.stretches
            if each.until > since and each.since < until
        )
        return sum(overlaps)

    def beginnings(self) -> Iterator[int]:
        """When a model began anew, in microseconds."""
        return (each.until for each in self.stretches if each.gone)


class RecordedModel:
    """Follows what a log says of its own model.

    It is there from its first settings on, as they say (in logs of an earlier version, which tell
    none, from the beginning), until settings say that the section is gone; the verb `engagement`
    switches it.
    """

    def __init__(self, *, there: bool, on: bool) -> None:
        self.off = OffPeriods()
        self._there, self._on, self._told = there, on, False
        self.off.see(0, there=there, on=on)

    def take(self, message: m.AnyMessage) -> None:
        """A message of the session."""
        match message:
            case m.EngagementAdopted(settings=settings):
                if settings and not (self._there and self._told):
                    self._on = settings.get("start", "run") != OFF
                self._there, self._told = bool(settings), True
            case m.Done(driver=driver, sent=sent) if driver == ENGAGEMENT:
                if sent.get("run") in RUNS:
                    self._on = sent["run"] != OFF
            case _:
                return
        self.off.see(message.t, there=self._there, on=self._on)
