"""Live sound between a driver and the robot process: a microphone's, and a voice for a loudspeaker.

Sound is no message: it is in no log and on no stream. A feed holds the newest fraction of a second
of it, cut into blocks. Who reads takes what it has not had yet; who reads too seldom loses sound
and learns how much. So sound is dropped and never late, and nobody waits for anybody.

A driver with a microphone makes a `SoundOffer` when it is made, and adds sound while it is
`wanted`. A driver through which somebody can talk names the feeds `VOICE` and `VOICE_STATE`, and
puts a `VoiceState` into the latter.
"""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.drivers.contract import DriverContext
from woz_tui.drivers.feeds import Feed

#: Feeds of the driver that has the microphone: its sound, and until when somebody listens.
SOUND, LISTENED = "sound", "sound.listened"
#: Feeds of the driver that plays a voice: its sound, and whether it is played now.
VOICE, VOICE_STATE = "voice.sound", "voice.state"
#: Under these names `Offer.lacks` says why there is no live sound, or how to have it.
LISTEN, TALK, END_TALK = "woz listen", "talk", "end_talk"
TALK_UNWRITTEN = dict.fromkeys((TALK, END_TALK), "write `talk: {}` into its settings")
NO_TALK = dict.fromkeys(
    (TALK, END_TALK),
    "it takes no live voice; add a driver of `type: speech` with `talk: {}`, which plays it with a"
    " loudspeaker of this machine",
)
#: So much sound a feed holds; who has lost some goes on with the newest so much. In seconds.
HELD_S, FRESH_S = 0.3, 0.04
#: Bytes of a sample: all live sound is S16_LE, one channel.
WIDTH = 2


@dataclass(frozen=True, slots=True)
class LiveBlock:
    """Some samples. `end`: frames from the beginning of the feed to its end; `t_us`: when it came,
    by the session's clock.
    """

    end: int
    t_us: int
    pcm: bytes

    @property
    def begin(self) -> int:
        """Frames from the beginning of the feed to its first one."""
        return self.end - len(self.pcm) // WIDTH


@dataclass(frozen=True, slots=True)
class SoundPiece:
    """What a reader has not had yet: samples up to frame `end`, of which the first came at `t_us`,
    and the `lost` frames before them.
    """

    end: int
    t_us: int
    pcm: bytes
    lost: int


@dataclass(frozen=True, slots=True)
class LiveSound:
    """The newest blocks, oldest first, at `rate` frames a second. `source`: who sends them, and
    `lost_s`, in seconds, what the source has dropped by itself so far.
    """

    rate: int
    blocks: tuple[LiveBlock, ...]
    source: str = ""
    lost_s: float = 0.0

    @property
    def end(self) -> int:
        """Frames from the beginning of the feed to now."""
        return self.blocks[-1].end

    def after(self, end: int) -> SoundPiece | None:
        """What came after frame `end`, in whole blocks; None: nothing. 0: a reader that begins gets
        the newest.
        """
        if end == self.end:
            return None
        begins = end <= 0 or end > self.end  # the latter: of an earlier run
        new = self.blocks
        if begins or end < new[0].begin:
            fresh = round(FRESH_S * self.rate)
            new = tuple(block for block in new if block.end > self.end - fresh)
        else:
            new = tuple(block for block in new if block.end > end)
        lost = 0 if begins else max(0, new[0].begin - end)
        return SoundPiece(self.end, new[0].t_us, b"".join(block.pcm for block in new), lost)


class SoundWindow:
    """Writes live sound into a feed. It belongs to one thread."""

    def __init__(self, feed: Feed, rate: int) -> None:
        self._feed = feed
        self.rate = rate
        self._blocks: tuple[LiveBlock, ...] = ()

    def add(self, pcm: bytes, t_us: int, source: str = "", lost_s: float = 0.0) -> None:
        """These samples came at `t_us`; S16_LE, one channel, whole samples."""
        if not pcm:
            return
        end = (self._blocks[-1].end if self._blocks else 0) + len(pcm) // WIDTH
        oldest = end - round(HELD_S * self.rate)
        kept = (block for block in self._blocks if block.begin >= oldest)
        self._blocks = (*kept, LiveBlock(end, t_us, pcm))
        self._feed.put(LiveSound(self.rate, self._blocks, source, lost_s))


class SoundReader:
    """Takes live sound out of a feed, from when it is made."""

    def __init__(self, feed: Feed) -> None:
        self._feed = feed
        sound = self._sound
        self._end = sound.end if sound is not None else 0

    @property
    def _sound(self) -> LiveSound | None:
        value = self._feed.latest().value
        return value if isinstance(value, LiveSound) else None

    def take(self) -> tuple[SoundPiece, LiveSound] | None:
        """What is new, and where it comes from; None: nothing."""
        sound = self._sound
        piece = sound.after(self._end) if sound is not None else None
        if sound is None or piece is None:
            return None
        self._end = piece.end
        return piece, sound


@dataclass(frozen=True, slots=True)
class SoundListened:
    """Somebody listens until `until_us` of the session's clock."""

    until_us: int


class SoundOffer:
    """A microphone's live sound; a driver that makes one has a microphone."""

    def __init__(self, context: DriverContext, rate: int) -> None:
        self._clock = context.clock
        self._listened = context.feed(LISTENED)
        self._window = SoundWindow(context.feed(SOUND), rate)

    @property
    def wanted(self) -> bool:
        """Whether somebody listens."""
        wish = self._listened.latest().value
        return isinstance(wish, SoundListened) and wish.until_us > self._clock.now_us()

    def add(self, pcm: bytes) -> None:
        """These samples came just now; S16_LE, one channel."""
        self._window.add(pcm, self._clock.now_us())


@dataclass(frozen=True, slots=True)
class VoiceState:
    """What a driver through which somebody talks takes: `rate` frames a second, S16_LE, one
    channel; and whether it is `on`: what comes is heard.
    """

    rate: int
    on: bool = False
