"""Feeds of a driver at another computer that reach the session: a camera's pictures, live sound;
and what the robots say, which a microphone there has to know.

Both sides look at their feeds a few times a second and send what is new; what the line has no room
for is dropped, and what comes late is not put into a feed. Values that drivers hand each other many
times a second (setpoints, faces) are not among them: such drivers belong to one computer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from woz_tui.drivers.feeds import Feed, Feeds
from woz_tui.drivers.own_voice import ROBOT_SPEECH, RobotSpeech
from woz_tui.drivers.sound_feeds import (
    LISTENED,
    SOUND,
    VOICE,
    VOICE_STATE,
    WIDTH,
    SoundListened,
    SoundReader,
    SoundWindow,
    VoiceState,
)
from woz_tui.network import driver_messages as dm
from woz_tui.protocol.camera_pictures import MOST_PIXELS, PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.system.clock import Clock

#: The feeds by which the session knows what a driver has.
OFFERS = (PICTURE, SOUND, VOICE_STATE, ROBOT_SPEECH)
#: How often feeds are looked at, in seconds.
LOOK_S = 0.02
#: Pictures a second, bytes of one and bytes of all a second that are sent at most.
PICTURES_S, PICTURE_BYTES, PICTURE_BYTES_S = 10.0, 3_000_000, 4_000_000
#: A wish to see or hear is sent again so often while it lasts, in seconds; it may not last longer.
WISH_S, LONGEST_WISH_S = 0.5, 5.0
#: Sound, and a picture, that is older when it comes is dropped, in seconds.
LATE_S, PICTURE_LATE_S = 0.5, 2.0
#: Rates of sound, in frames a second, and the longest piece, in seconds.
RATES, LONGEST_S = range(4_000, 192_001), 1.0

#: A driver's own feed of this name.
FeedOf = Callable[[str], Feed]
_SECOND = 1_000_000


def thinned(picture: Picture, width: int) -> Picture:
    """Every second, third ... pixel, so that it is not wider than needed nor longer than
    `PICTURE_BYTES`.
    """
    by = max(1, picture.width // max(1, width))
    while len(picture.rgb) // by**2 > PICTURE_BYTES:
        by += 1
    if by == 1:
        return picture
    line = 3 * picture.width
    rows = [picture.rgb[at : at + line] for at in range(0, len(picture.rgb), by * line)]
    wide = -(-picture.width // by)
    rgb = bytearray(3 * wide * len(rows))
    for colour in range(3):
        rgb[colour::3] = b"".join(row[colour :: 3 * by] for row in rows)
    return Picture(picture.t_us, wide, len(rows), bytes(rgb))


class _Sounds:
    """Sound that came over the line on its way into a feed."""

    def __init__(self, feed_of: FeedOf, topic: str, clock: Clock) -> None:
        self._feed_of = feed_of
        self._topic = topic
        self._clock = clock
        self._window: SoundWindow | None = None

    def take(self, sent: dm.SoundSent, t_us: int) -> None:
        """Put it into the feed, unless it is too late or no sound; its first sample came at `t_us`
        of the clock.
        """
        whole = len(sent.pcm) % WIDTH == 0 and len(sent.pcm) <= LONGEST_S * sent.rate * WIDTH
        late_us = self._clock.now_us() - t_us
        if sent.rate not in RATES or not whole or late_us > (LATE_S + LONGEST_S) * _SECOND:
            return
        if late_us / _SECOND - len(sent.pcm) / WIDTH / sent.rate > LATE_S:
            return
        if self._window is None or self._window.rate != sent.rate:
            self._window = SoundWindow(self._feed_of(self._topic), sent.rate)
        self._window.add(sent.pcm, t_us, sent.source[:100], max(0.0, sent.lost_s))


class ServedFeeds:
    """The driver's side.

    Args:
        feeds: Of the drivers of this computer.
        driver: Its name here.
        clock: Of this computer.
    """

    def __init__(self, feeds: Feeds, driver: str, clock: Clock) -> None:
        self._feeds = feeds
        self._driver = driver
        self._clock = clock
        self._voice = _Sounds(self._feed_of, VOICE, clock)
        self.begin()

    def begin(self) -> None:
        """A session begins to use the driver: it knows nothing yet."""
        self._offered: tuple[str, ...] = ()
        if self._driver in self._feeds.drivers(ROBOT_SPEECH):
            self._feed_of(ROBOT_SPEECH).put(None)
        self._sound: SoundReader | None = None
        self._picture = 0
        self._next_us = 0
        self._state: VoiceState | None = None

    def _feed_of(self, topic: str) -> Feed:
        return self._feeds.feed(self._driver, topic)

    def news(self, ahead_us: int) -> Iterator[dm.FromDriver]:
        """What is to be sent now; `ahead_us`: what is added to this clock's times for the session's
        computer. Pictures are bulky: see `is_bulky`.
        """
        offered = tuple(t for t in OFFERS if self._driver in self._feeds.drivers(t))
        if offered != self._offered:
            self._offered = offered
            yield dm.FeedsNamed(offered)
        if VOICE_STATE in offered:
            state = self._feed_of(VOICE_STATE).latest().value
            if isinstance(state, VoiceState) and state != self._state:
                self._state = state
                yield dm.VoiceTaken(state.rate, state.on)
        if SOUND in offered:
            yield from self._new_sound(ahead_us)
        if PICTURE in offered:
            yield from self._new_picture(ahead_us)

    def _new_sound(self, ahead_us: int) -> Iterator[dm.FromDriver]:
        wish = self._feed_of(LISTENED).latest().value
        if not (isinstance(wish, SoundListened) and wish.until_us > self._clock.now_us()):
            self._sound = None
            return
        if self._sound is None:
            self._sound = SoundReader(self._feed_of(SOUND))
        if (taken := self._sound.take()) is not None:
            piece, sound = taken
            yield dm.SoundSent(SOUND, sound.rate, piece.t_us + ahead_us, piece.pcm)

    def _new_picture(self, ahead_us: int) -> Iterator[dm.FromDriver]:
        now = self._clock.now_us()
        wish, latest = self._feed_of(WATCHED).latest().value, self._feed_of(PICTURE).latest()
        picture = latest.value
        if not (isinstance(wish, CameraWatched) and wish.until_us > now >= self._next_us):
            return
        if latest.serial == self._picture or not isinstance(picture, Picture):
            return
        self._picture = latest.serial
        sent = thinned(picture, wish.width)
        pause_s = max(1 / min(PICTURES_S, wish.rate), len(sent.rgb) / PICTURE_BYTES_S)
        # A little less: a camera's pictures do not come quite evenly.
        self._next_us = now + round(0.9 * pause_s * _SECOND)
        yield dm.PictureSent(sent.t_us + ahead_us, sent.width, sent.height, sent.rgb)

    def take(
        self, sent: dm.CameraWanted | dm.SoundWanted | dm.SoundSent | dm.RobotsSpoke, ahead_us: int
    ) -> None:
        """What the session has sent."""
        if isinstance(sent, dm.RobotsSpoke):
            self._feed_of(ROBOT_SPEECH).put(RobotSpeech(sent.sentences))
            return
        now, t_us = self._clock.now_us(), sent.boot_us - ahead_us
        until_us = min(t_us, now + round(LONGEST_WISH_S * _SECOND))
        match sent:
            case dm.CameraWanted(width=width, rate=rate):
                if 0 < width <= MOST_PIXELS and rate > 0:
                    self._feed_of(WATCHED).put(CameraWatched(until_us, width, rate))
            case dm.SoundWanted():
                self._feed_of(LISTENED).put(SoundListened(until_us))
            case dm.SoundSent(topic=topic):
                if topic == VOICE:
                    self._voice.take(sent, t_us)


def is_bulky(body: dm.FromDriver | dm.ToDriver) -> bool:
    """Whether everything else goes before it on the line."""
    return isinstance(body, dm.PictureSent)


def may_be_lost(body: dm.FromDriver | dm.ToDriver) -> bool:
    """Whether the next one replaces it, or it is of no use later."""
    return isinstance(body, dm.PictureSent | dm.SoundSent | dm.CameraWanted | dm.SoundWanted)


class SessionFeeds:
    """The session's side.

    Args:
        feed_of: The driver's feeds in the session.
        clock: The session's.
    """

    def __init__(self, feed_of: FeedOf, clock: Clock) -> None:
        self._feed_of = feed_of
        self._clock = clock
        self._offered: tuple[str, ...] = ()
        self._sound = _Sounds(feed_of, SOUND, clock)
        self._voice: SoundReader | None = None
        self._spoke = 0
        self._next_us: dict[str, int] = {}

    @property
    def _ahead_us(self) -> int:
        return self._clock.boot_us() - self._clock.now_us()

    def news(self) -> Iterator[dm.ToDriver]:
        """What is to be sent now."""
        for topic, offer in ((WATCHED, PICTURE), (LISTENED, SOUND)):
            if offer in self._offered:
                yield from self._wish(topic)
        if VOICE_STATE in self._offered:
            if self._voice is None:
                self._voice = SoundReader(self._feed_of(VOICE))
            if (taken := self._voice.take()) is not None:
                piece, sound = taken
                t_us = piece.t_us + self._ahead_us
                yield dm.SoundSent(VOICE, sound.rate, t_us, piece.pcm, sound.source, sound.lost_s)

        if ROBOT_SPEECH in self._offered:
            latest = self._feed_of(ROBOT_SPEECH).latest()
            if latest.serial != self._spoke and isinstance(latest.value, RobotSpeech):
                self._spoke = latest.serial
                yield dm.RobotsSpoke(latest.value.sentences)

    def _wish(self, topic: str) -> Iterator[dm.ToDriver]:
        now = self._clock.now_us()
        wish = self._feed_of(topic).latest().value
        if not isinstance(wish, CameraWatched | SoundListened) or wish.until_us <= now:
            return
        if now >= self._next_us.get(topic, 0):
            self._next_us[topic] = now + round(WISH_S * _SECOND)
            until_us = wish.until_us + self._ahead_us
            if isinstance(wish, CameraWatched):
                yield dm.CameraWanted(until_us, wish.width, wish.rate)
            else:
                yield dm.SoundWanted(until_us)

    def take(self, sent: dm.FeedsNamed | dm.PictureSent | dm.SoundSent | dm.VoiceTaken) -> None:
        """What the driver's side has sent."""
        match sent:
            case dm.FeedsNamed(topics=topics):
                self._offered = tuple(topic for topic in OFFERS if topic in topics)
                self._spoke = 0
                for topic in self._offered:
                    self._feed_of(topic)
            case dm.VoiceTaken(rate=rate, on=on):
                if rate in RATES:
                    self._feed_of(VOICE_STATE).put(VoiceState(rate, on))
            case dm.SoundSent(topic=topic):
                if topic == SOUND and SOUND in self._offered:
                    self._sound.take(sent, sent.boot_us - self._ahead_us)
            case dm.PictureSent(width=width, height=height, rgb=rgb):
                t_us = sent.boot_us - self._ahead_us
                late = self._clock.now_us() - t_us > PICTURE_LATE_S * _SECOND
                fits = 0 < len(rgb) == 3 * width * height and width > 0
                if PICTURE in self._offered and fits and not late:
                    self._feed_of(PICTURE).put(Picture(t_us, width, height, rgb))

    def lose(self) -> None:
        """Nothing comes any more, and nothing is heard there."""
        self._next_us.clear()
        self._voice = None
        if VOICE_STATE in self._offered:
            state = self._feed_of(VOICE_STATE).latest().value
            if isinstance(state, VoiceState):
                self._feed_of(VOICE_STATE).put(VoiceState(state.rate))
