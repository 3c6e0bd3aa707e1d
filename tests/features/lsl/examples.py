"""A message and a request of each kind, for the golden files."""

from __future__ import annotations

from woz_tui.features.lsl.kinds import (
    AskLslBegin,
    AskLslTake,
    AskLslTell,
    LslAdopted,
    LslClock,
    LslFound,
    LslLost,
    LslStream,
    TakenStream,
)

MESSAGES = (
    LslAdopted(
        prefix="ada",
        sensors=["distance"],
        shares=["texts"],
        takes=[
            TakenStream(stream="eyes", source_id="tobii-12", type="Markers"),
            TakenStream(stream="pulse", use="reading", sensor="heart", every_us=500_000),
        ],
    ),
    LslStream(
        stream="woz-markers", type="Markers", source_id="woz-S01-markers", uid="0", taken=True
    ),
    LslFound(stream="eyes", type="Markers", source_id="tobii-12", uid="1", host="tracker"),
    LslClock(stream="eyes", offset_us=-1204.5, uncertainty_us=310.0, too_fast=3),
    LslLost(stream="eyes", why="its program has ended, or its computer is not reached"),
    LslLost(stream="woz-markers", why="woz lsl has ended", outgoing=True),
)
REQUESTS = (
    AskLslBegin(ref=41),
    AskLslTell(ref=42, told=MESSAGES[3]),
    AskLslTake(ref=43, stream="eyes", text="fixation", at=12_000_000),
    AskLslTake(ref=44, stream="pulse", value=71.5, at=12_100_000),
)
