"""What is said of slots in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import RestrictedMessage
from woz_tui.protocol.kinds import FeatureKinds

#: The source of a value that was filled in before.
KEPT = "kept"


class SlotFilled(RestrictedMessage, frozen=True, kw_only=True, tag="slot.filled"):
    """A slot of an action's sentence has this `text` in the run `run`.

    `source`: typed, offered (one of the file's), heard (a word of what the visitor said), program,
    or kept (it was filled before). `took_us`: from when the console asked until the wizard sent it.
    `keep`: the value is kept for the participant or the trial (empty: it is not); `participant` and
    `trial`: which these are.
    """

    run: str
    action: str = ""
    slot: str
    text: str
    source: str
    took_us: int = 0
    keep: str = ""
    participant: str = ""
    trial: int = 0


KINDS = FeatureKinds(messages=(SlotFilled,))
