"""The qi messaging protocol, NAOqi's wire, in Python alone.

`NaoqiClient` calls services of a robot; `QiServer` offers some, with a directory of its own.
"""

from qimessaging.client import NaoqiClient
from qimessaging.errors import (
    CallCancelledError,
    CallTimeoutError,
    ConnectionLostError,
    LoginError,
    ProtocolError,
    QiError,
    RefusedError,
    RemoteError,
    ServiceLostError,
)
from qimessaging.hosted_objects import HostedMethod, HostedObject, HostedProperty, HostedSignal
from qimessaging.registering import Registration
from qimessaging.remote import RemoteObject
from qimessaging.server import QiServer

__all__ = [
    "CallCancelledError",
    "CallTimeoutError",
    "ConnectionLostError",
    "HostedMethod",
    "HostedObject",
    "HostedProperty",
    "HostedSignal",
    "LoginError",
    "NaoqiClient",
    "ProtocolError",
    "QiError",
    "QiServer",
    "RefusedError",
    "Registration",
    "RemoteError",
    "RemoteObject",
    "ServiceLostError",
]
