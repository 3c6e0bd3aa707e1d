"""Plays a recording: what comes when, at which speed, and the replies to requests. No thread.

Time is handed in: microseconds of any clock that does not go back. Nothing here reaches a robot;
whatever would play something is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from woz_tui.log.coding_file import Code, Coding
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Answer
from woz_tui.protocol.requests import (
    AskMarker,
    AskMistake,
    AskNote,
    AskRelease,
    AskReplay,
    AskStop,
    Pulse,
    Replaying,
    Reply,
    Request,
)
from woz_tui.protocol.sentence import Sentence, wording_of
from woz_tui.protocol.welcome import ReplayedLog
from woz_tui.replay.bookmarks import Bookmark
from woz_tui.replay.recording import Recording, kind_of, thinned
from woz_tui.replay.seek import ReplayError, seek_time
from woz_tui.session.recent_messages import MOST
from woz_tui.session.session_plan import panels_changed, welcome

#: What a console gets.
Incoming = m.Message | Answer | dict[str, Any]

SLOWEST, FASTEST = 0.25, 16.0
#: How often it is told how the replay stands, in microseconds of the viewer's time.
PULSE_US = 1_000_000
REFUSED = Sentence("replay.refused", "this is a replay; actions are not played")
UNMOVED = Sentence("replay.unmoved", "this is a replay; the robot does not move")
HOW_TO_CODE = Sentence(
    "replay.how_to_code", "m sets a code, n writes a note, x takes your last one back"
)
UNCODED = Sentence(
    "replay.uncoded", "nobody codes this replay; begin it with --coder and your code"
)


@dataclass(frozen=True, slots=True)
class ReplayStart:
    """How a replay begins: at which speed (0.25..16), where (microseconds), standing still, and
    how long an idle stretch may be (microseconds; None: as long as it was).
    """

    speed: float = 1.0
    at_us: int = 0
    paused: bool = False
    max_idle_us: int | None = None


class ReplayPlayer:
    """See the module's text.

    Args:
        recording: What is played.
        start: How to begin.
        log: What the console shows as the log's name.
        notes: Sentences about the log that are told at the beginning: damage, what is missing.
        coding: Takes the codes and notes of whoever watches; None: nobody codes.
    """

    def __init__(
        self,
        recording: Recording,
        start: ReplayStart | None = None,
        log: str = "",
        notes: tuple[str, ...] = (),
        coding: Coding | None = None,
    ) -> None:
        self._coding = coding
        start = start or ReplayStart()
        self.recording = recording
        self.log, self.notes = log, notes
        self.rate = min(FASTEST, max(SLOWEST, start.speed))
        self.paused = start.paused
        self._cuts = recording.cuts(start.max_idle_us)
        #: How far it has been played, in microseconds of the log.
        self.t = max(recording.begin_us, min(start.at_us, recording.length_us))
        self._index = 0
        self._local = 0
        self._status_us = 0
        self._list_codes()

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self.t >= self.recording.length_us and self._index >= len(self.recording.lines)

    @property
    def still(self) -> bool:
        return self.paused or self.ended

    # -- playing -----------------------------------------------------------------------------

    def begin(self, now: int) -> list[Incoming]:
        """The welcome, and notes on the log."""
        told = self._restart_at(self.t, now)
        text = "; ".join(self.notes)
        if text:
            about = Sentence("replay.this_log", "This log: {text}", text=text)
            told.append(self._notice("warning", about))
        if self._coding is not None:
            told.append(self._notice("info", HOW_TO_CODE))
        return told

    def _notice(self, level: str, text: Sentence) -> m.Notice:
        return m.Notice(level=level, text=text, wording=wording_of({"text": text}), t=self.t)

    def tick(self, now: int) -> list[Incoming]:
        """What has become due since the last time."""
        if self.still:
            return []
        to = self.t + round((now - self._local) * self.rate)
        cut = self._cuts.crossed(self.t, to)
        if cut is not None:
            return [*self._deliver(cut.begin), *self._restart_at(cut.end, now)]
        told = self._deliver(min(to, self.recording.length_us))
        self._local = now
        if self.ended or now - self._status_us >= PULSE_US:
            told += self._status(now)
        return told

    def _deliver(self, to: int) -> list[Incoming]:
        """Everything up to `to`; the position is there then."""
        end = self.recording.index(to)
        told = self._lines(end, to)
        self._index, self.t = end, to
        return told

    def _lines(self, end: int, to: int) -> list[Incoming]:
        """The lines before number `end` and the samples up to `to`, as they follow each other."""
        samples = thinned(self.recording.samples.between(self.t, to)) if to > self.t else []
        lines: list[Incoming] = [*self.recording.lines[self._index : end]]
        codes = self._coding.between(self.t, to) if self._coding is not None else ()
        lines += map(self._as_event, codes)
        if samples:
            lines = sorted([*lines, *samples], key=_number)
        told: list[Incoming] = []
        for line in lines:
            told.append(line)
            if isinstance(line, m.SessionPlan):
                told.append(panels_changed(line))
        return told

    def _restart_at(self, t: int, now: int) -> list[Incoming]:
        recording = self.recording
        self.t = max(recording.begin_us, min(t, recording.length_us))
        self._index = recording.index(self.t)
        self._local = now
        moment = recording.moment(self._index, self.t)
        told = welcome(
            recording.plan(self._index),
            console="replay",
            role="replay",
            seq=moment.recent[-1].seq if moment.recent else -1,
            t=self.t,
            log=self.log,
        )
        anew = msgspec.structs.replace(
            told,
            state=_raw(moment.state),
            recent=_raw(self._with_codes(moment.recent)),
            settings=msgspec.structs.replace(
                told.settings, study=moment.study, replay=self._about()
            ),
        )
        return [anew, *self._status(now, marks=True)]

    def _about(self) -> ReplayedLog:
        """What the console shows of the log itself."""
        at, wall = self.recording.wall(self._index)
        start = self.recording.start
        return ReplayedLog(
            t=at,
            ts=wall,
            notes=[*self.notes],
            wizard=start.wizard if start else "",
            experiment=start.experiment if start else "",
            software=" ".join(start.software.values()) if start else "",
            lines=len(self.recording.lines),
            coder=self._coding.coder if self._coding is not None else "",
        )

    def _status(self, now: int, *, marks: bool = False) -> list[Incoming]:
        """How the replay stands, and how fast time goes on."""
        self._status_us = now
        every = self.recording.marks if marks else None
        stands = Replaying(
            t=self.t,
            length_us=self.recording.length_us,
            rate=self.rate,
            paused=self.paused,
            ended=self.ended,
            cut_us=self._cuts.before(self.t),
            marks=None if every is None else [(mark.t, mark.text) for mark in every],
            sorts=[] if every is None else [mark.sort for mark in every],
        )
        return [stands, Pulse(t=self.t, rate=0.0 if self.still else self.rate)]

    # -- what is asked -----------------------------------------------------------------------

    def ask(self, request: Request, now: int) -> list[Incoming]:
        """Carry `request` out; the reply comes first, then what follows from it."""
        caught_up = self.tick(now)
        try:
            data, told = self._carry_out(request, now)
        except ReplayError as error:
            reason, hint = error.reason, error.hint
            wording = wording_of({"reason": reason, "hint": hint})
            reply = Reply(ref=request.ref, ok=False, reason=reason, hint=hint, wording=wording)
            return [*caught_up, reply]
        return [*caught_up, Reply(ref=request.ref, ok=True, data=data), *told]

    def _carry_out(self, request: Request, now: int) -> tuple[m.Json, list[Incoming]]:
        """What the reply tells, and what follows. Raises `ReplayError`."""
        match request:
            case AskReplay(what="pause"):
                return None, self._pause(now)
            case AskReplay(what="hold"):
                plays = not self.still
                return {"plays": plays}, self._pause(now) if plays else []
            case AskReplay(what="step"):
                return self._step(now)
            case AskReplay(what="faster"):
                return None, self._speed(self.rate * 2, now)
            case AskReplay(what="slower"):
                return None, self._speed(self.rate / 2, now)
            case AskReplay(what="seek"):
                return None, self._restart_at(
                    self._cuts.moved(self.t, round(request.by_s * 1e6)), now
                )
            case AskReplay():
                return None, self._restart_at(seek_time(request.to, self.recording, self.t), now)
            case AskMarker() | AskNote() | AskMistake():
                if self._coding is None:
                    raise ReplayError(UNCODED)
                return self._code(request, self._coding, now)
            case AskStop() | AskRelease():
                raise ReplayError(UNMOVED)
        raise ReplayError(REFUSED)

    # -- coding ------------------------------------------------------------------------------

    def _code(
        self, request: AskMarker | AskNote | AskMistake, coding: Coding, now: int
    ) -> tuple[m.Json, list[Incoming]]:
        """A code or a note at the present moment; or the last one is taken back."""
        text = "" if isinstance(request, AskMistake) else request.text.strip()
        if not text and not isinstance(request, AskMistake):
            raise ReplayError(Sentence("replay.empty_code", "an empty code says nothing"))
        try:
            if isinstance(request, AskMistake):
                code = coding.take_back()
            else:
                code = coding.add(self.t, text, note=isinstance(request, AskNote))
        except OSError as error:
            why = error.strerror or error
            raise ReplayError(
                Sentence("replay.not_written", "it is not written: {why}", why=why)
            ) from error
        if code is None:
            raise ReplayError(Sentence("replay.no_code_yet", "you have set no code yet"))
        self._list_codes()
        if isinstance(request, AskMistake):
            return {"code": code.text}, self._restart_at(self.t, now)
        return {"code": code.text}, [self._as_event(code), *self._status(now, marks=True)]

    def _list_codes(self) -> None:
        if self._coding is not None:
            self.recording.codes = [
                Bookmark(code.t, "code", code.text) for code in self._coding.codes
            ]

    def _as_event(self, code: Code) -> m.Message:
        """As the list of events has it; it is no line of the log."""
        if code.note:
            return m.Note(text=f"{code.text} ({code.coder})", t=code.t)
        return m.Marker(text=code.text, source=f"coder {code.coder}", t=code.t)

    def _with_codes(self, recent: list[m.Message]) -> list[m.Message]:
        """The last lines of the log and the coder's, by time."""
        if self._coding is None:
            return recent
        codes = [self._as_event(code) for code in self._coding.codes if code.t <= self.t]
        return sorted([*recent, *codes], key=lambda message: message.t)[-MOST:]

    def _pause(self, now: int) -> list[Incoming]:
        if self.ended:
            raise ReplayError(
                Sentence("replay.at_end", "the replay is at its end"),
                Sentence("replay.press_home", "press home to go to the beginning"),
            )
        self.paused = not self.paused
        self._local = now
        return self._status(now)

    def _speed(self, rate: float, now: int) -> list[Incoming]:
        if not SLOWEST <= rate <= FASTEST:
            raise ReplayError(
                Sentence(
                    "replay.speeds",
                    "the speed goes from {slowest:g} to {fastest:g} times",
                    slowest=SLOWEST,
                    fastest=FASTEST,
                )
            )
        self.rate = rate
        return self._status(now)

    def _step(self, now: int) -> tuple[m.Json, list[Incoming]]:
        """Go to the next line that shows something, and pause there."""
        number = self.recording.step(self._index)
        if number >= len(self.recording.lines):
            raise ReplayError(Sentence("replay.no_more_lines", "this log has no more lines"))
        self.paused = True
        t = max(self.t, self.recording.times[number])
        told = self._lines(number + 1, t)
        self._index, self.t = number + 1, t
        kind = kind_of(self.recording.lines[number])
        return {"kind": kind, "t": t}, [*told, *self._status(now)]


def _number(line: Incoming) -> int:
    number = line.get("seq", -1) if isinstance(line, dict) else getattr(line, "seq", -1)
    return number if isinstance(number, int) else -1


def _raw(messages: Sequence[m.Message]) -> list[msgspec.Raw]:
    return [msgspec.Raw(codec.encode(message).rstrip()) for message in messages]
