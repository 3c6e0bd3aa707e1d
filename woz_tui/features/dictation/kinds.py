"""What is said of dictation in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import Message, RestrictedMessage
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


class DictationListens(Message, frozen=True, kw_only=True, tag="dictation.listens"):
    """The field for dictation is open on the wizard's `console` (`on`), or is not any more (`why`:
    closed, stop, left, or silent: the console has not said for a while that it is). `woz dictate`
    understands a voice in between alone.
    """

    on: bool
    console: str
    why: str = ""


class AskDictation(Request, frozen=True, kw_only=True, tag="dictation"):
    """Of a wizard's console: the field for dictation is open (`on`), or is closed. That it is still
    open (`again`) is said at least every two seconds: whoever falls silent has closed it. What the
    stop has closed meanwhile is not opened by that.
    """

    on: bool
    again: bool = False


class AskDictated(Request, frozen=True, kw_only=True, tag="dictate"):
    """Of `woz dictate`: what the wizard dictated, for the field of `say`."""

    text: str
    lasted_us: int = 0
    took_us: int = 0


KINDS = FeatureKinds(
    messages=(Dictated, DictationSaid, DictationListens),
    requests=(AskDictated, AskDictation),
    open=(DictationListens,),
    unlisted=(DictationListens,),
)
