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
from woz_drivers.qimessaging.hosting import Hosted, Method, Property, Signal
from woz_drivers.qimessaging.registering import Registration
from woz_drivers.qimessaging.remote import RemoteObject
from woz_drivers.qimessaging.server import Server

__all__ = [
    "Cancelled",
    "Client",
    "ConnectionLost",
    "Hosted",
    "LoginError",
    "Method",
    "Property",
    "ProtocolError",
    "QiError",
    "Refused",
    "Registration",
    "RemoteError",
    "RemoteObject",
    "Server",
    "ServiceLost",
    "Signal",
    "TimedOut",
]
