"""Segments of speech that a robot notices by itself, as the session wants them told."""

from __future__ import annotations

from woz_tui.drivers.contract import DriverContext
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText


class NoticedSpeech:
    """Numbers the segments, from 1; each that began ends once. Times are those of the log.

    Attributes:
        ended_us: When the last segment ended.
    """

    def __init__(self, context: DriverContext) -> None:
        self._context = context
        self._segment = 0
        #: When the segment under way began; None: nobody speaks.
        self._began_us: int | None = None
        self.ended_us = 0

    @property
    def going_on(self) -> bool:
        """Whether somebody speaks."""
        return self._began_us is not None

    @property
    def now_us(self) -> int:
        """The time of the log."""
        return self._context.t(self._context.clock.now_us())

    def begin(self) -> None:
        """Somebody speaks, if nobody did before."""
        if self._began_us is None:
            self._segment += 1
            self._began_us = self.now_us
            self._context.tell(
                SpeechStarted(driver="", segment=self._segment, began=self._began_us)
            )

    def end(self, detail: str = "", heard_us: int | None = None) -> bool:
        """Nobody speaks any more, since now or since `heard_us`; `detail` says why, where that was
        not for silence. Returns whether anybody did before.
        """
        began, self._began_us = self._began_us, None
        if began is None:
            return False
        self.ended_us = max(began, self.now_us if heard_us is None else heard_us)
        self._context.tell(
            SpeechEnded(
                driver="", segment=self._segment, began=began, ended=self.ended_us, detail=detail
            )
        )
        return True

    def understood(self, text: str, took_us: int = 0) -> None:
        """The text of the last segment."""
        self._context.tell(SpeechText(driver="", segment=self._segment, text=text, took_us=took_us))
