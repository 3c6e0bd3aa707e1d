"""What `woz page` tells of itself, in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request

#: Characters of an address, or of what has failed.
MOST_TEXT = 300


class PageOpened(Message, frozen=True, kw_only=True, tag="page.opened"):
    """Pages of the session are at this `address`; told anew when the class has another code.
    `class_code`: what a class types there, which ends with the pages (empty: nobody watches).
    `roles`: for whom they are (watch, answer). `encrypted`: nobody in the network can read along.
    `console`: the connection of the pages.
    """

    address: str
    class_code: str = ""
    roles: list[str] = []
    encrypted: bool = False
    console: str = ""


class PageFailed(Message, frozen=True, kw_only=True, tag="page.failed"):
    """Something of the pages has failed, and `why`; the rest goes on."""

    why: str
    console: str = ""


class PageClosed(Message, frozen=True, kw_only=True, tag="page.closed"):
    """The pages at this address are gone."""

    address: str


class AskPageTell(Request, frozen=True, kw_only=True, tag="page.tell"):
    """What the program that shows the pages has to tell of them: a line for the log."""

    told: PageOpened | PageFailed


MESSAGES = (PageOpened, PageFailed, PageClosed)
KINDS = FeatureKinds(messages=MESSAGES, requests=(AskPageTell,), open=MESSAGES)
