"""Exceptions of the qi messaging protocol."""

from __future__ import annotations


class QiError(Exception):
    """Something did not work; the text says what, for a person to read."""


class ProtocolError(QiError):
    """Bytes that are no qi messaging, or a value that does not fit its signature."""


class RefusedError(QiError):
    """The other end said no: no such service or method, other arguments, or the method failed."""


class RemoteError(RefusedError):
    """The method was called and failed; the text is the other end's."""


class LoginError(RefusedError):
    """The other end does not let us in."""


class ServiceLostError(RefusedError):
    """This one service has gone; the connection to the directory stands."""


class CallCancelledError(RefusedError):
    """The other end says that the call was cancelled, though not by us."""


class CallTimeoutError(QiError):
    """No answer came in time. The other end may still carry the call out."""


class ConnectionLostError(QiError):
    """The connection has ended; nothing else will come through it."""
