"""What a Furhat hears: when somebody speaks, what was understood so far, and the whole of it.

It listens all the time but while it speaks itself. What is understood so far is a reading of the
sensor `speech`, with the words as its text.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from woz_drivers.furhat.link import FurhatLink, FurhatPart
from woz_drivers.furhat.realtime_events import (
    HearEnded,
    HearPartial,
    HearStarted,
    ListenEnded,
    ListenStarted,
)
from woz_drivers.furhat.settings import SETTINGS, FurhatSettings
from woz_drivers.sound.noticed_speech import NoticedSpeech
from woz_tui.drivers.contract import SPEECH, SPEECH_TEXT, DriverContext, Job, Offer
from woz_tui.protocol.messages import Json

#: It stops listening by itself for these reasons, and goes on after a while; else it is asked to.
_BY_ITSELF = ("robot_speak",)
#: Else it is asked again after so long, twice as long each time that nobody was heard meanwhile,
#: but so often at most; after so many times that is told.
_AGAIN_S, _DOUBLED, _OFTEN = 0.5, 6, 4


class FurhatHearing(FurhatPart):
    """Segments of speech with their texts."""

    SETTINGS = (SETTINGS["listening"],)

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._wanted = settings.listening.on
        self._listens = False
        self._speech = NoticedSpeech(context)
        #: Whether the last segment has ended before its text came.
        self._textless = False
        #: When it has to be asked to listen again, on the loop's clock; None: it has not.
        self._again: float | None = None
        self._ends_in_vain = 0
        link.on(ListenStarted, self._started)
        link.on(ListenEnded, self._ended)
        link.on(HearStarted, self._hears)
        link.on(HearPartial, self._hears_so_far)
        link.on(HearEnded, self._heard)

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """`listen`; speech and its texts."""
        return Offer(
            verbs=(
                SETTINGS["listening"].changed_by(
                    "recognise what is said, or stop doing so", lane="listen", limit_s=5.0
                ),
            ),
            sensors=(SPEECH, SPEECH_TEXT),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Begin or end listening."""
        self._wanted, self._again = job.args.get("on") is True, None
        if self._wanted:
            await self._listen()
        else:
            await self._link.send("request.listen.stop")
        return {"on": self._wanted}

    async def connected(self) -> None:
        """Listen if that is wanted."""
        self._state()
        if self._wanted:
            await self._listen()

    def lost(self) -> None:
        """Nobody knows whether they speak on."""
        self._listens, self._again, self._ends_in_vain = False, None, 0
        self._cut("the robot is not connected")
        self._context.sensor(SPEECH, "stale", "the robot is not connected")

    async def go_on(self) -> None:
        """Ask it to listen again if it has stopped for no reason of ours."""
        if self._again is not None and asyncio.get_running_loop().time() >= self._again:
            self._again = None
            await self._listen()

    async def close(self) -> None:
        """The session is over."""
        self._cut("the session ended")

    def shown(self) -> Mapping[str, Json]:
        """Whether it listens."""
        return {"listening": self._listens}

    async def _listen(self) -> None:
        settings = self._settings.listening
        phrases = {"phrases": list(settings.phrases)} if settings.phrases else {}
        await self._link.send(
            "request.listen.config", languages=list(settings.languages), **phrases
        )
        await self._link.send(
            "request.listen.start",
            partial=True,
            concat=True,
            stop_no_speech=False,
            stop_robot_start=True,
            stop_user_end=False,
            resume_robot_end=True,
            end_speech_timeout=settings.end_speech,
        )

    # -- what the robot tells ------------------------------------------------------------------

    def _started(self, _: ListenStarted) -> None:
        self._listens, self._again = True, None
        self._state()

    def _ended(self, event: ListenEnded) -> None:
        self._listens = False
        self._cut("")  # what it has understood of that is still told
        if self._wanted and event.cause not in _BY_ITSELF:
            after_s = _AGAIN_S * 2 ** min(self._ends_in_vain, _DOUBLED)
            self._again = asyncio.get_running_loop().time() + after_s
            self._ends_in_vain += 1
            if self._ends_in_vain == _OFTEN:
                why = f" ({event.cause})" if event.cause else ""
                self._context.notice(
                    "warning",
                    f"the robot ends listening by itself again and again{why}",
                    "look at the recognition of speech in its web interface",
                )
        self._state()

    def _state(self) -> None:
        if self._listens:
            self._context.sensor(SPEECH, "ready", "the robot tells itself when somebody speaks")
        else:
            self._context.sensor(SPEECH, "paused", "the robot does not listen now")

    def _hears(self, _: HearStarted) -> None:
        self._ends_in_vain = 0
        self._cut("")
        self._begin()

    def _hears_so_far(self, event: HearPartial) -> None:
        if not self._speech.going_on:
            self._begin()
        self._context.reading(SPEECH, None, text=event.text)

    def _heard(self, event: HearEnded) -> None:
        if not self._speech.going_on and not self._textless:
            self._begin()
        self._cut("")
        self._textless = False
        words = (event.text or "").strip()
        self._context.reading(SPEECH, None, text=words)
        self._speech.understood(words)

    def _begin(self) -> None:
        self._textless = False
        self._speech.begin()

    def _cut(self, detail: str) -> None:
        """What is under way ends now."""
        self._textless = self._speech.end(detail) or self._textless
