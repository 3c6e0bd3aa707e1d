"""Live sound: a microphone's to those who listen, and a voice to a loudspeaker. Never in the log.

Who listens asks for each piece and gets what the microphone's feed has and they have not had. The
feed holds a fraction of a second, so whoever asks late loses sound, and nothing piles up here.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
from dataclasses import dataclass

from msgspec.structs import replace

from woz_tui.drivers.sound_feeds import (
    LISTEN,
    LISTENED,
    SOUND,
    TALK,
    VOICE,
    VOICE_STATE,
    WIDTH,
    LiveSound,
    SoundListened,
    SoundPiece,
    SoundWindow,
    VoiceState,
)
from woz_tui.host.client_connection import ClientConnection
from woz_tui.protocol.live_sound import SoundHeard
from woz_tui.protocol.messages import Json, ListenerJoined, ListenerLeft
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requests import AskSound, AskTalk, Reply
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session import Session

#: How long new sound is waited for, and how often it is looked for, in seconds.
WAIT_S, LOOK_S = 1.0, 0.01
#: Pieces of sound that may be asked for at once, by who is far away.
AHEAD = 32
#: A microphone is told that somebody listens for so much longer than the longest wait, in seconds.
LISTENED_S = 2.5
#: The longest piece of a voice that is taken at once, in seconds.
LONGEST_S = 1.0
#: A voice that is older when it comes is dropped: a network held it back. In seconds.
LATE_S = 0.5
#: Whoever has sent no voice for so long has left it to others, in seconds.
SILENT_S = 5.0
#: Feed -> how to get a driver that has it.
_HOW_TO_ADD = {
    SOUND: Sentence(
        "host.add_microphone",
        "add one to the robot file: `ears: {{type: microphone}}` (docs/how-to/live-sound.md)",
    ),
    VOICE_STATE: (
        Sentence(
            "host.add_voice",
            "add one to the robot file: `voice: {{type: speech, talk: {{}}}}`"
            " (docs/how-to/live-sound.md)",
        )
    ),
}


@dataclass(slots=True)
class _Listening:
    """A client that listens, since when, and the frames that it lost."""

    driver: str
    began_us: int
    lost: int = 0
    rate: int = 0
    #: The frame up to which it has got sound, and how many answers it waits for.
    end: int = 0
    waiting: int = 0


@dataclass(slots=True)
class _Talking:
    """Whose voice a driver gets."""

    client: ClientConnection
    window: SoundWindow
    sent_us: int
    #: What came so late that it was not played, in seconds.
    late_s: float = 0.0


class SoundService:
    """Answers `AskSound` and `AskTalk` for one session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._listening: dict[ClientConnection, _Listening] = {}
        self._asking: dict[ClientConnection, asyncio.Task[None]] = {}
        self._talking: dict[str, _Talking] = {}

    def _drivers_with(self, feed: str) -> list[str]:
        """Drivers that have named this feed, in the order of the experiment."""
        named = self._session.feeds.drivers(feed)
        return [driver for driver in self._session.drivers if driver in named]

    def _driver(self, wanted: str, feed: str, what: str, lacking: str) -> str:
        """The one that is meant. Raises `RequestError`."""
        offered = self._drivers_with(feed)
        if not offered:
            lacks = {
                spec.name: spec.offer.lacks.get(lacking, "")
                for spec in self._session.experiment.drivers
                if wanted in ("", spec.name)
            }
            why = "; ".join(f"{name}: {each}" for name, each in lacks.items() if each)
            raise RequestError(
                Sentence("host.no_driver", "no driver of this session has a {what}", what=what),
                why or _HOW_TO_ADD[feed],
            )
        if wanted and wanted not in offered:
            raise RequestError(
                Sentence("host.has_none", "{wanted} has no {what}", wanted=wanted, what=what),
                Sentence(
                    "host.drivers_with",
                    "drivers with a {what}: {names}",
                    what=what,
                    names=", ".join(offered),
                ),
            )
        return wanted or offered[0]

    # -- who listens -------------------------------------------------------------------------

    def answer_listener(self, client: ClientConnection, request: AskSound) -> None:
        """Answer with sound, at once or within a second. Raises `RequestError`."""
        words_tell = bool(self._session.experiment.by_condition)
        view = client.view
        if view is not None and not view.redactor.may_hear(words_tell=words_tell):
            raise RequestError(
                Sentence(
                    "host.sound_reveals",
                    "live sound could reveal what this study hides from you",
                ),
                Sentence(
                    "host.listen_later",
                    "listen after the session to what the file has recorded",
                ),
            )
        driver = self._driver(request.driver, SOUND, "microphone with live sound", LISTEN)
        listening = self._listening.get(client)
        if listening is None or listening.driver != driver:
            self._end_listening(client)
            listening = self._begin_listening(client, driver)
        if listening.waiting >= AHEAD:
            raise RequestError(
                Sentence(
                    "host.pieces_asked",
                    "{ahead} pieces of sound have been asked for and did not come yet",
                    ahead=AHEAD,
                )
            )
        sound = self._session.feeds.feed(driver, SOUND).latest().value
        after = request.after
        if after <= 0 and isinstance(sound, LiveSound):  # what is left is of who listened earlier
            after = sound.end
        now = self._session.clock.now_us()
        listened = SoundListened(now + round(LISTENED_S * 1_000_000))
        self._session.feeds.feed(driver, LISTENED).put(listened)
        listening.waiting += 1
        before, follows = self._asking.get(client), request.after < 0
        self._asking[client] = asyncio.get_running_loop().create_task(
            self._in_order(client, listening, before, replace(request, after=after), follows)
        )

    async def _in_order(
        self,
        client: ClientConnection,
        listening: _Listening,
        before: asyncio.Task[None] | None,
        request: AskSound,
        follows: bool,
    ) -> None:
        """Answer when what was asked before has been answered; `follows`: with what comes then."""
        try:
            if before is not None:
                await asyncio.wait([before])
            after = (listening.end if follows else 0) or request.after
            await self._send_sound(client, listening.driver, request.ref, after)
        finally:
            listening.waiting -= 1
            if self._asking.get(client) is asyncio.current_task():
                del self._asking[client]

    def _begin_listening(self, client: ClientConnection, driver: str) -> _Listening:
        if client not in self._listening:
            client.closed.add_done_callback(lambda closed: self._end_listening(client))
        began = self._listening[client] = _Listening(driver, self._session.clock.now_us())
        self._publish(ListenerJoined(console=client.name, driver=driver))
        return began

    def _end_listening(self, client: ClientConnection) -> None:
        listening = self._listening.pop(client, None)
        if listening is None:
            return
        lost_us = listening.lost * 1_000_000 // listening.rate if listening.rate else 0
        self._publish(
            ListenerLeft(
                console=client.name,
                driver=listening.driver,
                duration_us=self._session.clock.now_us() - listening.began_us,
                lost_us=lost_us,
            )
        )

    def _publish(self, message: ListenerJoined | ListenerLeft) -> None:
        if not self._session.ended:
            self._session.hub.publish(message)

    async def _send_sound(
        self, client: ClientConnection, driver: str, ref: int, after: int
    ) -> None:
        shown = SoundHeard(ref=ref, driver=driver, microphones=self._drivers_with(SOUND))
        found = await self._next_sound(driver, after)
        if found is None:
            why = Sentence(
                "host.no_sound",
                "{driver} sent no sound within {wait_s:g} s",
                driver=driver,
                wait_s=WAIT_S,
            )
            client.send(replace(shown, why=why))
            return
        rate, piece = found
        if (listening := self._listening.get(client)) is not None:
            listening.rate, listening.end = rate, piece.end
            listening.lost += piece.lost
        client.send(
            replace(
                shown,
                rate=rate,
                end=piece.end,
                age_us=self._session.clock.now_us() - piece.t_us,
                sent_us=self._session.clock.boot_us(),
                lost=piece.lost,
                data=base64.b64encode(piece.pcm).decode(),
            )
        )

    async def _next_sound(self, driver: str, after: int) -> tuple[int, SoundPiece] | None:
        """What came after frame `after`, as soon as there is something; and its rate."""
        feed = self._session.feeds.feed(driver, SOUND)
        loop = asyncio.get_running_loop()
        until = loop.time() + WAIT_S
        while True:
            sound = feed.latest().value
            if isinstance(sound, LiveSound):
                piece = sound.after(after)
                if piece is not None:
                    return sound.rate, piece
            if loop.time() >= until:
                return None
            await asyncio.sleep(LOOK_S)

    # -- who talks ---------------------------------------------------------------------------

    def answer_talker(self, client: ClientConnection, request: AskTalk) -> Reply:
        """Hand a voice to the loudspeaker. Raises `RequestError`."""
        driver = self._driver(request.driver, VOICE_STATE, "loudspeaker for a live voice", TALK)
        state = self._session.feeds.feed(driver, VOICE_STATE).latest().value
        if not isinstance(state, VoiceState):
            raise RequestError(
                Sentence("host.no_live_voice", "{driver} takes no live voice yet", driver=driver),
                Sentence("host.wait_connected", "wait until it is connected"),
            )
        talking = self._talker(client, driver, state.rate)
        if request.data:
            self._take_voice(client, talking, request)
        data: dict[str, Json] = {
            **{"driver": driver, "rate": state.rate, "on": state.on},
            "late_s": round(talking.late_s, 3),
        }
        return Reply(ref=request.ref, ok=True, data=data)

    def _talker(self, client: ClientConnection, driver: str, rate: int) -> _Talking:
        now = self._session.clock.now_us()
        talking = self._talking.get(driver)
        if talking is not None and talking.client is not client:
            silent = now - talking.sent_us > SILENT_S * 1_000_000
            if not talking.client.closed.done() and not silent:
                raise RequestError(
                    Sentence(
                        "host.voice_taken",
                        "{name} sends its voice to {driver} already",
                        name=talking.client.name,
                        driver=driver,
                    ),
                    Sentence("host.end_talk", "end its `woz talk` first"),
                )
            talking = _Talking(client, talking.window, now)
        elif talking is None:
            window = SoundWindow(self._session.feeds.feed(driver, VOICE), rate)
            talking = _Talking(client, window, now)
        talking.sent_us = now
        self._talking[driver] = talking
        return talking

    def _take_voice(self, client: ClientConnection, talking: _Talking, request: AskTalk) -> None:
        rate = talking.window.rate
        if request.rate != rate:
            raise RequestError(
                Sentence(
                    "host.wrong_rate",
                    "the voice has {rate} Hz, and the robot file asks for {wanted} Hz",
                    rate=request.rate,
                    wanted=rate,
                ),
                Sentence(
                    "host.record_so",
                    "record with `arecord -f S16_LE -c 1 -r {rate}`",
                    rate=rate,
                ),
            )
        try:
            pcm = base64.b64decode(request.data, validate=True)
        except binascii.Error as error:
            raise RequestError(
                Sentence("host.no_base64", "the voice is no base64: {error}", error=error)
            ) from error
        if len(pcm) % WIDTH or len(pcm) > LONGEST_S * rate * WIDTH:
            raise RequestError(
                Sentence(
                    "host.no_voice_piece",
                    "{count} bytes are no piece of a voice: it has whole samples of {width} bytes,"
                    " and at most {longest_s:g} s",
                    count=len(pcm),
                    width=WIDTH,
                    longest_s=LONGEST_S,
                )
            )
        age_us = max(0, request.age_us) + self._session.standstill.waited_us(request.sent_us)
        lasted_s = len(pcm) / (WIDTH * rate)
        if age_us / 1_000_000 - lasted_s > LATE_S:
            talking.late_s += lasted_s
            return
        began_us = self._session.clock.now_us() - age_us
        lost_s = max(0.0, request.lost_s) + talking.late_s
        talking.window.add(pcm, began_us, client.name, lost_s)
