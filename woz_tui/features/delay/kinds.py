"""What is said of the response delay in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds


class ShapingChanged(Message, frozen=True, kw_only=True, tag="shaping.changed"):
    """From here on the robot answers a cue no sooner than `floor_us` and a random 0 to `jitter_us`
    after it; both 0: at once. `cues`: which (see `action.held`).
    """

    floor_us: int
    jitter_us: int
    cues: list[str]


class ActionHeld(Message, frozen=True, kw_only=True, tag="action.held"):
    """An action was asked for sooner after a cue than the robot answers: it begins at `until`. The
    cue's `sort` is speech (the visitor's speech ended), engagement or marker; `cued` is its moment,
    `until` that of the beginning, on the axis of `t`.
    """

    run: str
    action: str
    sort: str
    cued: int
    until: int


KINDS = FeatureKinds(messages=(ShapingChanged, ActionHeld), open=(ShapingChanged, ActionHeld))
