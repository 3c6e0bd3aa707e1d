"""A microphone's live sound on its way to who listens (`woz listen`).

Who listens asks for each piece (`requests.AskSound`) and gets it as a `SoundHeard`.
"""

from __future__ import annotations

from woz_tui.protocol.envelope import Answer


class SoundHeard(Answer, frozen=True, kw_only=True, tag="sound"):
    """The answer to an `AskSound`; not part of the session's stream and never logged.

    `data` holds samples (S16_LE, one channel, in base64) at `rate` frames a second, up to frame
    `end`. It was sent at `sent_us` of CLOCK_BOOTTIME, in the time of the computer of who listens,
    `age_us` microseconds after the first sample came. `lost` frames before them are gone. Without
    new sound within a second `data` is empty and `why` says so. `microphones`: the drivers of this
    session that have one; `driver` is whose sound this is.
    """

    ref: int
    driver: str = ""
    microphones: list[str] = []
    rate: int = 0
    end: int = 0
    age_us: int = 0
    sent_us: int = 0
    lost: int = 0
    data: str = ""
    why: str = ""
