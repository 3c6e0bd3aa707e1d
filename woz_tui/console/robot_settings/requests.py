"""Requests to change a robot's settings: what does not show yet, and what was refused.

Of one setting one request is under way at a time: an arrow key held down sends its last value when
the robot has taken the one before.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from woz_tui.console.robot_settings.lines import CONNECTING, CONNECTION, SettingLine
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.requests import AskVerb, Reply
from woz_tui.system.text_cleaning import with_remedy

if TYPE_CHECKING:
    from woz_tui.console.link.robot_requests import OnReply
    from woz_tui.console.state.console_state import ConsoleState

#: A setting that was set is read back within this time; after it the robot's word counts again.
READ_BACK_US = 3_000_000

Key = tuple[str, str]
Ask = Callable[[AskVerb, "OnReply"], None]


@dataclass(slots=True)
class PendingSetting:
    """A requested value. `sent` is under way until `over`: session time of the command's end."""

    line: SettingLine
    value: Json
    sent: Json = None
    run: str = ""
    over: int | None = None
    #: The robot's settings when the command had ended: any later ones tell what became of it.
    then: m.SettingsShown | None = None


class SettingRequests:
    """Asks, and remembers what for.

    Args:
        state: State of the console.
        ask: Sends a request, and calls with its reply.
        refused: What to do with a refusal that nobody looks at any more.
        key: The key that opened the screen, for the log.
        watched: Whether anybody looks.
    """

    def __init__(
        self,
        state: ConsoleState,
        ask: Ask,
        refused: Callable[[Reply], None],
        key: str,
        watched: Callable[[], bool],
    ) -> None:
        self._picture, self._ask, self._refused, self._key = state, ask, refused, key
        self._pending: dict[Key, PendingSetting] = {}
        self._refusals: dict[Key, str] = {}
        self._watched = watched

    def change(self, driver: str, line: SettingLine, value: Json) -> None:
        """Ask the robot for a value, now or as soon as it has taken the one before."""
        key = (driver, line.id)
        self._refusals.pop(key, None)
        if line.setting.section == CONNECTION:  # whatever was refused of any
            self._refusals = {
                (robot, id_): why
                for (robot, id_), why in self._refusals.items()
                if robot != driver or not id_.startswith(CONNECTING)
            }
        pending = self._pending.get(key)
        if pending is not None and pending.over is None:
            pending.value = value
        else:
            self._pending[key] = PendingSetting(line, value)
            self._send(key)

    def awaited(self, driver: str, line: SettingLine) -> Json:
        """The value that was requested and does not show yet; None: there is none."""
        pending = self._pending.get((driver, line.id))
        return pending.value if pending is not None else None

    def refusal(self, driver: str, line: SettingLine) -> str:
        """Why the last value was not taken, or nothing."""
        return self._refusals.get((driver, line.id), "")

    def refuse(self, driver: str, line: SettingLine, why: str) -> None:
        """Say at a line why nothing is done."""
        self._refusals[driver, line.id] = why

    def settle(self, now: int) -> None:
        """Look what became of everything; `now` is session time. Call it at each painting."""
        for key, pending in list(self._pending.items()):
            end = (
                self._picture.ends.get(pending.run)
                if pending.over is None and pending.run
                else None
            )
            if end is not None:
                self._ended(key, pending, end, now)
            if pending.over is not None and (
                self._shows(key[0], pending) or now - pending.over > READ_BACK_US
            ):
                self._drop(key, pending)

    def _ended(self, key: Key, pending: PendingSetting, end: m.End, now: int) -> None:
        if not isinstance(end, m.Done):  # of those without a reason another command took its place
            if isinstance(end, m.Failed | m.TimedOut | m.Refused):
                told = with_remedy(end.reason, end.remedy)
                self._refusals[key] = remedy_text(told, self._picture)
            self._drop(key, pending)
        elif pending.value != pending.sent:
            self._send(key)
        else:
            pending.over, pending.then = now, self._picture.session.robots.shown.get(key[0])

    def _shows(self, driver: str, pending: PendingSetting) -> bool:
        robot, name = self._picture.session.robots.shown.get(driver), pending.line.setting.name
        if robot is None:
            return False
        known = name in robot.wanted or robot.values.get(name) == pending.value
        return known or robot is not pending.then

    def _send(self, key: Key) -> None:
        pending = self._pending[key]
        pending.sent, pending.run = pending.value, ""
        setting = pending.line.setting
        args = {setting.argument: pending.value} if setting.argument else {}
        request = AskVerb(verb=setting.verb, args=args, on=key[0], source="key", key=self._key)
        self._ask(request, functools.partial(self._answered, key, pending))

    def _answered(self, key: Key, pending: PendingSetting, reply: Reply) -> None:
        if self._pending.get(key) is not pending:
            return
        pending.run = reply.run if reply.ok else ""
        if not pending.run:
            self._drop(key, pending)
        if not reply.ok:
            self._refusals[key] = with_remedy(reply.reason, reply.hint)
            if not self._watched():
                self._refused(reply)

    def _drop(self, key: Key, pending: PendingSetting) -> None:
        if self._pending.get(key) is pending:
            del self._pending[key]
