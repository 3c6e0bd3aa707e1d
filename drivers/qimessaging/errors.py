"""What can go wrong between two ends of the qi messaging protocol."""

from __future__ import annotations


class QiError(Exception):
    """Something did not work; the text says what, for a person to read."""


class ProtocolError(QiError):
    """Bytes that are no qi messaging, or a value that does not fit its signature."""


class Refused(QiError):  # noqa: N818 - read as `raise Refused(...)`
    """The other end said no: no such service or method, other arguments, or the method failed."""


class RemoteError(Refused):
    """The method was called and failed; the text is the other end's."""


class LoginError(Refused):
    """The other end does not let us in."""


class ServiceLost(Refused):
    """This one service has gone; the connection to the directory stands."""


class Cancelled(Refused):
    """The other end says that the call was cancelled, though not by us."""


class TimedOut(QiError):  # noqa: N818 - as above
    """No answer came in time. The other end may still carry the call out."""


class ConnectionLost(QiError):  # noqa: N818 - as above
    """The connection has ended; nothing else will come through it."""
