"""Writes a log anew without the lines of one of its participants."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, BinaryIO

import msgspec

from woz_tui import __version__
from woz_tui.export.feature_export import begun_subjects, id_fields, kinds_of_session
from woz_tui.log.damage import Damage
from woz_tui.log.line_reader import LogLine
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.timeline.session_state import LATEST_TIME, SessionState
from woz_tui.withdrawal.code_words import CodeWords, is_distinct, texts_in

_encoder = msgspec.json.Encoder()

#: Lines that say nothing of a participant: of the session, its file, its devices and its log.
#: Whoever comes next stands on them, so they stay.
OF_THE_SESSION = frozenset(
    {
        *("session.start", "session.plan", "session.end", "participant.withdrawn"),
        *("experiment.files", "experiment.reloaded"),
        *("clock", "checkpoint", "recorder.state", "record.waived", "process.stalled"),
        *("driver.connecting", "driver.connected", "driver.lost", "driver.faulted"),
        *("verbs.unable", "lane.faulted", "lane.recovered", "mode.changed", "settings.shown"),
        *("console.attached", "console.lost", "listener.joined", "listener.left"),
        *("panel.locked", "perception.changed"),
        *("engagement.settings",),
        *("rerun.started", "rerun.ended"),
    }
)
#: Lines whose texts are those of the experiment file, which may list codes as examples.
OF_THE_FILE = frozenset({"experiment.files", "session.plan"})
#: Lines whose `file` was recorded.
OF_RECORDINGS = frozenset({"speech.ended"})
#: Fields whose codes are none of participants.
_OTHER_CODES = frozenset({"kind", "session", "wizard", "run", "command", "console", "sha256"})
#: What begins something that ends with another line, without an id: it is whose it began with.
_BEGINS = frozenset({"trial.started", "break.started", "stop.pressed", "speech.started"})


@dataclass
class CutSummary:
    """What was taken out, and what was found on the way.

    Attributes:
        lines: Lines of actions that were taken out; `samples` the same of samples.
        spans: Their time, in microseconds of `t`, each up to the line that sets somebody else.
        files: Files that lines name which were taken out; `kept_files` those that others name.
        named: Kinds of other lines in which the code stood as a word and was replaced.
        left: Kinds of lines in which it still stands: the experiment's own text, or a code that
            may be something else there.
    """

    lines: int = 0
    samples: int = 0
    spans: list[tuple[int, int]] = field(default_factory=list)
    files: set[str] = field(default_factory=set)
    kept_files: set[str] = field(default_factory=set)
    named: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)


@dataclass
class _Run:
    """Lines with numbers one behind the other that are taken out."""

    first: int
    t: int
    ts: str = ""
    last: int = 0
    until: int = 0
    lines: int = 0
    samples: int = 0
    theirs: bool = False
    condition: str = ""
    trial: int | None = None

    def add(self, line: LogLine) -> None:
        self.last, self.until = line.seq, line.t
        self.ts = self.ts or line.ts
        if line.sample:
            self.samples += 1
        else:
            self.lines += 1


class LogCut:
    """Takes the lines of a session in their order and writes those that stay.

    A line is whose time it was; of an action, a command, an utterance, a trial and the like all
    lines are of whom it began with. Numbers and times stay; a line `participant.withdrawn` stands
    in the place of what is taken out, and has what holds behind it. Sums that were right are right
    again, others stay wrong.

    Args:
        code: The participant's.
        day: The day of the withdrawal.
        rename: Makes texts name files as they will be called.
    """

    def __init__(
        self,
        actions: BinaryIO,
        samples: BinaryIO,
        *,
        code: str,
        day: str,
        rename: Callable[[str], str],
    ) -> None:
        self.summary = CutSummary()
        self._actions, self._samples = actions, samples
        self._code, self._day, self._rename = code, day, rename
        self._words = CodeWords([code])
        #: What the log says, and what it will say.
        self._state, self._after = SessionState(), SessionState()
        self._old, self._new = hashlib.sha256(), hashlib.sha256()
        self._lines = 0
        #: Whether what has this id is theirs.
        self._owners: dict[tuple[object, ...], bool] = {}
        self._run: _Run | None = None
        self._ts = ""
        #: Since when it is their time.
        self._since: int | None = None

    def add(self, line: LogLine) -> None:
        """The next line of the session."""
        if not line.sample and line.message is not None:
            self._state.apply(line.message)
            self._note_turn(line.t)
        theirs = self._is_theirs(line)
        (self.summary.files if theirs else self.summary.kept_files).update(files_in(line))
        if theirs:
            self._take_out(line)
        else:
            self._end_run()
            self._keep(line)
        if not line.sample:
            self._old.update(line.raw + b"\n")
            self._ts = line.ts or self._ts

    def finish(self, damage: Damage, stem: str) -> None:
        """There are no more lines. What the recorder itself said of its losses stays."""
        self._end_run()
        if self._since is not None:
            self.summary.spans.append((self._since, LATEST_TIME))
        start = self._state.start
        lost = damage.dropped or damage.dropped_samples
        for since, until, waived in damage.unwritten or ([(-1, -1, -1)] if lost else []):
            said = m.Segment(
                t=until,
                log=stem,
                session=start.session if start is not None else "",
                number=1,
                dropped=damage.dropped,
                dropped_samples=damage.dropped_samples,
                unwritten_since=since,
                waived_at=waived,
            )
            self._actions.write(codec.encode(said))

    def _note_turn(self, t: int) -> None:
        now = self._state.study.participant == self._code
        if now and self._since is None:
            self._since = t
        elif not now and self._since is not None:
            self.summary.spans.append((self._since, t))
            self._since = None

    # -- whose a line is --------------------------------------------------------------------------

    def _is_theirs(self, line: LogLine) -> bool:
        now = self._state.study.participant == self._code
        if line.kind in OF_THE_SESSION | kinds_of_session():
            return False
        keys = list(_keys(line))
        subject, _, what = line.kind.partition(".")
        if line.kind in _BEGINS or (what == "started" and subject in begun_subjects()):
            self._owners.update(dict.fromkeys(keys, now))
            return now
        theirs = next((self._owners[key] for key in keys if key in self._owners), now)
        for key in keys:
            self._owners.setdefault(key, theirs)
        return theirs

    # -- what is written --------------------------------------------------------------------------

    def _take_out(self, line: LogLine) -> None:
        if self._run is None:
            self._run = _Run(line.seq, line.t)
        run = self._run
        run.add(line)
        run.theirs = self._state.study.participant == self._code
        run.condition = self._state.study.condition
        if isinstance(line.message, m.SessionChanged) and line.message.trial is not None:
            run.trial = line.message.trial

    def _end_run(self) -> None:
        run, self._run = self._run, None
        if run is None:
            return
        study = self._after.study
        message = m.ParticipantWithdrawn(
            seq=run.first,
            t=run.t,
            ts=run.ts or self._ts,
            last_removed=run.last,
            removed=run.lines,
            removed_samples=run.samples,
            removed_until=run.until,
            day=self._day,
            version=__version__,
            participant="" if run.theirs and study.participant else None,
            condition=run.condition if run.condition != study.condition else None,
            trial=run.trial,
        )
        self.summary.lines += run.lines
        self.summary.samples += run.samples
        self._after.apply(message)
        self._write(codec.encode(message).rstrip(b"\n"))

    def _keep(self, line: LogLine) -> None:
        fields = self._without_code(line)
        if line.sample:
            raw = line.raw if fields is line.fields else _encoder.encode(fields)
            self._samples.write(raw + b"\n")
            return
        if fields.get("sha256") == self._old.hexdigest():
            if line.kind == "checkpoint":
                sums = {"sha256": self._new.hexdigest(), "lines": self._lines}
                fields = {**fields, **sums}
            elif line.kind == "session.end":
                fields = {**fields, "sha256": self._new.hexdigest()}
        raw = line.raw if fields is line.fields else _encoder.encode(fields)
        if line.message is not None:
            self._after.apply(line.message if raw is line.raw else codec.decode_message(raw))
        self._write(raw)

    def _write(self, raw: bytes) -> None:
        self._actions.write(raw + b"\n")
        self._new.update(raw + b"\n")
        self._lines += 1

    def _without_code(self, line: LogLine) -> dict[str, Any]:
        """The fields of a line that stays; the same object if nothing of them names the person."""
        if self._code.encode() not in line.raw or not codes_in(line.fields, self._words):
            return line.fields
        if line.kind in OF_THE_FILE:
            self.summary.left.append(line.kind)
            return line.fields
        fields: dict[str, Any] = line.fields
        if line.kind == "session.start" and fields.get("participant") == self._code:
            fields = {**fields, "participant": ""}
        fields = _with_texts_of_people(fields, self._rename)
        if codes_in(fields, self._words):
            if not is_distinct(self._code):
                self.summary.left.append(line.kind)
            else:
                self.summary.named.append(line.kind)
                fields = _with_texts_of_people(fields, self._words.without)
        return fields


def _keys(line: LogLine) -> Iterator[tuple[object, ...]]:
    """What a line belongs to, by id; the more general first."""
    fields = line.fields
    for name in ("run", "command", *id_fields()):
        if isinstance(given := fields.get(name), str) and given:
            yield name, given
    subject = line.kind.partition(".")[0]
    if subject == "speech":
        yield subject, str(fields.get("driver")), str(fields.get("segment"))
    elif subject in ("trial", "break", "stop", *begun_subjects()):
        yield (subject,)


def files_in(line: LogLine) -> list[str]:
    """The file that was recorded with a line; what it names otherwise, such as the sound of an
    action, is the experiment's.
    """
    file = line.fields.get("file")
    return [file] if line.kind in OF_RECORDINGS and isinstance(file, str) and file else []


def codes_in(fields: Mapping[str, Any], words: CodeWords) -> set[str]:
    """The codes of participants that a line names, in whatever field."""
    values = [value for name, value in fields.items() if name not in _OTHER_CODES]
    return {code for text in texts_in(values) for code in words.within(text)}


def _with_texts_of_people(fields: dict[str, Any], change: Callable[[str], str]) -> dict[str, Any]:
    return {
        name: value if name in _OTHER_CODES else _with_texts(value, change)
        for name, value in fields.items()
    }


def _with_texts(value: Any, change: Callable[[str], str]) -> Any:
    match value:
        case str():
            return change(value)
        case list():
            return [_with_texts(item, change) for item in value]
        case dict():
            return {change(name): _with_texts(item, change) for name, item in value.items()}
    return value
