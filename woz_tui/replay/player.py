"""Plays a reel: what comes when, at which speed, and what becomes of what is asked. No thread.

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
from woz_tui.protocol.requests import (
    AnyAnswer,
    AnyRequest,
    AskMarker,
    AskMistake,
    AskNote,
    AskRelease,
    AskReplay,
    AskStop,
    Pulse,
    Replaying,
    Reply,
)
from woz_tui.protocol.welcome import ReplayedLog
from woz_tui.replay.bookmarks import Bookmark, IdleCut
from woz_tui.replay.recording import Recording, thinned
from woz_tui.replay.seek import SeekError, seek_time
from woz_tui.session.recent_messages import MOST
from woz_tui.session.session_plan import panels_changed, welcome

#: What a console gets.
Incoming = m.AnyMessage | AnyAnswer | dict[str, Any]

SLOWEST, FASTEST = 0.25, 16.0
#: How often it is told how the replay stands, in microseconds of the viewer's time.
PULSE_US = 1_000_000
REFUSED = "this is a replay; actions are not played"
UNMOVED = "this is a replay; the robot does not move"
HOW_TO_CODE = "m sets a code, n writes a note, x takes your last one back"
UNCODED = "nobody codes this replay; begin it with --coder and your code"


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
        reel: What is played.
        start: How to begin.
        log: What the console shows as the log's name.
        notes: Sentences about the log that are told at the beginning: damage, what is missing.
        coding: Takes the codes and notes of whoever watches; None: nobody codes.
    """

    def __init__(
        self,
        reel: Recording,
        start: ReplayStart | None = None,
        log: str = "",
        notes: tuple[str, ...] = (),
        coding: Coding | None = None,
    ) -> None:
        self._coding = coding
        start = start or ReplayStart()
        self.reel = reel
        self.log, self.notes = log, notes
        self.rate = min(FASTEST, max(SLOWEST, start.speed))
        self.paused = start.paused
        self._cuts = reel.cuts(start.max_idle_us)
        self._t = max(reel.begin_us, min(start.at_us, reel.length_us))
        self._index = 0
        self._local = 0
        self._told = 0
        self._mark_codes()

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self._t >= self.reel.length_us and self._index >= len(self.reel.lines)

    @property
    def still(self) -> bool:
        """Whether time stands still."""
        return self.paused or self.ended

    @property
    def t(self) -> int:
        """How far it has been played, in microseconds of the log."""
        return self._t

    def prepare(self, count: int) -> bool:
        """Work `count` lines ahead, so that going far is quick; whether there are more."""
        return self.reel.prepare(count)

    # -- playing -----------------------------------------------------------------------------

    def begin(self, now: int) -> list[Incoming]:
        """The welcome, and what is to be said of the log."""
        told = self._go(self._t, now)
        text = "; ".join(self.notes)
        if text:
            told.append(m.Notice(level="warning", text=f"This log: {text}", t=self._t))
        if self._coding is not None:
            told.append(m.Notice(level="info", text=HOW_TO_CODE, t=self._t))
        return told

    def tick(self, now: int) -> list[Incoming]:
        """What has become due since the last time."""
        if self.still:
            return []
        to = self._t + round((now - self._local) * self.rate)
        cut = self._cuts.crossed(self._t, to)
        if cut is not None:
            return self._skip(cut, now)
        told = self._deliver(min(to, self.reel.length_us))
        self._local = now
        if self.ended or now - self._told >= PULSE_US:
            told += self._stands(now)
        return told

    def _skip(self, cut: IdleCut, now: int) -> list[Incoming]:
        return [*self._deliver(cut.begin), *self._go(cut.end, now)]

    def _deliver(self, to: int) -> list[Incoming]:
        """Everything up to `to`; the position is there then."""
        end = self.reel.index(to)
        told = self._lines(end, to)
        self._index, self._t = end, to
        return told

    def _lines(self, end: int, to: int) -> list[Incoming]:
        """The lines before number `end` and the samples up to `to`, as they follow each other."""
        samples = thinned(self.reel.samples.between(self._t, to)) if to > self._t else []
        lines: list[Incoming] = [*self.reel.lines[self._index : end]]
        codes = self._coding.between(self._t, to) if self._coding is not None else ()
        lines += map(self._said, codes)
        if samples:
            lines = sorted([*lines, *samples], key=_number)
        return [each for line in lines for each in _shown(line)]

    def _go(self, t: int, now: int, index: int | None = None) -> list[Incoming]:
        """Begin anew at `t`."""
        reel = self.reel
        self._t = max(reel.begin_us, min(t, reel.length_us))
        self._index = reel.index(self._t) if index is None else index
        self._local = now
        moment = reel.moment(self._index, self._t)
        told = welcome(
            reel.plan(self._index),
            console="replay",
            role="replay",
            seq=moment.recent[-1].seq if moment.recent else -1,
            t=self._t,
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
        return [anew, *self._stands(now, marks=True)]

    def _about(self) -> ReplayedLog:
        """What the console shows of the log itself."""
        at, wall = self.reel.wall(self._index)
        start = self.reel.start
        return ReplayedLog(
            t=at,
            ts=wall,
            notes=[*self.notes],
            wizard=start.wizard if start else "",
            experiment=start.experiment if start else "",
            software=" ".join(start.software.values()) if start else "",
            lines=len(self.reel.lines),
            coder=self._coding.coder if self._coding is not None else "",
        )

    def _stands(self, now: int, *, marks: bool = False) -> list[Incoming]:
        """How the replay stands, and how fast time goes on."""
        self._told = now
        every = self.reel.marks if marks else None
        stands = Replaying(
            t=self._t,
            length_us=self.reel.length_us,
            rate=self.rate,
            paused=self.paused,
            ended=self.ended,
            cut_us=self._cuts.before(self._t),
            marks=None if every is None else [(mark.t, mark.text) for mark in every],
            sorts=[] if every is None else [mark.sort for mark in every],
        )
        return [stands, Pulse(t=self._t, rate=0.0 if self.still else self.rate)]

    # -- what is asked -----------------------------------------------------------------------

    def ask(self, request: AnyRequest, now: int) -> list[Incoming]:
        """Carry `request` out; the reply comes first, then what follows from it."""
        caught_up = self.tick(now)
        if isinstance(request, AskMarker | AskNote | AskMistake) and self._coding is not None:
            return [*caught_up, *self._code(request, self._coding, now)]
        if not isinstance(request, AskReplay):
            reason = UNMOVED if isinstance(request, AskStop | AskRelease) else REFUSED
            if isinstance(request, AskMarker | AskNote | AskMistake):
                reason = UNCODED
            return [*caught_up, Reply(ref=request.ref, ok=False, reason=reason)]
        try:
            data, told = self._carry(request, now)
        except SeekError as error:
            reply = Reply(ref=request.ref, ok=False, reason=str(error), hint=error.hint)
            return [*caught_up, reply]
        return [*caught_up, Reply(ref=request.ref, ok=True, data=data), *told]

    def _carry(self, request: AskReplay, now: int) -> tuple[m.Json, list[Incoming]]:
        match request.what:
            case "pause":
                return None, self._pause(now)
            case "step":
                return self._step(now)
            case "faster" | "slower":
                factor = 2.0 if request.what == "faster" else 0.5
                return None, self._speed(self.rate * factor, now)
            case "seek":
                return None, self._go(self._cuts.moved(self._t, round(request.by_s * 1e6)), now)
            case "go":
                return None, self._go(seek_time(request.to, self.reel, self._t), now)

    # -- coding ------------------------------------------------------------------------------

    def _code(
        self, request: AskMarker | AskNote | AskMistake, coding: Coding, now: int
    ) -> list[Incoming]:
        """A code or a note at the present moment; or the last one is taken back."""
        text = getattr(request, "text", "").strip()
        if not text and not isinstance(request, AskMistake):
            return [Reply(ref=request.ref, ok=False, reason="an empty code says nothing")]
        try:
            if isinstance(request, AskMistake):
                code = coding.take_back()
            else:
                code = coding.add(self._t, text, note=isinstance(request, AskNote))
        except OSError as error:
            reason = f"it is not written: {error.strerror or error}"
            return [Reply(ref=request.ref, ok=False, reason=reason)]
        if code is None:
            return [Reply(ref=request.ref, ok=False, reason="you have set no code yet")]
        self._mark_codes()
        told: list[Incoming] = [Reply(ref=request.ref, ok=True, data={"code": code.text})]
        if isinstance(request, AskMistake):
            return [*told, *self._go(self._t, now)]
        return [*told, self._said(code), *self._stands(now, marks=True)]

    def _mark_codes(self) -> None:
        if self._coding is not None:
            self.reel.codes = [Bookmark(code.t, "code", code.text) for code in self._coding.codes]

    def _said(self, code: Code) -> m.AnyMessage:
        """As the list of events has it; it is no line of the log."""
        if code.note:
            return m.Note(text=f"{code.text} ({code.coder})", t=code.t)
        return m.Marker(text=code.text, source=f"coder {code.coder}", t=code.t)

    def _with_codes(self, recent: list[m.Message]) -> list[m.Message]:
        """The last lines of the log and the coder's, by time."""
        if self._coding is None:
            return recent
        codes = [self._said(code) for code in self._coding.codes if code.t <= self._t]
        return sorted([*recent, *codes], key=lambda message: message.t)[-MOST:]

    def _pause(self, now: int) -> list[Incoming]:
        if self.ended:
            raise SeekError("the replay is at its end", "press home to go to the beginning")
        self.paused = not self.paused
        self._local = now
        return self._stands(now)

    def _speed(self, rate: float, now: int) -> list[Incoming]:
        if not SLOWEST <= rate <= FASTEST:
            raise SeekError(f"the speed goes from {SLOWEST:g} to {FASTEST:g} times")
        self.rate = rate
        return self._stands(now)

    def _step(self, now: int) -> tuple[m.Json, list[Incoming]]:
        """To the next line that says something; the replay stands still there."""
        number = self.reel.step(self._index)
        if number >= len(self.reel.lines):
            raise SeekError("this log has no more lines")
        self.paused = True
        t = max(self._t, self.reel.times[number])
        told = self._lines(number + 1, t)
        self._index, self._t = number + 1, t
        line = self.reel.lines[number]
        kind = line.get("kind") if isinstance(line, dict) else line.__struct_config__.tag
        return {"kind": str(kind), "t": t}, [*told, *self._stands(now)]


def _number(line: Incoming) -> int:
    number = line.get("seq", -1) if isinstance(line, dict) else getattr(line, "seq", -1)
    return number if isinstance(number, int) else -1


def _shown(line: Incoming) -> list[Incoming]:
    """The line, and what a console is told beside it."""
    return [line, panels_changed(line)] if isinstance(line, m.SessionPlan) else [line]


def _raw(messages: Sequence[m.Message]) -> list[msgspec.Raw]:
    return [msgspec.Raw(codec.encode(message).rstrip()) for message in messages]
