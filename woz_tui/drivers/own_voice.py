"""Whose voice a microphone hears: a visitor's, or the robot's own out of its loudspeaker.

One rule for the microphone's driver, which cuts the sound by it, and for whoever reads a log that
was written before there was a rule. Speech that begins while the robot speaks, or within `TAIL_US`
after it, is the robot's own. It is a visitor's all the same, an *overlap*, if it goes on for more
than `GOES_ON_US` after the robot fell silent, or if its words are others than the robot's.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS

#: Feed of a driver that hears: what the robots of the session say, as `RobotSpeech`.
ROBOT_SPEECH = "robot.speech"
#: For so long after its end a sentence may still be heard: a loudspeaker is late, a room echoes.
TAIL_US = 500_000
#: Speech that goes on for longer after the robot fell silent is somebody else's.
GOES_ON_US = 600_000
#: A sentence whose end is missing in a damaged log lasts so long: no `say` may run for longer.
LONGEST_US = 180_000_000
#: A text is the robot's if so many of its words are, in their order.
ALIKE = 0.6
#: Sentences that are kept, and requests for some that have not begun; words that are compared.
_KEPT, _MOST_WORDS = 32, 400
#: What a robot's text has beside words: `\pau=500\`, `^start(animations/...)`.
_TAGS = re.compile(r"\\[^\\]*\\|\^\w+\([^)]*\)")


@dataclass(frozen=True, slots=True)
class RobotSentence:
    """Something that a robot says, by the command of that id; times on the axis of `t`, in
    microseconds. `ended`: None while it is being said.
    """

    command: str
    text: str
    began: int
    ended: int | None = None

    @property
    def last(self) -> int:
        """Until when it is said at the longest."""
        return self.began + LONGEST_US if self.ended is None else self.ended


@dataclass(frozen=True, slots=True)
class RobotSpeech:
    """What the robots of a session have said of late, and say now, oldest first."""

    sentences: tuple[RobotSentence, ...] = ()
    #: What was asked for and has not begun: the command and its text.
    _asked: Mapping[str, str] = field(default_factory=dict)

    def after(self, message: m.Message) -> RobotSpeech:
        """The same with what a message tells: only commands that speak, and their ends, do."""
        if isinstance(message, m.Command):
            if message.verb not in SPEAKING_VERBS:
                return self
            text = message.args.get("text")
            asked = {**self._asked, message.command: text if isinstance(text, str) else ""}
            if len(asked) > _KEPT:
                del asked[next(iter(asked))]
            return RobotSpeech(self.sentences, asked)
        if isinstance(message, m.Dispatched):
            if message.command not in self._asked:
                return self
            asked = {**self._asked}
            said = RobotSentence(message.command, asked.pop(message.command), message.t)
            return RobotSpeech((*self.sentences, said)[-_KEPT:], asked)
        if isinstance(message, m.End):
            of_speech = {*self._asked, *(each.command for each in self.sentences)}
            if message.command not in of_speech:
                return self
            sentences = tuple(
                replace(each, ended=message.t)
                if each.command == message.command and each.ended is None
                else each
                for each in self.sentences
            )
            asked = {**self._asked}
            asked.pop(message.command, None)
            return RobotSpeech(sentences, asked)
        return self

    def heard_at(self, t: int) -> bool:
        """Whether speech that begins at `t` is the robot's own."""
        return any(each.began <= t <= each.last + TAIL_US for each in self.sentences)

    def began_within(self, since: int, until: int) -> bool:
        """Whether the robot began a sentence later than `since`, and not later than `until`."""
        return any(since < each.began <= until for each in self.sentences)

    def silent_since(self, t: int) -> int | None:
        """When the robot fell silent, at `t`; None: it speaks, or has never spoken."""
        last = max((each.last for each in self.sentences if each.began <= t), default=t + 1)
        return last if last <= t else None

    def said_within(self, began: int, ended: int) -> str:
        """What the robot may be heard to say between two moments."""
        return " ".join(
            each.text
            for each in self.sentences
            if each.began <= ended and each.last + TAIL_US >= began
        )


def is_robots(text: str, said: str) -> bool:
    """Whether what was understood is what the robot said, rather than somebody's words. Where it
    said nothing in words (`utter`), words do not tell.
    """
    heard, own = _words(text), _words(said)
    return not heard or not own or _in_order(heard, own) >= ALIKE * len(heard)


def visitors_words(words: Sequence[m.SpokenWord], said: str) -> list[m.SpokenWord]:
    """Those words that are not among the robot's."""
    own = set(_words(said))
    return [word for word in words if not own.issuperset(_words(word.text))]


def _words(text: str) -> list[str]:
    return re.findall(r"\w+", _TAGS.sub(" ", text).casefold())[:_MOST_WORDS]


def _in_order(one: Sequence[str], other: Sequence[str]) -> int:
    """The length of the longest common subsequence."""
    lengths = [0] * (len(other) + 1)
    for word in one:
        before = 0
        for at, each in enumerate(other, 1):
            kept = lengths[at]
            lengths[at] = before + 1 if word == each else max(lengths[at], lengths[at - 1])
            before = kept
    return lengths[-1]
