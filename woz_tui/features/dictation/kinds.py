"""What is said of dictation in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import RestrictedMessage
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class Dictated(RestrictedMessage, frozen=True, kw_only=True, tag="dictated"):
    """The wizard dictated this `text` (`dictation` counts from 1), which is not said by that.
    `lasted_us`: how long she spoke; `took_us`: from the end of it to the text.
    """

    kept_whole = True
    dictation: int
    text: str
    lasted_us: int = 0
    took_us: int = 0


class DictationSaid(RestrictedMessage, frozen=True, kw_only=True, tag="dictated.said"):
    """The sentence of the command `command` was dictated (`dictations`). `distance`: how much of it
    was changed before it was said, 0 to 1; `after_us`: from the last text.
    """

    command: str
    dictations: list[int]
    distance: float = 0.0
    after_us: int = 0


class AskDictated(Request, frozen=True, kw_only=True, tag="dictate"):
    """Of `woz dictate`: what the wizard dictated, for the field of `say`."""

    text: str
    lasted_us: int = 0
    took_us: int = 0


KINDS = FeatureKinds(messages=(Dictated, DictationSaid), requests=(AskDictated,))
