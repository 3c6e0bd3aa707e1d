"""The qi messaging protocol, NAOqi's wire, in Python alone.

`Client` calls services of a robot; `Server` offers some, with a directory of its own.
"""

from woz_drivers.qimessaging.client import Client
from woz_drivers.qimessaging.errors import (
    Cancelled,
    ConnectionLost,
    LoginError,
    ProtocolError,
    QiError,
    Refused,
    RemoteError,
    ServiceLost,
    TimedOut,
)
from woz_drivers.qimessaging.remote import RemoteObject

__all__ = [
    "Cancelled",
    "Client",
    "ConnectionLost",
    "LoginError",
    "ProtocolError",
    "QiError",
    "Refused",
    "RemoteError",
    "RemoteObject",
    "ServiceLost",
    "TimedOut",
]
