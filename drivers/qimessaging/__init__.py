"""The qi messaging protocol, NAOqi's wire, in Python alone.

`Client` calls services of a robot; `Server` offers some, with a directory of its own.
"""

from qimessaging.client import Client
from qimessaging.errors import (
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
from qimessaging.hosted_objects import Hosted, Method, Property, Signal
from qimessaging.registering import Registration
from qimessaging.remote import RemoteObject
from qimessaging.server import Server

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
