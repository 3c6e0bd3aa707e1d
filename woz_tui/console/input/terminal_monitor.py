"""Measures the line to the wizard's terminal: round trip, whether it lives, which keys are stale.

The round trip is measured with the question `CSI 5 n` (are you well?), to which every terminal
answers `CSI 0 n`. The cursor's position, `CSI 6 n`, would measure the same, but its answer in the
first row cannot be told from F3 with modifiers. Inside tmux and screen it is they who answer: the
measure then ends at them, and not at the wizard's desk.

How old a key may be follows from the last question that was answered in front of it: bytes keep
their order, so whatever comes behind an answer was typed after its question was asked. An answer
that was under way for long itself makes nothing fresh. A key is stale if it may be older than
`stale_after`; and, whatever the line says, if eight keys or more came in one read: text pasted
into a terminal without paste marks.

What follows such a read within 0.3 s is the rest of it, however few keys it has; not what is typed
on and on behind it, or a key that is held, nor what comes behind a text in a dialog, where it plays
nothing and the next key sends it.

A terminal that has never answered says nothing of the kind. Then a key is stale if this process
itself stood still for longer (stopped, or the computer slept) while keys came, and so are those
behind it, up to a pause of 0.3 s.

There, and inside tmux and screen, it is also stale if it comes with two others in one read when
none had come for as long: nobody types that, a line that was frozen sends it.

Repeats of one and the same key, held down, count as few: a third of a second of them may share a
read after a silence, a second of them at any time.

An answer may get lost, and then the next one must not be taken for it: it would make keys fresh
that came before it. A question that stays unanswered is therefore followed by another one, `CSI c`
(who are you?), whose answer settles all questions asked before it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from woz_tui.console.link.message_feed import MessageFeed
from woz_tui.protocol.requests import Beat
from woz_tui.system.clock import Clock

#: The question, and the other one while that is unanswered.
QUESTION, OTHER_QUESTION = "\x1b[5n", "\x1b[c"
#: One of them is asked so often: no key is believed to be older than it is by more than this and
#: the round trip. Where keys must be younger, so many times before one would be too old.
EVERY_S, TIMES = 0.5, 3
#: The same while the terminal takes no output, so that nothing could be asked.
PUT_OFF_S = 0.25
#: A question unanswered for so long: the line is dead, and driving stops. With the time until the
#: next question is due, and a beat, driving ends within three seconds.
DEAD_S = 2.0
#: A pause that ends a burst of stale keys; the rest of a text comes within this time.
PAUSE_S = 0.3
#: Keys in one read that nobody typed: after a silence, and at any time.
BURST, PASTED = 3, 8
#: The same for repeats of one key, at 30 a second.
REPEATS_AFTER_SILENCE, REPEATS = 10, 30


class Moment(NamedTuple):
    """When something was asked; the machine may have slept since."""

    now_us: int
    boot_us: int


class TerminalMonitor:
    """Used from the thread that reads the terminal; `rtt_ms` and `ok` may be read anywhere.

    What it finds out it also writes to the feed, which tells the host with every beat.
    """

    def __init__(self, feed: MessageFeed, clock: Clock, *, multiplexed: bool = False) -> None:
        """`multiplexed`: it is tmux or screen that answers."""
        self._feed = feed
        self._clock = clock
        self._multiplexed = multiplexed
        #: Whether this terminal has ever answered: one that does not is not dead for that.
        self._answers = False
        #: The question that is out; and when it was asked who it is, of what is unanswered.
        self._question_at: Moment | None = None
        self._unknown: deque[Moment] = deque()
        #: What comes now was typed after this.
        self._since = self._moment()
        self.reset()

    def reset(self) -> None:
        """Begin anew, at the start and after a suspension: old silence says nothing. What is under
        way may be as old as before.

        The terminal is asked who it is whenever it is taken.
        """
        asked = self._moment()
        self.rtt_ms: float | None = None
        self.ok = True
        self._unknown.append(asked)
        #: Since when an answer is due, or would be if the terminal took the question.
        self._unanswered_us: int | None = None
        #: When the question was asked that was answered last, and when its answer came: what had
        #: been written before the one has reached the terminal at the other. None: never.
        self.confirmed_us: tuple[int, int] | None = None
        #: The shortest time from a question to its answer so far, in microseconds; 0: unknown.
        self.quickest_us = 0
        self._hurried = False
        self._first_us: int | None = None
        self._due_us = asked.now_us
        if self._question_at is not None:
            self._due_us += round(self._every_s * 1_000_000)
        self._keys_us = self._awake_us = asked.boot_us
        self._gap_us = 0
        self._burst = self._untyped = False
        #: When text that nobody typed came last.
        self._text_us: int | None = None
        self._away = False
        self._publish()

    def leave(self) -> None:
        """Nobody watches from here on, until `reset`: the console is about to be suspended."""
        self._away = True
        self.ok = False
        self._publish()

    @property
    def _stale_us(self) -> float:
        return self._feed.stale_after_s * 1_000_000

    @property
    def _every_s(self) -> float:
        return min(EVERY_S, self._feed.stale_after_s / TIMES)

    def _moment(self) -> Moment:
        return Moment(self._clock.now_us(), self._clock.boot_us())

    # -- questions --------------------------------------------------------------------------------

    @property
    def question_in_s(self) -> float:
        """Seconds until the next question is due; 0 or less: now."""
        if self._hurried and self._question_at is None:
            return 0.0
        return (self._due_us - self._clock.now_us()) / 1_000_000

    @property
    def question(self) -> str:
        """What is to be asked next."""
        return QUESTION if self._question_at is None else OTHER_QUESTION

    def hurry(self) -> None:
        """Ask as soon as no question is out: somebody wants to know when all has been taken."""
        self._hurried = True

    @property
    def waits(self) -> bool:
        """Whether nobody knows yet if this terminal answers: it was asked only a moment ago."""
        asked = self._first_us
        return asked is None or self._clock.now_us() - asked < DEAD_S * 1_000_000

    def question_sent(self) -> None:
        """`question` went out just now."""
        asked = self._moment()
        if self._question_at is None:
            self._question_at = asked
        else:
            self._unknown.append(asked)
        self._wait_for_answer(asked.now_us)
        self._first_us = self._first_us or asked.now_us
        self._hurried = False
        self._due_us = asked.now_us + round(self._every_s * 1_000_000)

    def put_off(self) -> None:
        """The terminal takes no output at the moment: ask later."""
        now = self._clock.now_us()
        self._hurried = False
        self._wait_for_answer(now)
        self._due_us = now + round(PUT_OFF_S * 1_000_000)

    def _wait_for_answer(self, since_us: int) -> None:
        if self._unanswered_us is None:
            self._unanswered_us = since_us

    # -- answers ----------------------------------------------------------------------------------

    def answered(self) -> None:
        """The terminal answered the question: what comes behind was typed after it was asked."""
        asked, self._question_at = self._question_at, None
        if asked is None:
            return
        while self._unknown and self._unknown[0] <= asked:
            self._unknown.popleft()  # asked before: its answer would have come before, too
        self._answers = True
        self._confirm(asked)

    def identified(self) -> None:
        """The terminal said who it is: the same for that question, the oldest if several are out.

        A question that was asked before it has no answer any more.
        """
        if not self._unknown:
            return
        asked = self._unknown.popleft()
        if self._question_at is not None and self._question_at < asked:
            self._question_at = None
        self._since = max(self._since, asked)
        if self._question_at is None:
            self._confirm(asked)

    def _confirm(self, asked: Moment) -> None:
        now = self._clock.now_us()
        took_us = now - asked.now_us
        self._since = max(self._since, asked)
        self._unanswered_us = None
        self._burst = False
        self.rtt_ms = took_us / 1000
        self.confirmed_us = (asked.now_us, now)
        self.quickest_us = min(took_us, self.quickest_us or took_us)
        self._due_us = max(now, asked.now_us + round(self._every_s * 1_000_000))
        self._judge(now)

    # -- keys -------------------------------------------------------------------------------------

    def awake(self) -> None:
        """The reading thread runs; to be called before each read, and every half second."""
        boot = self._clock.boot_us()
        self._gap_us, self._awake_us = boot - self._awake_us, boot
        self._judge(self._clock.now_us())

    def arrived(self, chords: Sequence[str], *, play: bool = True) -> bool:
        """A read with these key presses (perhaps none) came: whether they are stale. `play`: they
        play actions, and no dialog has them.

        Ask `stale` and `age_us` again behind an answer in the same read.
        """
        boot = self._clock.boot_us()
        silence_us = boot - self._keys_us
        self._burst = not self._answers and (
            self._gap_us > self._stale_us or (self._burst and silence_us < PAUSE_S * 1_000_000)
        )
        known = self._answers and not self._multiplexed
        self._untyped = _untyped(chords, not known and silence_us > self._stale_us)
        if chords:
            if len(chords) >= PASTED and len(set(chords)) > 1:
                self._text_us = boot if play else None
            elif self._text_us is not None and boot - self._text_us < PAUSE_S * 1_000_000:
                self._untyped = True
            self._keys_us = boot
        self._judge(self._clock.now_us())
        return self.stale

    @property
    def now_us(self) -> int:
        """The time on which ages stand: `Clock.boot_us`."""
        return self._clock.boot_us()

    @property
    def age_us(self) -> int:
        """How old a key may be that comes now, in microseconds."""
        if self._answers:
            return self._clock.boot_us() - self._since.boot_us
        return self._gap_us

    @property
    def untyped(self) -> bool:
        """Whether the keys that came last are more than anybody types, or the rest of such."""
        return self._untyped

    @property
    def stale(self) -> bool:
        """Whether a key that comes now is not to be played."""
        return self._untyped or self._burst or self.age_us > self._stale_us

    def _judge(self, now: int) -> None:
        """A terminal that never answered a question counts as well, with unknown round trip."""
        waited_us = 0 if self._unanswered_us is None else now - self._unanswered_us
        alive = not self._answers or waited_us <= DEAD_S * 1_000_000
        before, self.ok = self.ok, alive and not self._away
        self._publish()
        if before and not self.ok:
            self._feed.ask(Beat(line_ok=False))  # the next beat may be half a second away

    def _publish(self) -> None:
        self._feed.line_ok = self.ok
        self._feed.round_trip_us = None if self.rtt_ms is None else round(self.rtt_ms * 1000)


def _untyped(chords: Sequence[str], after_silence: bool) -> bool:
    """Whether so many keys in one read cannot have been typed just now."""
    if len(set(chords)) <= 1:
        return len(chords) >= (REPEATS_AFTER_SILENCE if after_silence else REPEATS)
    return len(chords) >= (BURST if after_silence else PASTED)
