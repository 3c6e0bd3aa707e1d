"""What is said of scripts in the log and on the socket."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class ScriptMoved(Message, frozen=True, kw_only=True, tag="script.moved"):
    """The script's next line: `position` counts from 0; equal to the length at the end.

    `phase`: whose script; empty: that of the file. `played`: lines that were played, also those
    that are being played; older logs do not say it, there it is all before `position`. `halted`:
    the script stands still at this line, because it ended so (failed, refused, stopped, superseded;
    mistake: it was marked as one before its end).
    """

    position: int
    phase: str = msgspec.field(default_factory=str)
    played: list[int] | None = None
    halted: str = msgspec.field(default_factory=str)


class AskScript(Request, frozen=True, kw_only=True, tag="script"):
    """Play the script's next line (`play`), or move its position without playing: to `to`, or by
    so many lines from where it stands then (`by`; below 0: back). `text` is said in place of the
    line's first sentence, this once.

    `key`, `age_us`, `stale`, `slots`, `slot_sources` and `slots_took_us` as for an action.
    """

    aged = True
    plays = True
    play: bool = True
    to: int | None = None
    by: int = 0
    text: str = ""
    key: str = ""
    age_us: int = 0
    stale: bool = False
    slots: dict[str, str] = {}
    slot_sources: dict[str, str] = {}
    slots_took_us: int = 0


KINDS = FeatureKinds(messages=(ScriptMoved,), requests=(AskScript,), open=(ScriptMoved,))
