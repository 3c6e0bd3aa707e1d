"""What is said of streams of the Lab Streaming Layer in the log and on the socket."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request

#: The names behind the session's of the streams that are always sent; others are sensors'.
MARKERS, EVENTS = "markers", "events"


class TakenStream(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A stream that the session takes: its name, and its `source_id` and `type` where they are to
    be these. `use`: marker, cue or reading; `sensor`: the readings' name, `every_us`: the time
    between two of them at least.
    """

    stream: str
    source_id: str = ""
    type: str = ""
    use: str = msgspec.field(default_factory=lambda: "marker")
    sensor: str = ""
    every_us: int = 0


class LslAdopted(Message, frozen=True, kw_only=True, tag="lsl.settings"):
    """What `woz lsl` goes by from here on: `prefix`, with which the names of its streams begin, the
    `sensors` that it sends, what else of the log it `shares` (texts, conditions, codes), and the
    streams that it `takes`.
    """

    prefix: str = "woz"
    sensors: list[str] = []
    shares: list[str] = []
    takes: list[TakenStream] = []


class LslStream(Message, frozen=True, kw_only=True, tag="lsl.stream"):
    """The session is sent as this stream. `taken`: a recorder or another program takes it; told
    when that changes, too.
    """

    stream: str
    type: str
    source_id: str
    uid: str = ""
    taken: bool = False


class LslFound(Message, frozen=True, kw_only=True, tag="lsl.found"):
    """A stream that the session takes is there, from the computer `host`."""

    stream: str
    type: str = ""
    source_id: str = ""
    uid: str = ""
    host: str = ""


class LslLost(Message, frozen=True, kw_only=True, tag="lsl.lost"):
    """A stream is gone, one that the session takes or (`outgoing`) one of those as which it is
    sent; `why` says so in words.
    """

    stream: str
    why: str = ""
    outgoing: bool = False


class LslClock(Message, frozen=True, kw_only=True, tag="lsl.clock"):
    """How the clock of a stream's computer stands to this session's: `offset_us` added to a stamp
    from there makes one of the clock of `woz lsl`; half of a round trip, `uncertainty_us`, is how
    wrong it can be. `too_fast`: values of the stream so far that came too fast to be taken.
    """

    stream: str
    offset_us: float
    uncertainty_us: float
    too_fast: int = 0


class AskLslBegin(Request, frozen=True, kw_only=True, tag="lsl.begin"):
    """This program sends the session and takes its streams; refused while another one does."""


class AskLslTell(Request, frozen=True, kw_only=True, tag="lsl.tell"):
    """What the program that sends the session has to tell of the streams: a line for the log."""

    told: LslStream | LslFound | LslLost | LslClock


class AskLslTake(Request, frozen=True, kw_only=True, tag="lsl.take"):
    """What came over a stream that the file names: a `text`, or a number. `at`: its moment, in
    microseconds on the axis of `t`.
    """

    stream: str
    text: str = ""
    value: float | None = None
    at: int = -1


MESSAGES = LslAdopted, LslStream, LslFound, LslLost, LslClock
KINDS = FeatureKinds(
    messages=MESSAGES,
    requests=(AskLslBegin, AskLslTell, AskLslTake),
    open=MESSAGES,
    unlisted=(LslAdopted, LslClock),
)
