"""What is said and asked of choices in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import RestrictedMessage
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class ChoiceOffered(RestrictedMessage, frozen=True, kw_only=True, tag="choice.offered"):
    """The participant is offered a choice of the experiment file, in place of the one before.
    `options`: what stands on the buttons; `pictures`: the names of their pictures, empty where
    there are none.
    """

    kept_whole = True
    choice: str
    question: str = ""
    options: list[str] = []
    pictures: list[str] = []


class ChoiceMade(RestrictedMessage, frozen=True, kw_only=True, tag="choice.made"):
    """The participant chose `option` of what was offered last. `after_us`: from its being seen, as
    the page knows it (-1: it does not). `console`: on which page.
    """

    names_console = True
    choice: str
    option: str
    after_us: int = -1
    console: str = ""


class ChoiceGone(RestrictedMessage, frozen=True, kw_only=True, tag="choice.gone"):
    """Nothing of it was chosen. `how`: taken_back, replaced, moved_on (the trial is over, or
    another participant has come), reloaded, end.
    """

    choice: str
    how: str


class AskChoose(Request, frozen=True, kw_only=True, tag="choose"):
    """Choose `option` of what is offered; `offer`: the number (`seq`) of its `choice.offered`, so
    that what is chosen is what was seen.
    """

    offer: int
    option: str
    after_us: int = -1


class AskChoicePicture(Request, frozen=True, kw_only=True, tag="choice.picture"):
    """The picture of an option, by its place among those that are offered: the reply's `data` has
    its `type` and, as base64, its `bytes`.
    """

    offer: int
    place: int


MESSAGES = (ChoiceOffered, ChoiceMade, ChoiceGone)
KINDS = FeatureKinds(
    messages=MESSAGES,
    requests=(AskChoose, AskChoicePicture),
    for_participants=MESSAGES,
    put_to_participants=(ChoiceOffered,),
)
