"""What the console asks of the robot process, and the replies; what was typed in this sitting."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from woz_tui.config.screen_language import say, word
from woz_tui.console.link.message_feed import GONE, Loss, MessageFeed
from woz_tui.protocol import requests as r
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.messages import Json

#: Called in the console's own thread with the reply to a request, with a picture.
OnReply = Callable[[r.Reply], None]
OnPicture = Callable[[PictureShown], None]
#: Utterances typed in this sitting, for the history of `/`.
HISTORY = 100


def press_to(key: str, what: str) -> str:
    """`press ) to begin one`; `what` may be empty. A key in brackets would not be readable."""
    if not what:
        return say("link.press", "press {key}", key=key)
    return say("link.press_to", "press {key} to {what}", key=key, what=what)


class Connection(Protocol):
    """Knows whether the robot process can be reached."""

    lost: Loss | None


class RobotRequests:
    """Requests with their replies, and drafts of dialogs.

    Args:
        feed: Where requests go.
        connection: Whether it is there; what is asked meanwhile is refused.
        news: Shows a sentence above the hints.
        key: The key of one of the console's own commands, as a cap shows it.
        later: Calls with a reply once the console has worked through what it has.
        over: Called when the session that was ended from here is over.
    """

    def __init__(
        self,
        feed: MessageFeed,
        connection: Connection,
        *,
        news: Callable[[str, str], None],
        key: Callable[[str], str],
        later: Callable[[OnReply, r.Reply], object],
        over: Callable[[], None],
    ) -> None:
        self._feed, self._connection = feed, connection
        self._news, self._key, self._later, self._over = news, key, later, over
        self._waiting: dict[int, OnReply] = {}
        self._watching: dict[int, OnPicture] = {}
        #: Whether the session is being ended from here.
        self.ending = False
        #: Whether the wizard was ending it when something was asked here first.
        self.leaving = False
        #: Where the sentences are that the end wrote into a copy of the experiment file.
        self.typed_copy = ""
        self.drafts: dict[str, str] = {}
        self.history: list[str] = []
        self.moved: list[str] = []

    def ask(self, request: r.Request, on_reply: OnReply | None = None) -> None:
        """Send a request; without `on_reply` a refusal is shown above the hints."""
        if self._connection.lost:
            self._later(on_reply or self.refused, r.Reply(ref=0, ok=False, reason=GONE))
            return
        self._waiting[self._feed.ask(request)] = on_reply or self.refused

    def ask_picture(self, request: r.AskPicture, show: OnPicture, refused: OnReply) -> None:
        """Ask for a camera's picture: it comes in a reply's place."""
        ref = self._feed.ask(request)
        self._waiting[ref], self._watching[ref] = refused, show

    def pictured(self, shown: PictureShown) -> None:
        self._waiting.pop(shown.ref, None)
        show = self._watching.pop(shown.ref, None)
        if show is not None:
            show(shown)

    def replied(self, reply: r.Reply) -> None:
        """A reply came; those to keys pressed in the input thread have no waiting dialog."""
        self._watching.pop(reply.ref, None)
        self._waiting.pop(reply.ref, self.refused)(reply)

    def forget(self) -> None:
        """The connection is gone: no reply will come any more."""
        waiting, self._waiting = self._waiting, {}
        self._watching.clear()
        for ref, on_reply in waiting.items():
            on_reply(r.Reply(ref=ref, ok=False, reason=GONE))
        if self.ending:
            self._over()

    def refused(self, reply: r.Reply) -> None:
        """Show above the hints why something was not done."""
        if not reply.ok:
            key = self._key(reply.command) if reply.command else ""
            if key and reply.command == "release":
                self._news(say("stop.is_stopped", "Stopped. {key} releases", key=key), "warn")
                return
            hint = press_to(key, reply.hint) if key else reply.hint
            self._news("; ".join(part for part in (word(reply.reason), hint) if part), "warn")

    def say(self, text: str, on: str, key: str) -> None:
        """Say a typed utterance; `key` opened the dialog."""
        self.history = [*(old for old in self.history if old != text), text][-HISTORY:]
        self.ask(r.AskVerb(verb="say", args={"text": text}, on=on, source="key", key=key))

    def move(self, name: str, on: str, key: str) -> None:
        """Play a typed move; `key` opened the dialog."""
        self.moved = [*(old for old in self.moved if old != name), name][-HISTORY:]
        args: dict[str, Json] = {"move": name}
        self.ask(r.AskVerb(verb="play", args=args, on=on, source="key", key=key))

    def end_session(self) -> None:
        """End the session; the console goes when the robot process has gone.

        Until then the robot may move to its rest pose, and the stop is still needed.
        """
        self.ask(r.AskEnd(reason="wizard"), self._end_answered)

    def _end_answered(self, reply: r.Reply) -> None:
        self.ending = reply.ok
        if reply.ok:
            told = say("link.ends", "Session ends: the robot takes its rest pose")
            self._news(told, "warn")
        else:
            self.refused(reply)
