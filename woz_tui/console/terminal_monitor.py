"""Measures the line to the wizard's terminal: round trip, whether it lives, which keys are stale.

The round trip is measured with the question `CSI 5 n` (are you well?), to which every terminal
answers `CSI 0 n`. The cursor's position, `CSI 6 n`, would measure the same, but its answer in the
first row cannot be told from F3 with modifiers. Inside tmux and screen it is they who answer: the
measure then ends at them, and not at the wizard's desk.

A key is stale if it may have waited somewhere for longer than the wizard would want it played:

* the question has been out for `stale_s`, or could not be asked for so long because the terminal
  took no output, and nothing at all came in that time: the line stood still, so what comes now was
  pressed before, up to the answer or a pause of 0.3 s;
* three keys or more in one read after a silence of `stale_s`: nobody types that, a line that was
  frozen for less than a question's interval sends it;
* this process itself stood still (stopped, or the computer slept) while keys came;
* eight keys or more in one read at any time: text pasted into a terminal without paste marks.

Repeats of one and the same key, held down, count as few: a third of a second of them may share a
read after a silence, a second of them at any time.
"""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.console.message_feed import MessageFeed
from woz_tui.system.clock import Clock

#: The question, and how often it is asked.
QUESTION = "\x1b[5n"
EVERY_S = 2.0
#: An unanswered question is asked again after so long: it may have got lost.
AGAIN_S = 10.0
#: The same while the terminal takes no output, so that nothing could be asked.
PUT_OFF_S = 0.25
#: After so long without an answer or anything else the line counts as dead; driving then stops.
DEAD_S = 3.0
#: A press that may be older is not played.
STALE_S = 1.5
#: A pause that ends a burst of stale keys.
PAUSE_S = 0.3
#: Keys in one read that nobody typed: after a silence, and at any time.
BURST, PASTED = 3, 8
#: The same for repeats of one key, at 30 a second.
REPEATS_AFTER_SILENCE, REPEATS = 10, 30


class TerminalMonitor:
    """Used from the thread that reads the terminal; `rtt_ms` and `ok` may be read anywhere.

    What it finds out it also writes to the feed, which tells the host with every beat.
    """

    def __init__(self, feed: MessageFeed, clock: Clock) -> None:
        self._feed = feed
        self._clock = clock
        #: Whether this terminal has ever answered: one that does not is not dead for that.
        self._answers = False
        self.reset()

    def reset(self) -> None:
        """Begin anew, at the start and after a suspension: old silence says nothing."""
        now = self._clock.now_us()
        self.rtt_ms: float | None = None
        self.ok = True
        self._asked_us: int | None = None
        #: Since when an answer is due, or would be if the terminal took the question.
        self._unanswered_us: int | None = None
        #: When the question was asked that was answered last, and when its answer came: what had
        #: been written before the one has reached the terminal at the other. None: never.
        self.confirmed_us: tuple[int, int] | None = None
        #: The shortest time from a question to its answer so far, in microseconds; 0: unknown.
        self.quickest_us = 0
        self._hurried = False
        self._first_us: int | None = None
        self._due_us = now
        self._heard_us = self._clock.boot_us()
        self._awake_us = self._clock.boot_us()
        self._slept = False
        self._burst = False
        self._away = False
        self._publish()

    def leave(self) -> None:
        """Nobody watches from here on, until `reset`: the console is about to be suspended."""
        self._away = True
        self.ok = False
        self._publish()

    @property
    def question_in_s(self) -> float:
        """Seconds until the next question is due; 0 or less: now."""
        if self._hurried and self._asked_us is None:
            return 0.0
        return (self._due_us - self._clock.now_us()) / 1_000_000

    def hurry(self) -> None:
        """Ask as soon as no question is out: somebody wants to know when all has been taken."""
        self._hurried = True

    @property
    def waits(self) -> bool:
        """Whether nobody knows yet if this terminal answers: it was asked only a moment ago."""
        asked = self._first_us
        return asked is None or self._clock.now_us() - asked < DEAD_S * 1_000_000

    def question_sent(self) -> None:
        """The question went out just now."""
        now = self._clock.now_us()
        self._asked_us = now
        self._wait_for_answer(now)
        self._first_us = self._first_us or now
        self._hurried = False
        self._due_us = now + round(AGAIN_S * 1_000_000)

    def put_off(self) -> None:
        """The terminal takes no output at the moment: ask later."""
        now = self._clock.now_us()
        self._hurried = False
        self._wait_for_answer(now)
        self._due_us = now + round(PUT_OFF_S * 1_000_000)

    def _wait_for_answer(self, since_us: int) -> None:
        if self._unanswered_us is None:
            self._unanswered_us = since_us

    def answered(self) -> None:
        """The terminal answered: the line is fine, and keys from here on are fresh."""
        now = self._clock.now_us()
        self._answers = True
        self._unanswered_us = None
        self._burst = False
        if self._asked_us is not None:
            self.rtt_ms = (now - self._asked_us) / 1000
            self.confirmed_us = (self._asked_us, now)
            took_us = now - self._asked_us
            self.quickest_us = min(took_us, self.quickest_us or took_us)
            self._due_us = max(now, self._asked_us + round(EVERY_S * 1_000_000))
            self._asked_us = None
        self._judge(now)

    def awake(self) -> None:
        """The reading thread runs; to be called at least every half second."""
        boot = self._clock.boot_us()
        if boot - self._awake_us > (STALE_S + 0.5) * 1_000_000:
            self._slept = True
        self._awake_us = boot
        self._judge(self._clock.now_us())

    def arrived(self, chords: Sequence[str]) -> bool:
        """A read with these key presses (perhaps none) came: whether they are stale.

        `answered`, called between the keys of one read, makes those behind it fresh.
        """
        now, boot = self._clock.now_us(), self._clock.boot_us()
        silence_us = boot - self._heard_us
        stood_still = silence_us > STALE_S * 1_000_000 and (self._stalled(now) or self._slept)
        self._burst = stood_still or (self._burst and silence_us < PAUSE_S * 1_000_000)
        self._heard_us = boot
        self._slept = False
        self._judge(now)
        return self._burst or _untyped(chords, silence_us > STALE_S * 1_000_000)

    @property
    def burst(self) -> bool:
        """Whether keys that come now belong to a burst after a stall."""
        return self._burst

    def _stalled(self, now: int) -> bool:
        return self._answers and self._unanswered_for_us(now) > STALE_S * 1_000_000

    def _unanswered_for_us(self, now: int) -> int:
        return 0 if self._unanswered_us is None else now - self._unanswered_us

    def _judge(self, now: int) -> None:
        """A terminal that never answered a question counts as well, with unknown round trip."""
        waited_us = min(self._unanswered_for_us(now), self._clock.boot_us() - self._heard_us)
        alive = not self._answers or waited_us <= DEAD_S * 1_000_000
        self.ok = alive and not self._away
        self._publish()

    def _publish(self) -> None:
        self._feed.line_ok = self.ok
        self._feed.round_trip_us = None if self.rtt_ms is None else round(self.rtt_ms * 1000)


def _untyped(chords: Sequence[str], after_silence: bool) -> bool:
    """Whether so many keys in one read cannot have been typed just now."""
    if len(set(chords)) <= 1:
        return len(chords) >= (REPEATS_AFTER_SILENCE if after_silence else REPEATS)
    return len(chords) >= (BURST if after_silence else PASTED)
