"""A microphone that hears the robot: what it marks as the robot's, and where it cuts."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.microphone import transcriber

from tests.drivers.microphones import microphone_opener
from tests.drivers.published_messages import PATIENCE_S, PublishedMessages, until
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import RATE, square
from woz_tui.drivers.own_voice import ROBOT_SPEECH, RobotSentence, RobotSpeech
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText
from woz_tui.system.clock import ManualClock

SECOND = 1_000_000
EAR: dict[str, Any] = {"threshold": 0.1, "onset": 0.04, "hang_over": 0.4, "pre_roll": 0.06}
LOUD, QUIET = 0.5, 0.01
WORDS = "the whales are upstairs"


class Room:
    """Sound that comes at the pace of the clock, and what the robot says meanwhile."""

    def __init__(self, pipe: PipedCommand, clock: ManualClock, published: PublishedMessages):
        self._pipe, self._clock, self.published = pipe, clock, published
        self._frames = 0
        published.context.feed(LISTENED).put(SoundListened(clock.now_us() + 3600 * SECOND))
        self._said: tuple[RobotSentence, ...] = ()
        self._tell()

    @property
    def now(self) -> int:
        """On the axis of `t`."""
        return self.published.context.t(self._clock.now_us())

    def _tell(self) -> None:
        self.published.context.feed(ROBOT_SPEECH).put(RobotSpeech(self._said))

    def robot(self, text: str = WORDS) -> None:
        """The robot begins to speak."""
        self._said = (*self._said, RobotSentence("c", text, self.now))
        self._tell()

    def robot_ends(self) -> None:
        last = self._said[-1]
        ended = RobotSentence(last.command, last.text, last.began, self.now)
        self._said = (*self._said[:-1], ended)
        self._tell()

    async def hear(self, seconds: float, level: float) -> None:
        """So much sound, block by block; returns when the driver has judged it."""
        for _ in range(round(seconds / 0.02)):
            self._clock.advance(0.02)
            self._pipe.send(square(0.02, level))
            self._frames += RATE // 50
            await until(self._judged)

    def _judged(self) -> bool:
        sound = self.published.context.feed(SOUND).latest().value
        return isinstance(sound, LiveSound) and sound.end >= self._frames


Begin = Callable[..., Any]


@pytest.fixture
async def begin(tmp_path: Path) -> AsyncIterator[Begin]:
    pipe, clock = PipedCommand(tmp_path / "pipe"), ManualClock()
    async with microphone_opener(tmp_path) as some:

        async def started(**settings: Any) -> Room:
            settings = {"command": pipe.command, **EAR, **settings}
            _, published = await some.open(clock, "ears", **settings)
            await until(pipe.connected)
            return Room(pipe, clock, published)

        yield started


def told(room: Room) -> list[tuple[bool | None, bool]]:
    """Own, overlap of each segment that ended; each began as it ended."""
    ended = room.published.all(SpeechEnded)
    began = room.published.all(SpeechStarted)
    marks = [(one.own, one.overlap) for one in ended]
    assert [(one.own, one.overlap) for one in began[: len(ended)]] == marks
    assert [one.segment for one in ended] == [*range(1, len(ended) + 1)]
    return marks


async def test_what_begins_while_the_robot_speaks_is_its_own(begin: Begin) -> None:
    room = await begin()
    await room.hear(0.2, QUIET)
    room.robot()
    await room.hear(0.1, QUIET)
    await room.hear(1.0, LOUD)
    room.robot_ends()
    await room.hear(0.2, LOUD)  # the loudspeaker is late
    await room.hear(1.0, QUIET)
    await room.hear(0.5, LOUD)
    await room.hear(1.0, QUIET)
    assert told(room) == [(True, False), (False, False)]


async def test_where_it_goes_on_after_the_robot_it_is_cut(begin: Begin) -> None:
    """A visitor speaks into the sentence, and on for 1 s: theirs begins where it ended."""
    room = await begin()
    room.robot()
    await room.hear(1.0, LOUD)
    fell_silent = room.now
    room.robot_ends()
    await room.hear(1.0, LOUD)
    await room.hear(0.6, QUIET)
    assert told(room) == [(True, False), (False, True)]
    own, visitors = room.published.all(SpeechEnded)
    assert abs(own.ended - fell_silent) <= 40_000
    assert visitors.began == own.ended
    assert visitors.ended - visitors.began == pytest.approx(1.4 * SECOND, abs=60_000)


async def test_an_answer_within_the_silence_that_ends_speech_is_a_visitors(begin: Begin) -> None:
    """No overlap: the robot had ended. Its segment is still open, and is cut before the answer."""
    room = await begin(hang_over=1.0)
    room.robot()
    await room.hear(1.0, LOUD)
    room.robot_ends()
    await room.hear(0.4, QUIET)
    answered = room.now
    await room.hear(0.8, LOUD)
    await room.hear(1.2, QUIET)
    assert told(room) == [(True, False), (False, False)]
    assert abs(room.published.all(SpeechEnded)[1].began - (answered - 60_000)) <= 40_000


async def test_a_visitors_segment_ends_where_the_robot_begins(begin: Begin) -> None:
    """The wizard answers before the silence is over: the visitor has not spoken as long as that."""
    room = await begin(hang_over=1.0)
    await room.hear(1.0, LOUD)
    await room.hear(0.4, QUIET)
    began = room.now
    room.robot()
    await room.hear(2.0, LOUD)
    room.robot_ends()
    await room.hear(1.2, QUIET)
    assert told(room) == [(False, False), (True, False)]
    assert abs(room.published.all(SpeechEnded)[0].ended - began) <= 40_000


async def test_drop_leaves_the_robots_out_and_keeps_what_follows(begin: Begin) -> None:
    room = await begin(while_speaking="drop")
    room.robot()
    await room.hear(1.0, LOUD)
    room.robot_ends()
    await room.hear(1.0, LOUD)
    await room.hear(0.6, QUIET)
    assert told(room) == [(False, True)]


async def test_keep_makes_everybody_a_visitor(begin: Begin) -> None:
    room = await begin(while_speaking="keep")
    room.robot()
    await room.hear(0.5, LOUD)
    room.robot_ends()
    await room.hear(0.6, QUIET)
    assert told(room) == [(False, False)]


async def test_where_nobody_tells_what_the_robots_say_nothing_is_judged(begin: Begin) -> None:
    room = await begin()
    room.published.context.feed(ROBOT_SPEECH).put(None)
    await room.hear(0.5, LOUD)
    await room.hear(0.6, QUIET)
    assert told(room) == [(None, False)]


@pytest.mark.parametrize(
    ("words", "marks"),
    [("the whales are up stairs", (True, False)), ("where is the exit", (False, True))],
)
async def test_words_that_are_not_the_robots_are_a_visitors(
    begin: Begin, monkeypatch: pytest.MonkeyPatch, words: str, marks: tuple[bool, bool]
) -> None:
    monkeypatch.setattr(transcriber, "_FILE_S", PATIENCE_S)  # a busy machine is slow to write
    room = await begin(transcribe=("sh", "-c", f"echo {words}", "{file}"))
    room.robot()
    await room.hear(0.6, LOUD)
    room.robot_ends()
    await room.hear(0.6, QUIET)
    text = await room.published.first(SpeechText)
    assert text.text == words
    assert (text.own, text.overlap) == marks
    assert told(room) == [(True, False)], "nobody knew the words by then"


async def test_a_breath_of_its_own_voice_is_not_given_to_the_program(
    begin: Begin, tmp_path: Path
) -> None:
    """Programs make words of nothing: they would be a visitor's."""
    room = await begin(
        transcribe=("sh", "-c", "echo thank you", "{file}"), hang_over=0.1, pre_roll=0.0
    )
    room.robot()
    await room.hear(0.1, LOUD)
    await room.hear(0.2, QUIET)
    room.robot_ends()
    await room.hear(0.8, QUIET)
    await room.hear(0.5, LOUD)
    await room.hear(0.2, QUIET)
    text = await room.published.first(SpeechText)
    assert (text.segment, text.own) == (2, False)


def marked(messages: Iterable[SpeechStarted]) -> list[bool | None]:
    return [each.own for each in messages]


async def test_each_sentence_is_judged_by_itself(begin: Begin) -> None:
    room = await begin()
    for _ in range(2):
        room.robot()
        await room.hear(0.3, LOUD)
        room.robot_ends()
        await room.hear(1.2, QUIET)
        await room.hear(0.3, LOUD)
        await room.hear(0.6, QUIET)
    assert marked(room.published.all(SpeechStarted)) == [True, False] * 2
