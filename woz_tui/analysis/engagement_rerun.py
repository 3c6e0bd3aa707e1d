"""A session's log through the engagement model once more.

The same follower that the robot process uses reads the same messages, so with the settings of the
session its transitions come out exactly as they were; with others they tell what those would have
said. What the robot did then it has done: its sentences stay where they were.

A log has its settings itself (`engagement.settings`), also those that a reload brought in the
middle. What somebody names stands above all of them, and above the wizard's keys for just that:
whoever asks for another filter asks for it from the beginning to the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import settings_from_json, settings_to_json
from woz_tui.config.engagement_words import RUNS
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.log.log_reader import Damage, LogLine, read
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.engagement_stream import EngagementFollower
from woz_tui.sensing.model_time import SECOND
from woz_tui.timeline.session_state import SessionState

#: Arguments of the verbs by which the wizard changes settings while a session runs.
FILTER = frozenset({"kind", "samples", "threshold"})


@dataclass(frozen=True)
class SettingsOverride:
    """What stands above a log: `change` makes of the settings recorded those to go by, `named` are
    the arguments of verbs that do not count, such as `{"filter": {"kind"}}`.
    """

    change: Callable[[EngagementSettings], EngagementSettings] = lambda recorded: recorded
    named: Mapping[str, frozenset[str]] = field(default_factory=dict)
    #: Whether all of the log is computed with the same settings.
    one: bool = False

    @classmethod
    def always(
        cls, settings: EngagementSettings, named: Mapping[str, frozenset[str]] | None = None
    ) -> SettingsOverride:
        """The same settings, whatever the log tells."""
        return cls(lambda recorded: settings, named or {}, one=True)


class ModelRerun:
    """The model as it goes through a log.

    Args:
        settings: Those of the beginning; None: there is no model before the log tells some.
        above: What is made of what the log tells.
    """

    def __init__(self, settings: EngagementSettings | None, above: SettingsOverride) -> None:
        self.settings = settings or EngagementSettings()
        self.follower = None if settings is None else EngagementFollower(settings)
        self.above = above
        self._state = SessionState()
        #: Verbs with arguments that do not count, by command.
        self._passed_verbs: dict[str, str] = {}
        #: When keys of the wizard were passed over, in microseconds.
        self.passed_over: list[int] = []
        #: Why settings of the log were not taken.
        self.unreadable: list[str] = []
        #: When the log told settings, in microseconds.
        self.settings_at: list[int] = []

    def apply(self, message: m.Message) -> Sequence[Transition]:
        """One message; the transitions that it brought."""
        if not isinstance(message, m.Reading | m.EngagementShown):
            self._state.apply(message)
        understood = self._understood(message)
        if understood is None or self.follower is None:
            return ()
        return [*self.follower.apply(understood)]

    def until(self, t: int) -> Sequence[Transition]:
        """What happens by itself up to `t`."""
        return () if self.follower is None else [*self.follower.until(t)]

    def _understood(self, message: m.Message) -> m.Message | None:
        """The message as the model is to hear it; None: not at all."""
        match message:
            case m.EngagementAdopted():
                return self._settled(message)
            case m.Command(driver=driver, verb=verb) if driver == ENGAGEMENT:
                if verb in self.above.named:
                    self._passed_verbs[message.command] = verb
            case m.End(command=command) if command in self._passed_verbs:
                return self._obeyed(message, self.above.named[self._passed_verbs.pop(command)])
        return message

    def _obeyed(self, end: m.Message, named: frozenset[str]) -> m.Message | None:
        if not isinstance(end, m.Done) or not named & end.sent.keys():
            return end
        self.passed_over.append(end.t)
        left = {name: value for name, value in end.sent.items() if name not in named}
        return msgspec.structs.replace(end, sent=left) if left.keys() - {"sign"} else None

    def _settled(self, adopted: m.EngagementAdopted) -> m.Message | None:
        self.settings_at.append(adopted.t)
        if not adopted.settings:
            self.follower = None
            return None
        try:
            self.settings = self.above.change(settings_from_json(adopted.settings))
        except ValueError as error:
            self.unreadable.append(str(error))
            return None
        if self.follower is None:
            # As live: a model that begins in mid-session is told what holds.
            self.follower = EngagementFollower(self.settings)
            self.follower.catch_up(self._state.messages())
        return msgspec.structs.replace(adopted, settings=settings_to_json(self.settings))


# When an engagement model was switched off, or was not there: time that belongs to no state.

OFF = "off"


@dataclass(frozen=True, slots=True)
class OffPeriod:
    """From `since` to `until`, in microseconds; `missing`: there was no model, and the next one
    begins anew.
    """

    since: int
    until: int
    missing: bool


@dataclass(slots=True)
class OffPeriods:
    """Stretches in which a model was off, oldest first. It begins with a model that is there."""

    stretches: list[OffPeriod] = field(default_factory=list)
    _since: int | None = None
    _missing: bool = False

    def see(self, t: int, *, present: bool, on: bool) -> None:
        """How it stands from `t` on, in microseconds; `on` is of a model that is there."""
        missing = not present
        if self._since is not None and ((present and on) or missing != self._missing):
            self.close(t)
        if self._since is None and (missing or not on):
            self._since, self._missing = t, missing

    def close(self, t: int) -> None:
        """The stretch that is open, if one is, ends here."""
        if self._since is not None:
            self.stretches.append(OffPeriod(self._since, max(self._since, t), self._missing))
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
        return (each.until for each in self.stretches if each.missing)


class RecordedModel:
    """Follows what a log says of its own model.

    It is there from its first settings on, as they say (in logs of an earlier version, which tell
    none, from the beginning), until settings say that the section is gone; the verb `engagement`
    switches it.
    """

    def __init__(self, *, present: bool, on: bool) -> None:
        self.off = OffPeriods()
        self._present, self._on, self._has_settings = present, on, False
        self.off.see(0, present=present, on=on)

    def apply(self, message: m.Message) -> None:
        """A message of the session."""
        match message:
            case m.EngagementAdopted(settings=settings):
                if settings and not (self._present and self._has_settings):
                    self._on = settings.get("start", "run") != OFF
                self._present, self._has_settings = bool(settings), True
            case m.Done(driver=driver, sent=sent) if driver == ENGAGEMENT:
                if sent.get("run") in RUNS:
                    self._on = sent["run"] != OFF
            case _:
                return
        self.off.see(message.t, present=self._present, on=self._on)


_SAMPLE, SETTINGS_KIND = "sample", "engagement.settings"


@dataclass
class LogRerun:
    """What a log says, and what the model makes of it now; times in microseconds.

    `recorded` are the transitions that the session has logged, `computed` those of now. `end` is
    the last line's time, `sensors` what of the model's signs was ever sensed, `reloads` when the
    section of the experiment was changed while the session ran. `recorded_off` and `computed_off`:
    when the model of then, and that of now, was switched off or not there.
    """

    recorded: list[Transition] = field(default_factory=list)
    computed: list[Transition] = field(default_factory=list)
    end: int = 0
    sensors: set[str] = field(default_factory=set)
    reloads: list[int] = field(default_factory=list)
    start: m.SessionStart | None = None
    again: ModelRerun | None = None
    recorded_off: OffPeriods = field(default_factory=OffPeriods)
    computed_off: OffPeriods = field(default_factory=OffPeriods)


def rerun(
    path: Path,
    settings: EngagementSettings | None,
    damage: Damage,
    tell: Callable[[Transition], object] | None = None,
    above: SettingsOverride | None = None,
) -> LogRerun:
    """Read the log to which `path` belongs; `tell` hears of each transition as it is computed.

    `settings` hold from the beginning (None: from where the log tells some), and all the time
    unless `above` says what is made of those that the log tells.
    Raises `FileNotFoundError` and `ValueError` as `log_reader.read` does.
    """
    again = ModelRerun(
        settings, above or (SettingsOverride.always(settings) if settings else SettingsOverride())
    )
    recount = LogRerun()
    then = RecordedModel(present=settings is not None, on=settings is None or settings.start != OFF)
    recount.recorded_off = then.off
    _switched(recount.computed_off, again, 0)

    def follow(changes: Sequence[Transition]) -> None:
        recount.computed += changes
        if tell is not None:
            for change in changes:
                tell(change)

    for line in read(path, damage):
        recount.end = max(recount.end, line.t)
        sensor, follower = line.fields.get("sensor"), again.follower
        if line.kind == _SAMPLE and (
            follower is None or not isinstance(sensor, str) or sensor not in follower.sensors
        ):
            continue
        message = message_of(line)
        if message is not None:
            _note(recount, message)
            then.apply(message)
            follow(again.apply(message))
            _switched(recount.computed_off, again, message.t)
    follow(again.until(recount.end))
    for off in (recount.recorded_off, recount.computed_off):
        off.close(recount.end)
    recount.again = again
    return recount


def _switched(off: OffPeriods, again: ModelRerun, t: int) -> None:
    follower = again.follower
    off.see(t, present=follower is not None, on=follower is not None and follower.model.run != OFF)


def message_of(line: LogLine) -> m.Message | None:
    """The line as a message; a truth value counts as the number that it is live."""
    if line.kind == _SAMPLE and isinstance(line.fields.get("value"), bool):
        sensor, value = str(line.fields.get("sensor")), float(line.fields["value"])
        return m.Reading(seq=line.seq, t=line.t, sensor=sensor, value=value)
    return line.message


def _note(recount: LogRerun, message: m.Message) -> None:
    match message:
        case m.Reading(sensor=sensor):
            recount.sensors.add(sensor)
        case m.EngagementChanged():
            recount.recorded.append(
                Transition(
                    t=message.t,
                    was=message.was,
                    now=message.now,
                    outcome=message.outcome,
                    why=message.why,
                    verdicts=message.verdicts,
                    visitor=message.visitor,
                    forced=message.forced,
                )
            )
        case m.ExperimentReloaded(changes=changes):
            if any("engagement" in change for change in changes):
                recount.reloads.append(message.t)
        case m.SessionStart():
            recount.start = message


def line_of(change: Transition) -> dict[str, m.Json]:
    """A transition in the fields of the lines of samples, and what a session knows besides."""
    line: dict[str, m.Json] = {
        "t": change.t / SECOND,
        "presence": change.verdicts.get("presence"),
        "gaze": change.verdicts.get("gaze"),
        "id": change.verdicts.get("identity"),
        "distance": change.verdicts.get("distance"),
        "state": change.now,
        "outcome": change.outcome,
        "why": change.why,
    }
    if change.visitor:
        line["visitor"] = change.visitor
    if change.forced:
        line["forced"] = True
    return line
