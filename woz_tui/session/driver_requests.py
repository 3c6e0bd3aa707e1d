"""What drivers ask of the session: the hands on a control panel, the sounds of a move."""

from __future__ import annotations

import logging
from collections.abc import Callable, Container, Mapping

from woz_tui.config.experiment import Call
from woz_tui.drivers.contract import Ask
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import CommandRefusal, RequestOrigin
from woz_tui.session.participant_identity import RequestError

log = logging.getLogger(__name__)

#: Told how an ask ended: whether it was carried out, and why not.
OnCompletion = Callable[[bool, str], None]
#: Sends a call on to the bus, which is told what to do while it is busy, and tells its end.
Send = Callable[[Call, RequestOrigin, str, CommandRefusal | None, Callable[[m.End], None]], object]


class DriverRequests:
    """Carries out what drivers ask for, as if the wizard had pressed a key.

    Args:
        carry: What is to be done for action, stop, release, script and mark.
        call: Makes a call of a verb: raises `RequestError` if no driver can be named.
        send: Sends it.
        names: Names of all drivers.
        refuses: Why a verb is not even tried; the refusal is logged.
    """

    def __init__(
        self,
        carry: Mapping[str, Callable[[Ask, RequestOrigin], object]],
        call: Callable[[str, Mapping[str, m.Json], str], Call],
        send: Send,
        names: Container[str],
        refuses: Callable[[Ask], CommandRefusal | None] = lambda ask: None,
    ) -> None:
        self._carry = carry
        self._call = call
        self._send = send
        self._names = names
        self._refuses = refuses

    def ask(self, driver: str, ask: Ask, done: OnCompletion | None = None) -> None:
        """Carry out what `driver` asks for; `done` hears how it ended."""
        tell: OnCompletion = done or (lambda carried, why: None)
        try:
            self._carry_out(driver, ask, tell)
        except RequestError as error:
            tell(False, error.reason)
        except Exception as error:  # a stranger's ask; a knob would wait for its answer for ever
            log.exception("what %s asked for failed: %s", driver, ask)
            tell(False, f"{type(error).__name__}: {error}")

    def _carry_out(self, driver: str, ask: Ask, tell: OnCompletion) -> None:
        origin = RequestOrigin(ask.source, ask.key, driver)
        if ask.what == "verb":
            self._verb(driver, ask, origin, tell)
            return
        carry = self._carry.get(ask.what)
        if carry is None:
            raise RequestError(f"a driver cannot ask for {ask.what!r}")
        carry(ask, origin)
        tell(True, "")

    def _verb(self, driver: str, ask: Ask, origin: RequestOrigin, tell: OnCompletion) -> None:
        call = self._call(ask.name, ask.args, self._within(driver, ask.on))
        refusal = self._refuses(ask)

        def ended(end: m.End) -> None:
            tell(isinstance(end, m.Done), end.reason)

        self._send(call, origin, ask.when_busy or "queue", refusal, ended)
        if refusal is not None:
            tell(False, refusal.reason)

    def _within(self, driver: str, on: str) -> str:
        """The full name of `on` beside `driver`: robots of an experiment keep to themselves."""
        robot, dot, _ = driver.rpartition(".")
        if not dot:
            return on
        beside = f"{robot}.{on}" if on else robot
        return beside if not on or beside in self._names else on
