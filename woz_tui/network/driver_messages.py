"""What a session and the computer of a driver send each other, as MessagePack.

Both sides say the same things in a frame: which life of the served driver (`instance`) and which
conversation with it (`epoch`) they belong to. `number` counts those that must not be lost, from 1
in each direction; who sees a gap ends the conversation, and everything is told anew in the next
one. Frames with number 0 may be lost: readings and values of feeds, which the next one replaces,
and pings.

Changing anything here needs another `LINK`.
"""

from __future__ import annotations

from typing import Any

import msgspec

from woz_tui.drivers.contract import (
    Ask,
    HealthStatement,
    ModeStatement,
    NoticeStatement,
    ReadingStatement,
    SensorStatement,
    UnableStatement,
)
from woz_tui.drivers.own_voice import RobotSentence
from woz_tui.protocol.messages import Json

#: Which form of these messages; two sides of different forms do not talk.
LINK = 4


class _Body(msgspec.Struct, frozen=True, tag_field="is"):
    """What a frame carries."""


class CallFailure(msgspec.Struct, frozen=True):
    """How something failed: the exception's class among those of the contract, and its words."""

    kind: str
    what: str
    remedy: str = ""


# -- from the session ------------------------------------------------------------------------------


class DriverHello(_Body, frozen=True, tag="hello"):
    """A session wants to use the driver. What it decoded must be what is served: hashes of each of
    its `settings`, and of its verbs and sensors (`offer`).
    """

    link: int
    version: str
    session: str
    name: str
    type: str
    settings: dict[str, str]
    offer: str
    media: str


class Pong(_Body, frozen=True, tag="pong"):
    """The answer to a ping, at once: this computer's time, the last number it has sent, and whether
    the stop is pressed. With the first one the driver begins.
    """

    sent_us: int
    boot_us: int
    t_us: int
    last: int
    stopped: bool


class Perform(_Body, frozen=True, tag="perform"):
    """Carry out a command, unless it comes after `deadline_us` of the session's clock."""

    id: int
    command: str
    verb: str
    args: dict[str, Json]
    source: str
    deadline_us: int


class Cancel(_Body, frozen=True, tag="cancel"):
    """End a command or a call."""

    id: int


class Stop(_Body, frozen=True, tag="stop"):
    """Stop; it overtakes what was sent before. Commands of a smaller number that have not begun
    must not begin any more.
    """

    id: int
    scope: str


class Invoke(_Body, frozen=True, tag="invoke"):
    """Call a method of the driver: prepare_say, predict, resume, reread, rest, close."""

    id: int
    what: str
    args: list[Any] = []


class Left(_Body, frozen=True, tag="left"):
    """The session has given this conversation up, because of `why`."""

    why: str


class AskEnded(_Body, frozen=True, tag="ask-ended"):
    """How something ended that the driver has asked the session for."""

    id: int
    ok: bool
    why: str


# -- from the driver -------------------------------------------------------------------------------


class Here(_Body, frozen=True, tag="here"):
    """It is here; sent again and again. `epoch` of the conversation and driver of the session
    (`user`) that has it; 0: no session.
    """

    link: int
    version: str
    epoch: int = 0
    user: str = ""


class NotTaken(_Body, frozen=True, tag="not-taken"):
    """The session cannot have it."""

    why: str
    remedy: str = ""


class Ping(_Body, frozen=True, tag="ping"):
    """What is your time? The first one says that the session has the driver. With the last number
    sent, and how long an answer takes (0: unknown).
    """

    sent_us: int
    last: int
    round_trip_us: int


class Ended(_Body, frozen=True, tag="ended"):
    """A command or a call has ended; without `failure` well, and this came of it."""

    id: int
    failure: CallFailure | None = None
    result: Any = None


class Expects(_Body, frozen=True, tag="expects"):
    """A command takes so many seconds more."""

    id: int
    seconds: float


class MarkSent(_Body, frozen=True, tag="mark"):
    """`Job.mark`: a point within a command."""

    id: int
    sort: str
    text: str


class EvidenceSaid(_Body, frozen=True, tag="evidence"):
    """`Job.evidence`: on what the end of a command stands, or of its motion."""

    id: int
    kind: str


class MotionGoesOn(_Body, frozen=True, tag="goes-on"):
    """`Job.goes_on`: the motion of a command is not over with it."""

    id: int


class MotionEnded(_Body, frozen=True, tag="motion-ended"):
    """Such a motion has arrived, or will not (`why`)."""

    id: int
    why: str


class StopTaken(_Body, frozen=True, tag="stop-taken"):
    """The stop has come and is being carried out."""

    id: int


class StopEnded(_Body, frozen=True, tag="stopped"):
    """The stop has been carried out, or has failed."""

    id: int
    failure: CallFailure | None = None
    confirmed: tuple[str, ...] | None = None
    missing: tuple[str, ...] = ()


class MessageSent(_Body, frozen=True, tag="message"):
    """`DriverContext.show` and `DriverContext.tell`: a line of the session's protocol. All else
    that a driver says is sent as its `DriverStatement`.
    """

    line: bytes


class AskSent(_Body, frozen=True, tag="ask"):
    """`DriverContext.ask`; `answered`: the driver wants to hear how it ended."""

    id: int
    ask: Ask
    answered: bool


# -- values of feeds -------------------------------------------------------------------------------
# Times in them are CLOCK_BOOTTIME of the session's computer, in microseconds.


class FeedsNamed(_Body, frozen=True, tag="feeds"):
    """The driver has named these of the feeds that are shared (`shared_feeds`)."""

    topics: tuple[str, ...]


class PictureSent(_Body, frozen=True, tag="picture"):
    """A camera's picture, as `camera_pictures.Picture`."""

    boot_us: int
    width: int
    height: int
    rgb: bytes


class SoundSent(_Body, frozen=True, tag="sound"):
    """New sound of a feed, in either direction: a microphone's, or a voice for a loudspeaker. The
    first sample came at `boot_us`.
    """

    topic: str
    rate: int
    boot_us: int
    pcm: bytes
    source: str = ""
    lost_s: float = 0.0


class VoiceTaken(_Body, frozen=True, tag="voice"):
    """What a loudspeaker takes, as `sound_feeds.VoiceState`."""

    rate: int
    on: bool


class CameraWanted(_Body, frozen=True, tag="watched"):
    """Somebody watches, as `camera_pictures.CameraWatched`, until `boot_us`."""

    boot_us: int
    width: int
    rate: float


class SoundWanted(_Body, frozen=True, tag="listened"):
    """Somebody listens until `boot_us`."""

    boot_us: int


class RobotsSpoke(_Body, frozen=True, tag="spoke"):
    """What the robots of the session say and have said of late, as `own_voice.RobotSpeech`; times
    on the axis of the session's messages.
    """

    sentences: tuple[RobotSentence, ...]


ToDriver = (
    DriverHello
    | Pong
    | Perform
    | Cancel
    | Stop
    | Invoke
    | AskEnded
    | Left
    | CameraWanted
    | SoundWanted
    | SoundSent
    | RobotsSpoke
)
FromDriver = (
    Here
    | NotTaken
    | Ping
    | Ended
    | Expects
    | MarkSent
    | EvidenceSaid
    | MotionGoesOn
    | MotionEnded
    | StopTaken
    | StopEnded
    | ReadingStatement
    | SensorStatement
    | HealthStatement
    | ModeStatement
    | NoticeStatement
    | UnableStatement
    | MessageSent
    | AskSent
    | FeedsNamed
    | PictureSent
    | SoundSent
    | VoiceTaken
)


class FrameToDriver(msgspec.Struct, frozen=True, array_like=True):
    """One frame from the session."""

    instance: str
    epoch: int
    number: int
    body: ToDriver


class FrameFromDriver(msgspec.Struct, frozen=True, array_like=True):
    """One frame to the session."""

    instance: str
    epoch: int
    number: int
    body: FromDriver


encode = msgspec.msgpack.Encoder(enc_hook=str).encode
#: What decoding raises if somebody sent nonsense.
UNREADABLE = (msgspec.MsgspecError, ValueError, RecursionError)
#: The longest frame that is taken, in bytes: a picture and what belongs to it.
MOST_BYTES = 1 << 22
to_driver = msgspec.msgpack.Decoder(FrameToDriver)
from_driver = msgspec.msgpack.Decoder(FrameFromDriver)
