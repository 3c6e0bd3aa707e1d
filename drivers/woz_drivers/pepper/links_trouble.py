"""Why a robot cannot be reached, in words for the wizard."""

from __future__ import annotations

import errno
import os

from woz_drivers.pepper.address import Address
from woz_tui.core.driver import Lost

#: Reasons that mean: nobody is there.
_NOBODY = frozenset({errno.EHOSTUNREACH, errno.ENETUNREACH, errno.EHOSTDOWN, errno.ETIMEDOUT})
#: Nobody reads more of what a robot says, in characters.
_READABLE = 300


class Refused(Lost):
    """The robot is there, but will not have us, or is not the one we trust: trying again is of no
    use until somebody changes something.
    """


def words(text: str) -> str:
    """What a robot says of an error, in one line, without the listing of its program."""
    line = " ".join(text.partition("\n\nAt:")[0][: 4 * _READABLE].split())
    shown = "".join(sign if sign.isprintable() else "�" for sign in line)
    return shown if len(shown) <= _READABLE else f"{shown[:_READABLE]}…"


def unreachable(address: Address, number: int | None, text: str) -> Lost:
    """The system said no: `number` is its errno where known, `text` its words."""
    where = address.shown
    if number == errno.ECONNREFUSED:
        return Lost(
            f"{where} is there, but nothing listens on port {address.port}",
            "wait until NAOqi has started; NAOqi 2.9 and newer is tcps://nao@HOST:9503",
        )
    if number in _NOBODY:
        return silent(address)
    if "not found" in text.lower() or "not known" in text.lower() or "resolution" in text.lower():
        return unknown(address)
    reason = words(text) or (os.strerror(number) if number else "no reason given")
    return Lost(f"{where} cannot be reached: {reason}", "check its power and the network")


def unknown(address: Address) -> Lost:
    """No host has this name."""
    return Lost(
        f"no host is called {address.shown}",
        "press the robot's chest button: it says its IP address; give that",
    )


def silent(address: Address) -> Lost:
    """Nobody answered in time."""
    return Lost(
        f"{address.shown} does not answer",
        "is the robot on, and is this machine in its network?",
    )


def wrong_password(address: Address, variable: str, given: bool) -> Refused:
    """The robot does not take user and password."""
    if not given:
        return Refused(
            f"{address.shown} wants a password for the user {address.user or 'nao'}",
            f"set the environment variable {variable} before `woz` is started, and write the"
            " address as tcps://USER@HOST",
        )
    return Refused(
        f"{address.shown} refused the password of the user {address.user}",
        f"correct {variable} and start again, or give another user: tcps://USER@HOST",
    )


def hung_up(address: Address, variable: str) -> Lost:
    """The robot ended the connection before it was whole; libqi does not tell why."""
    return Lost(
        f"{address.shown} hung up while we logged in",
        f"is it starting? if not, it does not take the user {address.user or '(none)'} with the"
        f" password in {variable}: correct them, in the form tcps://USER@HOST",
    )


def wrong_certificate(address: Address, found: str) -> Refused:
    """Another certificate than the trusted one."""
    return Refused(
        f"{address.shown} shows another certificate than `trusted` says",
        f"is it the right robot? if so, set `trusted: {found}`",
    )
